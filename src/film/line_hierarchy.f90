!> Grids of a lubricated line contact, from the coarsest of the nested start to the finest, and the
!> resolved settings.
!>
!> What lies in front of the first node of a passage: the pressure of the smooth steady contact,
!> from a graded grid with a far inlet. It presses on the bodies and carries its load; the first
!> node has its pressure.
!>
!> So far out the pressure follows from the gap alone, dP/dX = lambda mu (H - H*)/(S H^3) with H
!> much larger than the film H* of the contact: what passes the contact hardly changes it.
module line_hierarchy
   use contact_moment, only: film_estimate, set_sliding
   use errors, only: error_t
   use features, only: surface_height
   use graded_nodes, only: monotone_cubic
   use half_space, only: deflection_by_elements
   use iteration_report, only: cycle_numbers_t, report_t
   use kinds, only: int64, wp
   use line_contact, only: line_contact_t
   use line_level, only: contact_load, line_level_t, new_level, set_plain_problem, turn
   use newton_work, only: newton_t
   use wall_clock, only: wall_seconds
   implicit none (type, external)
   private

   public :: line_hierarchy_t, new_hierarchy, new_level_of, pose_coarser_levels, &
      pose_steady_problem, relaxation_t, roughness_at, set_moment

   public :: coarsest_for_film, count_work, is_newton, report_cost

   !> The smoothers.
   integer, parameter, public :: smoother_block_jacobi = 1, smoother_gauss_seidel = 2, &
      smoother_line = 3, smoother_hybrid = 4

   !> The methods: FAS cycles; sweeps on the finest level alone; Newton steps on the finest level.
   integer, parameter, public :: method_fas = 1, method_block_jacobi = 2, &
      method_newton_dense = 3, method_newton_krylov = 4

   !> How to find a solution: the method, the numbers of its cycles (`coarse_sweeps` 0: the coarsest
   !> level of a cycle is solved exactly by Newton's method; of plain Block-Jacobi those between two
   !> evaluations of the residual), and when these end.
   type, extends(cycle_numbers_t) :: relaxation_t
      !> Without a fall of the smallest residual by 30 % in this many cycles it stagnates.
      integer :: patience = 12
      !> One of the method constants.
      integer :: method = method_fas
      !> One of the smoother constants.
      integer :: smoother = smoother_block_jacobi
      !> Coarse-grid visits in a cycle: 1 = V, 2 = W.
      integer :: visits = 1
      !> Smoothers use at most -bound dX as the kernel K_0/pi of a node itself; 0: the kernel as it
      !> is.
      real(wp) :: kernel_bound = 3.0_wp
      !> Film of the first start relative to the Moes film.
      real(wp) :: start_film = 1.0_wp
      !> Kappa scheme: the finest level is first solved by upwind2.
      logical :: thesis_first = .false.
      !> Starts from the solution on a graded grid.
      logical :: starts_graded = .false.
      !> The film is recomputed from the pressure before every sweep (false: H is relaxed with P, as
      !> in the thesis).
      logical :: film_is_recomputed = .true.
   end type relaxation_t

   !> All grids, and the data of their solution.
   type :: line_hierarchy_t
      !> The levels, the coarsest of the nested start first.
      type(line_level_t), allocatable :: levels(:)
      !> Coarsest level of the cycles of the present method (the finest for a method on one level),
      !> the same for FAS, and the finest level in use.
      integer :: coarsest = 1, fas_coarsest = 1, finest = 1
      type(relaxation_t) :: relaxation
      !> Exact solver of the coarsest level.
      type(newton_t) :: newton
      !> Bound on the Reynolds residual that cycles must reach; 0: not known.
      real(wp) :: goal = 0.0_wp
      !> The result uses the kappa space scheme, and so do coarse runs (module reynolds_line).
      logical :: is_kappa = .false.
      !> The nested start solves the two levels below the finest well enough to compare with it.
      logical :: wants_coarse_runs = .false.
      !> Wall time to set up the levels [s].
      real(wp) :: setup_seconds = 0.0_wp
      !> Sweeps weighted by nodes, in sweeps of the finest level.
      real(wp) :: work_units = 0.0_wp
      !> Pairs of transforms made before these levels.
      integer(int64) :: earlier_pairs = 0_int64
   end type line_hierarchy_t

   !> Bounds of the coarsest grid of the cycles (intervals).
   integer, parameter :: smallest_coarsest = 64, largest_coarsest = 512
   !> Fewest intervals on which asperities share the load.
   integer, parameter :: smallest_rough = 128
   !> Fewest intervals of a grid.
   integer, parameter :: smallest_grid = 8

