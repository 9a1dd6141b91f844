!> From the text of a namelist to a case: reading, checking, filling the record.
module case_input
   use body_input, only: derive_speeds, fill_bodies
   use case_record, only: case_t, list_dry, list_effective, path_from_namelist, set_effective
   use case_validation, only: check_regime, conserver, even_reason, validate
   use dry_input, only: fill_dry_case
   use duty_input, only: read_duty
   use file_heights, only: read_files
   use film_surface, only: make_surface
   use findings, only: findings_t
   use input_values, only: input_values_t, value_t
   use measured_heights, only: heights_t
   use key_row, only: dry, film, has_word, point
   use key_rules, only: find_unusual, unusual_t
   use line_case, only: fill_scaling, plan_line_case
   use lubricant_input, only: complete_alpha, derive_viscosity, fill_lubricant
   use namelist_text, only: entry_t, namelist_text_t, split_namelist
   use point_input, only: fill_point_case
   use set_entries, only: mark_entries
   use text, only: to_text
   use value_reader, only: read_values
   implicit none (type, external)
   private

   public :: read_case

contains

   !> Reads the namelist `content` of the file `file` (a name for paths and messages only).
   !>
   !> `entries` of the command line are in it already; findings about them name --set. Findings: all
   !> that is wrong, see namelist_text, value_reader and case_validation; else `case` is filled.
   subroutine read_case(content, file, case, findings, entries)
      character(*), intent(in) :: content, file
      type(case_t), intent(out) :: case
      type(findings_t), intent(out) :: findings
      type(entry_t), intent(in), optional :: entries(:)
      type(namelist_text_t) :: pieces
      type(input_values_t) :: values
      type(heights_t), allocatable :: files(:)
      character(:), allocatable :: oil
      logical :: is_alone, is_valid

      case%file = file
      case%namelist = content
      case%note = ''
      call split_namelist(content, pieces, values%findings)
      if (pieces%count > 0) then
         if (present(entries)) call mark_entries(entries, pieces)
         call read_values(pieces, values)
         is_alone = .false.
         oil = ''
         if (has_word(film, values%problem)) then
            call derive_speeds(values)
            call derive_viscosity(values, oil)
            call complete_alpha(values, is_alone)
            call read_duty(values, path_from_namelist(case, ''), case%duty)
         end if
         call validate(values)
         is_valid = values%findings%count == 0
         call read_files(values, path_from_namelist(case, ''), files)
         if (is_valid) call fill_case(values, files, case)
         case%unusual = find_unusual(values)
         if (oil /= '') case%unusual = [case%unusual, unusual_t(values%line_of('lubricant', &
            'viscosity'), oil, '')]
         if (is_alone) case%unusual = [case%unusual, unusual_t(values%line_of('lubricant', &
            'pressure_viscosity'), '&lubricant pressure_viscosity is given alone: Roelands '// &
            'with P0 = '//to_text(case%lubricant%roelands_p0, 3)//' Pa, z = ' &
            //to_text(case%lubricant%roelands_z, 4), '')]
      else if (values%findings%count == 0) then
         call values%findings%add(1, '', '', 'found no group, expected &case ... / and others; '// &
            'see asperity --template ehl_line')
      end if
      findings = values%findings
   end subroutine read_case

   !> The case that valid values and the `files` of its surfaces describe. Findings, beside those of
   !> the files: what does not go together in it.
   subroutine fill_case(values, files, case)
      type(input_values_t), intent(inout) :: values
      type(heights_t), allocatable, intent(inout) :: files(:)
      type(case_t), intent(inout) :: case
      character(:), allocatable :: key
      integer :: before

      before = values%findings%count
      case%title = values%text_value('case', 'title')
      case%output = trim(values%text_value('case', 'output'))
      case%has_xdmf = values%logical_value('output', 'xdmf')
      case%problem = values%word_value('case', 'problem')
      case%model = values%word_value('case', 'model')
      if (has_word(dry, case%problem)) then
         if (before > 0 .and. .not. allocated(files(1)%file)) return   ! its grid is not known
         case%dry%values = values
         call move_alloc(files, case%dry%files)
         call fill_dry_case(case%dry)
         values = case%dry%values
         if (values%findings%count > 0) return
         call list_effective(values, case)
         call list_dry(case)
         return
      end if
      call fill_lubricant(values, case%lubricant, case%materials)
      call fill_common(values, case)
      if (case%problem == point) then
         call fill_point_case(values, files, case)
         return
      end if
      call fill_bodies(values, case%bodies)
      call fill_numerics(values, case)
      call fill_scaling(values, case, key)
      call check_regime(values, key, case)
      if (values%findings%count > before) return
      call list_effective(values, case)
      if (allocated(case%duty)) call set_effective(case, 'history', 'table_checksum', &
         text=case%duty%digits)
      call make_surface(values, 'surface_1', files(1), case, case%contact%surface_1)
      call make_surface(values, 'surface_2', files(2), case, case%contact%surface_2)
      if (values%findings%count == 0) call plan_line_case(values, case)
   end subroutine fill_case

   !> &time, &output, &accuracy, tolerance and film floor of films; 0 where the program chooses.
   subroutine fill_common(values, case)
      type(input_values_t), intent(in) :: values
      type(case_t), intent(inout) :: case
      type(value_t) :: fields, thresholds

      fields = values%slot('output', 'fields')
      thresholds = values%slot('output', 'film_thresholds')
      associate (time => case%time, solver => case%solver, output => case%output_settings)
         time%is_transient = values%logical_value('time', 'transient')
         time%end_time = values%real_value('time', 'end_time')
         time%time_step = values%real_value('time', 'time_step')
         time%scheme = values%word_value('time', 'scheme')
         time%statistics_from = values%real_value('time', 'statistics_from', time%statistics_from)
         solver%tolerance = values%real_value('solver', 'tolerance')
         solver%max_cycles = values%integer_value('solver', 'max_cycles')
         solver%film_floor = values%real_value('solver', 'film_floor')   ! [m] before it is planned
         solver%on_film_breakdown = values%word_value('solver', 'on_film_breakdown')
         solver%target = values%real_value('accuracy', 'target')
         solver%wants_coarse_runs = values%logical_value('accuracy', 'error_bars')
         output%profile_stride = values%integer_value('output', 'profile_stride')
         output%fields = fields%words
         output%checkpoint_interval = values%real_value('output', 'checkpoint_interval')
         output%has_si = values%logical_value('output', 'si_copies')
         output%film_thresholds = thresholds%reals
         output%adequacy = values%word_value('output', 'adequacy')
      end associate
   end subroutine fill_common

   !> &domain, &solver, &film and &output of a line; 0 where the program chooses.
   subroutine fill_numerics(values, case)
      type(input_values_t), intent(in) :: values
      type(case_t), intent(inout) :: case

      associate (domain => case%domain)
         domain%has_inlet = values%has_value('domain', 'x_inlet')
         domain%has_outlet = values%has_value('domain', 'x_outlet')
         domain%x_inlet = values%real_value('domain', 'x_inlet')
         domain%x_outlet = values%real_value('domain', 'x_outlet')
         domain%intervals = values%integer_value('domain', 'intervals')
         domain%grid = values%word_value('domain', 'grid')
         domain%has_tail = values%logical_value('time', 'transient') .and. domain%grid /= 'even' &
            .and. values%word_value('case', 'equations') /= 'stokes' .and. .not. &
            (allocated(case%duty) .or. values%has_group('supply') &
            .or. values%has_group('asperities')) .and. (domain%grid == 'graded' &
            .or. .not. domain%has_inlet)
         if (even_reason(values) /= '') domain%grid = 'even'
         if (domain%grid == 'auto' .and. values%has_value('accuracy', 'target') &
            .and. .not. values%logical_value('time', 'transient')) domain%grid = 'graded'
      end associate
      case%contact%conserves_oil = conserver(values) /= ''
      case%contact%supply = values%real_value('supply', 'film', case%contact%supply)   ! [m]
      associate (solver => case%solver)
         solver%method = values%word_value('solver', 'method')
         solver%smoother = values%word_value('solver', 'smoother')
         solver%space_scheme = values%word_value('solver', 'space_scheme')
         solver%start = values%word_value('solver', 'start')
         solver%levels = values%integer_value('solver', 'levels')
         solver%pre_sweeps = values%integer_value('solver', 'pre_sweeps')
         solver%post_sweeps = values%integer_value('solver', 'post_sweeps')
         solver%coarse_sweeps = values%integer_value('solver', 'coarse_sweeps')
         solver%relaxation = values%real_value('solver', 'relaxation')
         solver%load_relaxation = values%real_value('solver', 'load_relaxation')
      end associate
      if (values%word_value('case', 'equations') == 'stokes') then
         case%layers = values%integer_value('film', 'layers')
         case%has_inertia = values%logical_value('film', 'inertia')
         case%solver%space_scheme = 'kappa'
      end if
      case%output_settings%velocity_layers = values%integer_value('output', 'velocity_layers')
   end subroutine fill_numerics

end module case_input
