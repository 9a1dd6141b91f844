!> Large pages of memory (Linux) for the fields of large grids.
!>
!> The system clears a page and enters it into its tables when it is first written to. With pages of
!> 2 MB in place of 4 kB that is 512 times rarer, and the processor finds columns of a field
!> without looking through long tables.
module large_pages
   use, intrinsic :: iso_c_binding, only: c_associated, c_int, c_intptr_t, c_null_ptr, c_ptr, &
      c_size_t
   use, intrinsic :: iso_fortran_env, only: int64
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: prefer_large_pages

   !> MADV_HUGEPAGE of madvise(2).
   integer(c_int), parameter :: large = 14_c_int
   !> Bytes of a large page; with less than two of them nothing is gained.
   integer(c_intptr_t), parameter :: page = 2097152_c_intptr_t
   !> Most that is taken at once [bytes]: larger blocks do not come from memory that is kept
   !> (`settle_memory`). This many of them at most.
   integer(c_intptr_t), parameter :: most = 536870912_c_intptr_t
   integer, parameter :: max_blocks = 256
   !> What a periodic area usually takes, elastic and in one load [bytes/node].
   real(wp), parameter :: of_node = 125.0_wp

   interface
      !> malloc(3).
      function c_malloc(size) bind(c, name='malloc') result(place)
         import :: c_ptr, c_size_t
         implicit none (type, external)
         integer(c_size_t), value :: size
         type(c_ptr) :: place
      end function c_malloc

      !> free(3).
      subroutine c_free(place) bind(c, name='free')
         import :: c_ptr
         implicit none (type, external)
         type(c_ptr), value :: place
      end subroutine c_free

      !> madvise(2).
      function c_madvise(place, length, advice) bind(c, name='madvise') result(status)
         import :: c_int, c_ptr, c_size_t
         implicit none (type, external)
         type(c_ptr), value :: place
         integer(c_size_t), value :: length
         integer(c_int), value :: advice
         integer(c_int) :: status
      end function c_madvise
   end interface

contains

   !> What an area of this many `nodes` takes next shall be on large pages, if the system has them.
   !> It is taken, told and given back; nothing is written to it, so it costs no memory.
   subroutine prefer_large_pages(nodes)
      integer(int64), intent(in) :: nodes
      type(c_ptr) :: block(max_blocks)
      integer(c_intptr_t) :: length, rest
      integer :: count, i

      count = 0
      rest = int(min(of_node*real(nodes, wp), real(most, wp)*max_blocks), c_intptr_t)
      do while (rest >= 2*page .and. count < max_blocks)
         length = min(rest, most)
         block(count + 1) = c_malloc(int(length, c_size_t))
         if (.not. c_associated(block(count + 1))) exit
         count = count + 1
         call tell(block(count), length)
         rest = rest - length
      end do
      do i = 1, count
         call c_free(block(i))
      end do
   end subroutine prefer_large_pages

   !> Tells the system about the whole large pages in `length` bytes at `place`. Where it has none
   !> nothing changes.
   subroutine tell(place, length)
      type(c_ptr), intent(in) :: place
      integer(c_intptr_t), intent(in) :: length
      integer(c_intptr_t) :: begin, end
      integer(c_int) :: status

      begin = transfer(place, begin)
      end = (begin + length)/page*page
      begin = (begin + page - 1)/page*page
      if (end > begin) status = c_madvise(transfer(begin, c_null_ptr), int(end - begin, &
         c_size_t), large)
   end subroutine tell

end module large_pages
