!> Surfaces with a wanted spectrum: self-affine with roll-off and cut-offs, wanted rms height, skewness and kurtosis.
module synthetic_surface
   use errors, only: error_t, fail, input_error
   use kinds, only: wp
   use random_numbers, only: normal_numbers
   use spectral_product, only: new_spectral_product, spectral_product_t
   use text, only: to_text
   implicit none (type, external)
   private

   public :: synthesis_t, synthetic_heights, truncate_harmonics

   !> What is wanted. Lengths [m].
   type :: synthesis_t
      integer :: seed = 1
      !> Hurst exponent, 0 ... 1.
      real(wp) :: hurst = 0.8_wp
      !> Rq [m].
      real(wp) :: rms_height = 0.0_wp
      !> No longer waves than `wavelength_long`, power law below `wavelength_rolloff`, no shorter waves than
      !> `wavelength_short` [m].
      real(wp) :: wavelength_long = 0.0_wp, wavelength_rolloff = 0.0_wp, wavelength_short = 0.0_wp
      !> Rsk and Rku of the heights (Gaussian: 0 and 3).
      real(wp) :: skewness = 0.0_wp, kurtosis = 3.0_wp
   end type synthesis_t

   !> Newton steps for skewness and kurtosis, and how close they must come.
   integer, parameter :: most_steps = 60
   real(wp), parameter :: close_enough = 1.0e-10_wp

