!> Checks over several values of a case: missing, contradictory and unused keys, physical nonsense.
!>
!> Each check adds its findings and goes on, so that one report has them all.
module case_validation
   use body_input, only: check_bodies, check_dry_bodies, check_load, speeds
   use case_record, only: case_t
   use input_keys, only: find_key, group_rows, key_rows
   use input_values, only: check_surface, input_values_t, value_t
   use key_row, only: dry, expected_value, film, has_word, is_in_range, lubricated
   use key_rules, only: check_rules, find_unusual, unusual_t
   use kinds, only: wp
   use lubricant_input, only: check_moes_laws, check_roelands
   use line_contact, only: max_intervals_of
   use system_limits, only: lubricated_memory, memory_fault, of_blas
   use text, only: to_text
   implicit none (type, external)
   private

   public :: check_regime, check_times, conserver, even_reason, validate

   !> Most time steps of a transient.
   real(wp), parameter :: max_steps = 1.0e8_wp
   !> Fewest intervals of the coarsest grid.
   integer, parameter :: min_intervals = 4
   !> Longest title [bytes]: HDF5 keeps attributes of up to 64 kB.
   integer, parameter :: longest_title = 10000

contains

   !> All checks over more than one key.
   subroutine validate(values)
      type(input_values_t), intent(inout) :: values
      logical :: is_read

      is_read = values%findings%count == 0
      call check_groups(values)
      call check_rules(values)
      call check_case(values)
      call check_accuracy(values)
      call check_fields(values)
      if (has_word(dry, values%problem)) then
         if (.not. is_read) return
         call check_dry_bodies(values)
      else
         call check_bodies(values)
      end if
      if (values%has_group('load') .or. values%is_given('history', 'file')) call check_load(values)
      call check_moes_laws(values)
      call check_roelands(values)
      call check_surface(values, 'surface_1', 'speed_1')
      call check_surface(values, 'surface_2', 'speed_2')
      if (values%problem == lubricated) call check_solver(values)
      if (.not. values%logical_value('time', 'transient')) return
      if (values%has_value('time', 'end_time')) call check_times(values, &
         values%real_value('time', 'end_time'), values%real_value('time', 'time_step'))
   end subroutine validate

   !> Findings about a transient that ends at `end_time` [T]: the given step, or the time from which
   !> quantities count, is later; too many steps of length `step`, where that is known (not 0).
   subroutine check_times(values, end_time, step)
      type(input_values_t), intent(inout) :: values
      real(wp), intent(in) :: end_time, step
      character(len=15), parameter :: keys(*) = [character(len=15) :: 'time_step', &
         'statistics_from']
      integer :: i

      do i = 1, size(keys)
         if (values%real_value('time', keys(i)) > end_time) call values%refuse('time', &
            keys(i), 'found '//to_text(values%real_value('time', keys(i)))// &
            ', expected at most end_time = '//to_text(end_time)//' [-]')
      end do
      if (step > 0.0_wp .and. end_time > max_steps*step) call values%refuse('time', merge( &
         'duration', 'end_time', values%is_given('time', 'duration')), 'found '// &
         to_text(end_time/step, 3)//' time steps, expected at most '//to_text(max_steps, 1))
   end subroutine check_times

   !> Finds groups that are missing, and groups that &moes replaces or excludes.
   subroutine check_groups(values)
      type(input_values_t), intent(inout) :: values
      logical :: has_moes
      integer :: i

      has_moes = has_word(film, values%problem) .and. values%has_group('moes')
      do i = 1, size(group_rows)
         associate (row => group_rows(i))
            if (.not. has_word(row%problems, values%problem)) cycle
            if (values%has_group(row%group)) then
               if (has_moes .and. row%yields_to_moes) call values%refuse(row%group, '', &
                  'found together with &moes, expected one of the two: &moes is a smooth '// &
                  'contact without SI units')
            else if (row%group == 'load' .and. values%is_given('history', 'file')) then
               continue   ! the table has it, or is refused
            else if (row%is_needed .and. .not. (has_moes .and. row%yields_to_moes)) then
               call values%refuse(row%group, '', 'missing, expected &' &
                  //trim(row%group)//' ... / ('//trim(row%meaning)//')')
            end if
         end associate
      end do
   end subroutine check_groups

   !> Findings: an output that cannot be the name of a file; a title that no attribute can hold.
   subroutine check_case(values)
      type(input_values_t), intent(inout) :: values
      character(:), allocatable :: output
      integer :: length

      length = len(values%text_value('case', 'title'))
      if (length > longest_title) call values%refuse('case', 'title', 'found ' // to_text(length) &
         // ' bytes, expected at most ' // to_text(longest_title))
      if (.not. values%has_value('case', 'output')) return
      output = trim(values%text_value('case', 'output'))
      if (output == '') then
         call values%refuse('case', 'output', 'found an empty text, expected the name of a file')
      else if (index(output, '/', back=.true.) == len(output)) then
         call values%refuse('case', 'output', 'found the folder ' // output &
            // ', expected the name of a file')
      end if
   end subroutine check_case

   !> Finds more intervals than the method is given, or than there is memory for, more levels than
   !> the grid has, equations and methods that do not go together.
   subroutine check_solver(values)
      type(input_values_t), intent(inout) :: values
      character(:), allocatable :: fault, method, reason
      integer :: intervals, levels

      if (values%has_value('history', 'file') .and. values%integer_value('output', &
         'velocity_layers') > 0) call values%refuse('output', 'velocity_layers', &
         'found with &history, expected 0')
      call check_cavitation(values)
      call check_heat(values)
      call check_equations(values)
      reason = even_reason(values)
      if (values%logical_value('time', 'transient')) then
         if (values%word_value('case', 'equations') /= 'stokes') reason = ''
      else if (values%is_given('accuracy', 'target') .and. reason /= 'intervals') then
         if (values%word_value('domain', 'grid') == 'even') reason = "grid = 'even'"
         if (reason /= '') call values%refuse('accuracy', 'target', 'found with '//reason &
            //', expected the graded grid of a steady contact')
      end if
      if (values%word_value('domain', 'grid') == 'graded' .and. reason /= '') call values%refuse( &
         'domain', 'grid', "found 'graded' with "//reason//", expected 'even' or 'auto'")
      if (.not. values%has_value('domain', 'intervals')) return
      method = trim(values%word_value('solver', 'method'))
      intervals = values%integer_value('domain', 'intervals')
      fault = memory_fault('a grid', lubricated_memory(intervals, 0.0_wp, &
         method == 'newton_dense', merge(values%integer_value('film', 'layers'), 0, &
         values%word_value('case', 'equations') == 'stokes')), of_blas)
      if (intervals > max_intervals_of(method)) fault = 'found ' // to_text(intervals) &
         // ', expected at most ' // to_text(max_intervals_of(method)) // " with method = '" &
         // method // "'"
      if (fault /= '') call values%refuse('domain', 'intervals', fault)
      levels = values%integer_value('solver', 'levels')
      if (.not. values%has_value('solver', 'levels')) return
      if (shiftr(intervals, levels - 1) < min_intervals) call values%refuse('solver', 'levels', &
         'found ' // to_text(levels) // ' levels for ' // to_text(intervals) &
         // ' intervals, expected at least ' // to_text(min_intervals) &
         // ' intervals on the coarsest grid')
   end subroutine check_solver

   !> What of the input needs an even grid; empty: nothing.
   pure function even_reason(values) result(reason)
      type(input_values_t), intent(in) :: values
      character(:), allocatable :: reason
      integer :: i

      reason = ''
      do i = 1, size(key_rows)
         associate (row => key_rows(i))
            if (row%group /= 'solver' .or. index(row%key, 'film') > 0 .or. .not. &
               has_word(row%problems, lubricated)) cycle
            if (.not. values%is_given('solver', row%key)) cycle
            if (row%kind == 'word') then
               if (row%default == "'"//trim(values%word_value('solver', row%key))//"'") cycle
            end if
            reason = '&solver '//trim(row%key)
         end associate
      end do
      if (values%has_value('domain', 'intervals')) reason = 'intervals'
      if (conserver(values) /= '') reason = conserver(values)
      if (values%word_value('case', 'equations') == 'stokes') reason = "equations = 'stokes'"
   end function even_reason

   !> What of the input has oil conserved where the film cavitates; empty: nothing.
   pure function conserver(values)
      type(input_values_t), intent(in) :: values
      character(:), allocatable :: conserver
      character(len=10), parameter :: groups(*) = [character(len=10) :: 'asperities', 'supply', &
         'thermal']
      integer :: i

      conserver = ''
      if (values%word_value('lubricant', 'cavitation') == 'mass_conserving') conserver = &
         "cavitation = 'mass_conserving'"
      i = findloc(values%has_group(groups), .true., dim=1, back=.true.)
      if (i > 0) conserver = '&'//trim(groups(i))
   end function conserver

   !> Finds what the conservation of oil does not go with.
   subroutine check_cavitation(values)
      type(input_values_t), intent(inout) :: values
      character(:), allocatable :: because

      if (conserver(values) == '') return
      because = 'with '//conserver(values)
      if (values%word_value('lubricant', 'cavitation') == 'reynolds') call values%refuse( &
         'lubricant', 'cavitation', "found 'reynolds' "//because//", expected 'mass_conserving'")
      if (values%word_value('case', 'equations') == 'stokes') call values%refuse('case', &
         'equations', "found 'stokes' "//because//", expected 'reynolds'")
      call check_method(values, 'auto newton_krylov', ' '//because// &
         ", expected 'auto' or 'newton_krylov'", because)
   end subroutine check_cavitation

   !> Finds what temperatures of the film do not go with.
   subroutine check_heat(values)
      type(input_values_t), intent(inout) :: values
      real(wp) :: inlet

      if (.not. values%has_group('thermal')) return
      if (values%logical_value('time', 'transient') .and. (.not. values%has_group('history') .or. &
         values%is_given('surface_1', 'shape') .or. values%is_given('surface_2', 'shape'))) call &
         values%refuse('time', 'transient', 'found .true. with &thermal, expected .false., or '// &
         'smooth surfaces with &history: of what passes with a surface the heat is not known')
      if (values%integer_value('output', 'velocity_layers') > 0) call values%refuse('output', &
         'velocity_layers', 'found with &thermal, expected 0')
      if (all(values%has_value('bodies', speeds))) then
         if (product(values%real_value('bodies', speeds)) <= 0.0_wp) call values%refuse('bodies', &
            'speed_1', 'found with &thermal a surface '// &
            'that rests or moves against the other, expected both to move with the oil')
      end if
      inlet = values%real_value('lubricant', 'temperature', values%real_value('thermal', &
         'temperature'))
      if (abs(inlet - values%real_value('thermal', 'temperature')) > 0.0_wp) call values%refuse( &
         'thermal', 'temperature', 'found another one than &lubricant temperature, '// &
         to_text(inlet)//' [degC], expected the same')
   end subroutine check_heat

   !> Finds what the full momentum equations of the film, and the scheme kappa, do not go with.
   subroutine check_equations(values)
      type(input_values_t), intent(inout) :: values
      character(:), allocatable :: because

      because = ''
      if (values%word_value('solver', 'space_scheme') == 'kappa') because = &
         "with space_scheme = 'kappa'"
      if (values%word_value('case', 'equations') == 'stokes') then
         because = "with equations = 'stokes'"
         if (values%has_value('history', 'file')) call values%refuse('history', 'file', 'found '// &
            because//", expected 'reynolds'")
         if (values%has_group('moes')) then
            call values%refuse('case', 'equations', "found 'stokes' with &moes, expected "// &
               "'reynolds': the slope of the film, b/R, is not known")
         else if (values%logical_value('time', 'transient') &
            .and. values%logical_value('film', 'inertia')) then
            call values%refuse('film', 'inertia', 'found .true. with transient = .true., '// &
               'expected .false., or a steady contact')
         end if
         if (values%word_value('solver', 'space_scheme') == 'upwind2') call values%refuse( &
            'solver', 'space_scheme', "found 'upwind2', expected 'auto' or 'kappa' "//because)
      end if
      if (because /= '') call check_method(values, 'auto newton_krylov newton_dense', &
         ", expected 'auto', 'newton_krylov' or 'newton_dense' "//because, because)
   end subroutine check_equations

   !> Finds a method that is none of the blank-separated `good` ones, told by `fault`, or a
   !> smoother, which those do not use.
   subroutine check_method(values, good, fault, because)
      type(input_values_t), intent(inout) :: values
      character(*), intent(in) :: good, fault, because
      character(:), allocatable :: method

      method = trim(values%word_value('solver', 'method'))
      if (.not. has_word(good//' ?', method)) then
         call values%refuse('solver', 'method', "found '"//method//"'"//fault)
      else if (values%word_value('solver', 'smoother') /= 'auto') then
         call values%refuse_unused('solver', 'smoother', because)
      end if
   end subroutine check_method

   !> Finds a field named twice, and shear stresses where the speeds of the surfaces are not known.
   subroutine check_fields(values)
      type(input_values_t), intent(inout) :: values
      type(value_t) :: fields
      integer :: i

      fields = values%slot('output', 'fields')
      if (.not. fields%has_value) return
      do i = 1, size(fields%words)
         if (any(fields%words(:i - 1) == fields%words(i)) .and. fields%words(i) /= '?') call &
            values%refuse('output', 'fields', "found '" // trim(fields%words(i)) &
            // "' twice, expected " // expected_value(key_rows(find_key('output', 'fields', &
            values%problem))) // ', each once')
         if (values%has_group('moes') .and. index(fields%words(i), 'shear_stress') == 1) call &
            values%refuse('output', 'fields', "found '" // trim(fields%words(i)) &
            // "' with &moes, expected 'pressure' or 'film_thickness': the speeds of the "// &
            'surfaces are not known')
      end do
   end subroutine check_fields

   !> Finds a target without the error bars that it needs, and a model that is left to the program
   !> without a target to choose it by, or with equations that it does not measure.
   subroutine check_accuracy(values)
      type(input_values_t), intent(inout) :: values

      if (values%word_value('case', 'model') == 'auto') then
         if (.not. values%is_given('accuracy', 'target')) call values%refuse('case', 'model', &
            "found 'auto' without &accuracy target, expected 'full', or a target")
         if (values%word_value('case', 'equations') == 'stokes') call values%refuse('case', &
            'model', "found 'auto' with equations = 'stokes', expected 'full'")
      end if
      if (.not. values%is_given('accuracy', 'target') .or. .not. values%has_value('accuracy', &
         'error_bars') .or. values%logical_value('accuracy', 'error_bars')) return
      call values%refuse('accuracy', 'error_bars', &
         'found .false., expected .true. with &accuracy target')
   end subroutine check_accuracy

   !> Adds findings: a load, given by `key`, whose contact is wider than the radius, where neither
   !> Hertz nor the half-space holds; a contact outside the range of &moes.
   subroutine check_regime(values, key, case)
      type(input_values_t), intent(inout) :: values
      character(*), intent(in) :: key
      type(case_t), intent(in) :: case
      type(unusual_t), allocatable :: unusual(:)

      if (.not. case%scaling%is_dimensional) return
      associate (scales => case%scaling, m => key_rows(find_key('moes', 'moes_m', lubricated)), &
         l => key_rows(find_key('moes', 'moes_l', lubricated)))
         if (scales%half_width >= case%bodies%reduced_radius) then
            call values%refuse('load', key, 'found a contact of half-width ' &
               // to_text(scales%half_width, 3) // ' m, expected less than the reduced radius, ' &
               // to_text(case%bodies%reduced_radius, 3) // ' m')
         else if (.not. (is_in_range(scales%moes_m, m%allowed) .and. is_in_range(scales%moes_l, &
            l%allowed))) then
            unusual = find_unusual(values)
            if (size(unusual) > 0) then
               call values%refuse('load', key, 'found no contact that can be computed: '// &
                  unusual(1)%words//unusual(1)%question)
               return
            end if
            call values%refuse('load', key, 'found a contact with Moes numbers M = ' &
               // to_text(scales%moes_m, 3) // ', L = ' // to_text(scales%moes_l, 3) &
               // ' (mean velocity), expected M ' // trim(m%allowed) // ' and L ' &
                  // trim(l%allowed))
         end if
      end associate
   end subroutine check_regime

end module case_validation
