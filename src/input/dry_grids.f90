!> The grid of a dry case from &domain, from the file of a surface or, for a wanted accuracy, the
!> one to begin with; whether it resolves the waves of the surfaces.
module dry_grids
   use dry_case, only: dry_case_t
   use dry_surfaces, only: same_length
   use even_grids, only: even_nodes
   use file_heights, only: read_surface
   use input_values, only: input_values_t, value_t
   use kinds, only: wp
   use surface_keys, only: has_shape, surfaces
   use text, only: add_sentence, to_text
   implicit none (type, external)
   private

   public :: check_waves, find_grid

   !> Nodes a side, at least, of the first grid for a target, of a line and of an area; most of any.
   integer, parameter :: first_nodes(2) = [64, 32], max_in_direction = 2**30
   !> Nodes in the finest wave below which a note says so; below the second it is another wave.
   real(wp), parameter :: min_nodes = 8.0_wp
   real(wp), parameter :: least_nodes = 2.0_wp
   !> Share of a node that rounding may take.
   real(wp), parameter :: rounding = 1.0e-6_wp

contains

   !> Nodes and lengths, from &domain or a file. Findings: missing or contradictory sizes; the file.
   subroutine find_grid(dry)
      type(dry_case_t), intent(inout) :: dry
      character(len=2) :: axes(2)
      character(:), allocatable :: count
      logical :: has_target
      real(wp) :: length
      integer :: directions, first, given, i, nodes(2)

      directions = 2
      axes = ['_x', '_y']
      if (dry%values%problem == 'dry_line') then
         directions = 1
         axes(1) = ''
      end if
      has_target = dry%values%is_given('accuracy', 'target')
      nodes = [1, 1]
      dry%lengths = 0.0_wp
      first = findloc(has_shape(dry%values, surfaces, 'file'), .true., dim=1)
      if (first > 0) call read_surface(dry%values, surfaces(first), dry%folder, dry%files(first))
      if (dry%values%findings%count > 0) return
      associate (file => dry%files(max(first, 1)))
         do i = 1, directions
            count = 'intervals'//trim(axes(i))
            given = dry%values%integer_value('domain', count)
            if (file%grid(i) > 0) nodes(i) = file%grid(i)
            length = nodes(i)*file%spacing(i)
            if (given > 0 .and. file%grid(i) > 0 .and. given /= nodes(i) &
               .and. .not. dry%is_periodic) then
               call dry%values%refuse('domain', count, 'found ' // to_text(given) &
                  // ', expected the ' // to_text(nodes(i)) // ' nodes of the file: without a '// &
                  'period its heights have no Fourier series to resample')
            else if (given > 0) then
               nodes(i) = given
            else if (file%grid(i) <= 0 .and. .not. has_target) then
               call dry%values%refuse_missing('domain', count)
            end if
            call find_length(dry, 'length'//trim(axes(i)), length, file%file)
            dry%lengths(i) = length
         end do
         if (has_target .and. dry%values%findings%count == 0) call choose_first_grid(dry, &
            file%grid, directions, nodes)
      end associate
      dry%grid%nx = nodes(1)
      dry%grid%ny = nodes(2)
      dry%first_nodes = nodes
      dry%grid%aspect = 1.0_wp
      if (dry%values%findings%count == 0 .and. nodes(2) > 1) dry%grid%aspect = dry%lengths(2) &
         /dry%lengths(1)
   end subroutine find_grid

   !> The `length` of one direction, that of the `file` of heights (if there is one) or 0
   !> before. Findings: neither is known; they contradict each other.
   subroutine find_length(dry, key, length, file)
      type(dry_case_t), intent(inout) :: dry
      character(*), intent(in) :: key
      real(wp), intent(inout) :: length
      character(*), intent(in), optional :: file
      character(:), allocatable :: hint
      real(wp) :: given

      given = dry%values%real_value('domain', key)
      if (given <= 0.0_wp .and. length <= 0.0_wp) then
         hint = ''
         if (present(file)) hint = ': '//file//' has no attribute spacing, or spacing_'// &
            trim(merge('y', 'x', key == 'length_y'))
         call dry%values%refuse_missing('domain', key, hint)
      else if (length <= 0.0_wp) then
         length = given
      else if (given > 0.0_wp .and. abs(given - length) > same_length*length) then
         call dry%values%refuse('domain', key, 'found ' // to_text(given) // ' m, expected ' &
            // to_text(length) // ' m, nodes times spacing of the file')
      end if
   end subroutine find_length

   !> `nodes` with which the search begins, as many in every wave as a contact area needs: even, or
   !> those of a periodic file (`in_file`) times a power of two; an open file stays on its own.
   !> Finding: a synthetic surface whose shortest waves would be those of the grid.
   subroutine choose_first_grid(dry, in_file, directions, nodes)
      type(dry_case_t), intent(inout) :: dry
      integer, intent(in) :: in_file(2), directions
      integer, intent(inout) :: nodes(2)
      real(wp) :: finest, spacing
      integer :: i

      do i = 1, size(surfaces)
         if (has_shape(dry%values, surfaces(i), 'synthetic') .and. .not. dry%values%is_given( &
            surfaces(i), 'wavelength_short')) call dry%values%refuse_missing(surfaces(i), &
            'wavelength_short', 'with &accuracy target')
      end do
      if (dry%values%findings%count > 0) return
      if (in_file(1) > 0 .and. .not. dry%is_periodic) return
      finest = minval(finest_wave(dry%values, surfaces))/min_nodes
      associate (lengths => dry%lengths(:directions))
         if (in_file(1) > 0) then
            do while (any((1.0_wp - rounding)*lengths/finest > nodes(:directions)) &
               .and. maxval(nodes) <= max_in_direction/2)
               nodes(:directions) = 2*nodes(:directions)
            end do
         else
            spacing = min(minval(lengths)/first_nodes(directions), finest)
            nodes(:directions) = even_nodes((1.0_wp - rounding)*lengths/spacing, &
               real(max_in_direction, wp))
         end if
      end associate
   end subroutine choose_first_grid

   !> Finds waves of a surface with fewer than two nodes. A note where they have few.
   subroutine check_waves(dry)
      type(dry_case_t), intent(inout) :: dry
      real(wp) :: spacing, wave, finest
      character(:), allocatable :: key
      integer :: i

      finest = huge(1.0_wp)
      do i = 1, size(surfaces)
         key = 'wavelength'
         spacing = dry%lengths(1)/dry%grid%nx
         wave = finest_wave(dry%values, surfaces(i))
         if (has_shape(dry%values, surfaces(i), 'synthetic')) then
            key = 'wavelength_short'
            if (dry%grid%ny > 1) spacing = max(spacing, dry%lengths(2)/dry%grid%ny)
            if (.not. dry%values%is_given(surfaces(i), key)) wave = least_nodes*spacing
         end if
         if (wave < (least_nodes - rounding)*spacing) call dry%values%refuse(surfaces(i), key, &
            'found ' // to_text(wave) // ' m, expected at least two nodes a wave, ' &
            // to_text(2.0_wp*spacing, 3) // ' m, or more intervals')
         if (wave < huge(1.0_wp)) finest = min(finest, wave/spacing)
      end do
      if (finest < min_nodes - rounding .and. dry%values%findings%count == 0) call add_sentence( &
         dry%note, 'the finest waves of the surface have ' // to_text(finest, 2) // ' nodes, of ' &
         // to_text(nint(min_nodes)) // ' that are needed for its contact area')
   end subroutine check_waves

   !> The shortest wave that the keys of a surface give [m]; huge: none.
   pure elemental real(wp) function finest_wave(values, group) result(wave)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: group
      type(value_t) :: slot

      slot = values%slot(group, trim(merge('wavelength_short', 'wavelength      ', &
         has_shape(values, group, 'synthetic'))))
      wave = minval(slot%reals)
   end function finest_wave

end module dry_grids
