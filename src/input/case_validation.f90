!> What the values of a case must have in common: missing, contradictory and unused keys, physical
!> nonsense.
!>
!> Each check adds its findings and goes on, so that one report tells everything.
module case_validation
   use case_memory, only: lubricated_memory
   use dry_validation, only: check_dry
   use findings, only: findings_t
   use input_keys, only: find_key, group_rows, key_rows
   use input_values, only: input_values_t, value_t
   use key_row, only: expected_value, has_word, lubricated
   use key_rules, only: check_rules
   use kinds, only: wp
   use lubricant_validation, only: check_lubricant
   use solver_settings, only: most_intervals_of
   use surface_validation, only: check_surface
   use system_limits, only: memory_fault
   use text, only: to_text
   use validation_messages, only: check_radii, report_missing, report_unused
   implicit none (type, external)
   private

   public :: validate

   !> Most time steps of a transient.
   real(wp), parameter :: most_steps = 1.0e8_wp
   !> Fewest intervals of the coarsest grid.
   integer, parameter :: fewest_intervals = 4
   !> Longest title [bytes]: HDF5 keeps attributes of up to 64 kB.
   integer, parameter :: longest_title = 10000

contains

   !> All checks over more than one key.
   subroutine validate(values, findings)
      type(input_values_t), intent(in) :: values
      type(findings_t), intent(inout) :: findings
      logical :: is_read

      is_read = findings%count == 0
      call check_groups(values, findings)
      call check_rules(values, findings)
      call check_case(values, findings)
      call check_accuracy(values, findings)
      if (values%problem /= lubricated) then
         if (is_read) call check_dry(values, findings)
         return
      end if
      if (values%has_group('bodies')) then
         call check_ways(values, 'reduced_radius', [character(len=20) :: 'radius_1', 'radius_2'], &
            findings)
         call check_ways(values, 'reduced_modulus', [character(len=20) :: 'youngs_modulus_1', &
            'youngs_modulus_2', &
            'poisson_ratio_1', 'poisson_ratio_2'], findings)
         call check_speeds(values, findings)
      end if
      if (values%has_group('load')) call check_load(values, findings)
      call check_lubricant(values, findings)
      call check_surface(values, 'surface_1', 'speed_1', findings)
      call check_surface(values, 'surface_2', 'speed_2', findings)
      call check_time(values, findings)
      call check_solver(values, findings)
      call check_output(values, findings)
   end subroutine validate

   !> Finds groups that are missing, and groups that &moes replaces or excludes.
   subroutine check_groups(values, findings)
      type(input_values_t), intent(in) :: values
      type(findings_t), intent(inout) :: findings
      logical :: has_moes
      integer :: i

      has_moes = values%problem == lubricated .and. values%has_group('moes')
      do i = 1, size(group_rows)
         associate (row => group_rows(i))
            if (.not. has_word(row%problems, trim(values%problem))) cycle
            if (values%has_group(row%group)) then
               if (has_moes .and. row%yields_to_moes) call findings%add(values%group_lines(i), &
                  row%group, '', 'found together with &moes, expected one of the two: &moes is '// &
                  'a smooth contact without SI units')
            else if (row%is_needed .and. .not. (has_moes .and. row%yields_to_moes)) then
               call findings%add(values%last_line, row%group, '', 'found no such group, '// &
                  'expected &'//trim(row%group)//' ... / ('//trim(row%meaning)//')')
            end if
         end associate
      end do
   end subroutine check_groups

   !> Findings: an output that cannot be the name of a file; a title that no attribute can hold.
   subroutine check_case(values, findings)
      type(input_values_t), intent(in) :: values
      type(findings_t), intent(inout) :: findings
      type(value_t) :: output, title

      title = values%slot('case', 'title')
      if (len(title%text) > longest_title) call findings%add(title%line, 'case', 'title', &
         'found ' // to_text(len(title%text)) &
         // ' bytes, expected at most ' // to_text(longest_title))
      output = values%slot('case', 'output')
      if (.not. output%has_value) return
      if (len_trim(output%text) == 0) then
         call findings%add(output%line, 'case', 'output', 'found an empty text, expected the '// &
            'name of a file')
      else if (index(output%text, '/', back=.true.) == len_trim(output%text)) then
         call findings%add(output%line, 'case', 'output', 'found the folder ' // trim(output%text) &
            // ', expected the name of a file')
      end if
   end subroutine check_case

   !> A reduced value of &bodies, or all of the values it follows from. Findings: both, none, some.
   subroutine check_ways(values, reduced, parts, findings)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: reduced
      character(*), intent(in) :: parts(:)
      type(findings_t), intent(inout) :: findings
      integer :: i, given
      character(:), allocatable :: list

      given = 0
      list = trim(parts(1))
      do i = 1, size(parts)
         if (values%is_given('bodies', trim(parts(i)))) given = given + 1
         if (i == size(parts)) list = list // ' and ' // trim(parts(i))
         if (i > 1 .and. i < size(parts)) list = list // ', ' // trim(parts(i))
      end do
      if (values%is_given('bodies', reduced)) then
         if (given > 0) call findings%add(values%line_of('bodies', reduced), 'bodies', reduced, &
            'found together with ' &
            // first_given(values, parts) // ', expected either ' // reduced // ' or ' // list)
      else if (given == 0) then
         call findings%add(values%line_of('bodies', ''), 'bodies', trim(parts(1)), &
            'found nothing, expected ' // list &
            // ', or ' // reduced // ' [' // trim(key_rows(find_key('bodies', reduced))%unit) &
               // ']')
      else
         do i = 1, size(parts)
            if (.not. values%is_given('bodies', trim(parts(i)))) call report_missing(values, &
               'bodies', trim(parts(i)), findings)
         end do
      end if
   end subroutine check_ways

   !> The first of `keys` of &bodies that is given.
   function first_given(values, keys) result(key)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: keys(:)
      character(:), allocatable :: key
      integer :: i

      key = ''
      do i = size(keys), 1, -1
         if (values%is_given('bodies', trim(keys(i)))) key = trim(keys(i))
      end do
   end function first_given

   !> Finding: speeds that draw no oil into the contact; radii that do not touch.
   subroutine check_speeds(values, findings)
      type(input_values_t), intent(in) :: values
      type(findings_t), intent(inout) :: findings
      real(wp) :: first, second

      if (values%has_value('bodies', 'speed_1') .and. values%has_value('bodies', 'speed_2')) then
         first = values%real_value('bodies', 'speed_1')
         second = values%real_value('bodies', 'speed_2')
         if (first + second <= 0.0_wp) call findings%add(values%line_of('bodies', 'speed_1'), &
            'bodies', 'speed_1', &
            'found speed_1 + speed_2 = ' // to_text(first + second) // ', expected a sum > 0 '// &
               '[m/s]: no oil is drawn in')
      end if
      call check_radii(values, findings)
   end subroutine check_speeds

   !> Finds no load, or two.
   subroutine check_load(values, findings)
      type(input_values_t), intent(in) :: values
      type(findings_t), intent(inout) :: findings

      if (values%is_given('load', 'load_per_length') .and. values%is_given('load', &
         'hertz_pressure')) then
         call findings%add(values%line_of('load', 'hertz_pressure'), 'load', 'hertz_pressure', &
            'found together with load_per_length, expected one of the two')
      else if (.not. values%is_given('load', 'load_per_length') &
         .and. .not. values%is_given('load', 'hertz_pressure')) then
         call findings%add(values%line_of('load', ''), 'load', 'load_per_length', &
            'found nothing, expected load_per_length [N/m] or hertz_pressure [Pa]')
      end if
   end subroutine check_load

   !> Finds times of a transient that contradict each other, and an inlet that is steady only.
   subroutine check_time(values, findings)
      type(input_values_t), intent(in) :: values
      type(findings_t), intent(inout) :: findings
      type(value_t) :: transient

      transient = values%slot('time', 'transient')
      if (.not. transient%logical) return
      call check_steps(values, findings)
      if (values%word_value('domain', 'inlet') == 'tail') call findings%add( &
         values%line_of('domain', 'inlet'), 'domain', 'inlet', &
         "found 'tail', expected 'auto' or 'zero' with transient = .true.")
   end subroutine check_time

   !> Finds a time step longer than the transient, figures that begin behind its end, too many
   !> steps. A step that the program chooses is the grid spacing, here estimated from the narrowest
   !> domain.
   subroutine check_steps(values, findings)
      type(input_values_t), intent(in) :: values
      type(findings_t), intent(inout) :: findings
      type(value_t) :: intervals
      real(wp) :: end_time, time_step

      if (.not. values%has_value('time', 'end_time')) return
      end_time = values%real_value('time', 'end_time')
      if (values%has_value('time', 'statistics_from')) then
         if (values%real_value('time', 'statistics_from') > end_time) call findings%add( &
            values%line_of('time', 'statistics_from'), 'time', 'statistics_from', 'found '// &
            to_text(values%real_value('time', 'statistics_from')) &
               //', expected at most end_time = '//to_text(end_time)//' [-]')
      end if
      intervals = values%slot('domain', 'intervals')
      if (values%has_value('time', 'time_step')) then
         time_step = values%real_value('time', 'time_step')
         if (time_step > end_time) call findings%add(values%line_of('time', 'time_step'), 'time', &
            'time_step', 'found ' &
            // to_text(time_step) // ', expected at most end_time = ' // to_text(end_time) &
               // ' [-]')
      else if (intervals%has_value) then
         time_step = 2.0_wp/real(intervals%integer, wp)
      else
         return
      end if
      if (end_time > most_steps*time_step) call findings%add(values%line_of('time', 'end_time'), &
         'time', 'end_time', 'found ' &
         // to_text(end_time/time_step, 3) // ' time steps, expected at most '// &
            '' // to_text(most_steps, 1))
   end subroutine check_steps

   !> Finds settings that contradict each other; more levels than the grid has.
   subroutine check_solver(values, findings)
      type(input_values_t), intent(in) :: values
      type(findings_t), intent(inout) :: findings
      character(:), allocatable :: method
      type(value_t) :: levels, intervals

      method = trim(values%word_value('solver', 'method'))
      if (values%word_value('solver', 'space_scheme') == 'kappa') call check_kappa_scheme(values, &
         findings)
      levels = values%slot('solver', 'levels')
      intervals = values%slot('domain', 'intervals')
      if (intervals%has_value) call check_fineness(intervals, method, findings)
      if (.not. levels%has_value .or. .not. intervals%has_value) return
      if (shiftr(intervals%integer, &
         levels%integer - 1) < fewest_intervals) call findings%add(levels%line, 'solver', &
            'levels', &
         'found ' // to_text(levels%integer) // ' levels for ' // to_text(intervals%integer) &
            // ' intervals, expected at least ' &
         // to_text(fewest_intervals) // ' intervals on the coarsest grid')
   end subroutine check_solver

   !> Finding: more intervals than the method is given, or than there is memory for.
   subroutine check_fineness(intervals, method, findings)
      type(value_t), intent(in) :: intervals
      character(*), intent(in) :: method
      type(findings_t), intent(inout) :: findings
      character(:), allocatable :: fault

      fault = memory_fault('a grid', lubricated_memory(intervals%integer, 0.0_wp, &
         method == 'newton_dense'))
      if (intervals%integer > most_intervals_of(method)) fault = &
         'found ' // to_text(intervals%integer) // ', expected at most ' &
         // to_text(most_intervals_of(method)) // " with method = '" // method // "'"
      if (fault /= '') call findings%add(intervals%line, 'domain', 'intervals', fault)
   end subroutine check_fineness

   !> Finds a method or smoother that cannot solve the kappa space scheme.
   subroutine check_kappa_scheme(values, findings)
      type(input_values_t), intent(in) :: values
      type(findings_t), intent(inout) :: findings
      character(*), parameter :: needs = "', expected 'auto', 'newton_krylov' or "// &
         "'newton_dense' with space_scheme = 'kappa'"
      character(:), allocatable :: method

      method = trim(values%word_value('solver', 'method'))
      if (index(method, 'block_jacobi') > 0) then
         call findings%add(values%line_of('solver', 'method'), 'solver', 'method', &
            "found '" // method // needs)
      else if (values%word_value('solver', 'smoother') /= 'auto') then
         call report_unused(values, 'solver', 'smoother', "with space_scheme = 'kappa'", findings)
      end if
   end subroutine check_kappa_scheme

   !> Finds a field named twice.
   subroutine check_output(values, findings)
      type(input_values_t), intent(in) :: values
      type(findings_t), intent(inout) :: findings
      type(value_t) :: fields
      integer :: i

      fields = values%slot('output', 'fields')
      if (.not. fields%has_value) return
      do i = 2, size(fields%words)
         if (any(fields%words(:i - 1) == fields%words(i)) &
            .and. fields%words(i) /= '?') call findings%add(fields%line, &
            'output', 'fields', "found '" // trim(fields%words(i)) // "' twice, expected " &
            // expected_value(key_rows(find_key('output', 'fields'))) // ', each once')
      end do
   end subroutine check_output

   !> Finds a target without the error bars that it needs.
   subroutine check_accuracy(values, findings)
      type(input_values_t), intent(in) :: values
      type(findings_t), intent(inout) :: findings
      type(value_t) :: error_bars

      error_bars = values%slot('accuracy', 'error_bars')
      if (.not. values%is_given('accuracy', 'target') .or. .not. error_bars%has_value) return
      if (.not. error_bars%logical) call findings%add(error_bars%line, 'accuracy', &
         'error_bars', 'found .false., expected .true. with &accuracy target')
   end subroutine check_accuracy

end module case_validation
