!> The commented, complete namelist of `asperity --template`: every key of the table, with the
!> values of an example.
module input_template
   use input_keys, only: group_rows, key_rows
   use key_condition, only: rules_text
   use key_row, only: has_word, is_chosen, is_optional, is_required, key_row_t, &
      lubricated, word_list, words_kind
   implicit none (type, external)
   private

   public :: template_text

   !> A key of the template.
   type :: example_t
      character(len=12) :: group
      character(len=20) :: key
      character(len=48) :: value
      !> False: shown as a comment, since it would contradict another key or not be used.
      logical :: is_active
   end type example_t

   !> Chapter 5, Case 1 of the thesis (Table 5.1). A key with a default of the table that is not
   !> listed shows its default.
   type(example_t), parameter :: examples(*) = [ &
      example_t('case', 'title', "'Case 1: smooth surfaces, steady'", .true.), &
      example_t('case', 'problem', "'ehl_line'", .true.), &
      example_t('case', 'output', "'case1.h5'", .false.), &
      example_t('bodies', 'radius_1', '0.01', .true.), &
      example_t('bodies', 'radius_2', '2.0', .true.), &
      example_t('bodies', 'reduced_radius', '9.950e-3', .false.), &
      example_t('bodies', 'youngs_modulus_1', '206e9', .true.), &
      example_t('bodies', 'youngs_modulus_2', '206e9', .true.), &
      example_t('bodies', 'poisson_ratio_1', '0.3', .true.), &
      example_t('bodies', 'poisson_ratio_2', '0.3', .true.), &
      example_t('bodies', 'reduced_modulus', '226.4e9', .false.), &
      example_t('bodies', 'speed_1', '0.1', .true.), &
      example_t('bodies', 'speed_2', '1.1', .true.), &
      example_t('bodies', 'plane', '.true.', .false.), &
      example_t('bodies', 'entrainment_speed', '0.6', .false.), &
      example_t('bodies', 'slide_to_roll', '1.666667', .false.), &
      example_t('bodies', 'hardness', '7e9', .false.), &
      example_t('bodies', 'contact_length', '0.02', .false.), &
      example_t('load', 'load_per_length', '1e5', .true.), &
      example_t('load', 'hertz_pressure', '0.6e9', .false.), &
      example_t('moes', 'moes_m', '20', .false.), &
      example_t('moes', 'moes_l', '10', .false.), &
      example_t('moes', 'velocity', "'sum'", .false.), &
      example_t('lubricant', 'viscosity', '0.14', .true.), &
      example_t('lubricant', 'pressure_viscosity', '2.3345e-8', .false.), &
      example_t('lubricant', 'roelands_z', '0.6', .true.), &
      example_t('lubricant', 'roelands_p0', '1.98e8', .true.), &
      example_t('lubricant', 'rheology', "'eyring'", .true.), &
      example_t('lubricant', 'eyring_stress', '3.3e6', .true.), &
      example_t('surface_1', 'amplitude', '2e-7, -1e-7', .false.), &
      example_t('surface_1', 'wavelength', '1e-4, 5e-5', .false.), &
      example_t('surface_1', 'position', '-2.5, -3.0', .false.), &
      example_t('surface_1', 'file', "'profile.csv'", .false.), &
      example_t('surface_1', 'dataset', "'z'", .false.), &
      example_t('surface_1', 'positions', "'x'", .false.), &
      example_t('surface_1', 'x_unit', "'mm'", .false.), &
      example_t('surface_1', 'z_unit', "'um'", .false.), &
      example_t('surface_1', 'detrend', "'line'", .false.), &
      example_t('surface_1', 'cutoff_long', '0.8e-3', .false.), &
      example_t('surface_1', 'cutoff_short', '2.5e-6', .false.), &
      example_t('surface_1', 'harmonics', '50', .false.), &
      example_t('surface_1', 'seed', '1', .false.), &
      example_t('surface_1', 'hurst', '0.8', .false.), &
      example_t('surface_1', 'rms_height', '50e-9', .false.), &
      example_t('surface_1', 'wavelength_long', '4e-4', .false.), &
      example_t('surface_1', 'wavelength_rolloff', '1e-4', .false.), &
      example_t('surface_1', 'wavelength_short', '2.5e-5', .false.), &
      example_t('surface_1', 'skewness', '0.0', .false.), &
      example_t('surface_1', 'kurtosis', '3.0', .false.), &
      example_t('surface_1', 'entry_length', '1.0', .false.), &
      example_t('domain', 'x_inlet', '-4.0', .false.), &
      example_t('domain', 'x_outlet', '1.5', .false.), &
      example_t('domain', 'intervals', '1024', .false.), &
      example_t('time', 'end_time', '2.181818', .false.), &
      example_t('time', 'time_step', '2.7e-3', .false.), &
      example_t('time', 'scheme', "'bdf2'", .false.), &
      example_t('time', 'statistics_from', '0.0', .false.), &
      example_t('solver', 'tolerance', '1e-8', .false.), &
      example_t('solver', 'max_cycles', '100', .false.), &
      example_t('solver', 'levels', '5', .false.), &
      example_t('solver', 'pre_sweeps', '2', .false.), &
      example_t('solver', 'post_sweeps', '2', .false.), &
      example_t('solver', 'coarse_sweeps', '100', .false.), &
      example_t('solver', 'relaxation', '0.8', .false.), &
      example_t('solver', 'load_relaxation', '0.5', .false.), &
      example_t('film', 'layers', '20', .false.), &
      example_t('film', 'inertia', '.false.', .false.), &
      example_t('output', 'profile_stride', '1', .false.), &
      example_t('output', 'fields', "'pressure', 'film_thickness'", .false.), &
      example_t('output', 'checkpoint_interval', '600.0', .false.), &
      example_t('output', 'film_thresholds', '50e-9, 100e-9', .false.), &
      example_t('solver', 'film_floor', '5e-9', .false.), &
      example_t('solver', 'on_film_breakdown', "'stop'", .false.), &
      example_t('accuracy', 'target', '1e-3', .false.), &
      example_t('accuracy', 'target_p_max', '0.01', .false.)]

   !> A synthetic rough surface, elastic-perfectly plastic, against a rigid plane, under three
   !> loads. The keys of &surface_2 are shown like those of &surface_1, all as comments.
   type(example_t), parameter :: dry_examples(*) = [ &
      example_t('case', 'title', "'Rough surface against a rigid plane'", .true.), &
      example_t('case', 'problem', "'dry_line'", .true.), &
      example_t('case', 'output', "'rough.h5'", .false.), &
      example_t('bodies', 'radius_1', '0.01', .false.), &
      example_t('bodies', 'radius_2', '2.0', .false.), &
      example_t('bodies', 'plane', '.true.', .false.), &
      example_t('bodies', 'reduced_radius', '9.950e-3', .false.), &
      example_t('bodies', 'youngs_modulus_1', '210e9', .true.), &
      example_t('bodies', 'poisson_ratio_1', '0.3', .true.), &
      example_t('bodies', 'youngs_modulus_2', '210e9', .false.), &
      example_t('bodies', 'poisson_ratio_2', '0.3', .false.), &
      example_t('bodies', 'reduced_modulus', '230.8e9', .false.), &
      example_t('bodies', 'hardness', '4e9', .true.), &
      example_t('load', 'mean_pressure', '50e6, 100e6, 250e6', .true.), &
      example_t('load', 'load_per_length', '100e3', .false.), &
      example_t('load', 'load', '10.0', .false.), &
      example_t('load', 'hertz_pressure', '1e9', .false.), &
      example_t('load', 'separation', '1e-6', .false.), &
      example_t('surface_1', 'shape', "'synthetic'", .true.), &
      example_t('surface_1', 'amplitude', '1e-6', .false.), &
      example_t('surface_1', 'wavelength', '1e-4', .false.), &
      example_t('surface_1', 'position', '0.0', .false.), &
      example_t('surface_1', 'file', "'profile.csv'", .false.), &
      example_t('surface_1', 'dataset', "'z'", .false.), &
      example_t('surface_1', 'positions', "'x'", .false.), &
      example_t('surface_1', 'x_unit', "'mm'", .false.), &
      example_t('surface_1', 'z_unit', "'um'", .false.), &
      example_t('surface_1', 'detrend', "'line'", .false.), &
      example_t('surface_1', 'cutoff_long', '0.8e-3', .false.), &
      example_t('surface_1', 'cutoff_short', '2.5e-6', .false.), &
      example_t('surface_1', 'harmonics', '50', .false.), &
      example_t('surface_1', 'rms_height', '1e-6', .true.), &
      example_t('surface_1', 'wavelength_long', '4e-4', .false.), &
      example_t('surface_1', 'wavelength_rolloff', '1e-4', .true.), &
      example_t('surface_1', 'wavelength_short', '1.25e-5', .true.), &
      example_t('domain', 'length', '4e-4', .true.), &
      example_t('domain', 'intervals', '512', .true.), &
      example_t('domain', 'periodic', '.true.', .true.), &
      example_t('domain', 'length_x', '4e-4', .true.), &
      example_t('domain', 'length_y', '4e-4', .true.), &
      example_t('domain', 'intervals_x', '256', .true.), &
      example_t('domain', 'intervals_y', '256', .true.), &
      example_t('output', 'fields', "'pressure', 'gap'", .false.), &
      example_t('accuracy', 'target', '0.02', .false.)]

   character(*), parameter :: nl = new_line('a')
   !> Column of the units.
   integer, parameter :: unit_column = 44

