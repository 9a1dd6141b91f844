!> One case as the user describes it, in SI, the name of its result file, and the list of all values
!> that it uses, given, default or derived.
module case_record
   use dry_case, only: dry_case_t
   use duty, only: duty_rows_t
   use features, only: rough_surface_t
   use height_form, only: curvature_of, tilt_of, trend_t
   use hertz, only: bodies_t
   use input_keys, only: key_rows
   use input_values, only: has_shape, input_values_t, read_synthesis, surfaces
   use key_row, only: has_word, lubricated
   use key_rules, only: is_used, unusual_t
   use kinds, only: wp
   use line_contact, only: domain_t, line_contact_t, rough_contact_t, solver_settings_t, &
      time_settings_t, word_length
   use lubricant, only: density_constant, lubricant_t, viscosity_constant, viscosity_roelands
   use passage_times, only: passage_times_t
   use point_contact, only: point_contact_t
   use profile, only: profile_length
   use scaling, only: scaling_t
   use summary_row, only: table_place_t
   use synthetic_surface, only: synthesis_t
   use text, only: joined, to_text
   use validity, only: materials_t
   implicit none (type, external)
   private

   public :: case_identity, case_t, effective_t, effective_text, list_dry, list_effective, &
      list_passage, list_trend, output_settings_t, path_from_namelist, result_path, set_effective

   !> A value that is used, given or default, for /input/effective/<group>/<key> of the result: as
   !> numbers, an integer or a text, the one that is allocated.
   type :: effective_t
      character(len=12) :: group
      character(len=24) :: key
      real(wp), allocatable :: reals(:)
      integer, allocatable :: integer
      character(:), allocatable :: text
   end type effective_t

   !> What is stored of a transient.
   type :: output_settings_t
      !> Every how many time steps profiles are stored [-].
      integer :: profile_stride
      !> Stored profiles: 'pressure', 'film_thickness'.
      character(len=word_length), allocatable :: fields(:)
      !> Wall time between checkpoints [s].
      real(wp) :: checkpoint_interval
      !> Films for the statistics [m]; none: no statistics.
      real(wp), allocatable :: film_thresholds(:)
      !> What each ingredient of the model changes is measured: '.true.', '.false.' or 'full'.
      character(len=word_length) :: adequacy
      !> Fields and series are stored in SI too.
      logical :: has_si
      !> Layers of the velocity across the film; 0: it is not stored.
      integer :: velocity_layers
   end type output_settings_t

   !> What only a lubricated case has.
   type :: line_case_t
      !> With Moes' numbers bodies, load and mu_0 are unknown (zero).
      type(bodies_t) :: bodies
      type(lubricant_t) :: lubricant
      !> What only the limits of the model need.
      type(materials_t) :: materials
      !> What changes in time; bodies, load and scales are then those of the reference state.
      type(duty_rows_t), allocatable :: duty
      !> The scales that follow from these.
      type(scaling_t) :: scaling
      !> As it is given.
      type(domain_t) :: domain
      !> As it is solved; domain, grid and, in `time`, time step are complete.
      type(line_contact_t) :: contact
      type(time_settings_t) :: time
      type(solver_settings_t) :: solver
      !> Layers across the film of the full momentum equations (0: none), with the oil's inertia.
      integer :: layers = 0
      logical :: has_inertia = .false.
   end type line_case_t

   !> One case. Made by `read_case` of module case_input.
   type, extends(line_case_t) :: case_t
      !> Free text of the user, UTF-8.
      character(:), allocatable :: title
      !> 'ehl_line', 'ehl_point', 'dry_line' or 'dry_area'.
      character(len=word_length) :: problem = ''
      !> 'full' or 'auto'.
      character(len=word_length) :: model
      !> NAME.xdmf is written next to the result.
      logical :: has_xdmf = .false.
      !> Result file as given, empty if not; see `result_path`.
      character(:), allocatable :: output
      !> Name of the namelist file.
      character(:), allocatable :: file
      !> Its text, byte for byte.
      character(:), allocatable :: namelist
      type(output_settings_t) :: output_settings
      !> Filled for dry problems.
      type(dry_case_t) :: dry
      !> Of a lubricated point contact; its bodies, oil and scales stand where those of a line do.
      type(point_contact_t), allocatable :: point
      !> Values outside the typical ranges of their keys.
      type(unusual_t), allocatable :: unusual(:)
      !> What the reader of the result should know about the input.
      character(:), allocatable :: note
      !> Where it gets a row in place of a result file; not allocated: nowhere.
      type(table_place_t), allocatable :: table
      !> Every value used, given or default or derived.
      type(effective_t), allocatable :: effective(:)
   end type case_t

