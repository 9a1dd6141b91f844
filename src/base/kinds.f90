!> The one real kind of the project, its long integers, and the circle constant.
module kinds
   use, intrinsic :: iso_fortran_env, only: int64, real64
   implicit none (type, external)
   private

   public :: int64

   !> Working precision: IEEE 754 double.
   integer, parameter, public :: wp = real64
   !> Circle constant [-].
   real(wp), parameter, public :: pi = 3.14159265358979323846264338327950288_wp
end module kinds
