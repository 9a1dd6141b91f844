!> Measured heights that were read from a file.
module measured_heights
   use height_form, only: height_sums_t
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: heights_t

   !> Heights on a uniform grid.
   type :: heights_t
      !> Heights (nx*ny) [m], x fastest; not allocated: too many to be held.
      real(wp), allocatable :: z(:)
      !> nx, ny; ny = 1: a profile.
      integer :: grid(2) = 0
      !> Spacing of the nodes [m]; 0: the file does not tell.
      real(wp) :: spacing(2) = 0.0_wp
      !> Path of the file; not allocated: there is none.
      character(:), allocatable :: file
      !> Checksum of the heights.
      character(len=16) :: digits = ''
      !> Their sums, for slopes and form.
      type(height_sums_t) :: sums
   end type heights_t

end module measured_heights
