!> The first failure of a series of HDF5 calls, with its reason in a few words from the library's
!> error stack.
module hdf5_reason
   use, intrinsic :: iso_c_binding, only: c_associated, c_f_pointer, c_funloc, c_funptr, c_int, &
      c_int64_t, c_loc, c_ptr, c_size_t
   use errors, only: error_t, fail
   implicit none (type, external)
   private

   public :: keep_hdf5_failure

   !> H5E_DEFAULT: the error stack of this thread.
   integer(c_int64_t), parameter :: default_stack = 0_c_int64_t
   !> H5E_WALK_UPWARD: the most specific entry first.
   integer(c_int), parameter :: walk_upward = 0_c_int
   !> Longest description that is read.
   integer, parameter :: max_length = 2000

   !> H5E_error2_t: one entry of the stack.
   type, bind(c) :: stack_entry_t
      integer(c_int64_t) :: class_id, major_id, minor_id
      integer(c_int) :: line
      type(c_ptr) :: function_name, file_name, description
   end type stack_entry_t

   interface
      !> Calls `visit` for every entry of the error stack.
      function h5ewalk2(stack, direction, visit, client) bind(c, name='H5Ewalk2') result(status)
         import :: c_funptr, c_int, c_int64_t, c_ptr
         implicit none (type, external)
         integer(c_int64_t), value :: stack
         integer(c_int), value :: direction
         type(c_funptr), value :: visit
         type(c_ptr), value :: client
         integer(c_int) :: status
      end function h5ewalk2

      !> Length of a C string.
      pure function strlen(string) bind(c, name='strlen') result(length)
         import :: c_ptr, c_size_t
         implicit none (type, external)
         type(c_ptr), value :: string
         integer(c_size_t) :: length
      end function strlen
   end interface

contains

   !> Keeps the first failure: `status` < 0 while `doing`; `what` says what cannot be done.
   subroutine keep_hdf5_failure(failure, kind, what, status, doing)
      type(error_t), allocatable, intent(inout) :: failure
      integer, intent(in) :: kind, status
      character(*), intent(in) :: what, doing
      character(:), allocatable :: reason

      if (status >= 0 .or. allocated(failure)) return
      reason = last_hdf5_reason()
      if (len(reason) > 0) reason = ': ' // reason
      call fail(failure, kind, what // ' (' // doing // ')' // reason)
   end subroutine keep_hdf5_failure

   !> The operating system's words ('No space left on device') where the library passes them on,
   !> else its own; '' if it has none.
   function last_hdf5_reason() result(reason)
      character(:), allocatable :: reason
      character(len=*), parameter :: marker = "error message = '"
      character(len=max_length), target :: description
      integer :: start, length

      description = ''
      reason = ''
      if (h5ewalk2(default_stack, walk_upward, c_funloc(keep_first), c_loc(description)) < 0) return
      reason = trim(description)
      start = index(reason, marker)
      if (start == 0) return
      reason = reason(start + len(marker):)
      length = index(reason, "'") - 1
      if (length > 0) reason = reason(:length)
   end function last_hdf5_reason

   !> Visits one stack entry: keeps the description of entry 0, the most specific one. Returns
   !> 0 = go on.
   function keep_first(number, entry, client) bind(c) result(status)
      integer(c_int), value :: number
      type(stack_entry_t), intent(in) :: entry
      type(c_ptr), value :: client
      integer(c_int) :: status
      character(len=max_length), pointer :: kept, source

      status = 0_c_int
      if (number /= 0_c_int .or. .not. c_associated(entry%description)) return
      call c_f_pointer(client, kept)
      call c_f_pointer(entry%description, source)
      kept = source(:min(strlen(entry%description), int(max_length, c_size_t)))
   end function keep_first

end module hdf5_reason
