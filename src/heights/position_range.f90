!> Positions of measured heights, one after another: whether they are those of a uniform grid, and
!> its spacing. They may fall: then the heights are read from the other end.
module position_range
   use, intrinsic :: iso_fortran_env, only: int64
   use height_limits, only: spacing_fault
   use kinds, only: wp
   use text, only: counted
   implicit none (type, external)
   private

   public :: position_range_t

   !> Largest error of a position, in spacings, that still counts as uniform.
   real(wp), parameter :: max_uneven = 1.0e-3_wp

   !> The spacings that the positions so far allow, each within `max_uneven` of its place.
   type :: position_range_t
      !> How many positions there were.
      integer(int64) :: count = 0_int64
      !> They fall.
      logical :: falls = .false.
      real(wp), private :: first = 0.0_wp, last = 0.0_wp
      real(wp), private :: low = 0.0_wp, high = huge(1.0_wp)
      !> Marks of the positions that set the bounds.
      integer(int64), private :: low_mark = 0_int64, high_mark = 0_int64
   contains
      procedure :: add, fault, mark_of_fault, distance
   end type position_range_t

contains

   !> Takes the next position [m]; `mark` says where it stands.
   pure subroutine add(self, x, mark)
      class(position_range_t), intent(inout) :: self
      real(wp), intent(in) :: x
      integer(int64), intent(in) :: mark
      real(wp) :: distance, high, low

      if (self%count == 0) self%first = x
      if (self%count == 1) self%falls = x < self%first
      self%last = x
      self%count = self%count + 1
      if (self%count == 1) return
      distance = merge(self%first - x, x - self%first, self%falls)
      low = distance/(self%count - 1 + max_uneven)
      high = distance/(self%count - 1 - max_uneven)
      if (low > self%low) then
         self%low = low
         self%low_mark = mark
      end if
      if (high < self%high) then
         self%high = high
         self%high_mark = mark
      end if
   end subroutine add

   !> Distance of neighbouring positions [m], of two or more; positive if they rise or fall.
   pure function distance(self)
      class(position_range_t), intent(in) :: self
      real(wp) :: distance

      distance = (self%last - self%first)/(self%count - 1)
      if (self%falls) distance = -distance
   end function distance

   !> "found ..., expected ..." where the positions are not those of a uniform grid, or fall though
   !> they `must_rise`; else empty.
   pure function fault(self, must_rise)
      class(position_range_t), intent(in) :: self
      logical, intent(in) :: must_rise
      character(:), allocatable :: fault

      if (self%count < 2) then
         fault = 'found '//counted(int(self%count), 'row')//' of numbers, expected at least 2'
      else if (self%falls .and. must_rise) then
         fault = 'found falling positions, expected rising ones'
      else if (.not. self%distance() > 0.0_wp) then
         fault = 'found positions that neither rise nor fall, expected those of a uniform grid'
      else if (self%mark_of_fault() > 0) then
         fault = 'found uneven positions, expected a uniform grid'
      else
         fault = spacing_fault(self%distance())
      end if
   end function fault

   !> Mark of the position that does not fit the others; 0: all do.
   pure function mark_of_fault(self) result(mark)
      class(position_range_t), intent(in) :: self
      integer(int64) :: mark

      mark = 0_int64
      if (self%count < 2) return
      if (.not. self%distance() > 0.0_wp) return
      if (self%distance() < self%low) then
         mark = self%low_mark
      else if (self%distance() > self%high) then
         mark = self%high_mark
      end if
   end function mark_of_fault

end module position_range
