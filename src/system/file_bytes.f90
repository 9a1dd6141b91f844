!> A file whose bytes are read and written at stated places, without a buffer: what was written
!> survives the process, and a full disk shows at once, unlike with FLUSH of Fortran. And the seal
!> of a file that this program will read again: a line behind its last byte, with the number of
!> bytes before it and their checksum, checked before the HDF5 library opens the file, since some
!> damaged files crash it. HDF5 does not see it; a program that changes the file takes it away.
module file_bytes
   use, intrinsic :: iso_c_binding, only: c_int, c_loc, c_null_char, c_size_t
   use c_library, only: c_close, c_open, c_pread, c_pwrite
   use disk_file, only: seal_bytes, seal_words
   use errors, only: error_t, fail, output_error
   use kinds, only: int64, wp
   implicit none (type, external)
   private

   public :: checksum_t, open_positional_file, positional_file_t, seal_fault, seal_file, sums_of

   !> Bytes of a real number; numbers that are read at once.
   integer, parameter, public :: real_bytes = 8
   integer(int64), parameter :: block_numbers = 65536_int64
   !> O_RDONLY and O_RDWR.
   integer(c_int), parameter :: read_only = 0_c_int, read_and_write = 2_c_int

   !> What `seal_fault` says of a file without a seal.
   character(*), parameter, public :: no_seal = &
      'it has no checksum: it is damaged, or of another version'

   !> An open file. Bytes are counted from 0. The first failure stays; what follows it does nothing.
   type :: positional_file_t
      character(:), allocatable :: path
      type(error_t), allocatable :: failure
      integer(c_int), private :: descriptor = -1_c_int
   contains
      procedure :: write_reals, read_reals
      procedure :: close => close_file
      procedure, private :: check
   end type positional_file_t

   !> Fletcher's sums of the bits so far, in 32-bit halves.
   type :: checksum_t
      integer(int64), private :: first = 0_int64, second = 0_int64
   contains
      procedure :: add
      procedure :: digits => digits_of
   end type checksum_t

   !> The largest prime below 2^32: modulo 2^32 - 1 all bits set would count like all bits clear.
   integer(int64), parameter :: modulus = 4294967291_int64
   !> Numbers after which the sums are reduced: below 2^60 by then.
   integer, parameter :: stretch = 4096
   !> The lower half of 64 bits.
   integer(int64), parameter :: half = 4294967295_int64

