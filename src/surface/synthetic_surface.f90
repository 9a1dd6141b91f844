!> Self-affine surfaces with roll-off, cut-offs and given rms height, skewness and kurtosis.
!>
!> Random numbers are the same on every machine, by Philox4x32-10, a counter-based generator (J. K.
!> Salmon, M. A. Moraes, R. O. Dror and D. E. Shaw, Parallel random numbers: as easy as 1, 2, 3,
!> Proc. SC11, 2011). Number i of a seed does not depend on those before it. All products are split
!> into halves of 16 bits: nothing overflows.
!>
!> And profiles of any length, composed of pieces that are made on demand. Piece k is a periodic
!> Gaussian profile of separate random numbers; it covers half of piece k - 1 and half of piece k +
!> 1. In the overlap the old one fades out as cos(a), the new one fades in as sin(a): the sum of two
!> independent Gaussian heights with these weights is Gaussian with the same variance, so that the
!> joints are invisible. The first piece follows the last. The spectrum is that of a piece, blurred
!> by about one wave in its length.
module synthetic_surface
   use errors, only: error_t, fail, input_error
   use kinds, only: int64, pi, wp
   use profile, only: height_source_t, smooth_ramp
   use spectral_product, only: new_spectral_product, spectral_product_t
   use text, only: to_text
   implicit none (type, external)
   private

   public :: bend_t, bent, new_synthetic_pieces, normal_numbers, philox, synthesis_t, &
      synthetic_heights, synthetic_pieces_t, truncate_harmonics

   !> Parameters of the surface. Lengths [m].
   type :: synthesis_t
      integer :: seed = 1
      !> Hurst exponent, 0 ... 1.
      real(wp) :: hurst = 0.8_wp
      !> Rq [m].
      real(wp) :: rms_height = 0.0_wp
      !> No longer waves than `wavelength_long`, power law below `wavelength_rolloff`, no shorter
      !> waves than `wavelength_short` [m].
      real(wp) :: wavelength_long = 0.0_wp, wavelength_rolloff = 0.0_wp, wavelength_short = 0.0_wp
      !> Rsk and Rku of the heights (Gaussian: 0 and 3).
      real(wp) :: skewness = 0.0_wp, kurtosis = 3.0_wp
   end type synthesis_t

   !> A rising function of heights: Tukey's, less a mean, over an rms.
   type :: bend_t
      real(wp) :: g = 0.0_wp, h = 0.0_wp
      real(wp) :: mean = 0.0_wp, rms = 1.0_wp
   end type bend_t

   !> Most Newton steps for skewness and kurtosis, and the largest deviation that ends them.
   integer, parameter :: max_steps = 60
   real(wp), parameter :: close_enough = 1.0e-10_wp

   integer(int64), parameter :: low_32 = int(z'FFFFFFFF', int64), low_16 = int(z'FFFF', int64)
   integer(int64), parameter :: multipliers(2) = [int(z'D2511F53', int64), int(z'CD9E8D57', int64)]
   integer(int64), parameter :: weyl(2) = [int(z'9E3779B9', int64), int(z'BB67AE85', int64)]
   integer, parameter :: rounds = 10

   !> Made by `new_synthetic_pieces`.
   type, extends(height_source_t) :: synthetic_pieces_t
      type(synthesis_t), private :: wanted
      type(bend_t), private :: bend
      !> Spacing of the heights [m], and heights in half a piece.
      real(wp), private :: spacing = 0.0_wp
      integer, private :: half = 0
   contains
      procedure :: get
   end type synthetic_pieces_t

