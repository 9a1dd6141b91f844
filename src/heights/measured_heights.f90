!> Measured heights that were read from a file.
module measured_heights
   use height_form, only: height_sums_t
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: height_request_t, heights_t

   !> What the keys of a surface say of its file.
   type :: height_request_t
      !> Its path; names of the columns of positions and heights, the latter the path in HDF5; empty
      !> where they are not given.
      character(:), allocatable :: file, positions, dataset
      !> Units of positions and heights, blank where the file says them.
      character(len=12) :: units(2) = ''
   end type height_request_t

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
