!> A file whose bytes are read and written at stated places, without a buffer in between (POSIX
!> pread and pwrite): what was written survives the process, and a full disk shows at once. (FLUSH
!> of Fortran does not report a failure.)
module positional_file
   use, intrinsic :: iso_c_binding, only: c_int, c_int64_t, c_loc, c_ptr, c_size_t
   use, intrinsic :: iso_fortran_env, only: int64, int8
   use errors, only: error_t, fail, output_error
   use kinds, only: wp
   use operating_system, only: closed, opened
   use signal_calls, only: c_pread
   implicit none (type, external)
   private

   public :: open_positional_file, positional_file_t

   !> Bytes of a real number.
   integer, parameter, public :: real_bytes = 8

   !> An open file. The first failure stays; what follows it does nothing.
   type :: positional_file_t
      character(:), allocatable :: path
      type(error_t), allocatable :: failure
      integer(c_int), private :: descriptor = -1_c_int
   contains
      !> Writes real numbers from byte `place` on (0 = the first).
      procedure :: write_reals
      procedure :: read_reals
      !> Writes and reads a number without sign, the lowest byte first.
      procedure :: write_number
      procedure :: number_at
      procedure :: close => close_file
      procedure, private :: check
   end type positional_file_t

   interface
      !> pwrite(2): bytes that were written, below 0 for an error.
      function c_pwrite(descriptor, bytes, count, place) bind(c, name='pwrite') result(done)
         import :: c_int, c_int64_t, c_ptr, c_size_t
         implicit none (type, external)
         integer(c_int), value :: descriptor
         type(c_ptr), value :: bytes
         integer(c_size_t), value :: count
         integer(c_int64_t), value :: place
         integer(c_size_t) :: done
      end function c_pwrite
   end interface

contains

   !> Opens an existing file, for reading alone or for both.
   subroutine open_positional_file(file, path, for_writing)
      type(positional_file_t), intent(out) :: file
      character(*), intent(in) :: path
      logical, intent(in) :: for_writing

      file%path = path
      file%descriptor = opened(path, for_writing)
      if (file%descriptor < 0_c_int) call fail(file%failure, output_error, &
         'cannot '//trim(merge('write', 'read ', for_writing))// &
         ' '//path//': it cannot be opened')
   end subroutine open_positional_file

   !> Writes `values` (n).
   subroutine write_reals(self, place, values)
      class(positional_file_t), intent(inout) :: self
      integer(int64), intent(in) :: place
      real(wp), intent(in), contiguous, target :: values(:)
      integer(c_size_t) :: bytes

      if (allocated(self%failure) .or. size(values) == 0) return
      bytes = size(values, kind=c_size_t)*real_bytes
      call self%check(c_pwrite(self%descriptor, c_loc(values), bytes, place) == bytes, 'write')
   end subroutine write_reals

   !> Reads `values` (m, n).
   subroutine read_reals(self, place, values)
      class(positional_file_t), intent(inout) :: self
      integer(int64), intent(in) :: place
      real(wp), intent(out), contiguous, target :: values(:, :)
      integer(c_size_t) :: bytes

      values = 0.0_wp
      if (allocated(self%failure) .or. size(values) == 0) return
      bytes = size(values, kind=c_size_t)*real_bytes
      call self%check(c_pread(self%descriptor, c_loc(values), bytes, place) == bytes, 'read')
   end subroutine read_reals

   !> Writes `number` >= 0 in 8 bytes.
   subroutine write_number(self, place, number)
      class(positional_file_t), intent(inout) :: self
      integer(int64), intent(in) :: place, number
      integer(int8), target :: bytes(8)
      integer :: byte, i

      if (allocated(self%failure)) return
      do i = 1, size(bytes)
         byte = int(ibits(number, 8*(i - 1), 8))
         bytes(i) = int(merge(byte - 256, byte, byte > 127), int8)
      end do
      call self%check(c_pwrite(self%descriptor, c_loc(bytes), 8_c_size_t, place) == 8_c_size_t, &
         'write')
   end subroutine write_number

   !> The number of the `n` bytes from `place` on; 0 after a failure.
   function number_at(self, place, n) result(number)
      class(positional_file_t), intent(inout) :: self
      integer(int64), intent(in) :: place
      integer, intent(in) :: n
      integer(int64) :: number
      integer(int8), target :: bytes(n)
      integer :: i

      number = 0_int64
      if (allocated(self%failure)) return
      call self%check(c_pread(self%descriptor, c_loc(bytes), int(n, c_size_t), place) == n, 'read')
      if (allocated(self%failure)) return
      do i = n, 1, -1
         number = ior(shiftl(number, 8), iand(int(bytes(i), int64), 255_int64))
      end do
   end function number_at

   !> Closes the file; twice does nothing.
   subroutine close_file(self)
      class(positional_file_t), intent(inout) :: self
      logical :: is_closed

      if (self%descriptor < 0_c_int) return
      is_closed = closed(self%descriptor)
      self%descriptor = -1_c_int
      call self%check(is_closed, 'write')
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

end module positional_file
