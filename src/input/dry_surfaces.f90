!> Composite heights of a dry case from the two surfaces.
module dry_surfaces
   use analytic_heights, only: feature_heights, node_positions, parabola_heights
   use dry_case, only: dry_case_t
   use errors, only: error_t
   use features, only: feature_ridge, feature_sinusoid, feature_t
   use findings, only: findings_t
   use fourier_resampling, only: resample_centres, resample_heights
   use height_file, only: heights_t, read_heights
   use input_values, only: input_values_t, value_t
   use kinds, only: wp
   use life_sign, only: begin_activity
   use synthesis_keys, only: read_synthesis
   use synthetic_surface, only: synthesis_t, synthetic_heights, truncate_harmonics
   use text, only: to_text
   implicit none (type, external)
   private

   public :: add_surface, load_first_file, same_length

   !> Relative difference of two lengths that are the same.
   real(wp), parameter :: same_length = 1.0e-3_wp
contains

   !> The heights of the first surface that is a file; nothing if none is.
   subroutine load_first_file(values, folder, heights, findings)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: folder
      type(heights_t), intent(out) :: heights
      type(findings_t), intent(inout) :: findings
      type(value_t) :: shape
      integer :: i
      character(len=9), parameter :: groups(2) = ['surface_1', 'surface_2']

      do i = 1, 2
         shape = values%slot(groups(i), 'shape')
         if (.not. shape%has_value) cycle
         if (.not. any(shape%words == 'file')) cycle
         call load_file(values, groups(i), folder, heights, findings)
         return
      end do
   end subroutine load_first_file

   !> The heights of the file of one surface.
   subroutine load_file(values, group, folder, heights, findings)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: group, folder
      type(heights_t), intent(out) :: heights
      type(findings_t), intent(inout) :: findings
      type(value_t) :: dataset, name
      type(error_t), allocatable :: error
      character(:), allocatable :: path

      name = values%slot(group, 'file')
      dataset = values%slot(group, 'dataset')
      path = trim(name%text)
      if (index(path, '/') /= 1) path = folder // path
      call read_heights(path, trim(dataset%text), heights, error)
      if (allocated(error)) then
         call findings%add(name%line, group, 'file', error%message)
      else if (values%problem == 'dry_line' .and. heights%grid(2) > 1) then
         call findings%add(name%line, group, 'file', 'found an area, expected a profile: '// &
            "problem = 'dry_area' takes areas")
      else if (values%problem == 'dry_area' .and. heights%grid(2) == 1) then
         call findings%add(name%line, group, 'file', 'found a profile, expected an area: '// &
            "problem = 'dry_line' takes profiles")
      end if
   end subroutine load_file

   !> Adds the heights of the surface `group` to those of `dry`. `radius` [m] is that of a parabola.
   !> Findings: what the surface itself finds.
   subroutine add_surface(values, group, folder, radius, dry, findings)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: group, folder
      real(wp), intent(in) :: radius
      type(dry_case_t), intent(inout) :: dry
      type(findings_t), intent(inout) :: findings
      type(value_t) :: shape
      real(wp), allocatable :: z(:)
      character(:), allocatable :: word

      shape = values%slot(group, 'shape')
      if (.not. shape%has_value) return
      word = trim(shape%words(1))
      allocate (z(size(dry%height)), source=0.0_wp)
      select case (word)
      case ('file')
         call add_file(values, group, folder, dry, z, findings)
      case ('synthetic')
         call add_synthetic(values, group, dry, z, findings)
      case ('parabola')
         z = parabola_heights(radius, positions(dry, 1), positions(dry, 2), dry%lengths, &
            dry%is_periodic)
      case ('feature', 'sinusoid')
         call add_features(values, group, dry, z, findings)
      case default
         return
      end select
      if (findings%count > 0) return
      if (values%is_given(group, 'harmonics')) call truncate(values, group, dry, z, findings)
      dry%height = dry%height + z
   end subroutine add_surface

   !> Positions of the nodes in x (1) or y (2); a line has y = 0 alone.
   pure function positions(dry, direction) result(x)
      type(dry_case_t), intent(in) :: dry
      integer, intent(in) :: direction
      real(wp), allocatable :: x(:)

      if (direction == 1) then
         x = node_positions(dry%grid%nx, dry%lengths(1), dry%is_periodic)
      else if (dry%grid%ny > 1) then
         x = node_positions(dry%grid%ny, dry%lengths(2), dry%is_periodic)
      else
         x = [0.0_wp]
      end if
   end function positions

   !> Heights of the file, on a periodic domain resampled to its nodes. Findings: another length;
   !> other nodes of an open domain.
   subroutine add_file(values, group, folder, dry, z, findings)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: group, folder
      type(dry_case_t), intent(in) :: dry
      real(wp), intent(inout) :: z(:)
      type(findings_t), intent(inout) :: findings
      type(heights_t) :: heights
      type(error_t), allocatable :: error
      real(wp) :: length
      integer :: i, line

      call load_file(values, group, folder, heights, findings)
      if (findings%count > 0) return
      line = values%line_of(group, 'file')
      do i = 1, merge(2, 1, dry%grid%ny > 1)
         length = heights%grid(i)*heights%spacing(i)
         if (length <= 0.0_wp .or. abs(length - dry%lengths(i)) <= same_length*dry%lengths(i)) cycle
         call findings%add(line, group, 'file', 'found nodes times spacing '// &
            '' // to_text(length) // ' m, expected the length of ' &
            // 'the domain, ' // to_text(dry%lengths(i)) // ' m')
         return
      end do
      call begin_activity('making the surface')
      if (any(heights%grid /= [dry%grid%nx, dry%grid%ny])) then
         if (.not. dry%is_periodic) then
            call findings%add(line, group, 'file', 'found ' // to_text(heights%grid(1)) // ' '// &
               'x ' // to_text(heights%grid(2)) &
               // ' nodes, expected ' // to_text(dry%grid%nx) // ' x ' // to_text(dry%grid%ny) &
                  // ' as in the other surface')
            return
         end if
         call resample_heights(heights%grid, [dry%grid%nx, dry%grid%ny], heights%z, error)
         if (allocated(error)) then
            call findings%add(line, group, 'file', error%message)
            return
         end if
      end if
      z = heights%z
   end subroutine add_file

   !> Heights with a wanted spectrum, those of the first grid resampled. Findings: wavelengths out
   !> of order; what the synthesis finds.
   subroutine add_synthetic(values, group, dry, z, findings)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: group
      type(dry_case_t), intent(in) :: dry
      real(wp), allocatable, intent(inout) :: z(:)
      type(findings_t), intent(inout) :: findings
      type(synthesis_t) :: wanted
      type(error_t), allocatable :: error

      associate (first => dry%recipe%nodes, nodes => [dry%grid%nx, dry%grid%ny])
         call read_synthesis(values, group, maxval(dry%lengths), 2.0_wp*dry%lengths(1)/first(1), &
            wanted, findings)
         if (findings%count > 0) return
         call begin_activity('making the surface')
         call synthetic_heights(wanted, first, dry%lengths(1), max(dry%lengths(2), tiny(1.0_wp)), &
            z, error)
         if (.not. allocated(error) .and. any(nodes /= first)) then
            if (dry%is_periodic) then
               call resample_heights(first, nodes, z, error)
            else
               call resample_centres(first, nodes, z, error)
            end if
         end if
      end associate
      if (allocated(error)) call findings%add(values%line_of(group, 'shape'), group, 'shape', &
         error%message)
   end subroutine add_synthetic

   !> Ridges, dents and sinusoids. Findings: arrays that do not belong together.
   subroutine add_features(values, group, dry, z, findings)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: group
      type(dry_case_t), intent(in) :: dry
      real(wp), intent(inout) :: z(:)
      type(findings_t), intent(inout) :: findings
      type(value_t) :: amplitude, position, shape, wavelength
      type(feature_t), allocatable :: features(:)
      integer :: i, n

      shape = values%slot(group, 'shape')
      amplitude = values%slot(group, 'amplitude')
      wavelength = values%slot(group, 'wavelength')
      position = values%slot(group, 'position')
      n = size(amplitude%reals)
      if (size(wavelength%reals) /= n .or. (size(position%reals) /= n .and. position%is_given) &
         .or. (size(shape%words) /= n .and. size(shape%words) /= 1)) then
         call findings%add(amplitude%line, group, 'amplitude', &
            'found ' // to_text(n) // ' values, expected as many of shape ' &
            // '(or one), wavelength and position')
         return
      end if
      allocate (features(n))
      do i = 1, n
         features(i) = feature_t(merge(feature_sinusoid, feature_ridge, &
            shape%words(min(i, size(shape%words))) == 'sinusoid'), &
            amplitude%reals(i), wavelength%reals(i), position%reals(min(i, size(position%reals))))
      end do
      z = feature_heights(features, positions(dry, 1), dry%grid%ny, dry%lengths(1), dry%is_periodic)
   end subroutine add_features

   !> Truncated Fourier series, (4.1). Findings: an open domain; more harmonics than the grid has.
   subroutine truncate(values, group, dry, z, findings)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: group
      type(dry_case_t), intent(in) :: dry
      real(wp), allocatable, intent(inout) :: z(:)
      type(findings_t), intent(inout) :: findings
      type(value_t) :: harmonics
      type(error_t), allocatable :: error
      integer :: most

      harmonics = values%slot(group, 'harmonics')
      most = dry%grid%nx/2 - 1
      if (dry%grid%ny > 1) most = min(most, dry%grid%ny/2 - 1)
      if (.not. dry%is_periodic) then
         call findings%add(harmonics%line, group, 'harmonics', &
            'found a truncation with periodic = .false., expected .true.')
      else if (harmonics%integer > most) then
         call findings%add(harmonics%line, group, 'harmonics', &
            'found ' // to_text(harmonics%integer) // ', expected at most ' &
            // to_text(most) // ', half the nodes less one')
      else
         call truncate_harmonics(harmonics%integer, [dry%grid%nx, dry%grid%ny], z, error)
         if (allocated(error)) call findings%add(harmonics%line, group, 'harmonics', error%message)
      end if
   end subroutine truncate

end module dry_surfaces
