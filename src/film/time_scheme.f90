!> Weights of the time schemes for steps of unequal length, and the lengths with which BDF2 begins.
!>
!> At T = 0 surfaces stand in a film that has not flowed around them: P(T) - P(0) then grows as a
!> fractional power of T, about T^0.8, and a first step of length dT leaves an error of that order
!> which no later step removes from the largest error over all times. The first steps are therefore
!> divided into parts. With parts of length ~ dT (T/dT)^0.6 every part has about the same error
!> (graded steps: H. Brunner, Math. Comp. 45, 1985, 417).
module time_scheme
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: derivative_weights, error_share, parabola_weights, part_ends

   !> Time T from which undivided steps suffice; exponent of the grading; shortest part, T
   !> (round-off).
   real(wp), parameter :: start_layer = 0.02_wp, grading = 0.6_wp, shortest_part = 1.0e-6_wp

contains

   !> Weights (new, old, older) of the values of y in h dy/dT at the new time, h the length of the
   !> step and `ratio` h over the length of the step before it; exact for parabolas: BDF2. Without
   !> an older value, backward Euler.
   pure function derivative_weights(ratio, has_older) result(weights)
      real(wp), intent(in) :: ratio
      logical, intent(in) :: has_older
      real(wp) :: weights(3)

      weights = [1.0_wp, -1.0_wp, 0.0_wp]
      if (has_older) weights = [(1.0_wp + 2.0_wp*ratio)/(1.0_wp + ratio), -(1.0_wp + ratio), &
         ratio**2/(1.0_wp + ratio)]
   end function derivative_weights

   !> Weights of the last `count` values (1 to 3, newest first) in the value at the new time by the
   !> polynomial of lowest degree. `ahead`: h over the length h1 of the last step; `back`: length h2
   !> of the step before it over h1.
   pure function parabola_weights(count, ahead, back) result(weights)
      integer, intent(in) :: count
      real(wp), intent(in) :: ahead, back
      real(wp) :: weights(3)

      select case (count)
      case (1)
         weights = [1.0_wp, 0.0_wp, 0.0_wp]
      case (2)
         weights = [1.0_wp + ahead, -ahead, 0.0_wp]
      case default
         weights = [(1.0_wp + ahead)*(1.0_wp + ahead + back)/(1.0_wp + back), &
            -ahead*(1.0_wp + ahead + back)/back, ahead*(1.0_wp + ahead)/(back*(1.0_wp + back))]
      end select
   end function parabola_weights

   !> Error of BDF2 over the difference of its value from that of the parabola through the three
   !> before, for small steps: `lengths` of the last step and of the two before it.
   pure real(wp) function error_share(lengths) result(share)
      real(wp), intent(in) :: lengths(3)
      real(wp) :: ratio, scheme, parabola

      ratio = lengths(1)/lengths(2)
      scheme = lengths(1)**3*(1 + ratio)**2/(ratio*(1 + 2*ratio))
      parabola = lengths(1)*(lengths(1) + lengths(2))*sum(lengths)
      share = scheme/(scheme + parabola)
   end function error_share

   !> Ends of the parts of a step, as shares of its length `time_step`, the last one 1: one part
   !> with backward Euler and after the start, else parts that follow the grading.
   pure function part_ends(scheme, step, time_step) result(ends)
      character(*), intent(in) :: scheme
      integer, intent(in) :: step
      real(wp), intent(in) :: time_step
      real(wp), allocatable :: ends(:)
      real(wp) :: wanted, exponent
      integer :: i, parts

      parts = 1
      exponent = 1.0_wp
      if (scheme == 'bdf2' .and. step*time_step < start_layer) then
         wanted = (start_layer/(step*time_step))**grading
         if (step == 1) then
            exponent = 1.0_wp/(1.0_wp - grading)
            parts = nint(exponent*wanted)
         else
            parts = nint(wanted)
         end if
         parts = max(1, min(parts, int((time_step/shortest_part)**(1.0_wp/exponent))))
      end if
      ends = [((real(i, wp)/parts)**exponent, i=1, parts)]
   end function part_ends

end module time_scheme
