!> Statistics of the film while rough surfaces pass, gathered step by step: how often and on what
!> share of the contact the film is thinner than given values, distributions of the smallest film
!> and the largest pressure, lambda ratio.
!>
!> The contact is the dry one of the reference load: -1 <= X <= 1 of a line. T = 0 counts only for
!> the smooth film: there the surfaces have entered it without a new solve.
module film_statistics
   use kinds, only: wp
   use line_state, only: line_state_t
   use quantities, only: central_value, smallest_film
   implicit none (type, external)
   private

   public :: add_start, add_time, film_statistics_t, new_statistics

   !> Bins of the distributions: equal in the logarithm, from 10^first on. The outer ones also count
   !> values beyond.
   integer, parameter, public :: bins_per_decade = 200, film_first = -7, pressure_first = -2
   integer, parameter :: bin_count = 2000

   !> Sums over the time steps so far. Dimensionless.
   type :: film_sums_t
      !> The contact is where q1 X^2 + 2 q2 X Y + q3 Y^2 <= 1.
      real(wp) :: border(3) = [1.0_wp, 0.0_wp, 0.0_wp]
      !> Number of time steps.
      real(wp) :: times = 0.0_wp
      !> Sums over time of the means over the contact: film, Psi_1 + Psi_2, its square.
      real(wp) :: film_sum = 0.0_wp, height_sum = 0.0_wp, square_sum = 0.0_wp
      !> H of the smooth contact at X = 0.
      real(wp) :: smooth_film = 0.0_wp
   end type film_sums_t

   !> The same, with thresholds and distributions.
   type, extends(film_sums_t) :: film_statistics_t
      !> Thresholds H (k) in any order; none: nothing is gathered.
      real(wp), allocatable :: thresholds(:)
      !> Time steps with a film below each threshold, and sum of the shares of the contact below it
      !> (k).
      real(wp), allocatable :: times_below(:), shares_below(:)
      !> Time steps by smallest film and by largest pressure of a node (bin_count).
      real(wp) :: film_bins(bin_count) = 0.0_wp, pressure_bins(bin_count) = 0.0_wp
   contains
      procedure :: lambda_ratio, rms_height
   end type film_statistics_t

contains

   !> Statistics for `thresholds` H (k).
   pure function new_statistics(thresholds) result(statistics)
      real(wp), intent(in) :: thresholds(:)
      type(film_statistics_t) :: statistics

      allocate (statistics%thresholds, source=thresholds)
      allocate (statistics%times_below(size(thresholds)), &
         statistics%shares_below(size(thresholds)), source=0.0_wp)
   end function new_statistics

   !> Sets the smooth film from the state at T = 0.
   pure subroutine add_start(statistics, state)
      type(film_statistics_t), intent(inout) :: statistics
      type(line_state_t), intent(in) :: state

      associate (smooth => state%film_thickness + heights_of(state), n => size(state%x))
         associate (middle => n*(size(smooth)/n/2))   ! row
            statistics%smooth_film = central_value(state%x, smooth(middle + 1:middle + n))
         end associate
      end associate
   end subroutine add_start

   !> Adds a time step.
   pure subroutine add_time(statistics, state)
      type(film_statistics_t), intent(inout) :: statistics
      type(line_state_t), intent(in) :: state
      logical :: inside(size(state%film_thickness))
      real(wp), allocatable :: y(:)
      integer :: j, k
      real(wp) :: share, smallest

      y = [0.0_wp]
      if (allocated(state%y)) y = state%y
      associate (x => state%x, q => statistics%border)
         inside = [(q(1)*x**2 + 2*q(2)*x*y(j) + q(3)*y(j)**2 <= 1.0_wp, j=1, size(y))]
      end associate
      smallest = smallest_film(state%x, state%film_thickness)
      share = 1.0_wp/max(count(inside), 1)
      associate (h => pack(state%film_thickness, inside), psi => pack(heights_of(state), inside))
         do k = 1, size(statistics%thresholds)
            if (smallest < statistics%thresholds(k)) statistics%times_below(k) = &
               statistics%times_below(k) + 1.0_wp
            statistics%shares_below(k) = statistics%shares_below(k) &
               + share*count(h < statistics%thresholds(k))
         end do
         statistics%film_sum = statistics%film_sum + share*sum(h)
         statistics%height_sum = statistics%height_sum + share*sum(psi)
         statistics%square_sum = statistics%square_sum + share*sum(psi**2)
      end associate
      call add_to_bin(statistics%film_bins, smallest, film_first)
      call add_to_bin(statistics%pressure_bins, maxval(state%pressure), pressure_first)
      statistics%times = statistics%times + 1.0_wp
   end subroutine add_time

   !> Psi_1 + Psi_2 on all nodes.
   pure function heights_of(state) result(heights)
      type(line_state_t), intent(in) :: state
      real(wp) :: heights(size(state%film_thickness))

      heights = 0.0_wp
      if (allocated(state%roughness_1)) heights = state%roughness_1 + state%roughness_2
   end function heights_of

   !> Adds one to the bin of `value`.
   pure subroutine add_to_bin(bins, value, first)
      real(wp), intent(inout) :: bins(:)
      real(wp), intent(in) :: value
      integer, intent(in) :: first
      integer :: i

      i = 1
      if (value > 0.0_wp) i = 1 + floor(bins_per_decade*(log10(value) - first))
      i = min(max(i, 1), size(bins))
      bins(i) = bins(i) + 1.0_wp
   end subroutine add_to_bin

   !> Composite rms height of both surfaces in the contact, over all times, in the unit of H.
   pure real(wp) function rms_height(self)
      class(film_statistics_t), intent(in) :: self

      rms_height = 0.0_wp
      if (self%times > 0.0_wp) rms_height = sqrt(max(self%square_sum/self%times &
         - (self%height_sum/self%times)**2, 0.0_wp))
   end function rms_height

   !> Lambda ratio: smooth central film over rms height; 0 if the surfaces are smooth.
   pure real(wp) function lambda_ratio(self)
      class(film_statistics_t), intent(in) :: self

      lambda_ratio = 0.0_wp
      if (self%rms_height() > 0.0_wp) lambda_ratio = self%smooth_film/self%rms_height()
   end function lambda_ratio

end module film_statistics
