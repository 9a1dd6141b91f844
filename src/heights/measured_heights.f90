!> Measured heights that were read from a file, and a source of heights without their form.
module measured_heights
   use errors, only: error_t
   use height_form, only: form_t, height_sums_t, subtract_form
   use profile, only: height_source_t
   use kinds, only: int64, wp
   implicit none (type, external)
   private

   public :: height_request_t, heights_t, level_heights_t, put_level

   !> What the keys of a surface say of its file.
   type :: height_request_t
      !> Its path; names of the columns of positions and heights (or the path in HDF5), or empty.
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

   !> A source, and the form that is taken off what it gives.
   type, extends(height_source_t) :: level_heights_t
      class(height_source_t), allocatable, private :: source
      type(form_t), private :: form
   contains
      procedure :: get
   end type level_heights_t

contains

   !> Puts the heights of `source` without `form` in its place.
   subroutine put_level(source, form)
      class(height_source_t), allocatable, intent(inout) :: source
      type(form_t), intent(in) :: form
      type(level_heights_t), allocatable :: level

      allocate (level)
      level%nodes = source%nodes
      level%form = form
      call move_alloc(source, level%source)
      call move_alloc(level, source)
   end subroutine put_level

   !> Heights from number `first` on. Error: that of the source.
   subroutine get(self, first, z, error)
      class(level_heights_t), intent(in) :: self
      integer(int64), intent(in) :: first
      real(wp), intent(out) :: z(:)
      type(error_t), allocatable, intent(out) :: error

      call self%source%get(first, z, error)
      if (allocated(error)) return
      call subtract_form(self%form, first, z)
   end subroutine get

end module measured_heights
