!> Measured and synthetic profiles of the lubricated line contact: from the keys of a surface to
!> heights that enter the contact.
module line_profiles
   use, intrinsic :: iso_fortran_env, only: int64
   use case_record, only: beside_namelist, case_t, set_effective
   use checksum, only: checksum_t
   use errors, only: error_t
   use features, only: rough_surface_t
   use findings, only: findings_t
   use height_file, only: open_heights
   use input_values, only: input_values_t, value_t
   use kinds, only: wp
   use profile, only: profile_length, profile_t
   use scaling, only: new_scaling, scaling_t
   use synthesis_keys, only: read_synthesis
   use synthetic_pieces, only: new_synthetic_pieces, synthetic_pieces_t
   use synthetic_surface, only: synthesis_t, synthetic_heights, truncate_harmonics
   use text, only: to_text
   implicit none (type, external)
   private

   public :: add_profile, place_surface

   !> Nodes of a synthetic profile in its shortest wave.
   integer, parameter :: nodes_per_wave = 16
   !> Domain where it is left open [half-widths], for the length of a synthetic profile.
   real(wp), parameter :: usual_domain = 30.0_wp
   !> Smooth entry of a profile where it is not given [half-widths].
   real(wp), parameter :: usual_entry = 1.0_wp
   !> Nodes of a profile up to which it is made at once; behind that it is put together from pieces.
   !> Then a piece has at least 32 of the longest waves, which are at most `most_waves` times as
   !> long as the shortest.
   integer, parameter :: most_nodes = 2**20, most_waves = most_nodes/(32*nodes_per_wave)
   !> Nodes of half a piece, at least.
   integer, parameter :: least_half = 32768
   !> Nodes of a file up to which harmonics can be taken.
   integer(int64), parameter :: most_truncated = 4194304_int64

