!> Real Fourier transforms of a field on a uniform grid of one or two dimensions, for use once, and
!> numbers of nodes that suit it: even, with fast transforms and coarse grids below. FFTW's basic
!> interface guarantees a plan for every grid.
module grid_transform
   use, intrinsic :: iso_c_binding, only: c_int, c_ptr
   use fftw, only: fftw_destroy_plan, fftw_estimate, fftw_execute_dft, fftw_execute_dft_c2r, &
      fftw_execute_dft_r2c, fftw_forward, fftw_plan_dft_1d, fftw_plan_dft_c2r, fftw_plan_dft_r2c
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: even_nodes, power_of_rows, transform_back, transform_field

   !> Chosen numbers of nodes are these times a power of two.
   integer, parameter :: sizes(*) = [8, 9, 10, 12, 14, 15], first_unit = 2

contains

   !> Computes spectrum(k, l) = sum of z exp(-2 pi i (k m/nx + l n/ny)) over the nodes (m, n) of
   !> `grid` = nx, ny (ny = 1: a line), for k = 0 ... nx/2, l = 0 ... ny - 1. `z` (nx*ny), x
   !> fastest.
   subroutine transform_field(grid, z, spectrum)
      integer, intent(in) :: grid(2)
      real(wp), intent(in) :: z(:)
      complex(wp), allocatable, intent(out) :: spectrum(:, :)
      real(wp), allocatable :: copy(:)
      type(c_ptr) :: plan

      allocate (spectrum(0:grid(1)/2, 0:grid(2) - 1), copy(size(z)))
      plan = fftw_plan_dft_r2c(2_c_int, int(grid(2:1:-1), c_int), copy, spectrum, fftw_estimate)
      copy = z
      call fftw_execute_dft_r2c(plan, copy, spectrum)
      call fftw_destroy_plan(plan)
   end subroutine transform_field

   !> Computes z = sum of spectrum exp(+2 pi i ...) over all k and l: `transform_field` and back
   !> multiplies by nx ny.
   subroutine transform_back(grid, spectrum, z)
      integer, intent(in) :: grid(2)
      complex(wp), intent(inout) :: spectrum(0:, 0:)
      real(wp), allocatable, intent(out) :: z(:)
      type(c_ptr) :: plan

      allocate (z(grid(1)*grid(2)))
      plan = fftw_plan_dft_c2r(2_c_int, int(grid(2:1:-1), c_int), spectrum, z, fftw_estimate)
      call fftw_execute_dft_c2r(plan, spectrum, z)
      call fftw_destroy_plan(plan)
   end subroutine transform_back

   !> Computes the mean over all rows z(:, j) of |sum of z exp(-2 pi i k m/nx)|^2 for k = 0 ...
   !> nx/2. Two rows are one complex row, whose squares at k and -k add up to twice theirs.
   !> Thread-safe.
   subroutine power_of_rows(z, power)
      real(wp), intent(in) :: z(:, :)
      real(wp), allocatable, intent(out) :: power(:)
      complex(wp), allocatable :: rows(:), spectrum(:)
      type(c_ptr) :: plan
      integer :: j, k, n

      n = size(z, 1)
      allocate (rows(n), spectrum(0:n))
      allocate (power(0:n/2), source=0.0_wp)
      !$omp critical (planning)
      plan = fftw_plan_dft_1d(int(n, c_int), rows, spectrum, fftw_forward, fftw_estimate)
      !$omp end critical (planning)
      do j = 1, size(z, 2), 2
         rows%re = z(:, j)
         rows%im = 0.0_wp
         if (j < size(z, 2)) rows%im = z(:, j + 1)
         call fftw_execute_dft(plan, rows, spectrum)
         spectrum(n) = spectrum(0)
         do k = 0, n/2
            associate (one => spectrum(k), opposite => spectrum(n - k))
               power(k) = power(k) + (one%re**2 + one%im**2 + opposite%re**2 + opposite%im**2)
            end associate
         end do
      end do
      power = 0.5_wp*power/size(z, 2)
      !$omp critical (planning)
      call fftw_destroy_plan(plan)
      !$omp end critical (planning)
   end subroutine power_of_rows

   !> Fewest nodes in one direction not below `least`, or the most not above `most`; 0: none.
   pure elemental function even_nodes(least, most) result(nodes)
      real(wp), intent(in) :: least, most
      integer :: nodes, i, unit

      nodes = 0
      unit = first_unit
      do
         do i = 1, size(sizes)
            if (sizes(i)*unit > most) return
            nodes = sizes(i)*unit
            if (nodes >= least) return
         end do
         unit = 2*unit
      end do
   end function even_nodes

end module grid_transform
