!> From the checked values of a namelist to a dry contact. Its grid is that of &domain or of the
!> file of a surface or, for a wanted accuracy, the one to begin with.
module dry_input
   use body_input, only: find_load, modulus_of, radius_of
   use dry_sweep, only: recommended_room
   use dry_case, only: dry_case_t, make_heights, same_length
   use dry_problem, only: kernel_band_limited, kernel_element, kernel_open, &
      method_conjugate_gradient, method_steepest_descent, no_hardness
   use grid_transform, only: even_nodes
   use file_heights, only: level_surface
   use hertz, only: line_half_width, point_radius
   use input_values, only: has_shape, input_values_t, surfaces, value_t
   use kinds, only: int64, pi, wp
   use system_limits, only: memory_fault
   use text, only: add_sentence, to_text
   implicit none (type, external)
   private

   public :: fill_dry_case

   !> Most nodes of an area: the transforms of an open one count four times as many in 32 bits.
   integer, parameter :: max_nodes = 536870911
   !> Images of a parabola on either side that are summed.
   integer, parameter :: images = 60

   !> Nodes a side, at least, of the first grid for a target, of a line and of an area; most of any.
   integer, parameter :: first_nodes(2) = [64, 32], max_in_direction = 2**30
   !> Nodes in the finest wave below which a note says so; below the second it is another wave.
   real(wp), parameter :: min_nodes = 8.0_wp
   real(wp), parameter :: least_nodes = 2.0_wp
   !> Share of a node that rounding may take.
   real(wp), parameter :: rounding = 1.0e-6_wp

