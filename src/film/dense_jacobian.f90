!> The Newton system of the line contact as a full matrix, solved by LAPACK in O(n^3): exact on
!> coarse grids, and the reference on fine ones.
module dense_jacobian
   use linear_systems, only: solve_dense, use_one_blas_thread
   use errors, only: error_t
   use kinds, only: wp
   use line_level, only: line_level_t
   use newton_work, only: linear_solver_t, reynolds_jacobian_t
   implicit none (type, external)
   private

   public :: dense_jacobian_t

   !> Matrix (n, n) and pivots, kept from call to call.
   type, extends(linear_solver_t) :: dense_jacobian_t
      real(wp), allocatable, private :: matrix(:, :)
      integer, allocatable, private :: pivots(:)
   contains
      procedure :: solve => solve_full_system
   end type dense_jacobian_t

contains

   !> Fills the matrix and solves.
   subroutine solve_full_system(self, level, jacobian, is_cavitated, step, is_solved)
      class(dense_jacobian_t), intent(inout), target :: self
      type(line_level_t), intent(inout), target :: level
      type(reynolds_jacobian_t), intent(in), target :: jacobian
      logical, intent(in) :: is_cavitated(:)
      real(wp), intent(inout) :: step(:)
      logical, intent(out) :: is_solved
      type(error_t), allocatable :: error
      integer :: n

      n = level%n
      if (allocated(self%matrix)) then
         if (size(self%pivots) /= n) deallocate (self%matrix, self%pivots)
      end if
      if (.not. allocated(self%matrix)) then
         allocate (self%matrix(n, n), self%pivots(n))
         call use_one_blas_thread()
      end if
      call fill_matrix(level, jacobian, is_cavitated, self%matrix)
      call solve_dense(self%matrix, step, self%pivots, error)
      is_solved = .not. allocated(error)
   end subroutine solve_full_system

   !> Rows 1..n-1: JP - JH K (identity where cavitated), last column sum of JH; row n: dX.
   pure subroutine fill_matrix(level, jacobian, is_cavitated, a)
      type(line_level_t), intent(in) :: level
      type(reynolds_jacobian_t), intent(in) :: jacobian
      logical, intent(in) :: is_cavitated(:)
      real(wp), intent(inout) :: a(:, :)
      integer :: i, j, n, o

      n = level%n
      associate (k => level%elastic%kernel, by_film => jacobian%by_film)
         do j = 1, n - 1
            do i = 1, n - 1
               a(i, j) = -by_film(-2, i)*k(abs(i - 2 - j)) - by_film(-1, i)*k(abs(i - 1 - j)) &
                  - by_film(0, i)*k(abs(i - j)) - by_film(1, i)*k(abs(i + 1 - j))
            end do
            do o = max(-2, 1 - j), min(2, n - 1 - j)
               a(j + o, j) = a(j + o, j) + jacobian%by_pressure(-o, j + o)
            end do
            where (is_cavitated) a(1:n - 1, j) = 0.0_wp
            if (is_cavitated(j)) a(j, j) = 1.0_wp
            a(n, j) = level%dx
         end do
         do i = 1, n - 1
            a(i, n) = merge(0.0_wp, sum(by_film(:, i)), is_cavitated(i))
         end do
         a(n, n) = 0.0_wp
      end associate
   end subroutine fill_matrix

end module dense_jacobian