contains

   !> Heights z (nx*ny) [m] of mean 0 on a periodic grid `length_x` x `length_y` [m]; ny = 1 is a line.
   !>
   !> White Gaussian noise is given the spectrum C ~ const up to the roll-off, then q^(-2H - d), d = 1 (line), 2 (area)
   !> (B. N. J. Persson et al., J. Phys.: Condens. Matter 17, 2005, R1). Then each height goes through one cubic that gives
   !> skewness and kurtosis (A. I. Fleishman, Psychometrika 43, 1978, 521), with the moments of this surface itself.
   !> Errors (input_error): no wave fits the grid; a skewness and kurtosis that no such cubic has.
   subroutine synthetic_heights(wanted, grid, length_x, length_y, z, error)
      type(synthesis_t), intent(in) :: wanted
      integer, intent(in) :: grid(2)
      real(wp), intent(in) :: length_x, length_y
      real(wp), allocatable, intent(out) :: z(:)
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: noise(:), symbol(:, :)
      type(spectral_product_t) :: filter
      real(wp) :: waves
      integer :: i, j, nx, ny

      nx = grid(1)
      ny = grid(2)
      allocate (symbol(0:nx/2, 0:ny - 1), noise(nx*ny), z(nx*ny))
      do j = 0, ny - 1
         do i = 0, nx/2
            waves = hypot(real(i, wp)/length_x, real(merge(j, j - ny, 2*j <= ny), wp)/length_y)
            symbol(i, j) = amplitude_at(wanted, waves, merge(1.0_wp, 2.0_wp, ny == 1))
         end do
      end do
      if (all(symbol <= 0.0_wp)) then
         call fail(error, input_error, 'found no wave between wavelength_short and wavelength_long on the grid')
         return
      end if
      call new_spectral_product(filter, nx, ny, symbol, .false., error)
      if (allocated(error)) return
      noise = normal_numbers(nx*ny, wanted%seed)
      call filter%apply(noise, z)
      z = z/(norm2(z)/sqrt(real(size(z), wp)))
      if (abs(wanted%skewness) > 0.0_wp .or. abs(wanted%kurtosis - 3.0_wp) > 0.0_wp) then
         call bend(wanted%skewness, wanted%kurtosis, z, error)
         if (allocated(error)) return
      end if
      z = wanted%rms_height*z
   end subroutine synthetic_heights

   !> Amplitude, the root of the spectrum, at `waves` [1/m] in d = `dimensions`; 0 outside the cut-offs.
   pure function amplitude_at(wanted, waves, dimensions) result(amplitude)
      type(synthesis_t), intent(in) :: wanted
      real(wp), intent(in) :: waves, dimensions
      real(wp) :: amplitude
      real(wp), parameter :: slack = 1.0_wp + 1.0e-9_wp

      amplitude = 0.0_wp
      if (waves <= 0.0_wp .or. waves*wanted%wavelength_long*slack < 1.0_wp .or. waves*wanted%wavelength_short > slack) return
      amplitude = max(1.0_wp, waves*wanted%wavelength_rolloff)**(-wanted%hurst - 0.5_wp*dimensions)
   end function amplitude_at

   !> z of mean 0 and rms 1 becomes z + c z^2 + d z^3, again with mean 0 and rms 1, with the wanted skewness and kurtosis.
   subroutine bend(skewness, kurtosis, z, error)
      real(wp), intent(in) :: skewness, kurtosis
      real(wp), intent(inout) :: z(:)
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: c, d, determinant, miss(2), miss_c(2), miss_d(2), slope(2, 2), step
      integer :: i
      real(wp), parameter :: delta = 1.0e-6_wp

      c = 0.0_wp
      d = 0.0_wp
      do i = 1, most_steps
         miss = moments(z, c, d) - [skewness, kurtosis]
         if (maxval(abs(miss)) < close_enough) exit
         miss_c = moments(z, c + delta, d) - [skewness, kurtosis]
         miss_d = moments(z, c, d + delta) - [skewness, kurtosis]
         slope(:, 1) = (miss_c - miss)/delta
         slope(:, 2) = (miss_d - miss)/delta
         determinant = slope(1, 1)*slope(2, 2) - slope(1, 2)*slope(2, 1)
         if (.not. abs(determinant) > 0.0_wp) exit
         step = max(1.0_wp, maxval(abs([slope(2, 2)*miss(1) - slope(1, 2)*miss(2), slope(1, 1)*miss(2) - slope(2, 1)*miss(1)] &
            /determinant))/0.1_wp)
         c = c - (slope(2, 2)*miss(1) - slope(1, 2)*miss(2))/(determinant*step)
         d = d - (slope(1, 1)*miss(2) - slope(2, 1)*miss(1))/(determinant*step)
      end do
      if (.not. maxval(abs(miss)) < 1.0e-6_wp .or. .not. is_rising(c, d, z)) then
         call fail(error, input_error, 'found skewness ' // to_text(skewness) // ' and kurtosis ' // to_text(kurtosis) &
            // ', which no rising cubic of a Gaussian surface has')
         return
      end if
      z = z + c*z**2 + d*z**3
      z = z - sum(z)/size(z)
      z = z/(norm2(z)/sqrt(real(size(z), wp)))
   end subroutine bend

   !> Skewness and kurtosis of z + c z^2 + d z^3.
   pure function moments(z, c, d) result(values)
      real(wp), intent(in) :: z(:), c, d
      real(wp) :: values(2)
      real(wp) :: mean, square, cube, fourth, y
      integer :: i

      mean = sum(z + c*z**2 + d*z**3)/size(z)
      square = 0.0_wp
      cube = 0.0_wp
      fourth = 0.0_wp
      do i = 1, size(z)
         y = z(i) + c*z(i)**2 + d*z(i)**3 - mean
         square = square + y**2
         cube = cube + y**3
         fourth = fourth + y**4
      end do
      square = square/size(z)
      values = [cube/size(z)/square**1.5_wp, fourth/size(z)/square**2]
   end function moments

   !> True if the cubic rises at every height: it then keeps the order of the heights.
   pure function is_rising(c, d, z)
      real(wp), intent(in) :: c, d, z(:)
      logical :: is_rising

      is_rising = all(1.0_wp + 2.0_wp*c*z + 3.0_wp*d*z**2 > 0.0_wp)
   end function is_rising

   !> Keeps the harmonics 1 ... `harmonics` of the periodic heights `z` (nx*ny) and drops the mean, (4.1); of an area those
   !> with hypot of the two numbers of waves up to it. Fails (internal_error) if FFTW does.
   subroutine truncate_harmonics(harmonics, grid, z, error)
      integer, intent(in) :: harmonics, grid(2)
      real(wp), allocatable, intent(inout) :: z(:)
      type(error_t), allocatable, intent(out) :: error
      type(spectral_product_t) :: filter
      real(wp), allocatable :: kept(:), symbol(:, :)
      integer :: i, j

      allocate (symbol(0:grid(1)/2, 0:grid(2) - 1), source=0.0_wp)
      do j = 0, grid(2) - 1
         do i = 0, grid(1)/2
            if (i**2 + merge(j, j - grid(2), 2*j <= grid(2))**2 <= harmonics**2) symbol(i, j) = 1.0_wp
         end do
      end do
      symbol(0, 0) = 0.0_wp
      call new_spectral_product(filter, grid(1), grid(2), symbol, .false., error)
      if (allocated(error)) return
      allocate (kept, mold=z)
      call filter%apply(z, kept)
      call move_alloc(kept, z)
   end subroutine truncate_harmonics

end module synthetic_surface
