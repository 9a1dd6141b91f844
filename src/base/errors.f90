!> Errors, returned to the caller: nothing below app/ stops or prints.
!>
!> Every routine that can fail has `type(error_t), allocatable, intent(out) :: error` as its last
!> argument; the first statement after the call is `if (allocated(error)) return`.
module errors
   implicit none (type, external)
   private

   public :: error_t, fail

   !> Bad input: a namelist, an option or a file that the user gave.
   integer, parameter, public :: input_error = 1
   !> An output that could not be written.
   integer, parameter, public :: output_error = 3
   !> A failure inside the program: LAPACK or FFTW refused, an invariant is broken.
   integer, parameter, public :: internal_error = 4

   !> An error with its kind (one of the constants above) and a message that states the facts.
   type :: error_t
      integer :: kind = internal_error
      character(:), allocatable :: message
   end type error_t

contains

   !> Allocates `error` with its kind and message.
   pure subroutine fail(error, kind, message)
      type(error_t), allocatable, intent(out) :: error
      integer, intent(in) :: kind
      character(*), intent(in) :: message

      allocate (error)
      error%kind = kind
      error%message = message
   end subroutine fail

end module errors
