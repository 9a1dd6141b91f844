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
   use own_file, only: seal_bytes, seal_words
   use positional_file, only: open_positional_file, positional_file_t, real_bytes
   implicit none (type, external)
   private

   public :: has_seal, seal_fault, seal_file

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

   !> What the seal of `path` says against it; empty: it is, byte for byte, what was sealed.
   function seal_fault(path) result(fault)
      character(*), intent(in) :: path
      character(:), allocatable :: fault
      type(positional_file_t) :: file
      integer(int64) :: bytes
      character(len=16) :: digits
      logical :: is_there

      fault = 'it has no checksum: it is damaged, or of another version'
      call read_seal(path, bytes, digits, is_there)
      if (.not. is_there) return
      call open_positional_file(file, path, for_writing=.false.)
      fault = ''
      if (digits_of(file, bytes) /= digits) fault = 'it is damaged: its checksum differs'
      call file%close()
      if (allocated(file%failure)) fault = file%failure%message
   end function seal_fault

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
      digits = line(len(seal_words) + 1:)
      is_there = line == seal_line(bytes, digits) .and. .not. allocated(file%failure)
   end subroutine read_seal

   !> The line itself.
   pure function seal_line(bytes, digits) result(line)
      integer(int64), intent(in) :: bytes
      character(len=16), intent(in) :: digits
      character(len=seal_bytes) :: line

      write (line, '(a,a,a,i0,a)') seal_words, digits, ' of the ', bytes, ' bytes before'
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