contains

   !> Gives `surface` of `case` its entry and, for shape 'file' or 'synthetic', its profile.
   !> Findings: the file; the synthesis.
   subroutine add_profile(values, group, case, surface, findings)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: group
      type(case_t), intent(inout) :: case
      type(rough_surface_t), intent(inout) :: surface
      type(findings_t), intent(inout) :: findings
      character(:), allocatable :: shape
      type(value_t) :: position
      logical :: is_profile

      shape = trim(values%word_value(group, 'shape'))
      if (case%time%is_transient) surface%entry_length = values%real_value(group, 'entry_length')
      is_profile = shape == 'file' .or. shape == 'synthetic'
      if (is_profile .and. case%time%is_transient .and. .not. values%is_given(group, &
         'entry_length')) surface%entry_length = usual_entry
      if (case%time%is_transient .and. shape /= 'smooth') call set_effective(case, group, &
         'entry_length', surface%entry_length)
      if (.not. is_profile) return
      allocate (surface%profile)
      if (shape == 'file') then
         call fill_from_file(values, group, case, surface%profile, findings)
      else
         call fill_synthetic(values, group, case, surface, findings)
      end if
      if (findings%count > 0) return
      surface%profile%end_length = max(surface%entry_length, usual_entry)
      position = values%slot(group, 'position')
      surface%profile%is_placed = position%is_given
      if (position%is_given) surface%profile%start = position%reals(1)
   end subroutine add_profile

   !> Heights of the file, which are read as they are needed; with harmonics they repeat themselves
   !> and are held.
   subroutine fill_from_file(values, group, case, profile, findings)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: group
      type(case_t), intent(inout) :: case
      type(profile_t), intent(inout) :: profile
      type(findings_t), intent(inout) :: findings
      type(value_t) :: name, dataset, harmonics
      type(error_t), allocatable :: error
      character(:), allocatable :: path
      character(len=16) :: digits
      integer(int64) :: most

      name = values%slot(group, 'file')
      dataset = values%slot(group, 'dataset')
      path = beside_namelist(case, trim(name%text))
      call open_heights(path, trim(dataset%text), profile%source, profile%spacing, digits, error)
      if (allocated(error)) then
         call findings%add(name%line, group, 'file', error%message)
         return
      end if
      if (.not. profile%spacing > 0.0_wp) call findings%add(name%line, group, 'file', &
         'found no spacing in '//path// &
         ', expected the attribute spacing_x or spacing [m] of the dataset')
      profile%finest_wave = 2.0_wp*profile%spacing
      call set_effective(case, group, 'heights_checksum', digits)
      call set_effective(case, group, 'heights_spacing', profile%spacing, 'm')
      harmonics = values%slot(group, 'harmonics')
      if (.not. harmonics%is_given .or. findings%count > 0) return
      most = min(profile%source%nodes/2 - 1, int(most_nodes, int64))
      if (profile%source%nodes > most_truncated) then
         call findings%add(harmonics%line, group, 'harmonics', 'found a profile of ' &
            //to_text(profile%source%nodes)// &
            ' nodes, expected at most '//to_text(most_truncated) &
               //': a series needs all of them at once')
      else if (harmonics%integer > most) then
         call findings%add(harmonics%line, group, 'harmonics', &
            'found '//to_text(harmonics%integer)//', expected at most '// &
            to_text(most)//', half the nodes less one')
      else
         call truncate_profile(harmonics%integer, profile, error)
         if (allocated(error)) call findings%add(harmonics%line, group, 'harmonics', error%message)
      end if
   end subroutine fill_from_file

   !> The truncated Fourier series of a whole profile, which is held from now on.
   subroutine truncate_profile(harmonics, profile, error)
      integer, intent(in) :: harmonics
      type(profile_t), intent(inout) :: profile
      type(error_t), allocatable, intent(out) :: error

      allocate (profile%heights(profile%source%nodes))
      call profile%source%get(0_int64, profile%heights, error)
      if (allocated(error)) return
      deallocate (profile%source)
      call truncate_harmonics(harmonics, [size(profile%heights), 1], profile%heights, &
         error)   ! error: the caller looks
      profile%is_periodic = .true.
      profile%finest_wave = size(profile%heights)*profile%spacing/harmonics
   end subroutine truncate_profile

   !> Heights with a wanted spectrum, long enough for the whole passage; they repeat themselves
   !> behind it.
   subroutine fill_synthetic(values, group, case, surface, findings)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: group
      type(case_t), intent(inout) :: case
      type(rough_surface_t), intent(inout) :: surface
      type(findings_t), intent(inout) :: findings
      type(synthesis_t) :: wanted
      real(wp) :: length, longest, shortest
      integer :: before

      shortest = values%real_value(group, 'wavelength_short')
      length = max(passage(case, surface%speed), values%real_value(group, 'wavelength_long'), &
         4.0_wp*shortest)
      longest = length
      if (length*nodes_per_wave > most_nodes*shortest) longest = most_waves*shortest
      before = findings%count
      call read_synthesis(values, group, longest, shortest, wanted, findings)
      if (wanted%wavelength_long > longest) then
         call findings%add(values%line_of(group, 'wavelength_long'), group, 'wavelength_long', &
            'found '// &
            to_text(wanted%wavelength_long)//' m, expected at most '//to_text(most_waves) &
               //' times wavelength_short in a '// &
            'profile of '//to_text(length, 3)//' m, which is too long to be made at once')
      end if
      if (findings%count > before) return
      call set_effective(case, group, 'wavelength_long', wanted%wavelength_long)
      call set_effective(case, group, 'wavelength_rolloff', wanted%wavelength_rolloff)
      call synthesise(wanted, length, group, values%line_of(group, 'shape'), case, &
         surface%profile, findings)
   end subroutine fill_synthetic

   !> At once, or from pieces if that needs more than `most_nodes`. Findings: what the synthesis
   !> finds.
   subroutine synthesise(wanted, length, group, line, case, profile, findings)
      type(synthesis_t), intent(in) :: wanted
      real(wp), intent(in) :: length
      character(*), intent(in) :: group
      integer, intent(in) :: line
      type(case_t), intent(inout) :: case
      type(profile_t), intent(inout) :: profile
      type(findings_t), intent(inout) :: findings
      type(synthetic_pieces_t), allocatable :: pieces
      type(checksum_t) :: sums
      type(error_t), allocatable :: error
      integer :: half, nodes

      profile%is_periodic = .true.
      profile%finest_wave = wanted%wavelength_short
      if (length*nodes_per_wave > most_nodes*wanted%wavelength_short) then
         profile%spacing = wanted%wavelength_short/nodes_per_wave
         half = least_half
         do while (half < most_nodes/(2*most_waves)*(wanted%wavelength_long &
            /wanted%wavelength_short))
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
            call set_effective(case, group, 'heights_checksum', sums%digits())
         end if
      end if
      if (allocated(error)) call findings%add(line, group, 'shape', error%message)
   end subroutine synthesise

   !> Length of a surface that passes through the domain or lies in it [m]; `speed` [m/s].
   function passage(case, speed) result(length)
      type(case_t), intent(in) :: case
      real(wp), intent(in) :: speed
      real(wp) :: length
      type(scaling_t) :: scales

      call new_scaling(scales, case%bodies, case%lubricant, case%load_per_length)
      length = usual_domain
      if (case%domain%has_inlet .and. case%domain%has_outlet) length = case%domain%x_outlet &
         - case%domain%x_inlet
      if (case%time%is_transient) length = length + 2.0_wp*abs(speed)/scales%speed_sum &
         *case%time%end_time
      length = length*scales%half_width
   end function passage

   !> Where a scaled surface is at time 0 (lengths in half-widths): what is given is the centre of
   !> the profile; else a moving profile has its leading end at the end of the domain where it
   !> enters, one at rest its centre at X = 0.
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
      surface%profile%is_placed = .true.
   end subroutine place_surface

end module line_profiles
