!> The seal of a file that this program will read again: a line behind its last byte, with the
!> number of bytes before it and their checksum. It covers everything in the file, names, attributes
!> and structure too, and is checked before the HDF5 library opens the file, since some damaged
!> files crash it. HDF5 and its tools do not see what lies behind the end of their own data; a
!> program that changes the file takes the line away.
module file_seal
   use, intrinsic :: iso_fortran_env, only: int64
   use checksum, only: checksum_t
   use errors, only: error_t
   use kinds, only: wp
   use positional_file, only: open_positional_file, positional_file_t, real_bytes
   implicit none (type, external)
   private

   public :: has_seal, is_whole, seal_file

   !> Length of the line, its end included [bytes]; its first words.
   integer, parameter :: seal_bytes = 80
   character(len=*), parameter :: beginning = 'asperity checksum '
   !> Numbers that are read at once.
   integer(int64), parameter :: block_numbers = 65536_int64

contains

   !> Seals the complete file `path`. Error: it cannot be read or written.
   subroutine seal_file(path, error)
      character(*), intent(in) :: path
      type(error_t), allocatable, intent(out) :: error
      type(positional_file_t) :: file
      integer(int64) :: bytes
      character(len=16) :: digits

      inquire (file=path, size=bytes)
      call open_positional_file(file, path, for_writing=.true.)
      digits = digits_of(file, bytes)
      call file%write_reals(bytes, transfer(seal_line(bytes, digits), [0.0_wp]))
      call file%close()
      if (allocated(file%failure)) error = file%failure
   end subroutine seal_file

   !> Whether `path` ends with a seal, right or wrong.
   function has_seal(path) result(answer)
      character(*), intent(in) :: path
      logical :: answer
      integer(int64) :: bytes
      character(len=16) :: digits

      call read_seal(path, bytes, digits, answer)
   end function has_seal

   !> Whether `path` ends with a seal and is, byte for byte, what was sealed.
   function is_whole(path) result(answer)
      character(*), intent(in) :: path
      logical :: answer
      type(positional_file_t) :: file
      integer(int64) :: bytes
      character(len=16) :: digits

      call read_seal(path, bytes, digits, answer)
      if (.not. answer) return
      call open_positional_file(file, path, for_writing=.false.)
      answer = digits_of(file, bytes) == digits
      call file%close()
      answer = answer .and. .not. allocated(file%failure)
   end function is_whole

   !> The last line of `path`: bytes before it and their checksum; `is_there`: it is a seal, and as
   !> long as it says.
   subroutine read_seal(path, bytes, digits, is_there)
      character(*), intent(in) :: path
      integer(int64), intent(out) :: bytes
      character(len=16), intent(out) :: digits
      logical, intent(out) :: is_there
      type(positional_file_t) :: file
      real(wp) :: numbers(seal_bytes/real_bytes, 1)
      character(len=seal_bytes) :: line

      inquire (file=path, size=bytes)
      bytes = bytes - seal_bytes
      is_there = bytes >= 0_int64
      digits = ''
      if (.not. is_there) return
      call open_positional_file(file, path, for_writing=.false.)
      call file%read_reals(bytes, numbers)
      call file%close()
      line = transfer(numbers, line)
      digits = line(len(beginning) + 1:)
      is_there = line == seal_line(bytes, digits) .and. .not. allocated(file%failure)
   end subroutine read_seal

   !> The line itself.
   pure function seal_line(bytes, digits) result(line)
      integer(int64), intent(in) :: bytes
      character(len=16), intent(in) :: digits
      character(len=seal_bytes) :: line

      write (line, '(a,a,a,i0,a)') beginning, digits, ' of the ', bytes, ' bytes before'
      line(seal_bytes:) = new_line('a')
   end function seal_line

   !> Checksum of the first `bytes` of an open file.
   function digits_of(file, bytes) result(digits)
      type(positional_file_t), intent(inout) :: file
      integer(int64), intent(in) :: bytes
      character(len=16) :: digits
      type(checksum_t) :: sums
      real(wp), allocatable :: values(:, :)
      integer(int64) :: count, place, rest

      allocate (values(block_numbers, 1))
      place = 0_int64
      do while (place + real_bytes <= bytes .and. .not. allocated(file%failure))
         count = min(block_numbers, (bytes - place)/real_bytes)
         call file%read_reals(place, values(:count, :))
         call sums%add(values(:count, 1))
         place = place + real_bytes*count
      end do
      rest = bytes - place
      if (rest > 0_int64) call sums%add([transfer(file%number_at(place, int(rest)), 0.0_wp)])
      digits = sums%digits()
   end function digits_of

end module file_seal