contains

   !> File of the result: `output` of the case, relative to the namelist, else the namelist's stem +
   !> .h5 in the current folder. A folder `output_dir` (empty: none) replaces the folder of either.
   pure function result_path(case, output_dir) result(path)
      type(case_t), intent(in) :: case
      character(*), intent(in) :: output_dir
      character(:), allocatable :: path
      integer :: point

      if (len(case%output) > 0) then
         path = case%output
         if (output_dir == '') path = path_from_namelist(case, path)
      else
         path = case%file(index(case%file, '/', back=.true.) + 1:)
         point = index(path, '.', back=.true.)
         if (point > 1) path = path(:point - 1)
         path = path // '.h5'
      end if
      if (output_dir /= '') path = output_dir // '/' // path(index(path, '/', back=.true.) + 1:)
   end function result_path

   !> A path that a namelist gives, relative to the folder of the namelist.
   pure function path_from_namelist(case, name) result(path)
      type(case_t), intent(in) :: case
      character(*), intent(in) :: name
      character(:), allocatable :: path

      path = name
      if (index(path, '/') /= 1) path = case%file(:index(case%file, '/', back=.true.)) // path
   end function path_from_namelist

   !> The values that decide about the result, one a line, before the program chooses anything.
   pure function case_identity(case) result(lines)
      type(case_t), intent(in) :: case
      character(:), allocatable :: lines
      integer :: i

      lines = '&case problem = '//trim(case%problem)
      do i = 1, size(case%effective)
         associate (entry => case%effective(i))
            if (entry%group == 'case' .or. any(entry%key == [character(len=19) :: &
               'checkpoint_interval', 'adequacy', 'si_copies', 'xdmf'])) cycle
            ! in brackets: each `//` copies what stands in front of it
            lines = lines//(new_line('a')//'&'//trim(entry%group)//' '//trim(entry%key) &
               //' = '//effective_text(entry))
         end associate
      end do
   end function case_identity

   !> A value as text; real numbers with all their digits, several separated by commas.
   pure function effective_text(entry) result(text)
      type(effective_t), intent(in) :: entry
      character(:), allocatable :: text
      integer, parameter :: all_digits = 17
      integer :: i

      if (allocated(entry%text)) then
         text = entry%text
      else if (allocated(entry%integer)) then
         text = to_text(entry%integer)
      else
         text = to_text(entry%reals(1), all_digits)
         do i = 2, size(entry%reals)
            text = text//', '//to_text(entry%reals(i), all_digits)
         end do
      end if
   end function effective_text

   !> Sets or adds an effective value: `reals` (at least one), `integer` or `text`.
   pure subroutine set_effective(case, group, key, reals, integer, text)
      type(case_t), intent(inout) :: case
      character(*), intent(in) :: group, key
      real(wp), intent(in), optional :: reals(:)
      integer, intent(in), optional :: integer
      character(*), intent(in), optional :: text
      type(effective_t) :: new
      integer :: place

      if (.not. allocated(case%effective)) allocate (case%effective(0))
      new%group = group   ! of equal lengths they are compared without a call
      new%key = key
      if (present(reals)) new%reals = reals
      if (present(integer)) new%integer = integer
      if (present(text)) new%text = text
      do place = 1, size(case%effective)
         if (case%effective(place)%key == new%key .and. case%effective(place)%group &
            == new%group) exit
      end do
      if (place > size(case%effective)) then
         case%effective = [case%effective, new]
      else
         case%effective(place) = new
      end if
   end subroutine set_effective

   !> Fills `case%effective` in the order of the key table; what the program chooses later says so.
   !> For a line, what follows from the given values: bodies, load, parameters of Roelands' law.
   subroutine list_effective(values, case)
      type(input_values_t), intent(in) :: values
      type(case_t), intent(inout) :: case
      type(effective_t) :: entries(size(key_rows))
      integer :: i, n

      n = 0
      do i = 1, size(key_rows)
         associate (row => key_rows(i), slot => values%slots(i))
            if (.not. slot%has_value .and. any([row%default /= 'chosen', &
               row%key == 'output'])) cycle
            if (.not. has_word(row%problems, values%problem)) cycle
            if (.not. is_used(values, row)) cycle
            n = n + 1
            entries(n)%group = row%group
            entries(n)%key = row%key
            if (.not. slot%has_value) then
               entries(n)%text = 'chosen by the program'
            else if (row%kind == 'integer') then
               entries(n)%integer = nint(slot%reals(1))
            else if (row%unit /= '') then
               entries(n)%reals = slot%reals
            else if (row%kind == 'text') then
               entries(n)%text = slot%text
            else   ! words and logicals
               entries(n)%text = joined(slot%words, ', ')
            end if
         end associate
      end do
      case%effective = entries(:n)
      if (values%problem /= lubricated) return
      if (case%scaling%is_dimensional) then
         call set_effective(case, 'bodies', 'reduced_radius', [case%bodies%reduced_radius])
         call set_effective(case, 'bodies', 'reduced_modulus', [case%bodies%reduced_modulus])
         call set_effective(case, 'load', 'load_per_length', [case%scaling%load_per_length])
      end if
      associate (oil => case%lubricant)
         if (oil%viscosity_law == viscosity_constant) call set_effective(case, 'lubricant', &
            'viscosity_law', text='constant')
         if (oil%density_law == density_constant) call set_effective(case, 'lubricant', &
            'density_law', text='constant')
         if (oil%pressure_viscosity > 0.0_wp) call set_effective(case, 'lubricant', &
            'pressure_viscosity', [oil%pressure_viscosity])
         if (oil%viscosity_law /= viscosity_roelands) return
         call set_effective(case, 'lubricant', 'roelands_p0', [oil%roelands_p0])
         call set_effective(case, 'lubricant', 'roelands_z', [oil%roelands_z])
      end associate
   end subroutine list_effective

   !> The times of a passage through a `contact`, line or point, and where its surfaces began.
   subroutine list_passage(case, contact, times)
      type(case_t), intent(inout) :: case
      class(rough_contact_t), intent(in) :: contact
      type(passage_times_t), intent(in) :: times

      if (case%time%is_transient) then
         call set_effective(case, 'time', 'end_time', [times%end_time])
         call set_effective(case, 'time', 'time_step', [case%time%time_step])
         call set_effective(case, 'time', 'statistics_from', [times%counts_from])
      end if
      call fill_positions(case, 'surface_1', contact%surface_1)
      call fill_positions(case, 'surface_2', contact%surface_2)
   end subroutine list_passage

   !> The centres of the features of a `surface`, or of a profile given without its place.
   subroutine fill_positions(case, group, surface)
      type(case_t), intent(inout) :: case
      character(*), intent(in) :: group
      type(rough_surface_t), intent(in) :: surface

      if (size(surface%features) > 0) call set_effective(case, group, 'position', &
         surface%features%position)
      if (.not. allocated(surface%profile)) return
      if (.not. surface%profile%is_placed) call set_effective(case, group, 'position', &
         [surface%profile%start + 0.5_wp*profile_length(surface%profile)])
   end subroutine fill_positions

   !> What follows from the given values of a dry case, or was chosen.
   subroutine list_dry(case)
      type(case_t), intent(inout) :: case
      type(synthesis_t) :: wanted
      integer :: i

      associate (dry => case%dry)
         call set_effective(case, 'bodies', 'reduced_modulus', [dry%reduced_modulus])
         call set_effective(case, 'domain', 'periodic', text=trim(merge('.true. ', &
            '.false.', dry%is_periodic)))
         if (.not. dry%is_periodic) call set_effective(case, 'domain', 'kernel', text='element')
         if (dry%grid%ny == 1) then
            call set_effective(case, 'domain', 'length', [dry%lengths(1)])
            call set_effective(case, 'domain', 'intervals', integer=dry%grid%nx)
         else
            call set_effective(case, 'domain', 'length_x', [dry%lengths(1)])
            call set_effective(case, 'domain', 'length_y', [dry%lengths(2)])
            call set_effective(case, 'domain', 'intervals_x', integer=dry%grid%nx)
            call set_effective(case, 'domain', 'intervals_y', integer=dry%grid%ny)
         end if
         do i = 1, size(surfaces)
            call list_trend(case, surfaces(i), dry%files(i)%trend)
            if (.not. has_shape(dry%values, surfaces(i), 'synthetic')) cycle
            call read_synthesis(dry%values, surfaces(i), maxval(dry%lengths), &
               2.0_wp*dry%lengths(1)/dry%first_nodes(1), wanted)
            call set_effective(case, surfaces(i), 'wavelength_long', [wanted%wavelength_long])
            call set_effective(case, surfaces(i), 'wavelength_rolloff', [wanted%wavelength_rolloff])
            call set_effective(case, surfaces(i), 'wavelength_short', [wanted%wavelength_short])
         end do
      end associate
   end subroutine list_dry

   !> What was taken off the heights of the file of a surface, if it has one.
   subroutine list_trend(case, group, trend)
      type(case_t), intent(inout) :: case
      character(*), intent(in) :: group
      type(trend_t), intent(in) :: trend
      integer :: directions

      if (trend%word == '') return
      directions = merge(2, 1, trend%form%grid(2) > 1)
      call set_effective(case, group, 'detrend', text=trim(trend%word))
      if (trend%word == 'none') return
      call set_effective(case, group, 'heights_mean', trend%form%terms(:1))
      if (trend%word == 'mean') return
      associate (curvatures => curvature_of(trend), tilts => tilt_of(trend))
         call set_effective(case, group, 'heights_tilt', tilts(:directions))
         if (trend%word == 'line') return
         call set_effective(case, group, 'heights_curvature', curvatures(:directions))
      end associate
   end subroutine list_trend

end module case_record
