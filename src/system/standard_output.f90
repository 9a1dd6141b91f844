!> Text for standard output. (Fortran's own output reports neither a full device nor a closed pipe.)
module standard_output
   use, intrinsic :: iso_c_binding, only: c_int, c_size_t
   use errors, only: error_t, fail, output_error
   use operating_system, only: closed, opened
   use signal_calls, only: c_write, standard_error
   implicit none (type, external)
   private

   public :: print_text, settle_standard_streams, write_text

   !> File descriptor of standard output.
   integer(c_int), parameter, public :: standard_output_descriptor = 1_c_int
   character(*), parameter :: lost = 'cannot write to standard output: the disk is full, or '// &
      'nobody reads it'

contains

   !> Prints all of `text` and closes standard output. Error: some of it is lost.
   subroutine print_text(text, error)
      character(*), intent(in) :: text
      type(error_t), allocatable, intent(out) :: error

      call write_text(text, error)
      if (allocated(error)) return
      ! some file systems report a full disk only here
      if (.not. closed(standard_output_descriptor)) call fail(error, output_error, lost)
   end subroutine print_text

   !> Writes all of `text` and leaves standard output open. Error: some of it is lost.
   subroutine write_text(text, error)
      character(*), intent(in) :: text
      type(error_t), allocatable, intent(out) :: error
      integer(c_size_t) :: done, written

      done = 0_c_size_t
      do while (done < len(text))
         written = c_write(standard_output_descriptor, text(done + 1:), len(text) - done)
         if (written <= 0_c_size_t) then
            call fail(error, output_error, lost)
            return
         end if
         done = done + written
      end do
   end subroutine write_text

   !> Opens closed standard streams on /dev/null: else the next files to be opened would take their
   !> descriptors, and messages would go into a result.
   subroutine settle_standard_streams()
      integer(c_int) :: descriptor
      logical :: is_closed

      do
         descriptor = opened('/dev/null', for_writing=.false.)
         if (descriptor < 0_c_int .or. descriptor > standard_error) exit
      end do
      if (descriptor > standard_error) is_closed = closed(descriptor)
   end subroutine settle_standard_streams

end module standard_output