contains

   !> Computes heights z (nx*ny) [m] of mean 0 on a periodic grid `length_x` x `length_y` [m]; ny =
   !> 1 is a line.
   !>
   !> White Gaussian noise is given the spectrum C ~ const up to the roll-off, then q^(-2H - d), d =
   !> 1 (line), 2 (area) (B. N. J. Persson et al., J. Phys.: Condens. Matter 17, 2005, R1). Then one
   !> rising function of each height gives skewness and kurtosis, Tukey's g and h (D. C. Hoaglin, in
   !> Exploring Data Tables, Trends, and Shapes, 1985), with the moments of this surface. Errors
   !> (input_error): no wave fits the grid; no such function gives this skewness and kurtosis.
   subroutine synthetic_heights(wanted, grid, length_x, length_y, z, error)
      type(synthesis_t), intent(in) :: wanted
      integer, intent(in) :: grid(2)
      real(wp), intent(in) :: length_x, length_y
      real(wp), allocatable, intent(out) :: z(:)
      type(error_t), allocatable, intent(out) :: error
      type(bend_t) :: bend

      call gaussian_heights(wanted, grid, length_x, length_y, 0_int64, z, error)
      if (allocated(error)) return
      call find_bend(wanted, z, bend, error)
      if (allocated(error)) return
      z = wanted%rms_height*bent(z, bend)
   end subroutine synthetic_heights

   !> Computes Gaussian heights z (nx*ny) of mean 0 and rms 1 with the spectrum of `wanted`, from
   !> one `series` of random numbers of the seed. Error (input_error): no wave fits the grid.
   subroutine gaussian_heights(wanted, grid, length_x, length_y, series, z, error)
      type(synthesis_t), intent(in) :: wanted
      integer, intent(in) :: grid(2)
      real(wp), intent(in) :: length_x, length_y
      integer(int64), intent(in) :: series
      real(wp), allocatable, intent(out) :: z(:)
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: noise(:), symbol(:, :)
      type(spectral_product_t) :: filter
      real(wp), parameter :: slack = 1.0_wp + 1.0e-9_wp
      real(wp) :: power, waves
      integer :: i, j, nx, ny

      nx = grid(1)
      ny = grid(2)
      power = -wanted%hurst - 0.5_wp*merge(1.0_wp, 2.0_wp, ny == 1)
      allocate (symbol(0:nx/2, 0:ny - 1), source=0.0_wp)   ! root of the spectrum
      allocate (noise(nx*ny), z(nx*ny))
      do j = 0, ny - 1
         do i = 0, nx/2
            waves = hypot(real(i, wp)/length_x, real(merge(j, j - ny, 2*j <= ny), wp)/length_y)
            if (waves > 0.0_wp .and. waves*wanted%wavelength_long*slack >= 1.0_wp &
               .and. waves*wanted%wavelength_short <= slack) symbol(i, j) = max(1.0_wp, &
               waves*wanted%wavelength_rolloff)**power
         end do
      end do
      if (all(symbol <= 0.0_wp)) then
         call fail(error, input_error, 'found no wave between wavelength_short and '// &
            'wavelength_long on the grid')
         return
      end if
      call new_spectral_product(filter, nx, ny, symbol, 1, error)
      if (allocated(error)) return
      noise = normal_numbers(nx*ny, wanted%seed, series)
      call filter%apply(noise, z)
      z = z/(norm2(z)/sqrt(real(size(z), wp)))
   end subroutine gaussian_heights

   !> Finds the function that gives heights `z` of mean 0 and rms 1 the wanted skewness and
   !> kurtosis; mean and rms stay. Error (input_error): there is none.
   subroutine find_bend(wanted, z, bend, error)
      type(synthesis_t), intent(in) :: wanted
      real(wp), intent(in) :: z(:)
      type(bend_t), intent(out) :: bend
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: change(2), determinant, g, goal(2), h, miss(2), slope(2, 2)
      logical :: is_found
      integer :: i
      real(wp), parameter :: delta = 1.0e-6_wp, longest_step = 0.05_wp

      if (abs(wanted%skewness) <= 0.0_wp .and. abs(wanted%kurtosis - 3.0_wp) <= 0.0_wp) return
      goal = [wanted%skewness, wanted%kurtosis]
      g = wanted%skewness/3.0_wp
      h = 0.0_wp
      do i = 1, max_steps
         miss = moments(tukey(z, g, h)) - goal
         if (maxval(abs(miss)) < close_enough) exit
         slope(:, 1) = (moments(tukey(z, g + delta, h)) - goal - miss)/delta
         slope(:, 2) = (moments(tukey(z, g, h + delta)) - goal - miss)/delta
         determinant = slope(1, 1)*slope(2, 2) - slope(1, 2)*slope(2, 1)
         if (.not. abs(determinant) > 0.0_wp) exit
         change = [slope(2, 2)*miss(1) - slope(1, 2)*miss(2), slope(1, 1)*miss(2) - slope(2, &
            1)*miss(1)]/determinant
         change = change/max(1.0_wp, maxval(abs(change))/longest_step)
         g = g - change(1)
         h = h - change(2)
      end do
      is_found = maxval(abs(miss)) < 1.0e-6_wp
      ! Its derivative must be positive at every height: then it keeps their order.
      if (is_found) is_found = all(tukey(z, g, h)*h*z + exp(g*z + 0.5_wp*h*z**2) > 0.0_wp)
      if (.not. is_found) then
         call fail(error, input_error, 'found skewness ' // to_text(wanted%skewness) // ' and '// &
            'kurtosis ' &
            // to_text(wanted%kurtosis) // ', which this Gaussian surface cannot be given')
         return
      end if
      bend%g = g
      bend%h = h
      bend%mean = sum(tukey(z, g, h))/size(z)
      bend%rms = norm2(tukey(z, g, h) - bend%mean)/sqrt(real(size(z), wp))
   end subroutine find_bend

   !> Value of the function at a height.
   pure elemental real(wp) function bent(z, bend) result(y)
      real(wp), intent(in) :: z
      type(bend_t), intent(in) :: bend

      y = (tukey(z, bend%g, bend%h) - bend%mean)/bend%rms
   end function bent

   !> (exp(g z) - 1)/g exp(h z^2/2): g > 0 lengthens the upper tail, h > 0 both.
   pure elemental real(wp) function tukey(z, g, h) result(y)
      real(wp), intent(in) :: z, g, h

      y = z*(1.0_wp + 0.5_wp*g*z)
      if (abs(g*z) > 1.0e-5_wp) y = (exp(g*z) - 1.0_wp)/g
      y = y*exp(0.5_wp*h*z**2)
   end function tukey

   !> Skewness and kurtosis of `y`.
   pure function moments(y) result(values)
      real(wp), intent(in) :: y(:)
      real(wp) :: values(2), mean, square

      mean = sum(y)/size(y)
      square = sum((y - mean)**2)/size(y)
      values = [sum((y - mean)**3)/size(y)/square**1.5_wp, sum((y - mean)**4)/size(y)/square**2]
   end function moments

   !> Keeps the harmonics 1 ... `harmonics` of periodic heights (nx*ny), (4.1), of an area by the
   !> hypot of both wave numbers. Errors: the grid has fewer (input_error); FFTW (internal_error).
   subroutine truncate_harmonics(harmonics, grid, z, error)
      integer, intent(in) :: harmonics, grid(2)
      real(wp), allocatable, intent(inout) :: z(:)
      type(error_t), allocatable, intent(out) :: error
      type(spectral_product_t) :: filter
      real(wp), allocatable :: kept(:), symbol(:, :)
      integer :: j, most
      integer(int64) :: across, i

      most = minval(grid/2 - 1, mask=grid > 1)
      if (harmonics > most) then
         call fail(error, input_error, 'found '//to_text(harmonics)//', expected at most ' &
            //to_text(most)//', half the nodes less one')
         return
      end if
      allocate (symbol(0:grid(1)/2, 0:grid(2) - 1), source=0.0_wp)
      do j = 0, grid(2) - 1
         across = merge(j, j - grid(2), 2*j <= grid(2))
         do i = 0, grid(1)/2
            if (i**2 + across**2 <= int(harmonics, int64)**2) symbol(i, j) = 1.0_wp
         end do
      end do
      symbol(0, 0) = 0.0_wp
      call new_spectral_product(filter, grid(1), grid(2), symbol, 1, error)
      if (allocated(error)) return
      allocate (kept, mold=z)
      call filter%apply(z, kept)
      call move_alloc(kept, z)
   end subroutine truncate_harmonics

   !> Four words of 32 bits, 0 ... 2^32 - 1, from a `counter` (4) and a `key` (2) of such words.
   pure function philox(counter, key) result(words)
      integer(int64), intent(in) :: counter(4), key(2)
      integer(int64) :: words(4), high(2), low(2), round_key(2)
      integer :: i

      words = counter
      round_key = key
      do i = 1, rounds
         call multiply(multipliers(1), words(1), high(1), low(1))
         call multiply(multipliers(2), words(3), high(2), low(2))
         words = [ieor(ieor(high(2), words(2)), round_key(1)), low(2), &
            ieor(ieor(high(1), words(4)), round_key(2)), low(1)]
         round_key = iand(round_key + weyl, low_32)
      end do
   end function philox

   !> High and low word of the product of two words of 32 bits.
   pure elemental subroutine multiply(a, b, high, low)
      integer(int64), intent(in) :: a, b
      integer(int64), intent(out) :: high, low
      integer(int64) :: a_high, a_low, b_high, b_low, carry, middle

      a_high = shiftr(a, 16)
      a_low = iand(a, low_16)
      b_high = shiftr(b, 16)
      b_low = iand(b, low_16)
      carry = a_low*b_low
      middle = a_high*b_low + shiftr(carry, 16)
      low = iand(middle, low_16) + a_low*b_high
      high = a_high*b_high + shiftr(middle, 16) + shiftr(low, 16)
      low = ior(shiftl(iand(low, low_16), 16), iand(carry, low_16))
   end subroutine multiply

   !> `n` independent normal numbers (mean 0, variance 1) of a `seed` >= 0, by the transform of Box
   !> and Muller. Each `series` (0 ... 2^32 - 1) of a seed gives others.
   pure function normal_numbers(n, seed, series) result(values)
      integer, intent(in) :: n, seed
      integer(int64), intent(in) :: series
      real(wp) :: values(n)
      integer(int64) :: words(4)
      real(wp) :: angle, radius
      integer :: i

      do i = 1, n, 2
         words = philox([int(i/2, int64), 0_int64, series, 0_int64], [int(seed, int64), 0_int64])
         radius = sqrt(-2.0_wp*log(uniform(words(1), words(2))))
         angle = 2.0_wp*pi*uniform(words(3), words(4))
         values(i) = radius*cos(angle)
         if (i < n) values(i + 1) = radius*sin(angle)
      end do
   end function normal_numbers

   !> A number in (0, 1) from the upper 52 bits of two words.
   pure real(wp) function uniform(first, second)
      integer(int64), intent(in) :: first, second

      uniform = (real(ior(shiftl(first, 20), shiftr(second, 12)), wp) + 0.5_wp)*2.0_wp**(-52)
   end function uniform

   !> Prepares a profile of `halves` >= 2 half pieces of `half` heights, `spacing` [m] apart, with
   !> skewness and kurtosis of piece 0 and rms height of each. Errors: as in `synthetic_heights`.
   subroutine new_synthetic_pieces(source, wanted, spacing, half, halves, error)
      type(synthetic_pieces_t), intent(out) :: source
      type(synthesis_t), intent(in) :: wanted
      real(wp), intent(in) :: spacing
      integer, intent(in) :: half
      integer(int64), intent(in) :: halves
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: z(:)

      source%wanted = wanted
      source%spacing = spacing
      source%half = half
      source%nodes = halves*half
      call make_piece(source, 0_int64, z, error)
      if (.not. allocated(error)) call find_bend(wanted, z, source%bend, error)
   end subroutine new_synthetic_pieces

   !> Computes heights from number `first` on. Error: memory for the transforms.
   subroutine get(self, first, z, error)
      class(synthetic_pieces_t), intent(in) :: self
      integer(int64), intent(in) :: first
      real(wp), contiguous, intent(out) :: z(:)
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: fading(:), rising(:)
      integer(int64) :: from, k, node, to
      real(wp) :: angle
      integer :: i

      z = 0.0_wp
      do k = first/self%half, (first + size(z) - 1)/self%half
         if (allocated(rising)) then
            call move_alloc(rising, fading)
         else
            call make_piece(self, k, fading, error)
            if (allocated(error)) return
         end if
         call make_piece(self, modulo(k + 1, self%nodes/self%half), rising, error)
         if (allocated(error)) return
         from = max(first, k*self%half)
         to = min(first + size(z), (k + 1)*self%half) - 1
         do node = from, to
            i = int(node - k*self%half)
            angle = 0.5_wp*pi*smooth_ramp(real(i, wp)/self%half)
            z(node - first + 1) = cos(angle)*fading(self%half + i + 1) + sin(angle)*rising(i + 1)
         end do
      end do
      z = self%wanted%rms_height*bent(z, self%bend)
   end subroutine get

   !> Computes Gaussian heights (2*half) of piece `k`, with rms 1.
   subroutine make_piece(self, k, z, error)
      class(synthetic_pieces_t), intent(in) :: self
      integer(int64), intent(in) :: k
      real(wp), allocatable, intent(out) :: z(:)
      type(error_t), allocatable, intent(out) :: error

      call gaussian_heights(self%wanted, [2*self%half, 1], 2*self%half*self%spacing, &
         tiny(1.0_wp), k, z, error)
   end subroutine make_piece

end module synthetic_surface
