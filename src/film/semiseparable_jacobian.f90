!> Solves the Newton system of the line contact on an even grid in O(n log n): GMRES on the exact
!> product, by FFT, preconditioned by nearly the same matrix (module bordered_system).
module semiseparable_jacobian
   use bordered_system, only: bordered_system_t, factor_bordered, solve_first
   use errors, only: error_t
   use gmres, only: gmres_t, solve_gmres
   use kinds, only: pi, wp
   use line_level, only: line_level_t
   use newton_work, only: linear_solver_t, reynolds_jacobian_t
   use semiseparable, only: exponential_sum_t, fit_exponentials, new_semiseparable, sample_points, &
      terms
   implicit none (type, external)
   private

   public :: semiseparable_jacobian_t

   !> The system; points to the level of one call.
   type, extends(bordered_system_t) :: even_system_t
      type(line_level_t), pointer :: level => null()
   contains
      procedure :: deflect => deflect_even
   end type even_system_t

   !> Work space, kept from call to call.
   type, extends(linear_solver_t) :: semiseparable_jacobian_t
      type(even_system_t) :: system
      type(gmres_t), private :: krylov
   contains
      procedure :: solve => solve_semiseparable_system
   end type semiseparable_jacobian_t

contains

   !> Factors the approximate Jacobian, solves with the factors, and continues with GMRES if the
   !> remainder exceeds the tolerance.
   subroutine solve_semiseparable_system(self, level, jacobian, is_cavitated, step, is_solved)
      class(semiseparable_jacobian_t), intent(inout), target :: self
      type(line_level_t), intent(inout), target :: level
      type(reynolds_jacobian_t), intent(in), target :: jacobian
      logical, intent(in) :: is_cavitated(:)
      real(wp), intent(inout) :: step(:)
      logical, intent(out) :: is_solved
      real(wp), allocatable :: remainder(:), product(:)
      real(wp) :: allowed, left, largest, share

      is_solved = self%system%n == level%n
      if (.not. is_solved) call prepare_kernel(self%system, level, is_solved)
      if (.not. is_solved) return
      associate (system => self%system)
         system%level => level
         system%by_pressure => jacobian%by_pressure(:, 1:level%n - 1)
         system%by_film => jacobian%by_film(:, 1:level%n - 1)
         system%is_cavitated = is_cavitated
         nullify (system%carry)
         if (allocated(jacobian%carry)) system%carry => jacobian%carry
         system%diagonal => jacobian%diagonal
         if (allocated(level%rough)) system%yields = -level%rough%slope(1:level%n - 1)
         call factor_bordered(system, is_solved)
         if (.not. is_solved) return
         allowed = self%tolerance*norm2(step)
         remainder = step
         call solve_first(system, step)
         allocate (product, mold=step)
         call system%multiply(step, product)
         self%iterations = 1
         remainder = remainder - product
         left = norm2(remainder)
         largest = maxval(abs(remainder(:level%n - 1)*jacobian%diagonal(1:level%n - 1)))
         is_solved = left <= allowed .and. largest <= self%goal
         if (is_solved .or. .not. left < huge(1.0_wp)) return
         share = allowed/left
         if (self%goal < largest) share = min(share, self%goal/largest)
         call solve_gmres(self%krylov, system, share, remainder, is_solved)
      end associate
      step = step + remainder
      self%iterations = 1 + self%krylov%iterations
      is_solved = is_solved .or. self%krylov%iterations > 0
   end subroutine solve_semiseparable_system

   !> Fits kappa_j = pi K_j/dX - ln dX, times the elasticity, and allocates storage, once per grid.
   subroutine prepare_kernel(system, level, is_ready)
      type(even_system_t), intent(inout) :: system
      type(line_level_t), intent(in) :: level
      logical, intent(out) :: is_ready
      type(exponential_sum_t) :: fit
      type(error_t), allocatable :: error
      real(wp) :: ratio(terms, 1)
      integer :: d, o

      associate (elastic => level%elastic, dx => level%dx, points => sample_points(level%n))
         call fit_exponentials(real(points, wp), pi*elastic%kernel(points)/dx - elastic%elasticity &
            *log(dx), fit, error)
         is_ready = .not. allocated(error)
         if (.not. is_ready) return
         ratio(:, 1) = exp(-fit%rate)
         call new_semiseparable(system%factors, level%n - 1, ratio, ratio, ratio)
         system%n = level%n
         system%weights = spread(dx, 1, level%n - 1)
         system%constant = -(fit%constant + elastic%elasticity*log(dx))/pi
         if (.not. allocated(system%rows)) allocate (system%rows(1))
         associate (row => system%rows(1))
            do o = -2, 1
               row%left(:, o) = dx/pi*fit%weight*ratio(:, 1)**o
               row%right(:, o) = dx/pi*fit%weight*ratio(:, 1)**(-o)
               do d = -2, 2
                  row%slots(o, d) = -elastic%kernel(abs(d - o)) - dx*system%constant
                  if (d < 0) row%slots(o, d) = row%slots(o, d) - dot_product(row%left(:, o), &
                     ratio(:, 1)**(-d))
                  if (d > 0) row%slots(o, d) = row%slots(o, d) - dot_product(row%right(:, o), &
                     ratio(:, 1)**d)
               end do
            end do
         end associate
      end associate
   end subroutine prepare_kernel

   !> h = K p by FFT; K is symmetric.
   subroutine deflect_even(self, p, h)
      class(even_system_t), intent(inout) :: self
      real(wp), intent(in), contiguous :: p(0:)
      real(wp), intent(out), contiguous :: h(0:)

      call self%level%elastic%apply(p, h)
   end subroutine deflect_even

end module semiseparable_jacobian
