!> The one real kind of the project.
module kinds
   use, intrinsic :: iso_fortran_env, only: real64
   implicit none (type, external)
   private

   !> Working precision: IEEE 754 double.
   integer, parameter, public :: wp = real64
end module kinds