contains

   !> Sets gap, load and first pressure of a level with the tail of its contact, if any. The cell of
   !> the first node begins half a spacing in front of it: there the tail ends.
   pure subroutine set_tail(level, contact)
      type(line_level_t), intent(inout) :: level
      type(line_contact_t), intent(in) :: contact
      real(wp), allocatable :: x(:), pressure(:)
      integer :: m

      if (.not. (contact%domain%has_tail .and. allocated(contact%tail))) return
      associate (tail => contact%tail)
         m = count(tail%x < level%x(0) - 0.5_wp*level%dx)
         x = [tail%x(:m), level%x(0) - 0.5_wp*level%dx, level%x(0)]
         pressure = monotone_cubic(tail%x, tail%pressure, x)
      end associate
      level%state%pressure(0) = pressure(m + 2)
      level%gap = level%gap - level%elastic%elasticity*deflection_by_elements(x(:m + 1), &
         pressure(:m + 1), level%x)
      level%load = level%load - dot_product(0.5_wp*(x(2:m + 1) - x(:m)), pressure(2:m + 1) &
         + pressure(:m))
      level%rhs_load = level%load   ! for a passage that resumes
   end subroutine set_tail

   !> Intervals of the coarsest grid that carries a film with a margin of 2 (semiseparable rule): dX
   !> <= min( sqrt(H_c/(1.7 max(M,1)^0.4)), max(1, sqrt(2 H_c))/2 ), at least `fewest` or 32; M with
   !> the sum velocity.
   pure integer function coarsest_for_film(contact, fewest) result(intervals)
      type(line_contact_t), intent(in) :: contact
      integer, intent(in), optional :: fewest
      real(wp) :: film, largest_dx

      film = film_estimate(contact)
      largest_dx = min(sqrt(film/(1.7_wp*max(contact%moes_m_sum, 1.0_wp)**0.4_wp)), &
         0.5_wp*max(1.0_wp, sqrt(2*film)))
      intervals = merge(smallest_rough, 32, allocated(contact%asperities))
      if (present(fewest)) intervals = fewest
      do while ((contact%domain%x_outlet - contact%domain%x_inlet)/intervals > largest_dx &
         .and. intervals < 2**24)
         intervals = 2*intervals
      end do
   end function coarsest_for_film

   !> Builds the grids for `contact%domain%intervals` = n, each with half the intervals of the next.
   !> `levels` > 0 fixes the number of levels of the cycles. n is a power of two, or a small odd
   !> number times one, which limits how coarse the grids become.
   subroutine new_hierarchy(hierarchy, contact, levels, error)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(line_contact_t), intent(in) :: contact
      integer, intent(in) :: levels
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: start
      integer :: coarsest, first, k, n

      n = contact%domain%intervals
      first = halved(n, coarsest_for_film(contact))
      if (levels > 0) then
         coarsest = halved(n, max(n/2**(levels - 1), smallest_grid))
      else
         coarsest = halved(n, max(first, min(largest_coarsest, max(smallest_coarsest, 4*first))))
      end if
      first = min(first, coarsest)
      if (allocated(hierarchy%levels)) deallocate (hierarchy%levels)
      allocate (hierarchy%levels(1 + doublings(first, n)))
      hierarchy%finest = size(hierarchy%levels)
      hierarchy%fas_coarsest = 1 + doublings(first, coarsest)
      hierarchy%coarsest = hierarchy%fas_coarsest
      start = wall_seconds()
      do k = 1, hierarchy%finest
         call new_level_of(contact, first*2**(k - 1), hierarchy%levels(k), error)
         if (allocated(error)) return
      end do
      hierarchy%setup_seconds = hierarchy%setup_seconds + wall_seconds() - start
      hierarchy%levels(hierarchy%finest)%is_kappa = hierarchy%is_kappa
   end subroutine new_hierarchy

   !> Allocates a level of `n` intervals on the domain of a contact, with what lies in front of it.
   subroutine new_level_of(contact, n, level, error)
      type(line_contact_t), intent(in) :: contact
      integer, intent(in) :: n
      type(line_level_t), intent(inout) :: level
      type(error_t), allocatable, intent(out) :: error

      call new_level(level, contact%lambda, contact%fluid, [contact%domain%x_inlet, &
         contact%domain%x_outlet], n, error, contact%elasticity)
      if (allocated(error)) return
      call set_tail(level, contact)
      level%slide_to_roll = contact%slide_to_roll
      level%oil%supply = contact%supply
      if (contact%conserves_oil) allocate (level%oil%saturation(0:n), source=1.0_wp)
      if (allocated(contact%heating)) then
         allocate (level%heat, level%oil%factor(0:n), level%oil%shift(0:n))
         level%heat%law = contact%heating
         allocate (level%heat%rise(0:n, 3), level%heat%change(0:n), source=0.0_wp)
         level%oil%factor = 1.0_wp
         level%oil%shift = 0.0_wp
      end if
      if (.not. allocated(contact%asperities)) return
      allocate (level%rough)
      allocate (level%state%asperity_pressure(0:n), level%state%separation(0:n), source=0.0_wp)
      associate (rough => level%rough)
         rough%law = contact%asperities
         rough%friction = rough%law%boundary_friction/contact%slope
         allocate (rough%pressure(0:n), rough%slope(0:n), rough%gap_slope(0:n), &
            rough%factor(0:n), rough%ln_slope(0:n), source=0.0_wp)
      end associate
   end subroutine new_level_of

   !> Halves n while it is even and the half is at least `least`; n itself if it is less.
   pure integer function halved(n, least) result(coarse)
      integer, intent(in) :: n, least

      coarse = n
      do while (modulo(coarse, 2) == 0 .and. coarse/2 >= least)
         coarse = coarse/2
      end do
   end function halved

   !> Number of doublings from `coarse` to `fine`.
   pure integer function doublings(coarse, fine) result(times)
      integer, intent(in) :: coarse, fine

      times = nint(log(real(fine, wp)/coarse)/log(2.0_wp))
   end function doublings

   !> Sets load, gap and speeds of all levels to those of a contact at `time`, if they change in
   !> time. The state of a level turns with the flow.
   pure subroutine set_moment(hierarchy, contact, time)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(line_contact_t), intent(in) :: contact
      real(wp), intent(in) :: time
      integer :: k

      if (.not. allocated(contact%duty)) return
      do k = 1, size(hierarchy%levels)
         associate (level => hierarchy%levels(k))
            level%moment = contact%duty%at(time)
            associate (now => level%moment)
               level%entrainment = abs(sum(now%speeds))
               if (level%direction*sum(now%speeds) < 0.0_wp) call turn(level)
               level%slide_to_roll = 2*level%direction*(now%speeds(2) - now%speeds(1))
               level%load = contact_load*now%load
               level%rhs_load = level%load
               level%gap(:) = 0.5_wp*level%x**2/now%radius
               call set_sliding(level%fluid, contact%lambda, now)
               if (allocated(level%heat)) level%heat%law%speeds = now%speeds &
                  *sum(contact%heating%speeds)
            end associate
         end associate
      end do
   end subroutine set_moment

   !> Height Psi_1 + Psi_2 of both surfaces on a level at time T (0:n).
   pure function roughness_at(contact, level, time) result(roughness)
      type(line_contact_t), intent(in) :: contact
      type(line_level_t), intent(in) :: level
      real(wp), intent(in) :: time
      real(wp) :: roughness(0:level%n)

      roughness = surface_height(contact%surface_1, level%direction*level%x, &
         time) + surface_height(contact%surface_2, level%direction*level%x, time)
   end function roughness_at

   !> Poses the steady problem on every level, with surfaces at time 0 (`with_roughness`) or smooth.
   pure subroutine pose_steady_problem(hierarchy, contact, with_roughness)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(line_contact_t), intent(in) :: contact
      logical, intent(in) :: with_roughness
      integer :: k

      do k = 1, size(hierarchy%levels)
         associate (level => hierarchy%levels(k))
            call set_plain_problem(level, 0*level%x)
            if (with_roughness) level%rhs_film = level%rhs_film - roughness_at(contact, level, &
               0.0_wp)
         end associate
      end do
   end subroutine pose_steady_problem

   !> Poses it on the levels below the finest, from the right side of the finest: cycles have left
   !> their coarse problems there.
   pure subroutine pose_coarser_levels(hierarchy)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      integer :: k

      do k = hierarchy%finest - 1, 1, -1
         call set_plain_problem(hierarchy%levels(k), 0*hierarchy%levels(k)%x)
         hierarchy%levels(k)%rhs_film = hierarchy%levels(k + 1)%rhs_film(::2)
      end do
   end subroutine pose_coarser_levels

   !> Whether the method is Newton's on the finest level, after which the film is that of pressure
   !> and H0.
   pure logical function is_newton(relaxation)
      type(relaxation_t), intent(in) :: relaxation

      is_newton = any(relaxation%method == [method_newton_krylov, method_newton_dense])
   end function is_newton

   !> Adds `sweeps` on level k to the work.
   pure subroutine count_work(hierarchy, k, sweeps)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      integer, intent(in) :: k, sweeps

      hierarchy%work_units = hierarchy%work_units &
         + sweeps*real(hierarchy%levels(k)%n, wp)/hierarchy%levels(size(hierarchy%levels))%n
   end subroutine count_work

   !> Writes the cost so far into the report.
   pure subroutine report_cost(hierarchy, report)
      type(line_hierarchy_t), intent(in) :: hierarchy
      type(report_t), intent(inout) :: report

      report%cost%fft_pairs = hierarchy%earlier_pairs + sum(hierarchy%levels%elastic%products)
      report%cost%work_units = hierarchy%work_units
   end subroutine report_cost

end module line_hierarchy
