!> A surface of a lubricated contact: from its keys to features and measured or synthetic heights.
module film_surface
   use case_record, only: case_t, list_trend, set_effective
   use file_bytes, only: checksum_t
   use errors, only: error_t
   use features, only: rough_surface_t
   use file_heights, only: cutoffs, hold_heights, level_surface, units_hint
   use height_form, only: form_t, rms_height
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

   !> Nodes of synthetic heights in their shortest wave.
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
   !> `heights` are those of its file, if it has one. Findings: the file; the synthesis.
   subroutine make_surface(values, group, heights, case, surface)
      type(input_values_t), intent(inout) :: values
      character(*), intent(in) :: group
      type(heights_t), intent(inout) :: heights
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
         if (shape == 'synthetic') then
            call make_synthetic(values, group, case, surface%speed, heights, surface%profile)
         else if (allocated(heights%file)) then
            call take_file(values, group, case, heights, surface%profile)
         end if
         associate (profile => surface%profile, nx => heights%sums%grid(1), &
            ny => heights%sums%grid(2))
            profile%spacing = heights%spacing(1)
            profile%form = heights%trend%form
            call move_alloc(heights%source, profile%source)
            if (allocated(case%point) .and. allocated(heights%z)) then
               profile%row_spacing = heights%spacing(2)
               profile%first_row = -0.5_wp*(ny - 1)*heights%spacing(2)
               profile%rows = reshape(heights%z, [nx, ny])
               profile%heights = profile%rows(:, (ny + 1)/2)
               deallocate (heights%z)
            else
               call move_alloc(heights%z, profile%heights)
            end if
            profile%end_length = max(surface%entry_length, usual_entry)
            profile%is_placed = values%is_given(group, 'position')
            profile%start = values%real_value(group, 'position', profile%start)
         end associate
      end if
      if (case%scaling%is_dimensional) then
         surface = scaled_surface(surface, case%scaling)
      else
         surface%speed = 1.0_wp
      end if
   end subroutine make_surface

   !> Levels the `heights` of a file, those to come from their source too, and lists what they are;
   !> with harmonics a profile becomes its truncated Fourier series, held in memory. Findings: no
   !> spacing; too many nodes; harmonics; heights far above the expected film, else a note.
   subroutine take_file(values, group, case, heights, profile)
      type(input_values_t), intent(inout) :: values
      character(*), intent(in) :: group
      type(case_t), intent(inout) :: case
      type(heights_t), intent(inout) :: heights
      type(profile_t), intent(inout) :: profile
      type(error_t), allocatable :: error
      type(form_t) :: form
      character(:), allocatable :: fault, words
      real(wp) :: film, height
      integer :: harmonics
      logical :: is_series

      if (any(heights%spacing <= 0.0_wp .and. heights%sums%grid > 1)) then
         call values%refuse(group, 'file', 'found no spacing in '//heights%file//', expected '// &
            'the attribute '//merge('spacing_y', 'spacing_x', heights%spacing(1) > 0.0_wp)// &
            ' or spacing [m] of the dataset')
         return
      end if
      is_series = values%is_given(group, 'harmonics')
      call level_surface(values, group, is_series, heights, case%note)
      call list_trend(case, group, heights%trend)
      call set_effective(case, group, 'heights_checksum', text=heights%digits)
      profile%finest_wave = max(2*maxval(heights%spacing), 0.5_wp*values%real_value(group, &
         'cutoff_short'))
      associate (scales => case%scaling)
         film = scales%film*central_film(scales%moes_m/m_mean_per_sum, &
            scales%moes_l*l_sum_per_mean)
         if (allocated(case%point)) film = scales%film*case%point%expected_film
      end associate
      form = heights%trend%form
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
      if (allocated(case%point)) return
      call set_effective(case, group, 'heights_spacing', heights%spacing(:1))
      if (.not. is_series .or. values%findings%count > 0) return
      harmonics = values%integer_value(group, 'harmonics')
      call hold_heights(heights, ': a series', fault)
      if (fault == '') then
         call truncate_harmonics(harmonics, [size(heights%z), 1], heights%z, error)
         if (allocated(error)) fault = error%message
      end if
      if (fault /= '') call values%refuse(group, 'harmonics', fault)
      profile%is_periodic = .true.
      if (allocated(heights%z)) profile%finest_wave = size(heights%z)*heights%spacing(1)/harmonics
   end subroutine take_file

   !> Heights with a wanted spectrum, which repeat: as long as the passage at `speed` [m/s], an area
   !> as long and wide as the domain, or as the longest waves. A profile of more than `max_nodes` is
   !> made from pieces. Findings: those of the synthesis; too many nodes.
   subroutine make_synthetic(values, group, case, speed, heights, profile)
      type(input_values_t), intent(inout) :: values
      character(*), intent(in) :: group
      type(case_t), intent(inout) :: case
      real(wp), intent(in) :: speed
      type(heights_t), intent(inout) :: heights
      type(profile_t), intent(inout) :: profile
      type(synthesis_t) :: wanted
      type(error_t), allocatable :: error
      type(checksum_t) :: sums
      real(wp) :: lengths(2), longest, shortest
      integer :: before, directions
      logical :: is_long

      shortest = values%real_value(group, 'wavelength_short')
      directions = 1
      lengths = tiny(1.0_wp)
      if (allocated(case%point)) then
         directions = 2
         lengths = [case%point%domain%x_outlet - case%point%domain%x_inlet, &
            2*case%point%domain%y_half_width]
      else
         lengths(1) = usual_domain
         if (case%domain%has_inlet .and. case%domain%has_outlet) lengths(1) = &
            case%domain%x_outlet - case%domain%x_inlet
         if (case%time%is_transient) lengths(1) = lengths(1) + 2.0_wp*abs(speed) &
            /case%scaling%speed_sum*case%time%end_time
      end if
      lengths(:directions) = max(lengths(:directions)*case%scaling%half_width, &
         values%real_value(group, 'wavelength_long'), 4.0_wp*shortest)
      is_long = directions == 1 .and. lengths(1)*nodes_per_wave > max_nodes*shortest
      longest = merge(max_waves*shortest, minval(lengths(:directions)), is_long)
      before = values%findings%count
      call read_synthesis(values, group, longest, shortest, wanted)
      if (wanted%wavelength_long > longest) call values%refuse(group, 'wavelength_long', &
         'found '//to_text(wanted%wavelength_long)//' m, expected at most '//to_text(max_waves) &
         //' times wavelength_short in a profile of '//to_text(lengths(1), 3) &
         //' m, which is too long to be made at once')
      if (directions == 2 .and. product(lengths/shortest*nodes_per_wave) > max_area) call &
         values%refuse(group, 'wavelength_short', 'found '//to_text(shortest)// &
         ' m, expected at least '//to_text(nodes_per_wave*sqrt(product(lengths)/max_area), 3)// &
         ' m for an area of '//to_text(lengths(1), 3)//' m times '//to_text(lengths(2), 3)//' m')
      if (values%findings%count > before) return
      if (directions == 1) then
         call set_effective(case, group, 'wavelength_long', [wanted%wavelength_long])
         call set_effective(case, group, 'wavelength_rolloff', [wanted%wavelength_rolloff])
      end if
      profile%is_periodic = .true.
      profile%finest_wave = shortest
      if (is_long) then
         call make_pieces(wanted, lengths(1), heights, profile, error)
      else
         associate (grid => heights%sums%grid)
            grid = 1
            grid(:directions) = 2*ceiling(0.5_wp*lengths(:directions)*nodes_per_wave/shortest)
            heights%spacing = lengths/grid
            call synthetic_heights(wanted, int(grid), lengths(1), lengths(2), heights%z, error)
         end associate
         if (.not. allocated(error)) then
            call sums%add(heights%z)
            call set_effective(case, group, 'heights_checksum', text=sums%digits())
         end if
      end if
      if (allocated(error)) call values%refuse(group, 'shape', error%message)
   end subroutine make_synthetic

   !> The source of a synthetic profile of some `length` [m] that is made from pieces.
   subroutine make_pieces(wanted, length, heights, profile, error)
      type(synthesis_t), intent(in) :: wanted
      real(wp), intent(in) :: length
      type(heights_t), intent(inout) :: heights
      type(profile_t), intent(inout) :: profile
      type(error_t), allocatable, intent(out) :: error
      type(synthetic_pieces_t), allocatable :: pieces
      integer :: half

      heights%spacing = wanted%wavelength_short/nodes_per_wave
      half = least_half
      do while (half < max_nodes/(2*max_waves)*(wanted%wavelength_long/wanted%wavelength_short))
         half = 2*half
      end do
      profile%window = half
      allocate (pieces)
      call new_synthetic_pieces(pieces, wanted, heights%spacing(1), half, &
         ceiling(length/(half*heights%spacing(1)), int64), error)
      if (.not. allocated(error)) call move_alloc(pieces, heights%source)
   end subroutine make_pieces

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

end module film_surface