contains

   !> The template of a `problem`.
   pure function template_text(problem) result(template)
      character(*), intent(in) :: problem
      character(:), allocatable :: template
      integer :: i

      template = '! A lubricated line contact (chapter 5, Case 1)'
      if (problem /= lubricated) template = '! A dry rough contact'
      template = template // '; asperity --keys shows the ranges too. Lines with ! in' // nl &
         // '! the first column hold keys that are optional here or replace others. The order '// &
            'of all is free.' // nl
      do i = 1, size(group_rows)
         if (.not. has_word(group_rows(i)%problems, problem)) cycle
         template = template // nl // group_text(problem, trim(group_rows(i)%group), &
            trim(group_rows(i)%meaning))
      end do
   end function template_text

   !> One group; commented out altogether if no key of it is active.
   pure function group_text(problem, group, meaning) result(text)
      character(*), intent(in) :: problem, group, meaning
      character(:), allocatable :: text
      character(:), allocatable :: lines, mark
      type(example_t) :: example
      logical :: is_active
      integer :: i

      lines = ''
      is_active = .false.
      do i = 1, size(key_rows)
         if (key_rows(i)%group /= group .or. .not. has_word(key_rows(i)%problems, problem)) cycle
         example = example_of(key_rows(i), problem)
         is_active = is_active .or. example%is_active
         lines = lines // key_text(key_rows(i), example)
      end do
      mark = '! '
      if (is_active) mark = ''
      text = '! ' // meaning // nl // mark // '&' // group // nl // lines // mark // '/' // nl
   end function group_text

   !> The example of a key; of &surface_2 as in &surface_1, in a dry case as a comment.
   pure function example_of(row, problem) result(example)
      type(key_row_t), intent(in) :: row
      character(*), intent(in) :: problem
      type(example_t) :: example
      character(len=len(row%group)) :: group

      group = row%group
      if (group == 'surface_2') group = 'surface_1'
      if (problem == lubricated) then
         example = example_in(examples, group, row)
      else
         example = example_in(dry_examples, group, row)
         if (row%group == 'surface_2') example%is_active = .false.
         if (row%key == 'problem') example%value = "'"//problem//"'"
      end if
   end function example_of

   !> The example of `group` and the key of `row` in `list`; the default where none is listed.
   pure function example_in(list, group, row) result(example)
      type(example_t), intent(in) :: list(:)
      character(*), intent(in) :: group
      type(key_row_t), intent(in) :: row
      type(example_t) :: example
      integer :: i

      do i = 1, size(list)
         example = list(i)
         if (example%group == group .and. example%key == row%key) return
      end do
      example = example_t(row%group, row%key, row%default, .true.)
   end function example_in

   !> Two lines: the meaning; key, value, unit, default, words.
   pure function key_text(row, example) result(text)
      type(key_row_t), intent(in) :: row
      type(example_t), intent(in) :: example
      character(:), allocatable :: text
      character(:), allocatable :: line, note

      line = '   '
      if (.not. example%is_active) line = '!  '
      line = line // trim(row%key) // ' = ' // trim(example%value)
      note = ''
      if (row%unit /= '') note = ' [' // trim(row%unit) // ']'
      if (row%default == is_chosen) then
         note = note // ' default: chosen by the program'
      else if (row%default /= is_required .and. row%default /= is_optional) then
         note = note // ' default ' // trim(row%default)
         if (index(trim(row%words), ' ') > 0) note = note // ','
      end if
      if (index(trim(row%words), ' ') > 0) note = note // merge(' any of ', ' one of ', row%kind &
         == words_kind) // word_list(row%words)
      if (note /= '') line = line // repeat(' ', max(0, unit_column - len(line))) // ' !' // note
      text = '   ! ' // trim(row%meaning) // rules_text(row) // nl // line // nl
   end function key_text

end module input_template
