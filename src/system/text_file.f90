!> A whole text file as one string, and the checks that it is text at all.
module text_file
   use, intrinsic :: iso_fortran_env, only: int64
   use errors, only: error_t, fail, input_error
   use file_identity, only: file_fault
   use text, only: count_of, to_text
   implicit none (type, external)
   private

   public :: encoding_fault, open_stream, read_text_file

   !> Largest file that is read [bytes]; a namelist has a few thousand.
   integer(int64), parameter :: largest_file = 16777216_int64
   character(*), parameter :: line_feed = achar(10), line_end = achar(13)//line_feed

contains

   !> Reads `file` into `content`. A line feed ends each line: a carriage return that stands alone
   !> becomes one, and one before a line feed stays.
   !>
   !> Errors (input_error): the file does not exist, is a folder, a pipe or a device, cannot be
   !> read, is larger than 16 MB.
   subroutine read_text_file(file, content, error)
      character(*), intent(in) :: file
      character(:), allocatable, intent(out) :: content
      type(error_t), allocatable, intent(out) :: error
      integer :: i, unit, status
      integer(int64) :: bytes
      character(len=256) :: message

      content = ''
      call open_stream(file, unit, bytes, error)
      if (allocated(error)) return
      if (bytes > largest_file) then
         call fail(error, input_error, file // ': found ' // to_text(bytes) // ' bytes, '// &
            'expected a namelist of at most 16 MB')
      else if (bytes > 0) then
         deallocate (content)
         allocate (character(len=bytes) :: content)
         read (unit, iostat=status, iomsg=message) content
         if (status /= 0) call fail(error, input_error, file // ': cannot be read: ' &
            // trim(message))
      end if
      close (unit, iostat=status)
      do i = 1, len(content)
         if (content(i:i) /= achar(13) .or. content(i:min(i + 1, len(content))) &
            == line_end) cycle
         content(i:i) = line_feed
      end do
   end subroutine read_text_file

   !> Opens `file` for reading byte by byte; it has so many `bytes`. Errors (input_error): the file
   !> does not exist, is a folder, a pipe or a device, cannot be opened.
   subroutine open_stream(file, unit, bytes, error)
      character(*), intent(in) :: file
      integer, intent(out) :: unit
      integer(int64), intent(out) :: bytes
      type(error_t), allocatable, intent(out) :: error
      integer :: status
      character(len=256) :: message

      unit = -1
      bytes = 0_int64
      if (file_fault(file) /= '') then
         call fail(error, input_error, file // ': ' // file_fault(file))
         return
      end if
      open (newunit=unit, file=file, access='stream', form='unformatted', action='read', &
         status='old', iostat=status, iomsg=message)
      if (status == 0) inquire (unit=unit, size=bytes)
      if (status /= 0) call fail(error, input_error, file // ': cannot be opened: ' &
         // trim(message))
   end subroutine open_stream

   !> What is wrong with `content` as a text in UTF-8, and at which byte; empty: nothing.
   pure subroutine encoding_fault(content, fault, place)
      character(*), intent(in) :: content
      character(:), allocatable, intent(out) :: fault
      integer, intent(out) :: place
      character(*), parameter :: null = achar(0), mark = char(255)//char(254), &
         other_mark = char(254)//char(255)
      character(len=2) :: head
      character(len=4) :: byte

      fault = ''
      place = find_bad_byte(content)
      if (place == 0) return
      write (byte, '(a,z2.2)') '0x', iachar(content(place:place))
      fault = 'the byte '//byte
      head = content
      if (all(head /= [mark, other_mark]) .and. count_of(null, head) /= 1) return
      fault = 'UTF-16'
      place = 1
   end subroutine encoding_fault

   !> Position of the first byte of `content` that is not UTF-8 text (0: none). Tab, line feed, form
   !> feed and carriage return are text; other control characters are not.
   pure function find_bad_byte(content) result(position)
      character(*), intent(in) :: content
      integer :: position, i, j, code, following

      i = 1
      do while (i <= len(content))
         position = i
         code = iachar(content(i:i))
         select case (code)
         case (9, 10, 12, 13, 32:126)
            following = 0
         case (194:223)
            following = 1
         case (224:239)
            following = 2
         case (240:244)
            following = 3
         case default
            return
         end select
         if (i + following > len(content)) return
         do j = i + 1, i + following
            if (iand(iachar(content(j:j)), 192) /= 128) return
         end do
         i = i + following + 1
      end do
      position = 0
   end function find_bad_byte

end module text_file
