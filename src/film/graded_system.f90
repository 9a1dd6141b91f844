!> The Newton system of a graded line, or the transposed one, in O(n): module bordered_system with
!> the kernel of uneven nodes.
module graded_system
   use bordered_system, only: bordered_system_t, factor_bordered, solve_first
   use errors, only: error_t
   use gmres, only: gmres_t, solve_gmres
   use graded_kernel, only: element_exponentials, graded_kernel_t, new_graded_kernel
   use graded_line, only: graded_line_t
   use kinds, only: pi, wp
   use semiseparable, only: exponential_sum_t, fit_exponentials, new_semiseparable, terms
   implicit none (type, external)
   private

   public :: factorise, graded_factors_t, solve_system

   !> Exponentials that decay further than this within a row's elements are left out of it.
   real(wp), parameter :: least_decay = 1.0e-8_wp
   !> Distances at which the kernel is fitted.
   integer, parameter :: points = 80

   !> The system, with a kernel that is as good as linear solutions have to be.
   type, extends(bordered_system_t) :: graded_system_t
      type(graded_kernel_t) :: kernel
   contains
      procedure :: deflect
   end type graded_system_t

   !> Factors, and what they need. `is_sound`: they exist.
   type :: graded_factors_t
      logical :: is_sound = .false.
      !> Accuracy of the kernel in the products.
      real(wp) :: accuracy = 1.0e-5_wp
      !> Nodes for which the rows of the kernel are ready (0:n).
      real(wp), allocatable, private :: x(:)
      real(wp), allocatable, private :: by_pressure(:, :), by_film(:, :)
      type(graded_system_t) :: system
      type(gmres_t), private :: krylov
   end type graded_factors_t

