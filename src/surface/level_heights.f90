!> Heights of a source without their form, of any number.
module level_heights
   use, intrinsic :: iso_fortran_env, only: int64
   use errors, only: error_t
   use height_form, only: form_t, take_off
   use height_source, only: height_source_t
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: level_heights_t, put_level

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
      call take_off(self%form, first, z)
   end subroutine get

end module level_heights
