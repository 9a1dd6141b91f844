!> Mathematical constants.
module constants
   use kinds, only: wp
   implicit none (type, external)
   private

   !> Circle constant [-].
   real(wp), parameter, public :: pi = 3.14159265358979323846264338327950288_wp
end module constants
