!> Text files: a whole one as one string, the check that it is text at all, and the lines of one of
!> any length, one after another from any place on. Lines end with LF, CR or CRLF.
module text_file
   use, intrinsic :: iso_fortran_env, only: int64
   use disk_file, only: file_fault
   use errors, only: error_t, fail, input_error
   use text, only: count_of, find_bad_byte, to_text
   implicit none (type, external)
   private

   public :: encoding_fault, open_lines, read_text_file, text_lines_t

   !> Largest file that is read as one string [bytes]; a namelist has a few thousand.
   integer(int64), parameter :: largest_file = 16777216_int64
   !> Longest line [bytes].
   integer, parameter :: longest_line = 65536
   character(*), parameter :: line_feed = achar(10), carriage_return = achar(13)
   character(*), parameter :: line_ends = line_feed//carriage_return

   !> An open file.
   type :: text_lines_t
      !> The present line, its first byte in the file (1 = the first) and its number.
      character(len=longest_line) :: line = ''
      integer :: length = 0
      integer(int64) :: place = 1_int64, number = 0_int64
      character(:), allocatable :: file
      !> Bytes of the file.
      integer(int64) :: bytes = 0_int64
      integer, private :: unit = -1
      !> The part of it that is held, from byte `base` on, filled up to `filled`, read up to `used`.
      integer(int64), private :: base = 1_int64
      character(len=longest_line + 2), private :: buffer = ''
      integer, private :: filled = 0, used = 0
   contains
      procedure :: seek, next
      procedure :: close => close_lines
      procedure, private :: refill
   end type text_lines_t

contains

   !> Reads `file` into `content`. A line feed ends each line: a carriage return that stands alone
   !> becomes one, and one before a line feed stays.
   !>
   !> Errors (input_error): no such file, a folder, pipe or device; not readable; above 16 MB.
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
         if (content(i:i) == carriage_return .and. content(i:min(i + 1, len(content))) &
            /= carriage_return//line_feed) content(i:i) = line_feed
      end do
   end subroutine read_text_file

   !> Opens `file` for reading byte by byte; it has this many `bytes`. Errors (input_error): the
   !> file does not exist, is a folder, a pipe or a device, cannot be opened.
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

   !> Opens `file` behind a byte order mark. Error: no such file; a folder, a pipe or a device.
   subroutine open_lines(lines, file, error)
      type(text_lines_t), intent(out) :: lines
      character(*), intent(in) :: file
      type(error_t), allocatable, intent(out) :: error

      lines%file = file
      call open_stream(file, lines%unit, lines%bytes, error)
      if (.not. allocated(error)) call lines%refill(error)   ! error: handed up
      if (lines%buffer(:3) == char(239)//char(187)//char(191)) lines%used = 3
   end subroutine open_lines

   !> Goes to byte `place` (1 = the first), where line `number` begins.
   subroutine seek(self, place, number)
      class(text_lines_t), intent(inout) :: self
      integer(int64), intent(in) :: place, number

      self%base = place
      self%filled = 0
      self%used = 0
      self%number = number - 1
   end subroutine seek

   !> The next line without its end; `is_there` is false at the end. Errors: unreadable; too long.
   subroutine next(self, is_there, error)
      class(text_lines_t), intent(inout) :: self
      logical, intent(out) :: is_there
      type(error_t), allocatable, intent(out) :: error
      integer :: end

      is_there = .true.
      end = self%used + scan(self%buffer(self%used + 1:self%filled), line_ends)
      if (end == self%used .or. end == self%filled) then   ! half a line, or half of its end
         call self%refill(error)
         if (allocated(error)) return
         end = scan(self%buffer(:self%filled), line_ends)
         is_there = self%filled > 0
         if (end == 0) end = self%filled + 1
      end if
      self%place = self%base + self%used
      self%number = self%number + 1
      self%length = end - 1 - self%used
      if (self%length > longest_line) then
         call fail(error, input_error, self%file//':'//to_text(self%number) &
            //': found a line of more than '//to_text(longest_line)//' characters')
         return
      end if
      self%line(:self%length) = self%buffer(self%used + 1:end - 1)
      if (self%buffer(end:min(end + 1, self%filled)) == carriage_return//line_feed) end = end + 1
      self%used = min(end, self%filled)
   end subroutine next

   !> Moves what is not used to the front of the buffer and fills the rest.
   subroutine refill(self, error)
      class(text_lines_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error
      character(len=256) :: message
      integer :: more, rest, status

      rest = self%filled - self%used
      self%buffer(:rest) = self%buffer(self%used + 1:self%filled)
      self%base = self%base + self%used
      self%used = 0
      more = int(min(int(len(self%buffer) - rest, int64), self%bytes - (self%base + rest) + 1))
      self%filled = rest
      if (more <= 0) return
      read (self%unit, pos=self%base + rest, iostat=status, iomsg=message) self%buffer(rest &
         + 1:rest + more)
      self%filled = rest + more
      if (status /= 0) call fail(error, input_error, self%file//': cannot be read: '//trim(message))
   end subroutine refill

   !> Closes the file.
   subroutine close_lines(self)
      class(text_lines_t), intent(inout) :: self

      close (self%unit)
   end subroutine close_lines

end module text_file
