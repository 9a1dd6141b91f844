!> Source of the heights of a profile that is too long for memory: any part of them, in any order.
module height_source
   use, intrinsic :: iso_fortran_env, only: int64
   use errors, only: error_t
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: height_source_t

   !> Equally spaced heights, numbered 0 ... nodes - 1.
   type, abstract :: height_source_t
      integer(int64) :: nodes = 0_int64
   contains
      !> Returns heights [m] from number `first` on, as many as `z` has.
      procedure(get_interface), deferred :: get
   end type height_source_t

   abstract interface

      !> The same part always gives the same bits. Error: the source cannot provide it.
      subroutine get_interface(self, first, z, error)
         import :: error_t, height_source_t, int64, wp
         implicit none (type, external)
         class(height_source_t), intent(in) :: self
         integer(int64), intent(in) :: first
         real(wp), intent(out) :: z(:)
         type(error_t), allocatable, intent(out) :: error
      end subroutine get_interface

   end interface

end module height_source
