!> The plan of a lubricated case: from SI to the dimensionless contact, with domain, grid and time
!> step that are given or chosen; whether these fit into memory and resolve ridges, dents and
!> sinusoids. (The finest waves of profiles may be noise: they get a note only.)
module line_case
   use asperities, only: scaled
   use body_input, only: find_load
   use case_record, only: case_t, path_from_namelist
   use case_validation, only: check_times
   use contact_moment, only: least_speed
   use domain_choice, only: choose_domain
   use features, only: rough_surface_t
   use film_surface, only: place_surface
   use input_values, only: input_values_t, surfaces
   use key_row, only: point
   use kinds, only: wp
   use line_contact, only: finest_wave, leaves_scheme, line_contact_t, max_intervals_of, &
      max_refined_intervals, rough_contact_t, time_settings_t
   use lubricant_input, only: read_asperities
   use moes, only: l_sum_per_mean, m_mean_per_sum
   use passage_times, only: place_features, sufficient_end
   use scaling, only: new_heating, new_moes_scaling, new_scaling, scaled_fluid, sum_per_mean
   use surface_scaling, only: scaled_duty
   use system_limits, only: lubricated_memory, memory_fault, of_blas
   use text, only: to_text
   use wave_resolution, only: choose_time_step, intervals_at_least, min_in_a_wave
   implicit none (type, external)
   private

   public :: fill_scaling, plan_duty, plan_line_case, plan_times

   !> No end time that is chosen is later [T].
   real(wp), parameter :: latest_end = 1000.0_wp
   !> 0 degC above the temperature from which Houpert's factor counts, 138 K [K].
   real(wp), parameter :: houpert_excess = 273.15_wp - 138.0_wp

