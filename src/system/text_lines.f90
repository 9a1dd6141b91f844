!> The lines of a text file of any length, one after another from any place on. Each ends with LF,
!> CR or CRLF; the byte order mark of UTF-8 before the first one is left out.
module text_lines
   use, intrinsic :: iso_fortran_env, only: int64
   use errors, only: error_t, fail, input_error
   use text, only: to_text
   use text_file, only: open_stream
   implicit none (type, external)
   private

   public :: open_lines, text_lines_t

   character(*), parameter :: line_feed = achar(10), carriage_return = achar(13)
   character(*), parameter :: line_ends = line_feed//carriage_return
   !> Longest line [bytes].
   integer, parameter, public :: longest_line = 65536

   !> An open file.
   type :: text_lines_t
      !> The present line, its first byte in the file and its number, counted from `seek` on.
      character(len=longest_line) :: line = ''
      integer :: length = 0
      integer(int64) :: place = 1_int64
      integer(int64) :: number = 0_int64
      character(:), allocatable :: file
      integer, private :: unit = -1
      !> Bytes of the file.
      integer(int64) :: bytes = 0_int64
      !> The part of it that is held, from byte `base` on, filled up to `filled`, read up to `used`.
      integer(int64), private :: base = 1_int64
      character(len=longest_line), private :: buffer = ''
      integer, private :: filled = 0, used = 0
      !> The line before ended with CR: an LF that follows belongs to it.
      logical, private :: after_return = .false.
   contains
      !> Goes to byte `place` (1 = the first), where line `number` begins.
      procedure :: seek
      !> Reads the next line; `is_there` is false behind the last one.
      procedure :: next
      procedure :: close => close_lines
      procedure, private :: refill
   end type text_lines_t

contains

   !> Opens `file` at its first line. Error: no such file; a folder, a pipe or a device.
   subroutine open_lines(lines, file, error)
      type(text_lines_t), intent(out) :: lines
      character(*), intent(in) :: file
      type(error_t), allocatable, intent(out) :: error

      lines%file = file
      call open_stream(file, lines%unit, lines%bytes, error)
      if (.not. allocated(error)) call lines%refill(error)   ! error: handed up
      if (lines%buffer(:3) == char(239)//char(187)//char(191)) lines%used = 3
   end subroutine open_lines

   !> Goes elsewhere.
   subroutine seek(self, place, number)
      class(text_lines_t), intent(inout) :: self
      integer(int64), intent(in) :: place, number

      self%base = place
      self%filled = 0
      self%used = 0
      self%after_return = .false.
      self%number = number - 1
   end subroutine seek

   !> The next line without its end. Errors: the file cannot be read; the line is too long.
   subroutine next(self, is_there, error)
      class(text_lines_t), intent(inout) :: self
      logical, intent(out) :: is_there
      type(error_t), allocatable, intent(out) :: error
      integer :: length

      is_there = .true.
      if (self%after_return .and. self%used == self%filled) call self%refill(error)
      if (allocated(error)) return
      if (self%after_return .and. self%used < self%filled) then
         if (self%buffer(self%used + 1:self%used + 1) == line_feed) self%used = self%used + 1
      end if
      length = scan(self%buffer(self%used + 1:self%filled), line_ends) - 1
      if (length < 0) then
         call self%refill(error)
         if (allocated(error)) return
         length = scan(self%buffer(:self%filled), line_ends) - 1
      end if
      self%place = self%base + self%used
      self%number = self%number + 1
      self%length = merge(self%filled, length, length < 0)
      if (length < 0) then
         is_there = self%filled > 0
         if (self%filled == len(self%buffer) .and. self%base &
            + self%filled <= self%bytes) call fail(error, input_error, &
            self%file//':'//to_text(self%number)//': found a line of more than ' &
               //to_text(len(self%buffer))//' characters')
      end if
      self%line(:self%length) = self%buffer(self%used + 1:self%used + self%length)
      self%used = min(self%used + self%length + 1, self%filled)
      self%after_return = self%used > 0 .and. length >= 0
      if (self%after_return) self%after_return = self%buffer(self%used:self%used) == carriage_return
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

end module text_lines
