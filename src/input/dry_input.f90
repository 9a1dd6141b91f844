!> From the checked values of a namelist to a dry contact.
module dry_input
   use, intrinsic :: iso_fortran_env, only: int64
   use body_input, only: find_load, modulus_of, radius_of
   use constants, only: pi
   use dry_sweep, only: recommended_room
   use dry_case, only: dry_case_t
   use dry_problem, only: kernel_band_limited, kernel_element, kernel_open, no_hardness
   use dry_grids, only: check_waves, find_grid
   use dry_surfaces, only: make_heights, prepare_files
   use measured_heights, only: heights_t
   use hertz, only: line_half_width, point_radius
   use input_values, only: value_t
   use dry_settings, only: method_conjugate_gradient, method_steepest_descent
   use kinds, only: wp
   use surface_keys, only: has_shape, surfaces
   use system_limits, only: memory_fault
   use text, only: add_sentence, to_text
   implicit none (type, external)
   private

   public :: fill_dry_case

   !> Most nodes of an area: the transforms of an open one count four times as many in 32 bits.
   integer, parameter :: max_nodes = 536870911
   !> Images of a parabola on either side that are summed.
   integer, parameter :: images = 60

contains

   !> Fills `dry` from its values; `folder` of the namelist. Findings: grids, surfaces, loads.
   subroutine fill_dry_case(folder, dry)
      character(*), intent(in) :: folder
      type(dry_case_t), intent(inout) :: dry
      type(value_t) :: fields

      dry%folder = folder
      dry%reduced_modulus = modulus_of(dry%values)
      dry%radius = radius_of(dry%values)
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
      if (dry%values%findings%count == 0) call check_waves(dry)
      if (dry%values%findings%count == 0) call check_size(dry)
      if (dry%values%findings%count > 0) return
      call prepare_files(dry)
      if (dry%values%findings%count > 0) return
      call make_heights(dry)
      if (dry%values%findings%count > 0) return
      call fill_loads(dry)
      call fill_solver(dry)
      ! Only the way to a target makes the heights again.
      if (.not. dry%target > 0.0_wp) dry%files = heights_t()
      if (dry%values%findings%count == 0) call check_parabola(dry)
   end subroutine fill_dry_case

   !> Findings: more nodes than can be counted, or than there is memory for.
   subroutine check_size(dry)
      type(dry_case_t), intent(inout) :: dry
      character(:), allocatable :: fault, key
      integer(int64) :: nodes

      key = trim(merge('intervals  ', 'intervals_x', dry%values%problem == 'dry_line'))
      nodes = int(dry%grid%nx, int64)*dry%grid%ny
      fault = memory_fault('a grid', dry%memory_on([dry%grid%nx, dry%grid%ny]))
      if (nodes > max_nodes) fault = 'found ' // to_text(nodes) // ' nodes, expected at most ' &
         // to_text(max_nodes)
      if (fault /= '') call dry%values%refuse('domain', key, fault)
   end subroutine check_size

   !> Mean pressures and hardness. Finding: a load above hardness times area.
   subroutine fill_loads(dry)
      type(dry_case_t), intent(inout) :: dry
      type(value_t) :: pressures
      real(wp) :: area, load
      character(:), allocatable :: key

      dry%loads%has_history = dry%values%word_value('load', 'loading') == 'history'
      dry%loads%hardness = dry%values%real_value('bodies', 'hardness', no_hardness)
      if (dry%values%is_given('load', 'separation')) then
         call fill_separations(dry)
         return
      end if
      area = dry%lengths(1)
      if (dry%grid%ny > 1) area = area*dry%lengths(2)
      if (dry%values%is_given('load', 'mean_pressure')) then
         key = 'mean_pressure'
         pressures = dry%values%slot('load', key)
         dry%loads%mean_pressure = pressures%reals
      else
         call find_load(dry%values, dry%radius, dry%reduced_modulus, key, load)
         dry%loads%mean_pressure = [load/area]
      end if
      if (maxval(dry%loads%mean_pressure) > dry%loads%hardness) call dry%values%refuse('load', &
         key, 'found a mean pressure of ' // to_text(maxval(dry%loads%mean_pressure)) &
         // ' Pa, expected at most the hardness, ' // to_text(dry%loads%hardness) // ' Pa')
   end subroutine fill_loads

   !> Separations. Findings: an open line; nothing touches; an elastic surface pressed beyond flat.
   subroutine fill_separations(dry)
      type(dry_case_t), intent(inout) :: dry
      type(value_t) :: given
      real(wp) :: top
      character(:), allocatable :: fault

      given = dry%values%slot('load', 'separation')
      dry%loads%separation = given%reals
      fault = ''
      associate (highest => maxval(given%reals), lowest => minval(given%reals))
         if (.not. dry%is_periodic .and. dry%grid%ny == 1) then
            fault = 'found a separation with periodic = .false., expected a load: the '// &
               'deflection of an open line has no datum'
         else if (.not. dry%is_periodic) then
            if (lowest <= 0.0_wp) fault = 'found ' // to_text(lowest) // ' m, expected > 0: in '// &
               'an open area the approach of the bodies since first touch'
         else
            top = maxval(dry%height) - sum(dry%height)/size(dry%height)
            if (highest >= top) then
               fault = 'found ' // to_text(highest) // ' m, at which nothing touches, '// &
                  'expected < ' // to_text(top) // ' m'
            else if (lowest <= 0.0_wp .and. dry%loads%hardness >= no_hardness) then
               fault = 'found ' // to_text(lowest) // ' m, expected > 0: an elastic surface is '// &
                  'flat there'
            end if
         end if
      end associate
      if (fault /= '') call dry%values%refuse('load', 'separation', fault)
   end subroutine fill_separations

   !> Kernel, method, tolerance. Finding: band_limited on an open domain.
   subroutine fill_solver(dry)
      type(dry_case_t), intent(inout) :: dry

      associate (values => dry%values)
         if (dry%is_periodic) then
            dry%grid%kernel = merge(kernel_element, kernel_band_limited, &
               values%word_value('domain', 'kernel') == 'element')
         else
            dry%grid%kernel = kernel_open
            if (values%is_given('domain', 'kernel') .and. values%word_value('domain', &
               'kernel') == 'band_limited') call values%refuse('domain', 'kernel', &
               "found 'band_limited' with periodic = .false., expected 'element'")
         end if
         dry%settings%method = merge(method_steepest_descent, method_conjugate_gradient, &
            values%word_value('solver', 'method') == 'steepest_descent')
         dry%settings%tolerance = values%real_value('solver', 'tolerance')
         dry%settings%max_cycles = values%integer_value('solver', 'max_cycles')
      end associate
   end subroutine fill_solver

   !> Findings: two parabolas; an open domain inside the contact. Note: what periodic images do.
   subroutine check_parabola(dry)
      type(dry_case_t), intent(inout) :: dry
      logical :: is_one(2)

      is_one = has_shape(dry%values, surfaces, 'parabola')
      if (all(is_one)) then
         call dry%values%refuse(surfaces(2), 'shape', 'found a second parabola, expected one: '// &
            'the reduced radius is that of both bodies')
      else if (any(is_one) .and. dry%is_periodic) then
         call add_sentence(dry%note, note_on_images(dry))
      else if (any(is_one) .and. any(has_shape(dry%values, surfaces, 'smooth'))) then
         call check_room(dry)
      end if
   end subroutine check_parabola

   !> Finds an open domain shorter than the contact of Hertz (what yields is wider still).
   subroutine check_room(dry)
      type(dry_case_t), intent(inout) :: dry
      real(wp) :: growth, length, load, needed, width
      character(:), allocatable :: key
      logical :: is_line

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
   end subroutine check_room

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

end module dry_input
