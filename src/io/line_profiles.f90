!> Measured and synthetic profiles of the lubricated line contact: from the keys of a surface to heights that enter the contact.
module line_profiles
   use, intrinsic :: iso_fortran_env, only: int64
   use case_record, only: case_t, set_effective
   use errors, only: error_t
   use features, only: rough_surface_t
   use findings, only: findings_t
   use height_file, only: heights_t, read_heights
   use input_values, only: input_values_t, value_t
   use kinds, only: wp
   use profile, only: profile_t
   use scaling, only: new_scaling, scaling_t
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
   integer, parameter :: most_nodes = 2**24

contains

   !> Gives `surface` of `case` its entry and, for shape 'file' or 'synthetic', its profile. Findings: the file; the synthesis.
   subroutine add_profile(values, group, case, surface, findings)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: group
      type(case_t), intent(inout) :: case
      type(rough_surface_t), intent(inout) :: surface
      type(findings_t), intent(inout) :: findings
      character(:), allocatable :: shape
      type(value_t) :: position

      shape = trim(values%word_value(group, 'shape'))
      if (case%time%is_transient) surface%entry_length = values%real_value(group, 'entry_length')
      if (shape /= 'file' .and. shape /= 'synthetic') return
      if (case%time%is_transient .and. .not. values%is_given(group, 'entry_length')) surface%entry_length = usual_entry
      allocate (surface%profile)
      if (shape == 'file') then
         call fill_from_file(values, group, case%file, surface%profile, findings)
      else
         call fill_synthetic(values, group, case, surface, findings)
      end if
      if (findings%count > 0) return
      surface%profile%end_length = max(surface%entry_length, usual_entry)
      position = values%slot(group, 'position')
      surface%profile%is_placed = position%is_given
      if (position%is_given) surface%profile%start = position%reals(1)
      if (case%time%is_transient) call set_effective(case, group, 'entry_length', to_text(surface%entry_length, 17), 'half-widths')
      call set_effective(case, group, 'heights_checksum', checksum(surface%profile%heights), '')
   end subroutine add_profile

   !> Heights of the file; with harmonics they repeat themselves.
   subroutine fill_from_file(values, group, namelist, profile, findings)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: group, namelist
      type(profile_t), intent(inout) :: profile
      type(findings_t), intent(inout) :: findings
      type(value_t) :: name, dataset, harmonics
      type(heights_t) :: heights
      type(error_t), allocatable :: error
      character(:), allocatable :: path

      name = values%slot(group, 'file')
      dataset = values%slot(group, 'dataset')
      path = trim(name%text)
      if (index(path, '/') /= 1) path = namelist(:index(namelist, '/', back=.true.))//path
      call read_heights(path, trim(dataset%text), heights, error)
      if (allocated(error)) then
         call findings%add(name%line, group, 'file', error%message)
         return
      end if
      if (heights%grid(2) > 1) call findings%add(name%line, group, 'file', 'found an area, expected a profile')
      if (.not. heights%spacing(1) > 0.0_wp) call findings%add(name%line, group, 'file', 'found no spacing in '//path// &
         ', expected the attribute spacing_x or spacing [m] of the dataset')
      harmonics = values%slot(group, 'harmonics')
      profile%is_periodic = harmonics%is_given
      if (harmonics%is_given .and. harmonics%integer > size(heights%z)/2 - 1) call findings%add(harmonics%line, group, &
         'harmonics', 'found '//to_text(harmonics%integer)//', expected at most '//to_text(size(heights%z)/2 - 1)// &
         ', half the nodes less one')
      if (findings%count > 0) return
      if (harmonics%is_given) then
         call truncate_harmonics(harmonics%integer, [size(heights%z), 1], heights%z, error)
         if (allocated(error)) call findings%add(harmonics%line, group, 'harmonics', error%message)
         profile%finest_wave = size(heights%z)*heights%spacing(1)/harmonics%integer
      else
         profile%finest_wave = 2.0_wp*heights%spacing(1)
      end if
      call move_alloc(heights%z, profile%heights)
      profile%spacing = heights%spacing(1)
   end subroutine fill_from_file

   !> Heights with a wanted spectrum, long enough for the whole passage; they repeat themselves behind it.
   subroutine fill_synthetic(values, group, case, surface, findings)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: group
      type(case_t), intent(in) :: case
      type(rough_surface_t), intent(inout) :: surface
      type(findings_t), intent(inout) :: findings
      type(synthesis_t) :: wanted
      type(value_t) :: seed
      type(error_t), allocatable :: error
      real(wp) :: length
      integer :: nodes

      seed = values%slot(group, 'seed')
      wanted%seed = seed%integer
      wanted%hurst = values%real_value(group, 'hurst')
      wanted%rms_height = values%real_value(group, 'rms_height')
      wanted%skewness = values%real_value(group, 'skewness')
      wanted%kurtosis = values%real_value(group, 'kurtosis')
      wanted%wavelength_short = values%real_value(group, 'wavelength_short')
      length = max(passage(case, surface%speed), values%real_value(group, 'wavelength_long'), 4.0_wp*wanted%wavelength_short)
      if (length*nodes_per_wave/wanted%wavelength_short > most_nodes) then
         call findings%add(values%line_of(group, 'wavelength_short'), group, 'wavelength_short', 'found waves so short that '// &
            'the profile of '//to_text(length, 3)//' m has more than '//to_text(most_nodes)//' nodes, expected longer ones')
         return
      end if
      nodes = 2*ceiling(0.5_wp*length*nodes_per_wave/wanted%wavelength_short)
      surface%profile%spacing = length/nodes
      surface%profile%is_periodic = .true.
      surface%profile%finest_wave = wanted%wavelength_short
      wanted%wavelength_long = length
      if (values%is_given(group, 'wavelength_long')) wanted%wavelength_long = values%real_value(group, 'wavelength_long')
      wanted%wavelength_rolloff = wanted%wavelength_long
      if (values%is_given(group, 'wavelength_rolloff')) wanted%wavelength_rolloff = values%real_value(group, 'wavelength_rolloff')
      if (wanted%wavelength_short > wanted%wavelength_rolloff .or. wanted%wavelength_rolloff > wanted%wavelength_long) then
         call findings%add(values%line_of(group, 'shape'), group, 'wavelength_rolloff', 'found '// &
            to_text(wanted%wavelength_rolloff)//' m, expected wavelength_short <= wavelength_rolloff <= wavelength_long')
         return
      end if
      call synthetic_heights(wanted, [nodes, 1], length, tiny(1.0_wp), surface%profile%heights, error)
      if (allocated(error)) call findings%add(values%line_of(group, 'shape'), group, 'shape', error%message)
   end subroutine fill_synthetic

   !> Length of a surface that passes through the domain or lies in it [m]; `speed` [m/s].
   function passage(case, speed) result(length)
      type(case_t), intent(in) :: case
      real(wp), intent(in) :: speed
      real(wp) :: length
      type(scaling_t) :: scales

      call new_scaling(scales, case%bodies, case%lubricant, case%load_per_length)
      length = usual_domain
      if (case%domain%has_inlet .and. case%domain%has_outlet) length = case%domain%x_outlet - case%domain%x_inlet
      if (case%time%is_transient) length = length + 2.0_wp*abs(speed)/scales%speed_sum*case%time%end_time
      length = length*scales%half_width
   end function passage

   !> Where a scaled surface is at time 0 (lengths in half-widths): what is given is the centre of the profile; else a moving
   !> profile has its leading end at the end of the domain where it enters, one at rest its centre at X = 0.
   pure subroutine place_surface(surface, x_inlet, x_outlet)
      type(rough_surface_t), intent(inout) :: surface
      real(wp), intent(in) :: x_inlet, x_outlet
      real(wp) :: length

      surface%entry_position = merge(x_inlet, x_outlet, surface%speed >= 0.0_wp)
      if (.not. allocated(surface%profile)) return
      length = (size(surface%profile%heights) - 1)*surface%profile%spacing
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

   !> Fletcher's sum of the bits of the heights, in 32-bit halves, as 16 hexadecimal digits.
   pure function checksum(heights) result(digits)
      real(wp), intent(in) :: heights(:)
      character(len=16) :: digits
      integer(int64), parameter :: modulus = 4294967295_int64
      integer(int64) :: bits, first, second
      integer :: i

      first = 0_int64
      second = 0_int64
      do i = 1, size(heights)
         bits = transfer(heights(i), bits)
         first = modulo(first + ibits(bits, 0, 32), modulus)
         second = modulo(second + first, modulus)
         first = modulo(first + ibits(bits, 32, 32), modulus)
         second = modulo(second + first, modulus)
      end do
      write (digits, '(2z8.8)') second, first
   end function checksum

end module line_profiles
