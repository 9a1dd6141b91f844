!> The surfaces of the lubricated line contact: from their keys to features, and to measured or
!> synthetic heights that enter the contact.
module line_profiles
   use case_record, only: case_t, list_trend, path_from_namelist, set_effective
   use file_bytes, only: checksum_t
   use errors, only: error_t
   use features, only: rough_surface_t
   use file_heights, only: cutoffs, hold_heights, level_surface, read_surface, units_hint
   use height_form, only: form_t, rms_height, trend_t
   use measured_heights, only: heights_t
   use input_values, only: features_of, input_values_t, read_synthesis
   use kinds, only: int64, wp
   use moes, only: central_film, l_sum_per_mean, m_mean_per_sum
   use profile, only: profile_length, profile_t
   use surface_scaling, only: scaled_surface
   use synthetic_surface, only: new_synthetic_pieces, synthesis_t, synthetic_heights, &
      synthetic_pieces_t, truncate_harmonics
   use text, only: add_sentence, to_text
   implicit none (type, external)
   private

   public :: make_surface, place_surface

   !> Nodes of a synthetic profile in its shortest wave.
   integer, parameter :: nodes_per_wave = 16
   !> Domain where it is left open [half-widths], for the length of a synthetic profile.
   real(wp), parameter :: usual_domain = 30.0_wp
   !> Smooth entry of a profile where it is not given [half-widths].
   real(wp), parameter :: usual_entry = 1.0_wp
   !> A profile of at most this many nodes is made at once, a longer one from pieces of at least 32
   !> of the longest waves, which are at most `max_waves` times as long as the shortest.
   integer, parameter :: max_nodes = 2**20, max_waves = max_nodes/(32*nodes_per_wave)
   !> Rms height over the expected film from which a note is given, and above which it is refused.
   real(wp), parameter :: many_films = 10.0_wp, most_films = 1000.0_wp
   !> Most nodes of a synthetic area.
   real(wp), parameter :: max_area = 2.0_wp**22
   !> Nodes of half a piece, at least.
   integer, parameter :: least_half = 32768

