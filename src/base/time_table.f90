!> A quantity over time from the rows of a table, with its exact integral: linear or by monotone
!> cubics between rows (F. N. Fritsch and J. Butland, SIAM J. Sci. Stat. Comput. 5, 1984, 300);
!> repeated, or constant before the first and behind the last row.
module time_table
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: monotone_slopes, new_time_table, row_below, time_table_t

   !> The slope changes at a row if a parabola through its shorter neighbour would miss the values
   !> by this share of the largest.
   real(wp), parameter :: kink_share = 0.01_wp

   !> Rows and what is between them.
   type :: time_table_t
      !> Times of the rows (n), rising, and values there.
      real(wp), allocatable :: times(:), values(:)
      logical :: is_periodic = .false.
      !> Coefficients c of c_0 + c_1 s + c_2 s^2 + c_3 s^3 at the time s behind a row (0:3, n - 1),
      !> and the integral up to each row (n).
      real(wp), allocatable, private :: cubic(:, :), sums(:)
      !> Times at which the slope jumps, of one period.
      real(wp), allocatable, private :: kink_times(:)
   contains
      procedure :: value, integral, kinks
   end type time_table_t

contains

   !> A table of two rows or more at rising `times`; if it `is_periodic` the last ends the period.
   pure function new_time_table(times, values, is_linear, is_periodic) result(table)
      real(wp), intent(in) :: times(:), values(:)
      logical, intent(in) :: is_linear, is_periodic
      type(time_table_t) :: table
      real(wp) :: slope(0:size(times) + 1), rise(0:size(times)), gap(0:size(times)), change, least
      logical :: is_kink(size(times) - 1)
      integer :: before, i, n

      n = size(times)
      table%times = times
      table%values = values
      table%is_periodic = is_periodic
      gap(1:n - 1) = times(2:) - times(:n - 1)
      gap([0, n]) = merge(gap([n - 1, 1]), gap([1, n - 1]), is_periodic)
      rise(1:n - 1) = (values(2:) - values(:n - 1))/gap(1:n - 1)
      rise([0, n]) = merge(rise([n - 1, 1]), rise([1, n - 1]), is_periodic)
      slope = monotone_slopes(gap, rise)
      allocate (table%cubic(0:3, n - 1), source=0.0_wp)
      table%cubic(0, :) = values(:n - 1)
      if (is_linear) then
         table%cubic(1, :) = rise(1:n - 1)
      else
         table%cubic(1, :) = slope(1:n - 1)
         table%cubic(2, :) = (3*rise(1:n - 1) - 2*slope(1:n - 1) - slope(2:n))/gap(1:n - 1)
         table%cubic(3, :) = (slope(1:n - 1) + slope(2:n) - 2*rise(1:n - 1))/gap(1:n - 1)**2
      end if
      allocate (table%sums(n), source=0.0_wp)
      do i = 2, n
         table%sums(i) = table%sums(i - 1) + piece_integral(table%cubic(:, i - 1), gap(i - 1))
      end do
      least = kink_share*maxval(abs(values))
      is_kink = .false.
      do i = merge(1, 2, is_periodic), n - 1   ! of the two rows that join periods the first
         before = merge(n - 1, i - 1, i == 1)
         associate (left => gap(before), right => gap(i), c => table%cubic)
            change = abs(c(1, i) - c(1, before) - left*(2*c(2, before) + 3*left*c(3, before))) &
               *min(left, right) + merge(abs(values(1) - values(n)), 0.0_wp, i == 1)
         end associate
         is_kink(i) = change > least
      end do
      table%kink_times = pack(times(:n - 1), is_kink)
   end function new_time_table

   !> Slopes at n + 1 nodes by the weighted harmonic mean of the slopes `rise` (n) of the intervals
   !> of lengths `gap` (n) on both sides, 0 at extremes and at both ends.
   pure function monotone_slopes(gap, rise) result(slope)
      real(wp), intent(in) :: gap(:), rise(:)
      real(wp) :: slope(size(gap) + 1)
      integer :: i

      slope = 0.0_wp
      do i = 2, size(gap)
         if (rise(i - 1)*rise(i) > 0.0_wp) slope(i) = 3*(gap(i - 1) + gap(i))/((2*gap(i) &
            + gap(i - 1))/rise(i - 1) + (gap(i) + 2*gap(i - 1))/rise(i))
      end do
   end function monotone_slopes

   !> The value at `time`.
   pure real(wp) function value(self, time)
      class(time_table_t), intent(in) :: self
      real(wp), intent(in) :: time
      real(wp) :: cycles, s
      integer :: i

      call find_piece(self, time, i, s, cycles)
      associate (c => self%cubic)
         value = c(0, i) + s*(c(1, i) + s*(c(2, i) + s*c(3, i)))
      end associate
   end function value

   !> The integral from the first row to `time`.
   pure real(wp) function integral(self, time)
      class(time_table_t), intent(in) :: self
      real(wp), intent(in) :: time
      real(wp) :: cycles, s
      integer :: i, n

      n = size(self%times)
      call find_piece(self, time, i, s, cycles)
      integral = cycles*self%sums(n) + self%sums(i) + piece_integral(self%cubic(:, i), s)
      if (self%is_periodic) return
      integral = integral + min(time - self%times(1), 0.0_wp)*self%values(1) &
         + max(time - self%times(n), 0.0_wp)*self%values(n)
   end function integral

   !> Times behind `from` and before `to`, rising, at which the slope jumps.
   pure function kinks(self, from, to) result(times)
      class(time_table_t), intent(in) :: self
      real(wp), intent(in) :: from, to
      real(wp), allocatable :: times(:)
      real(wp) :: period
      integer :: first, last, number

      period = self%times(size(self%times)) - self%times(1)
      first = 0
      last = 0
      if (self%is_periodic) first = floor((from - self%times(1))/period)
      if (self%is_periodic) last = floor((to - self%times(1))/period)
      allocate (times(0))
      do number = first, last
         associate (all => self%kink_times + number*period)
            times = [times, pack(all, all > from .and. all < to)]
         end associate
      end do
   end function kinks

   !> The piece `i` that holds `time`, the time `s` behind its row, and the whole periods before.
   pure subroutine find_piece(table, time, i, s, cycles)
      type(time_table_t), intent(in) :: table
      real(wp), intent(in) :: time
      integer, intent(out) :: i
      real(wp), intent(out) :: s, cycles
      integer :: n

      n = size(table%times)
      s = time
      cycles = 0.0_wp
      associate (first => table%times(1), period => table%times(n) - table%times(1))
         if (table%is_periodic) cycles = floor((time - first)/period)
         s = min(max(time - cycles*period, first), table%times(n))
      end associate
      i = row_below(table%times, s)
      s = s - table%times(i)
   end subroutine find_piece

   !> The row k < n of rising values next below `value`, by bisection.
   pure integer function row_below(values, value) result(k)
      real(wp), intent(in) :: values(:), value
      integer :: above, middle

      k = 1
      above = size(values)
      do while (above - k > 1)
         middle = (k + above)/2
         if (values(middle) <= value) then
            k = middle
         else
            above = middle
         end if
      end do
   end function row_below

   !> The integral of a piece up to the time `s` behind its row.
   pure real(wp) function piece_integral(c, s) result(integral)
      real(wp), intent(in) :: c(0:3), s

      integral = s*(c(0) + s*(c(1)/2 + s*(c(2)/3 + s*c(3)/4)))
   end function piece_integral

end module time_table
