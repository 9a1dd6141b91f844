!> The grid of a dry case from &domain, from the file of a surface or, for a wanted accuracy, the
!> one to begin with.
module dry_grids
   use dry_case, only: dry_case_t
   use dry_checks, only: fewest_nodes, finest_wave, has_shape, is_periodic
   use dry_surfaces, only: load_first_file, same_length
   use even_grids, only: even_nodes
   use findings, only: findings_t
   use height_file, only: heights_t
   use input_values, only: input_values_t, value_t
   use kinds, only: wp
   use text, only: to_text
   use validation_messages, only: report_missing
   implicit none (type, external)
   private

   public :: find_grid

   !> Nodes in the shorter direction of the first grid for a wanted accuracy, of a line and of an
   !> area, and the most.
   integer, parameter :: first_nodes(2) = [64, 32], most_in_direction = 2**30
   !> Share of a node that rounding may take.
   real(wp), parameter :: rounding = 1.0e-6_wp

contains

   !> Nodes and lengths, from &domain or from the file of a surface. Findings: missing or
   !> contradictory sizes; the file.
   subroutine find_grid(values, folder, dry, findings)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: folder
      type(dry_case_t), intent(inout) :: dry
      type(findings_t), intent(inout) :: findings
      character(len=12) :: counts(2), lengths(2)
      type(heights_t) :: heights
      type(value_t) :: slot
      integer :: i, nodes(2)

      dry%is_periodic = is_periodic(values)
      counts = ['intervals_x ', 'intervals_y ']
      lengths = ['length_x    ', 'length_y    ']
      nodes = [1, 1]
      dry%lengths = 0.0_wp
      if (values%problem == 'dry_line') then
         counts(1) = 'intervals'
         lengths(1) = 'length'
      end if
      call load_first_file(values, folder, heights, findings)
      if (findings%count > 0) return
      do i = 1, merge(1, 2, values%problem == 'dry_line')
         slot = values%slot('domain', trim(counts(i)))
         if (heights%grid(i) > 0) nodes(i) = heights%grid(i)
         dry%lengths(i) = nodes(i)*heights%spacing(i)
         if (slot%is_given .and. heights%grid(i) > 0 .and. slot%integer /= nodes(i) &
            .and. .not. dry%is_periodic) then
            call findings%add(slot%line, 'domain', trim(counts(i)), &
               'found ' // to_text(slot%integer) // ', expected the ' &
               // to_text(nodes(i)) // ' nodes of the file: without a period its heights have '// &
                  'no Fourier series to resample')
         else if (slot%is_given) then
            nodes(i) = slot%integer
         else if (heights%grid(i) <= 0 .and. .not. values%is_given('accuracy', 'target')) then
            call report_missing(values, 'domain', trim(counts(i)), findings)
         end if
         call find_length(values, trim(lengths(i)), dry%lengths(i), findings, heights%file)
      end do
      if (values%is_given('accuracy', 'target') .and. findings%count == 0) then
         call choose_first_grid(values, dry, heights%grid, nodes, findings)
      end if
      dry%grid%nx = nodes(1)
      dry%grid%ny = nodes(2)
      dry%recipe%nodes = nodes
      dry%grid%aspect = 1.0_wp
      if (findings%count == 0 .and. nodes(2) > 1) dry%grid%aspect = dry%lengths(2)/dry%lengths(1)
   end subroutine find_grid

   !> The `length` of one direction, that of the `file` of heights (if there is one) or 0
   !> before. Findings: neither is known; they contradict each other.
   subroutine find_length(values, key, length, findings, file)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: key
      real(wp), intent(inout) :: length
      type(findings_t), intent(inout) :: findings
      character(*), intent(in), optional :: file
      type(value_t) :: slot

      slot = values%slot('domain', key)
      if (.not. slot%is_given) then
         if (length > 0.0_wp) return
         if (present(file)) then
            call report_missing(values, 'domain', key, findings, &
               ': '//file//' has no attribute spacing, or spacing_'// &
               trim(merge('y', 'x', key == 'length_y')))
         else
            call report_missing(values, 'domain', key, findings)
         end if
      else if (length <= 0.0_wp) then
         length = slot%reals(1)
      else if (abs(slot%reals(1) - length) > same_length*length) then
         call findings%add(slot%line, 'domain', key, 'found ' // to_text(slot%reals(1)) // ' '// &
            'm, expected ' // to_text(length) &
            // ' m, nodes times spacing of the file')
      end if
   end subroutine find_length

   !> `nodes` with which the search for a grid begins, as many in every wave as a contact area
   !> needs: even numbers, or the nodes of a periodic file (`in_file`) times a power of two; the
   !> heights of an open file stay on their own. Finding: a synthetic surface whose shortest waves
   !> would be those of the grid.
   subroutine choose_first_grid(values, dry, in_file, nodes, findings)
      type(input_values_t), intent(in) :: values
      type(dry_case_t), intent(in) :: dry
      integer, intent(in) :: in_file(2)
      integer, intent(inout) :: nodes(2)
      type(findings_t), intent(inout) :: findings
      character(len=9), parameter :: groups(2) = ['surface_1', 'surface_2']
      real(wp) :: finest, spacing
      integer :: directions, i

      surfaces: do i = 1, 2
         if (values%is_given(groups(i), 'wavelength_short') .or. .not. has_shape(values, &
            groups(i), 'synthetic')) cycle surfaces
         call report_missing(values, groups(i), 'wavelength_short', findings, &
            'with &accuracy target')
      end do surfaces
      if (findings%count > 0) return
      if (in_file(1) > 0 .and. .not. dry%is_periodic) return
      directions = merge(1, 2, values%problem == 'dry_line')
      finest = min(finest_wave(values, groups(1)), finest_wave(values, groups(2)))/fewest_nodes
      associate (lengths => dry%lengths(:directions))
         if (in_file(1) > 0) then
            do while (any((1.0_wp - rounding)*lengths/finest > nodes(:directions)) &
               .and. maxval(nodes) <= most_in_direction/2)
               nodes(:directions) = 2*nodes(:directions)
            end do
         else
            spacing = min(minval(lengths)/first_nodes(directions), finest)
            nodes(:directions) = even_nodes((1.0_wp - rounding)*lengths/spacing, &
               real(most_in_direction, wp))
         end if
      end associate
   end subroutine choose_first_grid

end module dry_grids