contains

   !> Factors the matrix of the line's last evaluation.
   subroutine factorise(line, factors)
      type(graded_line_t), intent(in) :: line
      type(graded_factors_t), intent(inout), target :: factors
      real(wp) :: unused(line%n)
      logical :: is_ready
      integer :: i

      is_ready = allocated(factors%x)
      if (is_ready) is_ready = size(factors%x) == size(line%x)
      if (is_ready) is_ready = all(abs(factors%x - line%x) <= 0.0_wp)
      if (.not. is_ready) then
         call prepare_rows(line, factors%accuracy, factors%system, factors%is_sound)
         if (.not. factors%is_sound) return
         factors%x = line%x(:)
         factors%by_pressure = line%by_pressure
         factors%by_film = line%by_film
      end if
      associate (system => factors%system)
         system%is_cavitated = line%is_cavitated
         do i = 1, line%n - 1
            factors%by_pressure(:, i) = line%by_pressure(:, i)/line%diagonal(i)
            factors%by_film(:, i) = line%by_film(:, i)/line%diagonal(i)
         end do
         system%by_pressure => factors%by_pressure(:, :)   ! from 1
         system%by_film => factors%by_film(:, :)
         call factor_bordered(system, factors%is_sound)
         unused = 0.0_wp
         if (factors%is_sound) call solve_first(system, unused)
      end associate
   end subroutine factorise

   !> Solves with fresh factors, to a remainder of a share `tolerance` of the right side, that `x`
   !> (n) holds on entry. Where GMRES fails, `x` is the best that it found.
   subroutine solve_system(factors, tolerance, x, is_transposed)
      type(graded_factors_t), intent(inout), target :: factors
      real(wp), intent(in) :: tolerance
      real(wp), intent(inout) :: x(:)
      logical, intent(in) :: is_transposed
      logical :: is_solved

      factors%system%is_transposed = is_transposed
      call solve_gmres(factors%krylov, factors%system, tolerance, x, is_solved)
   end subroutine solve_system

   !> Fits ln d between the smallest spacing and the length, and fills the rows of the kernel.
   subroutine prepare_rows(line, accuracy, system, is_ready)
      type(graded_line_t), intent(in) :: line
      real(wp), intent(in) :: accuracy
      type(graded_system_t), intent(inout) :: system
      logical, intent(out) :: is_ready
      type(exponential_sum_t) :: fit
      type(error_t), allocatable :: error
      real(wp), dimension(terms, line%n) :: decay, near, far
      real(wp), dimension(terms, line%n - 1) :: onward, backward
      real(wp) :: distances(points), smallest
      integer :: i, n

      n = line%n
      smallest = minval(line%spacing)
      distances = [(((line%x(n) - line%x(0))/smallest)**(real(i, wp)/(points - 1)), &
         i=0, points - 1)]
      call fit_exponentials(distances, log(distances), fit, error)
      is_ready = .not. allocated(error)
      if (.not. is_ready) return
      call element_exponentials(fit%rate/smallest, line%spacing, [(terms, i=1, n)], decay, near, &
         far)
      onward = far(:, 2:) + decay(:, 2:)*near(:, :n - 1)
      backward = far(:, :n - 1) + decay(:, :n - 1)*near(:, 2:)
      call new_semiseparable(system%factors, n - 1, decay(:, 2:), onward, backward)
      system%n = n
      call new_graded_kernel(system%kernel, line%x, line%elasticity, accuracy)
      system%weights = line%elastic%weights(1:n - 1)
      system%constant = -line%elasticity/pi*(fit%constant + log(smallest))
      if (allocated(system%rows)) deallocate (system%rows)
      allocate (system%rows(n - 1))
      do i = 1, n - 1
         call fill_row(line, line%elasticity/pi*fit%weight, decay, onward, backward, i, system)
      end do
   end subroutine prepare_rows

   !> Fills row `i` of the kernel with exponentials of the given `weight`, their decay along the
   !> elements and what the columns add to them.
   pure subroutine fill_row(line, weight, decay, onward, backward, i, system)
      type(graded_line_t), intent(in) :: line
      real(wp), intent(in) :: weight(terms), decay(:, :), onward(:, :), backward(:, :)
      integer, intent(in) :: i
      type(graded_system_t), intent(inout) :: system
      real(wp) :: two(terms), column(terms)
      integer :: d, o

      associate (row => system%rows(i), band => line%elastic%band, one => decay(:, i), &
         next => decay(:, i + 1))
         two = one*decay(:, max(i - 1, 1))
         do o = -2, 1
            row%left(:, o) = 0.0_wp
            row%right(:, o) = 0.0_wp
         end do
         where (two > least_decay)
            row%left(:, -2) = weight/two
            row%left(:, -1) = weight/one
            row%left(:, 0) = weight
            row%left(:, 1) = weight*next
         end where
         where (next > least_decay)
            row%right(:, -2) = weight*two
            row%right(:, -1) = weight*one
            row%right(:, 0) = weight
            row%right(:, 1) = weight/next
         end where
         row%slots = 0.0_wp
         do d = max(-2, 1 - i), min(2, line%n - 1 - i)
            select case (d)
            case (:-1)
               column = onward(:, i + d)
            case (1:)
               column = backward(:, i + d)
            case default
               column = 0.0_wp
            end select
            if (d == -2) column = column*one
            if (d == 2) column = column*next
            do o = max(-2, -i), 1
               row%slots(o, d) = -band(o - d, i + d) - system%constant*system%weights(i &
                  + d) - dot_product(merge(row%left(:, o), row%right(:, o), d < 0), column)
            end do
         end do
      end associate

   end subroutine fill_row

   !> h = K p, or K^T p of a transposed system.
   subroutine deflect(self, p, h)
      class(graded_system_t), intent(inout) :: self
      real(wp), intent(in), contiguous :: p(0:)
      real(wp), intent(out), contiguous :: h(0:)

      if (self%is_transposed) then
         call self%kernel%multiply_transposed(p, h)
      else
         call self%kernel%multiply(p, h)
      end if
   end subroutine deflect

end module graded_system
