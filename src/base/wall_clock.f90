!> Wall time.
module wall_clock
   use kinds, only: int64, wp
   implicit none (type, external)
   private

   public :: wall_seconds

contains

   !> Seconds on a clock with an arbitrary zero: only differences have a meaning.
   recursive real(wp) function wall_seconds() result(seconds)
      integer(int64) :: ticks, rate

      call system_clock(ticks, rate)
      seconds = real(ticks, wp)/real(rate, wp)
   end function wall_seconds

end module wall_clock