contains

   !> The scales of a contact, a point with D = Rx/Ry = `ratio`, by Moes' numbers or a load `key`.
   subroutine fill_scaling(values, case, key, ratio)
      type(input_values_t), intent(in) :: values
      type(case_t), intent(inout) :: case
      character(:), allocatable, intent(out) :: key
      real(wp), intent(in), optional :: ratio
      real(wp) :: load, m, l
      logical :: is_sum

      call find_load(values, case%bodies%reduced_radius, case%bodies%reduced_modulus, key, load, &
         ratio)
      if (values%has_group('moes')) then
         m = values%real_value('moes', 'moes_m')
         l = values%real_value('moes', 'moes_l')
         is_sum = values%word_value('moes', 'velocity') == 'sum'
         if (is_sum .and. present(ratio)) then
            m = m*sum_per_mean**0.75_wp
            l = l*sum_per_mean**(-0.25_wp)
         else if (is_sum) then
            m = m*m_mean_per_sum
            l = l/l_sum_per_mean
         end if
         call new_moes_scaling(case%scaling, m, l, case%lubricant, ratio)
      else
         call new_scaling(case%scaling, case%bodies, case%lubricant, load, ratio)
      end if
   end subroutine fill_scaling

   !> Plans a `case`: contact, time step, settings of the solver, how far the grid may be refined.
   !> Findings: grid or time step are too coarse for the surfaces, or the grid is too fine.
   subroutine plan_line_case(values, case)
      type(input_values_t), intent(inout) :: values
      type(case_t), intent(inout) :: case
      type(time_settings_t) :: given

      call read_asperities(values, path_from_namelist(case, trim(values%text_value('asperities', &
         'file'))), case%bodies%reduced_modulus, case%contact%asperities)   ! in SI, scaled below
      if (values%has_group('thermal')) then
         case%contact%heating = new_heating(case%scaling, case%bodies, case%materials%effusivity, &
            case%materials%conductivity)
         case%contact%heating%thermal_viscosity = case%materials%thermal_viscosity
         case%contact%heating%excess = values%real_value('thermal', 'temperature') + houpert_excess
         case%contact%heating%has_flow = values%logical_value('thermal', 'inlet_heating')
      end if
      associate (contact => case%contact)
         contact%lambda = case%scaling%lambda
         contact%moes_m_sum = case%scaling%moes_m/m_mean_per_sum
         contact%moes_l_sum = case%scaling%moes_l*l_sum_per_mean
         contact%slide_to_roll = case%scaling%slide_to_roll
         contact%fluid = scaled_fluid(case%scaling, case%lubricant, case%bodies)
         contact%domain = case%domain
         if (case%time%is_transient) contact%domain%grid = 'even'
         if (case%scaling%is_dimensional) then
            contact%slope = case%scaling%slope
            if (contact%supply < huge(1.0_wp)) contact%supply = contact%supply/case%scaling%film
            if (allocated(contact%asperities)) contact%asperities = scaled(contact%asperities, &
               case%scaling%film, case%scaling%hertz_pressure)
         end if
         call plan_duty(values, contact, case)
         call choose_domain(contact, case%solver%target)
      end associate
      if (allocated(case%duty) .and. allocated(case%contact%heating)) then
         if (.not. case%contact%duty%rolls()) call values%refuse('history', 'file', &
            'found with &thermal a surface that rests or moves against the other, expected '// &
            'speed_1 and speed_2 above 0')
      end if
      if (allocated(case%duty) .and. leaves_scheme(case%solver) .and. .not. &
         case%contact%conserves_oil) then   ! a film that is squeezed closes with upwind2
         if (.not. case%contact%duty%always_moves(least_speed)) case%solver%space_scheme = 'kappa'
      end if
      given = case%time
      call plan_times(values, case%contact, case)
      given%end_time = case%time%end_time
      if (values%findings%count == 0) call check_grid(values, given, case)
   end subroutine plan_line_case

   !> The history of a `contact`, line or point, and whether it is repeated until its film repeats
   !> itself. Findings: ridges without a position, the steady contact of rest.
   subroutine plan_duty(values, contact, case)
      type(input_values_t), intent(inout) :: values
      class(rough_contact_t), intent(inout) :: contact
      type(case_t), intent(inout) :: case
      integer :: features(2), i

      if (.not. allocated(case%duty)) return
      contact%duty = scaled_duty(case%duty, case%scaling)
      contact%surface_1%course = contact%duty%speeds(1)
      contact%surface_2%course = contact%duty%speeds(2)
      case%time%may_lengthen = all([case%duty%is_periodic, case%time%end_time <= 0.0_wp, .not. &
         values%is_given('time', 'duration'), &
         case%time%statistics_from < 0.0_wp, finest_wave(contact) >= huge(1.0_wp), &
         size(case%output_settings%film_thresholds) == 0])
      features = [size(contact%surface_1%features), size(contact%surface_2%features)]
      do i = 1, size(surfaces)   ! where the speed changes, none is the usual one
         if (features(i) > 0 .and. .not. values%has_value(surfaces(i), 'position')) call &
            values%refuse_missing(surfaces(i), 'position', 'with &history')
      end do
      if (case%time%scheme == 'quasi_steady' .and. .not. contact%duty%always_moves(0.0_wp)) call &
         values%refuse('time', 'scheme', "found 'quasi_steady' with a history that stops or "// &
         "reverses, expected 'bdf2': at rest there is no steady film")
   end subroutine plan_duty

   !> Where the surfaces of a `contact`, line or point, begin; film floor, end and step of a
   !> transient. Findings: nothing tells when it ends; waves too fine for grid or step.
   subroutine plan_times(values, contact, case)
      type(input_values_t), intent(inout) :: values
      class(rough_contact_t), intent(inout) :: contact
      type(case_t), intent(inout) :: case

      call place_surface(contact%surface_1, contact%domain%x_inlet, contact%domain%x_outlet)
      call place_surface(contact%surface_2, contact%domain%x_inlet, contact%domain%x_outlet)
      if (case%time%is_transient) call place_features(contact)
      if (case%scaling%is_dimensional) case%solver%film_floor = case%solver%film_floor &
         /case%scaling%film
      associate (time => case%time)
         if (values%is_given('time', 'duration')) time%end_time = values%real_value('time', &
            'duration')/case%scaling%time
         if (time%is_transient .and. .not. time%end_time > 0.0_wp) then
            time%end_time = sufficient_end(contact)
            if ((time%end_time > latest_end .and. .not. allocated(case%duty)) .or. .not. &
               time%end_time > 0.0_wp) call values%refuse_missing('time', 'end_time', &
               'where nothing rough moves, or hardly')
         end if
         call choose_time_step(contact, time)
         if (time%is_transient) call check_times(values, time%end_time, time%time_step)
      end associate
      if (.not. case%scaling%is_dimensional .or. (case%solver%target > 0.0_wp &
         .and. case%problem /= point)) return
      call check_wave(values, 'surface_1', contact%surface_1, contact, case)
      call check_wave(values, 'surface_2', contact%surface_2, contact, case)
   end subroutine plan_times

   !> Finding, without a line: the grid that the program chooses is too fine for the method, or for
   !> the memory, with the time step of `given`. Determines for how many intervals there is memory.
   subroutine check_grid(values, given, case)
      type(input_values_t), intent(inout) :: values
      type(time_settings_t), intent(in) :: given
      type(case_t), intent(inout) :: case
      character(:), allocatable :: fault

      associate (intervals => case%contact%domain%intervals, method => case%solver%method, &
         most => case%solver%max_intervals)
         fault = memory_fault_on(case, given, intervals)
         if (intervals > max_intervals_of(method)) fault = 'found '//to_text(intervals) &
            //' intervals, which the program chooses, expected at most ' &
            //to_text(max_intervals_of(method))//" with method = '"//trim(method)//"'"
         if (fault /= '') call values%findings%add(0, 'domain', 'intervals', fault)
         most = max_refined_intervals
         do while (most > intervals .and. memory_fault_on(case, given, most) /= '')
            most = most/2
         end do
      end associate
   end subroutine check_grid

   !> What is wrong with the memory of a grid of so many `intervals`, with the time step of `given`.
   function memory_fault_on(case, given, intervals) result(fault)
      type(case_t), intent(in) :: case
      type(time_settings_t), intent(in) :: given
      integer, intent(in) :: intervals
      character(:), allocatable :: fault
      type(line_contact_t) :: trial
      type(time_settings_t) :: time
      real(wp) :: steps

      trial = case%contact
      trial%domain%intervals = intervals
      time = given
      call choose_time_step(trial, time)
      steps = 0.0_wp
      if (time%is_transient) steps = time%end_time/time%time_step
      fault = memory_fault('a grid', lubricated_memory(intervals, steps, &
         case%solver%method == 'newton_dense', case%layers), of_blas)
   end function memory_fault_on

   !> Finds a wave that falls between the nodes, or passes within two of the given time steps.
   subroutine check_wave(values, group, surface, contact, case)
      type(input_values_t), intent(inout) :: values
      character(*), intent(in) :: group
      type(rough_surface_t), intent(in) :: surface
      class(rough_contact_t), intent(in) :: contact
      type(case_t), intent(in) :: case
      character(:), allocatable :: key
      real(wp) :: wave, dx, nodes, way

      if (size(surface%features) == 0) return
      wave = minval(surface%features%wavelength)
      key = trim(merge('intervals_x', 'intervals  ', values%problem == point))
      associate (domain => contact%domain, half_width => case%scaling%half_width)
         dx = (domain%x_outlet - domain%x_inlet)/domain%intervals
         nodes = wave/dx
         if (nodes < min_in_a_wave .and. values%has_value('domain', key)) then
            call values%refuse('domain', key, 'found '//to_text(domain%intervals) &
               //', a grid with '//to_text(nodes, 2)//' nodes in the wavelength '// &
               to_text(wave*half_width, 3)//' m of &'//group//', expected at least '// &
               to_text(intervals_at_least(min_in_a_wave*domain%intervals/nodes)) &
               //', two nodes in a wave')
         else if (nodes < min_in_a_wave) then
            call values%refuse(group, 'wavelength', 'found '//to_text(wave*half_width, 3)// &
               ' m, '//to_text(nodes, 2)//' nodes of the finest grid that the program chooses, '// &
               'expected at least '//to_text(min_in_a_wave*dx*half_width, 3)//' m, or '//key &
               //' in &domain')
         end if
      end associate
      way = abs(surface%speed)*case%time%time_step
      if (wave < min_in_a_wave*way .and. values%has_value('time', 'time_step')) call &
         values%refuse('time', 'time_step', 'found '//to_text(case%time%time_step, 3)// &
            ', in which &'//group//' moves by '//to_text(way/wave, 2) &
            //' of its wavelength, expected at most '// &
            to_text(wave/(min_in_a_wave*abs(surface%speed)), 3)//' [-], half of it')
   end subroutine check_wave

end module line_case
