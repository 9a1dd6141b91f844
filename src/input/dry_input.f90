!> From the values of a namelist to a dry contact: checks over several keys, then the record.
module dry_input
   use, intrinsic :: iso_fortran_env, only: int64
   use bodies, only: reduced_modulus, reduced_radius
   use case_memory, only: dry_memory, most_nodes
   use case_validation, only: check_accuracy
   use dry_case, only: dry_case_t, dry_recipe_t
   use dry_checks, only: check_parabola, check_waves, has_shape
   use dry_problem, only: kernel_band_limited, kernel_element, kernel_open, no_hardness
   use dry_scaling, only: contact_modulus
   use dry_grids, only: find_grid
   use dry_heights, only: make_heights
   use findings, only: findings_t
   use hertz, only: line_load_from_pressure, point_load_from_pressure
   use input_keys, only: group_rows, has_word
   use input_values, only: input_values_t, value_t
   use dry_settings, only: method_conjugate_gradient, method_steepest_descent
   use kinds, only: wp
   use system_limits, only: memory_fault
   use text, only: to_text
   use validation_messages, only: check_radii, report_missing, report_unused
   implicit none (type, external)
   private

   public :: fill_dry_case

contains

   !> Checks the `values` of a dry problem and fills `dry`; `folder` is that of the namelist, with
   !> its slash. Findings: missing, contradictory and unused keys; files; a load above hardness
   !> times area.
   subroutine fill_dry_case(values, folder, dry, findings)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: folder
      type(dry_case_t), intent(out) :: dry
      type(findings_t), intent(inout) :: findings

      call check_needed_groups(values, findings)
      call check_bodies(values, findings)
      call check_one_load(values, findings)
      call check_accuracy(values, findings)
      if (findings%count > 0) return
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

   !> Findings: groups that every dry case needs.
   subroutine check_needed_groups(values, findings)
      type(input_values_t), intent(in) :: values
      type(findings_t), intent(inout) :: findings
      integer :: i

      do i = 1, size(group_rows)
         if (group_rows(i)%needed /= 'yes' .or. .not. has_word(group_rows(i)%problems, &
            trim(values%problem))) cycle
         if (.not. values%has_group(group_rows(i)%group)) call findings%add(values%last_line, &
            trim(group_rows(i)%group), '', &
            'found no such group, expected &' // trim(group_rows(i)%group) // ' ... / (' &
               // trim(group_rows(i)%meaning) // ')')
      end do
   end subroutine check_needed_groups

   !> Findings: elasticity given twice or in part; radii without a parabola, or the reverse.
   subroutine check_bodies(values, findings)
      type(input_values_t), intent(in) :: values
      type(findings_t), intent(inout) :: findings
      character(len=16), parameter :: parts(*) = [character(len=16) :: 'youngs_modulus_1', &
         'poisson_ratio_1', &
         'youngs_modulus_2', 'poisson_ratio_2']
      logical :: has_parabola
      integer :: i

      if (values%is_given('bodies', 'reduced_modulus')) then
         do i = 1, size(parts)
            call report_unused(values, 'bodies', trim(parts(i)), 'with reduced_modulus', findings)
         end do
      else
         do i = 1, 2
            if (.not. values%is_given('bodies', trim(parts(i)))) then
               call report_missing(values, 'bodies', trim(parts(i)), findings, &
                  '(or reduced_modulus)')
            end if
         end do
         if (values%is_given('bodies', 'youngs_modulus_2') .neqv. values%is_given('bodies', &
            'poisson_ratio_2')) then
            call report_missing(values, 'bodies', &
               trim(parts(merge(4, 3, values%is_given('bodies', 'youngs_modulus_2')))), findings)
         end if
      end if
      has_parabola = has_shape(values, 'surface_1', 'parabola') .or. has_shape(values, &
         'surface_2', 'parabola')
      if (has_parabola) then
         if (.not. (values%is_given('bodies', 'reduced_radius') .or. values%is_given('bodies', &
            'radius_1') &
            .and. values%is_given('bodies', 'radius_2'))) then
            call report_missing(values, 'bodies', 'reduced_radius', findings, &
               "(or radius_1 and radius_2) for shape = 'parabola'")
         else if (.not. values%is_given('bodies', 'reduced_radius')) then
            call check_radii(values, findings)
         end if
      else
         call report_unused(values, 'bodies', 'reduced_radius', "without shape = 'parabola'", &
            findings)
         call report_unused(values, 'bodies', 'radius_1', "without shape = 'parabola'", findings)
         call report_unused(values, 'bodies', 'radius_2', "without shape = 'parabola'", findings)
         call report_unused(values, 'load', 'hertz_pressure', "without shape = 'parabola'", &
            findings)
      end if
   end subroutine check_bodies

   !> Findings: no load, or more than one.
   subroutine check_one_load(values, findings)
      type(input_values_t), intent(in) :: values
      type(findings_t), intent(inout) :: findings
      character(len=16) :: keys(4)
      integer :: given, i

      keys = [character(len=16) :: 'mean_pressure', 'hertz_pressure', &
              merge('load_per_length', 'load           ', values%problem == 'dry_line'), &
                 'separation']
      if (.not. values%has_group('load')) return
      given = 0
      do i = 1, size(keys)
         if (.not. values%is_given('load', trim(keys(i)))) cycle
         given = given + 1
         if (given > 1) call findings%add(values%line_of('load', trim(keys(i))), 'load', &
            trim(keys(i)), &
            'found more than one load, expected one of mean_pressure, hertz_pressure, ' &
               // trim(keys(3)) // ', separation')
      end do
      if (given == 0) call findings%add(values%line_of('load', ''), 'load', 'mean_pressure', &
         'found nothing, expected mean_pressure [Pa], hertz_pressure [Pa], ' // trim(keys(3)) &
            // ' or separation [m]')
   end subroutine check_one_load

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