contains

   !> The scaled `surface` that a `group` gives: features, entry, profile; smooth with &moes.
   !> Findings: the file; the synthesis.
   subroutine make_surface(values, group, case, surface)
      type(input_values_t), intent(inout) :: values
      character(*), intent(in) :: group
      type(case_t), intent(inout) :: case
      type(rough_surface_t), intent(out) :: surface
      character(:), allocatable :: shape
      logical :: is_profile

      surface%features = features_of(values, group)
      surface%speed = merge(case%bodies%speed_1, case%bodies%speed_2, group == 'surface_1')
      shape = trim(values%word_value(group, 'shape'))
      is_profile = shape == 'file' .or. shape == 'synthetic'
      if (case%time%is_transient) then
         surface%entry_length = values%real_value(group, 'entry_length', &
            merge(usual_entry, 0.0_wp, is_profile))
         if (shape /= 'smooth') call set_effective(case, group, 'entry_length', &
            [surface%entry_length])
      end if
      if (is_profile) then
         allocate (surface%profile)
         if (allocated(case%point)) then
            call fill_area(values, group, case, surface%profile)
         else if (shape == 'file') then
            call fill_from_file(values, group, case, surface%profile)
         else
            call fill_synthetic(values, group, case, surface%speed, surface%profile)
         end if
         surface%profile%end_length = max(surface%entry_length, usual_entry)
         surface%profile%is_placed = values%is_given(group, 'position')
         surface%profile%start = values%real_value(group, 'position', surface%profile%start)
      end if
      if (case%scaling%is_dimensional) then
         surface = scaled_surface(surface, case%scaling)
      else
         surface%speed = 1.0_wp
      end if
   end subroutine make_surface

   !> Heights of the file, read as they are needed; with harmonics the truncated Fourier series of
   !> the periodic profile, held in memory. Findings: too many nodes, harmonics.
   subroutine fill_from_file(values, group, case, profile)
      type(input_values_t), intent(inout) :: values
      character(*), intent(in) :: group
      type(case_t), intent(inout) :: case
      type(profile_t), intent(inout) :: profile
      type(heights_t) :: heights
      type(error_t), allocatable :: error
      character(:), allocatable :: fault
      integer :: harmonics

      call read_surface(values, group, path_from_namelist(case, ''), heights, profile%source)
      if (.not. allocated(profile%source)) return
      profile%spacing = heights%spacing(1)
      call take_heights(values, group, case, heights, profile)
      call set_effective(case, group, 'heights_spacing', [profile%spacing])
      if (allocated(heights%z)) call move_alloc(heights%z, profile%heights)
      if (.not. values%is_given(group, 'harmonics') .or. values%findings%count > 0) return
      harmonics = values%integer_value(group, 'harmonics')
      call hold_heights(profile%source, profile%form, profile%heights, ': a series', fault)
      if (fault == '') then
         call truncate_harmonics(harmonics, [size(profile%heights), 1], profile%heights, error)
         if (allocated(error)) fault = error%message
      end if
      if (fault /= '') call values%refuse(group, 'harmonics', fault)
      profile%is_periodic = .true.
      if (allocated(profile%heights)) profile%finest_wave = size(profile%heights) &
         *profile%spacing/harmonics
   end subroutine fill_from_file

   !> Heights of an area: of the file, or with a wanted spectrum as long and wide as the usual
   !> domain, or as its longest waves, which repeat. Findings: the file; the synthesis.
   subroutine fill_area(values, group, case, area)
      type(input_values_t), intent(inout) :: values
      character(*), intent(in) :: group
      type(case_t), intent(inout) :: case
      type(profile_t), intent(inout) :: area
      type(heights_t) :: heights
      type(synthesis_t) :: wanted
      type(checksum_t) :: sums
      type(error_t), allocatable :: error
      real(wp) :: lengths(2), shortest

      if (values%word_value(group, 'shape') == 'file') then
         call read_surface(values, group, path_from_namelist(case, ''), heights)
         if (.not. allocated(heights%z)) return
         call take_heights(values, group, case, heights, area)
         if (values%findings%count > 0) return
      else
         shortest = values%real_value(group, 'wavelength_short')
         associate (domain => case%point%domain)
            lengths = case%scaling%half_width*[domain%x_outlet - domain%x_inlet, &
               2*domain%y_half_width]
         end associate
         lengths = max(lengths, values%real_value(group, 'wavelength_long'), 4*shortest)
         call read_synthesis(values, group, minval(lengths), shortest, wanted)
         if (product(lengths/shortest*nodes_per_wave) > max_area) call values%refuse(group, &
            'wavelength_short', 'found '//to_text(shortest)//' m, expected at least '// &
            to_text(nodes_per_wave*sqrt(product(lengths)/max_area), 3)//' m for an area of '// &
            to_text(lengths(1), 3)//' m times '//to_text(lengths(2), 3)//' m')
         if (values%findings%count > 0) return
         area%is_periodic = .true.
         area%finest_wave = shortest
         heights%grid = 2*ceiling(0.5_wp*lengths*nodes_per_wave/shortest)
         heights%spacing = lengths/heights%grid
         call synthetic_heights(wanted, heights%grid, lengths(1), lengths(2), heights%z, error)
         if (allocated(error)) then
            call values%refuse(group, 'shape', error%message)
            return
         end if
         call sums%add(heights%z)
         call set_effective(case, group, 'heights_checksum', text=sums%digits())
      end if
      area%spacing = heights%spacing(1)
      area%row_spacing = heights%spacing(2)
      area%first_row = -0.5_wp*(heights%grid(2) - 1)*heights%spacing(2)
      area%rows = reshape(heights%z, heights%grid)
      area%heights = area%rows(:, (heights%grid(2) + 1)/2)
   end subroutine fill_area

   !> Levels the `heights` of a file, those to come from the source of the `profile` too, and lists
   !> what they are; sets their finest wave. Findings: no spacing; heights far above any film. A
   !> note: above the film that is expected.
   subroutine take_heights(values, group, case, heights, profile)
      type(input_values_t), intent(inout) :: values
      character(*), intent(in) :: group
      type(case_t), intent(inout) :: case
      type(heights_t), intent(inout) :: heights
      type(profile_t), intent(inout) :: profile
      type(trend_t) :: trend
      type(form_t) :: form
      character(:), allocatable :: words
      real(wp) :: film, height

      if (any(heights%spacing <= 0.0_wp .and. heights%sums%grid > 1)) then
         call values%refuse(group, 'file', 'found no spacing in '//heights%file//', expected '// &
            'the attribute '//merge('spacing_y', 'spacing_x', heights%spacing(1) > 0.0_wp)// &
            ' or spacing [m] of the dataset')
         return
      end if
      call level_surface(values, group, values%is_given(group, 'harmonics'), heights, trend, &
         case%note, profile%source)
      profile%form = trend%form
      call list_trend(case, group, trend)
      call set_effective(case, group, 'heights_checksum', text=heights%digits)
      profile%finest_wave = max(2*maxval(heights%spacing), 0.5_wp*values%real_value(group, &
         'cutoff_short'))
      associate (scales => case%scaling)
         film = scales%film*central_film(scales%moes_m/m_mean_per_sum, &
            scales%moes_l*l_sum_per_mean)
         if (allocated(case%point)) film = scales%film*case%point%expected_film
      end associate
      form = trend%form
      if (any(values%is_given(group, cutoffs))) form%terms = 0.0_wp   ! the sums lack it already
      height = rms_height(heights%sums, form)
      words = to_text(height, 3)//' m, '//to_text(height/film, 2)// &
         ' times the film that is expected, '//to_text(film, 3)//' m'
      if (height > most_films*film) then
         call values%refuse(group, 'file', heights%file//': found heights with an rms of '// &
            words//', expected less than '//to_text(nint(most_films))//' times'//units_hint)
      else if (height > many_films*film) then
         call add_sentence(case%note, 'the rms height of '//group//' is '//words//units_hint)
      end if
   end subroutine take_heights

   !> Heights with a wanted spectrum, as long as the passage at `speed` [m/s]; then they repeat.
   !> They are made at once, or from pieces if that needs more than `max_nodes`. Findings: those of
   !> the synthesis.
   subroutine fill_synthetic(values, group, case, speed, profile)
      type(input_values_t), intent(inout) :: values
      character(*), intent(in) :: group
      type(case_t), intent(inout) :: case
      real(wp), intent(in) :: speed
      type(profile_t), intent(inout) :: profile
      type(synthesis_t) :: wanted
      type(synthetic_pieces_t), allocatable :: pieces
      type(error_t), allocatable :: error
      type(checksum_t) :: sums
      real(wp) :: length, longest, shortest
      integer :: before, half, nodes
      logical :: is_long

      shortest = values%real_value(group, 'wavelength_short')
      length = usual_domain
      if (case%domain%has_inlet .and. case%domain%has_outlet) length = case%domain%x_outlet &
         - case%domain%x_inlet
      if (case%time%is_transient) length = length + 2.0_wp*abs(speed)/case%scaling%speed_sum &
         *case%time%end_time
      length = max(length*case%scaling%half_width, values%real_value(group, 'wavelength_long'), &
         4.0_wp*shortest)
      is_long = length*nodes_per_wave > max_nodes*shortest
      longest = merge(max_waves*shortest, length, is_long)
      before = values%findings%count
      call read_synthesis(values, group, longest, shortest, wanted)
      if (wanted%wavelength_long > longest) call values%refuse(group, 'wavelength_long', &
         'found '//to_text(wanted%wavelength_long)//' m, expected at most '//to_text(max_waves) &
         //' times wavelength_short in a profile of '//to_text(length, 3) &
         //' m, which is too long to be made at once')
      if (values%findings%count > before) return
      call set_effective(case, group, 'wavelength_long', [wanted%wavelength_long])
      call set_effective(case, group, 'wavelength_rolloff', [wanted%wavelength_rolloff])
      profile%is_periodic = .true.
      profile%finest_wave = wanted%wavelength_short
      if (is_long) then
         profile%spacing = wanted%wavelength_short/nodes_per_wave
         half = least_half
         do while (half < max_nodes/(2*max_waves)*(wanted%wavelength_long/wanted%wavelength_short))
            half = 2*half
         end do
         profile%window = half
         allocate (pieces)
         call new_synthetic_pieces(pieces, wanted, profile%spacing, half, &
            ceiling(length/(half*profile%spacing), int64), error)
         if (.not. allocated(error)) call move_alloc(pieces, profile%source)
      else
         nodes = 2*ceiling(0.5_wp*length*nodes_per_wave/wanted%wavelength_short)
         profile%spacing = length/nodes
         call synthetic_heights(wanted, [nodes, 1], length, tiny(1.0_wp), profile%heights, error)
         if (.not. allocated(error)) then
            call sums%add(profile%heights)
            call set_effective(case, group, 'heights_checksum', text=sums%digits())
         end if
      end if
      if (allocated(error)) call values%refuse(group, 'shape', error%message)
   end subroutine fill_synthetic

   !> Places a scaled surface at time 0 (lengths in half-widths): a given position is its centre;
   !> else a moving profile is about to enter the domain, one at rest has its centre at X = 0.
   pure subroutine place_surface(surface, x_inlet, x_outlet)
      type(rough_surface_t), intent(inout) :: surface
      real(wp), intent(in) :: x_inlet, x_outlet
      real(wp) :: length

      surface%entry_position = merge(x_inlet, x_outlet, surface%speed >= 0.0_wp)
      if (.not. allocated(surface%profile)) return
      length = profile_length(surface%profile)
      if (surface%profile%is_placed) then
         surface%profile%start = surface%profile%start - 0.5_wp*length
      else if (surface%speed > 0.0_wp) then
         surface%profile%start = x_inlet - length
      else if (surface%speed < 0.0_wp) then
         surface%profile%start = x_outlet
      else
         surface%profile%start = -0.5_wp*length
      end if
   end subroutine place_surface

end module line_profiles
