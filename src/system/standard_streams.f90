!> Standard output and error. (Fortran's own output reports no full device and no closed pipe.)
module standard_streams
   use, intrinsic :: iso_c_binding, only: c_int, c_null_char, c_size_t
   use c_library, only: c_close, c_isatty, c_open, c_write, standard_error, standard_output
   use errors, only: error_t, fail, output_error
   implicit none (type, external)
   private

   public :: is_terminal, print_text, settle_standard_streams, write_text

   character(*), parameter :: lost = 'cannot write to standard output: the disk is full, or '// &
      'nobody reads it'

contains

   !> Prints all of `text` and closes standard output, unless there is an error. Error: some of it
   !> is lost.
   subroutine print_text(text, error)
      character(*), intent(in) :: text
      type(error_t), allocatable, intent(inout) :: error

      call write_text(text, error)
      if (allocated(error)) return
      ! some file systems report a full disk only here
      if (c_close(standard_output) /= 0_c_int) call fail(error, output_error, lost)
   end subroutine print_text

   !> Writes all of `text`, unless there is an error, and leaves standard output open. Error: some
   !> of it is lost.
   subroutine write_text(text, error)
      character(*), intent(in) :: text
      type(error_t), allocatable, intent(inout) :: error
      integer(c_size_t) :: done, written

      done = 0_c_size_t
      do while (done < len(text) .and. .not. allocated(error))
         written = c_write(standard_output, text(done + 1:), len(text) - done)
         if (written <= 0_c_size_t) call fail(error, output_error, lost)
         done = done + written
      end do
   end subroutine write_text

   !> Opens closed standard streams on /dev/null: else messages would go into the next file opened.
   subroutine settle_standard_streams()
      integer(c_int) :: descriptor

      do
         descriptor = c_open('/dev/null'//c_null_char, 0_c_int)   ! O_RDONLY
         if (descriptor < 0_c_int .or. descriptor > standard_error) exit
      end do
      if (descriptor > standard_error) descriptor = c_close(descriptor)
   end subroutine settle_standard_streams

   !> Whether a file descriptor is a terminal.
   logical function is_terminal(descriptor) result(answer)
      integer(c_int), intent(in) :: descriptor

      answer = c_isatty(descriptor) == 1_c_int
   end function is_terminal

end module standard_streams
