!> From the checked values of a namelist to a dry contact.
module dry_input
   use, intrinsic :: iso_fortran_env, only: int64
   use bodies, only: reduced_modulus, reduced_radius
   use case_memory, only: dry_memory, most_nodes
   use dry_case, only: dry_case_t, dry_recipe_t
   use dry_checks, only: check_parabola, check_waves
   use dry_problem, only: kernel_band_limited, kernel_element, kernel_open, no_hardness
   use dry_scaling, only: contact_modulus
   use dry_grids, only: find_grid
   use dry_heights, only: make_heights
   use findings, only: findings_t
   use hertz, only: line_load_from_pressure, point_load_from_pressure
   use input_values, only: input_values_t, value_t
   use dry_settings, only: method_conjugate_gradient, method_steepest_descent
   use kinds, only: wp
   use system_limits, only: memory_fault
   use text, only: to_text
   implicit none (type, external)
   private

   public :: fill_dry_case

contains

   !> Fills `dry` from the `values` of a dry problem; `folder` is that of the namelist, with its
   !> slash. Findings: grids, surfaces and loads that cannot be.
   subroutine fill_dry_case(values, folder, dry, findings)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: folder
      type(dry_case_t), intent(out) :: dry
      type(findings_t), intent(inout) :: findings

      dry%reduced_modulus = modulus_of(values)
      dry%recipe = dry_recipe_t(values, folder, radius_of(values))
      call find_grid(values, folder, dry, findings)
      if (findings%count == 0) call check_waves(values, dry, findings)
      if (findings%count == 0) call check_size(values, dry, findings)
      if (findings%count > 0) return
      call make_heights(dry, findings)
      if (findings%count > 0) return
      call fill_loads(values, dry%recipe%radius, dry, findings)
      call fill_solver(values, dry, findings)
      if (findings%count == 0) call check_parabola(values, dry%recipe%radius, dry, findings)
   end subroutine fill_dry_case

   !> Findings: more nodes than can be counted, or than there is memory for.
   subroutine check_size(values, dry, findings)
      type(input_values_t), intent(in) :: values
      type(dry_case_t), intent(in) :: dry
      type(findings_t), intent(inout) :: findings
      character(:), allocatable :: fault, key
      integer(int64) :: nodes

      key = trim(merge('intervals  ', 'intervals_x', values%problem == 'dry_line'))
      nodes = int(dry%grid%nx, int64)*dry%grid%ny
      fault = memory_fault('a grid', dry_memory([dry%grid%nx, dry%grid%ny], dry%is_periodic))
      if (nodes > most_nodes) fault = 'found ' // to_text(nodes) // ' nodes, expected at most ' &
         // to_text(most_nodes)
      if (fault /= '') call findings%add(values%line_of('domain', key), 'domain', key, fault)
   end subroutine check_size

   !> E' [Pa]: given, of both bodies, or of the first against a rigid one.
   function modulus_of(values) result(modulus)
      type(input_values_t), intent(in) :: values
      real(wp) :: modulus

      if (values%is_given('bodies', 'reduced_modulus')) then
         modulus = values%real_value('bodies', 'reduced_modulus')
      else if (values%is_given('bodies', 'youngs_modulus_2')) then
         modulus = reduced_modulus(values%real_value('bodies', 'youngs_modulus_1'), &
            values%real_value('bodies', 'poisson_ratio_1'), values%real_value('bodies', &
               'youngs_modulus_2'), &
            values%real_value('bodies', 'poisson_ratio_2'))
      else
         modulus = contact_modulus(values%real_value('bodies', 'youngs_modulus_1'), &
            values%real_value('bodies', 'poisson_ratio_1'))
      end if
   end function modulus_of

   !> R [m] of a parabola; 0 if there is none.
   function radius_of(values) result(radius)
      type(input_values_t), intent(in) :: values
      real(wp) :: radius

      radius = 0.0_wp
      if (values%is_given('bodies', 'reduced_radius')) then
         radius = values%real_value('bodies', 'reduced_radius')
      else if (values%is_given('bodies', 'radius_1')) then
         radius = reduced_radius(values%real_value('bodies', 'radius_1'), &
            values%real_value('bodies', 'radius_2'))
      end if
   end function radius_of

   !> Mean pressures and hardness. Finding: a load above hardness times area.
   subroutine fill_loads(values, radius, dry, findings)
      type(input_values_t), intent(in) :: values
      real(wp), intent(in) :: radius
      type(dry_case_t), intent(inout) :: dry
      type(findings_t), intent(inout) :: findings
      type(value_t) :: slot
      real(wp) :: area
      character(:), allocatable :: key

      dry%loads%has_history = values%word_value('load', 'loading') == 'history'
      dry%loads%hardness = no_hardness
      if (values%is_given('bodies', 'hardness')) dry%loads%hardness = values%real_value('bodies', &
         'hardness')
      if (values%is_given('load', 'separation')) then
         call fill_separations(values, dry, findings)
         return
      end if
      area = dry%lengths(1)
      if (dry%grid%ny > 1) area = area*dry%lengths(2)
      if (values%is_given('load', 'mean_pressure')) then
         key = 'mean_pressure'
         slot = values%slot('load', key)
         dry%loads%mean_pressure = slot%reals
      else if (values%is_given('load', 'hertz_pressure')) then
         key = 'hertz_pressure'
         if (dry%grid%ny == 1) then
            dry%loads%mean_pressure = [line_load_from_pressure(values%real_value('load', key), &
               radius, dry%reduced_modulus)/area]
         else
            dry%loads%mean_pressure = [point_load_from_pressure(values%real_value('load', key), &
               radius, dry%reduced_modulus)/area]
         end if
      else
         key = 'load_per_length'
         if (dry%grid%ny > 1) key = 'load'
         dry%loads%mean_pressure = [values%real_value('load', key)/area]
      end if
      if (maxval(dry%loads%mean_pressure) &
         > dry%loads%hardness) call findings%add(values%line_of('load', key), 'load', key, &
         'found a mean pressure of ' // to_text(maxval(dry%loads%mean_pressure)) &
            // ' Pa, expected at most the hardness, ' &
         // to_text(dry%loads%hardness) // ' Pa')
   end subroutine fill_loads

   !> Separations. Findings: an open line; nothing touches; an elastic periodic surface pressed
   !> further than flat.
   subroutine fill_separations(values, dry, findings)
      type(input_values_t), intent(in) :: values
      type(dry_case_t), intent(inout) :: dry
      type(findings_t), intent(inout) :: findings
      type(value_t) :: slot
      real(wp) :: top
      character(:), allocatable :: found

      slot = values%slot('load', 'separation')
      dry%loads%separation = slot%reals
      found = ''
      if (.not. dry%is_periodic .and. dry%grid%ny == 1) then
         found = 'found a separation with periodic = .false., expected a load: the deflection '// &
            'of an open line has no datum'
      else if (.not. dry%is_periodic) then
         if (minval(slot%reals) <= 0.0_wp) found = 'found ' // to_text(minval(slot%reals)) &
            // ' m, expected > 0: in an open ' &
            // 'area the approach of the bodies since first touch'
      else
         top = maxval(dry%height) - sum(dry%height)/size(dry%height)
         if (maxval(slot%reals) >= top) then
            found = 'found ' // to_text(maxval(slot%reals)) // ' m, at which nothing touches, '// &
               'expected < ' // to_text(top) // ' m'
         else if (minval(slot%reals) <= 0.0_wp .and. dry%loads%hardness >= no_hardness) then
            found = 'found ' // to_text(minval(slot%reals)) // ' m, expected > 0: an elastic '// &
               'surface is flat there'
         end if
      end if
      if (found /= '') call findings%add(slot%line, 'load', 'separation', found)
   end subroutine fill_separations

   !> Kernel, method, tolerance, error bars. Finding: band_limited on an open domain.
   subroutine fill_solver(values, dry, findings)
      type(input_values_t), intent(in) :: values
      type(dry_case_t), intent(inout) :: dry
      type(findings_t), intent(inout) :: findings
      type(value_t) :: slot

      dry%grid%kernel = kernel_open
      if (dry%is_periodic) then
         dry%grid%kernel = kernel_band_limited
         if (values%word_value('domain', 'kernel') == 'element') dry%grid%kernel = kernel_element
      else if (values%is_given('domain', 'kernel') .and. values%word_value('domain', &
         'kernel') == 'band_limited') then
         call findings%add(values%line_of('domain', 'kernel'), 'domain', 'kernel', &
            "found 'band_limited' with periodic = .false., expected 'element'")
      end if
      dry%settings%method = method_conjugate_gradient
      if (values%word_value('solver', 'method') == 'steepest_descent') dry%settings%method = &
         method_steepest_descent
      dry%settings%tolerance = values%real_value('solver', 'tolerance')
      slot = values%slot('solver', 'max_cycles')
      dry%settings%max_cycles = slot%integer
      slot = values%slot('accuracy', 'error_bars')
      dry%has_error_bars = slot%logical
      if (values%is_given('accuracy', 'target')) dry%target = values%real_value('accuracy', &
         'target')
   end subroutine fill_solver

end module dry_input