contains

   !> Fills `dry` from its values and files. Findings, beside those of a second file that cannot be
   !> read: grid, surface, load, kernel.
   subroutine fill_dry_case(dry)
      type(dry_case_t), intent(inout) :: dry
      type(value_t) :: fields
      character(:), allocatable :: fault
      integer :: before

      before = dry%values%findings%count
      dry%reduced_modulus = modulus_of(dry%values)
      dry%radius = radius_of(dry%values, '')
      dry%wants_adequacy = dry%values%logical_value('output', 'adequacy')
      dry%has_error_bars = dry%values%logical_value('accuracy', 'error_bars')
      dry%target = dry%values%real_value('accuracy', 'target')
      fields = dry%values%slot('output', 'fields')
      dry%stored_fields = fields%words
      dry%is_single = dry%values%word_value('output', 'precision') == 'single'
      ! Where it is not said, a parabola is not periodic.
      dry%is_periodic = .not. any(has_shape(dry%values, surfaces, 'parabola'))
      if (dry%values%has_value('domain', 'periodic')) dry%is_periodic = &
         dry%values%logical_value('domain', 'periodic')
      call find_grid(dry)
      if (dry%values%findings%count == before) call check_waves(dry)
      if (dry%values%findings%count > before) return
      fault = memory_fault('a grid', dry%memory_on([dry%grid%nx, dry%grid%ny]))
      associate (nodes => int(dry%grid%nx, int64)*dry%grid%ny)
         if (nodes > max_nodes) fault = 'found '//to_text(nodes)//' nodes, expected at most '// &
            to_text(max_nodes)
      end associate
      if (fault /= '') call dry%values%refuse('domain', trim(merge('intervals  ', 'intervals_x', &
         dry%values%problem == 'dry_line')), fault)
      call level_files(dry)
      if (dry%values%findings%count > 0) return
      call make_heights(dry)
      if (dry%values%findings%count > 0) return
      call fill_loads(dry)
      associate (values => dry%values)
         dry%grid%kernel = merge(kernel_element, kernel_band_limited, values%word_value('domain', &
            'kernel') == 'element')
         if (.not. dry%is_periodic) dry%grid%kernel = kernel_open
         if (.not. dry%is_periodic .and. values%is_given('domain', 'kernel') .and. &
            values%word_value('domain', 'kernel') == 'band_limited') call values%refuse('domain', &
            'kernel', "found 'band_limited' with periodic = .false., expected 'element'")
         dry%settings%method = merge(method_steepest_descent, method_conjugate_gradient, &
            values%word_value('solver', 'method') == 'steepest_descent')
         dry%settings%keeps_pressures = dry%is_compared()
         dry%settings%tolerance = values%real_value('solver', 'tolerance')
         dry%settings%max_cycles = values%integer_value('solver', 'max_cycles')
      end associate
      if (dry%values%findings%count == 0) call check_parabola(dry)
   end subroutine fill_dry_case

   !> Levels both files, unless there are findings, once the lengths of the domain are known.
   subroutine level_files(dry)
      type(dry_case_t), intent(inout) :: dry
      integer :: i

      do i = 1, size(surfaces)
         associate (file => dry%files(i))
            if (allocated(file%file) .and. dry%values%findings%count == 0) then
               where (file%spacing <= 0.0_wp) file%spacing = dry%lengths/file%sums%grid
               call level_surface(dry%values, surfaces(i), dry%is_periodic, file, dry%note)
            end if
         end associate
      end do
   end subroutine level_files

   !> Mean pressures, or separations, and hardness. Findings: a load above hardness times area; a
   !> separation of an open line, without contact, or of an elastic surface pressed beyond flat.
   subroutine fill_loads(dry)
      type(dry_case_t), intent(inout) :: dry
      type(value_t) :: given
      real(wp) :: area, load
      character(:), allocatable :: fault, key

      dry%loads%has_history = dry%values%word_value('load', 'loading') == 'history'
      dry%loads%hardness = dry%values%real_value('bodies', 'hardness', no_hardness)
      if (dry%values%is_given('load', 'separation')) then
         given = dry%values%slot('load', 'separation')
         dry%loads%separation = given%reals
         fault = ''
         associate (highest => maxval(given%reals), lowest => minval(given%reals), &
            top => maxval(dry%height) - sum(dry%height)/size(dry%height))
            if (.not. dry%is_periodic .and. dry%grid%ny == 1) then
               fault = 'found a separation with periodic = .false., expected a load: the '// &
                  'deflection of an open line has no datum'
            else if (.not. dry%is_periodic .and. lowest <= 0.0_wp) then
               fault = 'found ' // to_text(lowest) // ' m, expected > 0: in an open area the '// &
                  'approach of the bodies since first touch'
            else if (dry%is_periodic .and. highest >= top) then
               fault = 'found ' // to_text(highest) // ' m, at which nothing touches, '// &
                  'expected < ' // to_text(top) // ' m'
            else if (lowest <= 0.0_wp .and. dry%loads%hardness >= no_hardness) then
               fault = 'found ' // to_text(lowest) // ' m, expected > 0: an elastic surface is '// &
                  'flat there'
            end if
         end associate
         if (fault /= '') call dry%values%refuse('load', 'separation', fault)
         return
      end if
      area = dry%lengths(1)
      if (dry%grid%ny > 1) area = area*dry%lengths(2)
      if (dry%values%is_given('load', 'mean_pressure')) then
         key = 'mean_pressure'
         given = dry%values%slot('load', key)
         dry%loads%mean_pressure = given%reals
      else
         call find_load(dry%values, dry%radius, dry%reduced_modulus, key, load)
         dry%loads%mean_pressure = [load/area]
      end if
      if (maxval(dry%loads%mean_pressure) > dry%loads%hardness) call dry%values%refuse('load', &
         key, 'found a mean pressure of ' // to_text(maxval(dry%loads%mean_pressure)) &
         // ' Pa, expected at most the hardness, ' // to_text(dry%loads%hardness) // ' Pa')
   end subroutine fill_loads

   !> Finds two parabolas; an open domain shorter than the contact of Hertz. Note: periodic images.
   subroutine check_parabola(dry)
      type(dry_case_t), intent(inout) :: dry
      real(wp) :: growth, length, load, needed, width
      character(:), allocatable :: key
      logical :: is_line, is_one(2)

      is_one = has_shape(dry%values, surfaces, 'parabola')
      if (all(is_one)) then
         call dry%values%refuse(surfaces(2), 'shape', 'found a second parabola, expected one: '// &
            'the reduced radius is that of both bodies')
      else if (any(is_one) .and. dry%is_periodic) then
         call add_sentence(dry%note, note_on_images(dry))
      end if
      if (dry%is_periodic .or. .not. (count(is_one) == 1 .and. any(has_shape(dry%values, surfaces, &
         'smooth')))) return
      is_line = dry%grid%ny == 1
      length = merge(dry%lengths(1), minval(dry%lengths), is_line)
      growth = 0.0_wp
      if (allocated(dry%loads%separation)) then
         width = 2.0_wp*sqrt(max(0.0_wp, maxval(dry%loads%separation))*dry%radius)
      else
         load = maxval(dry%loads%mean_pressure)*dry%lengths(1)
         if (is_line) then
            width = 2.0_wp*line_half_width(load, dry%radius, dry%reduced_modulus)
         else
            width = 2.0_wp*point_radius(load*dry%lengths(2), dry%radius, dry%reduced_modulus)
         end if
         ! A mean pressure loads a longer domain more.
         if (dry%values%is_given('load', 'mean_pressure')) growth = merge(1.0_wp/2.0_wp, &
            2.0_wp/3.0_wp, is_line)
      end if
      if (width <= length) return
      needed = length*(recommended_room*width/length)**(1.0_wp/(1.0_wp - growth))
      key = 'length'
      if (.not. is_line) key = trim(merge('length_x', 'length_y', dry%lengths(1) <= dry%lengths(2)))
      call dry%values%refuse('domain', key, 'found ' // to_text(length) &
         // ' m, which ends inside the contact of ' // to_text(width, 3) &
         // ' m (Hertz), expected about ' // to_text(needed, 2) // ' m')
   end subroutine check_parabola

   !> By how much the images of a periodic parabola raise its largest pressure. Near the contact
   !> they bend the surface like a larger curvature 1/R + (P/(pi E')) sum 1/d^3, d the distances of
   !> the images; of a line 1/R + 4 pi w/(3 E' L^2).
   pure function note_on_images(dry) result(note)
      type(dry_case_t), intent(in) :: dry
      character(:), allocatable :: note
      real(wp) :: bending, load, rise
      integer :: i, j

      note = 'the parabola is repeated with the period, which changes its contact'
      if (.not. allocated(dry%loads%mean_pressure)) return
      load = maxval(dry%loads%mean_pressure)*dry%lengths(1)
      if (dry%grid%ny == 1) then
         bending = 4.0_wp*pi*load/(3.0_wp*dry%reduced_modulus*dry%lengths(1)**2)
         rise = (1.0_wp + dry%radius*bending)**(1.0_wp/2.0_wp) - 1.0_wp
      else
         bending = 0.0_wp
         do j = -images, images
            do i = -images, images
               if (i /= 0 .or. j /= 0) bending = bending + hypot(i*dry%lengths(1), &
                  j*dry%lengths(2))**(-3)
            end do
         end do
         bending = bending*load*dry%lengths(2)/(pi*dry%reduced_modulus)
         rise = (1.0_wp + dry%radius*bending)**(2.0_wp/3.0_wp) - 1.0_wp
      end if
      note = 'the parabola is repeated with the period: its images raise the largest pressure '// &
         'by about ' // to_text(100.0_wp*rise, 2) // ' % over that of Hertz '// &
         '(periodic = .false. has none)'
   end function note_on_images

   !> Nodes and lengths, from &domain or a file. Findings: missing or contradictory sizes; the file.
   subroutine find_grid(dry)
      type(dry_case_t), intent(inout) :: dry
      character(len=2) :: axes(2)
      character(:), allocatable :: count
      logical :: has_target
      real(wp) :: length
      integer :: before, directions, first, given, i, nodes(2)

      directions = 2
      axes = ['_x', '_y']
      if (dry%values%problem == 'dry_line') then
         directions = 1
         axes(1) = ''
      end if
      has_target = dry%values%is_given('accuracy', 'target')
      nodes = [1, 1]
      dry%lengths = 0.0_wp
      before = dry%values%findings%count
      first = max(1, findloc(has_shape(dry%values, surfaces, 'file'), .true., dim=1))
      associate (file => dry%files(first), grid => int(dry%files(first)%sums%grid))
         do i = 1, directions
            count = 'intervals'//trim(axes(i))
            given = dry%values%integer_value('domain', count)
            if (grid(i) > 0) nodes(i) = grid(i)
            length = nodes(i)*file%spacing(i)
            if (given > 0 .and. grid(i) > 0 .and. given /= nodes(i) &
               .and. .not. dry%is_periodic) then
               call dry%values%refuse('domain', count, 'found ' // to_text(given) &
                  // ', expected the ' // to_text(nodes(i)) // ' nodes of the file: without a '// &
                  'period its heights have no Fourier series to resample')
            else if (given > 0) then
               nodes(i) = given
            else if (grid(i) <= 0 .and. .not. has_target) then
               call dry%values%refuse_missing('domain', count)
            end if
            call find_length(dry, 'length'//trim(axes(i)), length, file%file)
            dry%lengths(i) = length
         end do
         if (has_target .and. dry%values%findings%count == before) call choose_first_grid(dry, &
            grid(1) > 0, directions, nodes)
      end associate
      dry%grid%nx = nodes(1)
      dry%grid%ny = nodes(2)
      dry%first_nodes = nodes
      dry%grid%aspect = 1.0_wp
      if (dry%values%findings%count == before .and. nodes(2) > 1) dry%grid%aspect = dry%lengths(2) &
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
   !> those of a periodic file times a power of two; an open file stays on its own. A finding is a
   !> synthetic surface whose shortest waves would be those of the grid.
   subroutine choose_first_grid(dry, has_file, directions, nodes)
      type(dry_case_t), intent(inout) :: dry
      logical, intent(in) :: has_file
      integer, intent(in) :: directions
      integer, intent(inout) :: nodes(2)
      real(wp) :: finest, spacing
      integer :: i

      do i = 1, size(surfaces)
         if (has_shape(dry%values, surfaces(i), 'synthetic') .and. .not. dry%values%is_given( &
            surfaces(i), 'wavelength_short')) call dry%values%refuse_missing(surfaces(i), &
            'wavelength_short', 'with &accuracy target')
      end do
      if (has_file .and. .not. dry%is_periodic) return
      finest = minval(finest_wave(dry%values, surfaces))/min_nodes
      associate (lengths => dry%lengths(:directions))
         if (has_file) then
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

      slot = values%slot(group, merge('wavelength_short', 'wavelength      ', &
         has_shape(values, group, 'synthetic')))
      wave = minval(slot%reals)
   end function finest_wave

end module dry_input
