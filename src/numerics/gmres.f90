!> Right-preconditioned GMRES without restart (Saad, Iterative Methods for Sparse Linear Systems,
!> 2nd ed., section 9.3), for systems that a good preconditioner solves in a few iterations.
module gmres
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: krylov_system_t, gmres_t, solve_gmres

   !> A linear system with its product and an approximate inverse.
   type, abstract :: krylov_system_t
   contains
      procedure(product_interface), deferred :: multiply
      procedure(precondition_interface), deferred :: precondition
   end type krylov_system_t

   abstract interface
      !> y (n) = A x (n).
      subroutine product_interface(self, x, y)
         import :: krylov_system_t, wp
         class(krylov_system_t), intent(inout) :: self
         real(wp), intent(in) :: x(:)
         real(wp), intent(out) :: y(:)
      end subroutine product_interface

      !> x (n) = M x, with M close to the inverse of A.
      subroutine precondition_interface(self, x)
         import :: krylov_system_t, wp
         class(krylov_system_t), intent(inout) :: self
         real(wp), intent(inout) :: x(:)
      end subroutine precondition_interface
   end interface

   !> Basis and preconditioned basis (n, most + 1), kept between calls; of the last call, iterations
   !> and the weights in x of the vectors that `multiply` was given, by turn.
   type :: gmres_t
      integer :: max_iterations = 20
      integer :: iterations = 0
      real(wp), allocatable :: weights(:)
      real(wp), allocatable, private :: basis(:, :), directions(:, :)
   end type gmres_t

contains

   !> Solves A x = b to |b - A x| <= tolerance |b|; `x` (n) holds b on entry. `is_solved` is false
   !> if the iteration limit is reached or the numbers fail; x is then the best approximation, or
   !> unchanged.
   subroutine solve_gmres(gmres, system, tolerance, x, is_solved)
      type(gmres_t), intent(inout) :: gmres
      class(krylov_system_t), intent(inout) :: system
      real(wp), intent(in) :: tolerance
      real(wp), intent(inout) :: x(:)
      logical, intent(out) :: is_solved
      real(wp) :: hessenberg(gmres%max_iterations + 1, gmres%max_iterations)
      real(wp) :: cosine(gmres%max_iterations), sine(gmres%max_iterations), &
         rest(gmres%max_iterations + 1)
      real(wp) :: size_of_b
      integer :: j

      if (allocated(gmres%basis)) then
         if (size(gmres%basis, 1) /= size(x)) deallocate (gmres%basis, gmres%directions)
      end if
      if (.not. allocated(gmres%basis)) allocate (gmres%basis(size(x), gmres%max_iterations + 1), &
         gmres%directions(size(x), gmres%max_iterations))
      gmres%iterations = 0
      gmres%weights = [real(wp) ::]
      size_of_b = norm2(x)
      is_solved = size_of_b <= 0.0_wp
      if (is_solved .or. .not. size_of_b < huge(1.0_wp)) return
      rest(1) = size_of_b
      gmres%basis(:, 1) = x/size_of_b
      do j = 1, gmres%max_iterations
         gmres%directions(:, j) = gmres%basis(:, j)
         call system%precondition(gmres%directions(:, j))
         call system%multiply(gmres%directions(:, j), gmres%basis(:, j + 1))
         call orthogonalise(gmres%basis(:, 1:j + 1), hessenberg(:, j))
         if (.not. abs(hessenberg(j + 1, j)) < huge(1.0_wp)) return
         call rotate(hessenberg(:, j), cosine, sine, rest, j)
         gmres%iterations = j
         is_solved = abs(rest(j + 1)) <= tolerance*size_of_b
         if (is_solved) exit
      end do
      x = 0.0_wp
      do j = gmres%iterations, 1, -1   ! of the triangular system
         rest(j) = rest(j)/hessenberg(j, j)
         rest(1:j - 1) = rest(1:j - 1) - rest(j)*hessenberg(1:j - 1, j)
         x = x + rest(j)*gmres%directions(:, j)
      end do
      gmres%weights = rest(:gmres%iterations)
   end subroutine solve_gmres

   !> Orthogonalises the last vector against all before it (modified Gram-Schmidt); `column`
   !> receives the products and its length.
   pure subroutine orthogonalise(vectors, column)
      real(wp), intent(inout) :: vectors(:, :)
      real(wp), intent(out) :: column(:)
      integer :: i, last

      last = size(vectors, 2)
      column = 0.0_wp
      do i = 1, last - 1
         column(i) = dot_product(vectors(:, last), vectors(:, i))
         vectors(:, last) = vectors(:, last) - column(i)*vectors(:, i)
      end do
      column(last) = norm2(vectors(:, last))
      if (column(last) > 0.0_wp) vectors(:, last) = vectors(:, last)/column(last)
   end subroutine orthogonalise

   !> Applies the old Givens rotations to column j, and a new one that annihilates its last entry.
   pure subroutine rotate(column, cosine, sine, rest, j)
      real(wp), intent(inout) :: column(:), cosine(:), sine(:), rest(:)
      integer, intent(in) :: j
      real(wp) :: upper, length
      integer :: i

      do i = 1, j - 1
         upper = cosine(i)*column(i) + sine(i)*column(i + 1)
         column(i + 1) = -sine(i)*column(i) + cosine(i)*column(i + 1)
         column(i) = upper
      end do
      length = max(hypot(column(j), column(j + 1)), tiny(1.0_wp))
      cosine(j) = column(j)/length
      sine(j) = column(j + 1)/length
      column(j) = length
      column(j + 1) = 0.0_wp
      rest(j + 1) = -sine(j)*rest(j)
      rest(j) = cosine(j)*rest(j)
   end subroutine rotate

end module gmres