contains

   !> Opens an existing file, for reading alone or for both.
   subroutine open_positional_file(file, path, for_writing)
      type(positional_file_t), intent(out) :: file
      character(*), intent(in) :: path
      logical, intent(in) :: for_writing

      file%path = path
      file%descriptor = c_open(path//c_null_char, merge(read_and_write, read_only, for_writing))
      if (file%descriptor < 0_c_int) call fail(file%failure, output_error, 'cannot ' &
         //trim(merge('write', 'read ', for_writing))//' '//path//': it cannot be opened')
   end subroutine open_positional_file

   !> Writes `values` (n) from byte `place` on.
   subroutine write_reals(self, place, values)
      class(positional_file_t), intent(inout) :: self
      integer(int64), intent(in) :: place
      real(wp), intent(in), contiguous, target :: values(:)
      integer(c_size_t) :: bytes

      if (allocated(self%failure) .or. size(values) == 0) return
      bytes = size(values, kind=c_size_t)*real_bytes
      call self%check(c_pwrite(self%descriptor, c_loc(values), bytes, place) == bytes, 'write')
   end subroutine write_reals

   !> Reads `values` (n) from byte `place` on.
   subroutine read_reals(self, place, values)
      class(positional_file_t), intent(inout) :: self
      integer(int64), intent(in) :: place
      real(wp), intent(out), contiguous, target :: values(:)
      integer(c_size_t) :: bytes

      bytes = size(values, kind=c_size_t)*real_bytes
      if (.not. allocated(self%failure) .and. bytes > 0_c_size_t) call self%check( &
         c_pread(self%descriptor, c_loc(values), bytes, place) == bytes, 'read')
      if (allocated(self%failure)) values = 0.0_wp
   end subroutine read_reals

   !> Closes the file; twice does nothing.
   subroutine close_file(self)
      class(positional_file_t), intent(inout) :: self
      integer(c_int) :: status

      if (self%descriptor < 0_c_int) return
      status = c_close(self%descriptor)
      self%descriptor = -1_c_int
      call self%check(status == 0_c_int, 'write')
   end subroutine close_file

   !> Keeps the first failure.
   subroutine check(self, is_done, doing)
      class(positional_file_t), intent(inout) :: self
      logical, intent(in) :: is_done
      character(*), intent(in) :: doing

      if (is_done .or. allocated(self%failure)) return
      if (doing == 'read') then
         call fail(self%failure, output_error, 'cannot read '//self%path//': it ends too early')
      else
         call fail(self%failure, output_error, 'cannot write '//self%path// &
            ': no space (the disk is full, or a quota or a limit on the size of files is reached)')
      end if
   end subroutine check

   !> Seals the complete file `path`. Error: it cannot be read or written.
   subroutine seal_file(path, error)
      character(*), intent(in) :: path
      type(error_t), allocatable, intent(out) :: error
      type(positional_file_t) :: file
      type(checksum_t) :: sums
      integer(int64) :: bytes

      inquire (file=path, size=bytes)
      call open_positional_file(file, path, for_writing=.true.)
      sums = sums_of(file, bytes)
      call file%write_reals(bytes, transfer(seal_line(bytes, sums%digits()), [0.0_wp]))
      call file%close()
      if (allocated(file%failure)) error = file%failure
   end subroutine seal_file

   !> What the seal of `path` says against it; empty: it is, byte for byte, what was sealed.
   function seal_fault(path) result(fault)
      character(*), intent(in) :: path
      character(:), allocatable :: fault
      type(positional_file_t) :: file
      type(checksum_t) :: sums
      integer(int64) :: bytes
      real(wp) :: numbers(seal_bytes/real_bytes)
      character(len=seal_bytes) :: line
      character(len=16) :: digits

      fault = no_seal
      inquire (file=path, size=bytes)
      bytes = bytes - seal_bytes   ! before the seal
      if (bytes < 0_int64) return
      call open_positional_file(file, path, for_writing=.false.)
      call file%read_reals(bytes, numbers)
      line = transfer(numbers, line)
      digits = line(len(seal_words) + 1:)
      if (line == seal_line(bytes, digits) .and. .not. allocated(file%failure)) then
         sums = sums_of(file, bytes)
         fault = ''
         if (sums%digits() /= digits) fault = 'it is damaged: its checksum differs'
         if (allocated(file%failure)) fault = file%failure%message
      end if
      call file%close()
   end function seal_fault

   !> The line itself.
   pure function seal_line(bytes, digits) result(line)
      integer(int64), intent(in) :: bytes
      character(len=16), intent(in) :: digits
      character(len=seal_bytes) :: line

      write (line, '(a,a,a,i0,a)') seal_words, digits, ' of the ', bytes, ' bytes before'
      line(seal_bytes:) = new_line('a')
   end function seal_line

   !> Checksum of the first `bytes` of an open file, filled up with zeros to a multiple of 8.
   function sums_of(file, bytes) result(sums)
      type(positional_file_t), intent(inout) :: file
      integer(int64), intent(in) :: bytes
      type(checksum_t) :: sums
      real(wp), allocatable :: values(:)
      integer(int64), target :: last
      integer(int64) :: place

      allocate (values(block_numbers))
      do place = 0_int64, bytes - real_bytes, real_bytes*block_numbers
         associate (block => values(:min(block_numbers, (bytes - place)/real_bytes)))
            call file%read_reals(place, block)
            call sums%add(block)
         end associate
         if (allocated(file%failure)) return
      end do
      place = bytes - modulo(bytes, int(real_bytes, int64))
      if (place == bytes) return
      last = 0_int64
      call file%check(c_pread(file%descriptor, c_loc(last), bytes - place, place) &
         == bytes - place, 'read')
      call sums%add([transfer(last, 0.0_wp)])
   end function sums_of

   !> Adds `values`, the lower half of each before the upper one.
   pure subroutine add(self, values)
      class(checksum_t), intent(inout) :: self
      real(wp), intent(in) :: values(:)
      integer(int64) :: bits, first, second
      integer :: begin, i

      do begin = 1, size(values), stretch
         first = self%first
         second = self%second
         do i = begin, min(begin + stretch - 1, size(values))
            bits = transfer(values(i), bits)
            first = first + iand(bits, half)
            second = second + first
            first = first + shiftr(bits, 32)
            second = second + first
         end do
         self%first = modulo(first, modulus)
         self%second = modulo(second, modulus)
      end do
   end subroutine add

   !> The second and the first sum.
   pure function digits_of(self) result(digits)
      class(checksum_t), intent(in) :: self
      character(len=16) :: digits

      write (digits, '(2z8.8)') self%second, self%first
   end function digits_of

end module file_bytes
