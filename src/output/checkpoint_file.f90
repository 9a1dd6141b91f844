!> The file of a checkpoint: values with names, which one walk over them writes or reads.
!>
!> A walk calls `visit` for each value, with its path in the file. While the file is written the
!> value goes there; while it is read the value comes from there, and must be as large as it was.
!> The first failure is kept, as in `hdf5_file` and `hdf5_input`, and what follows it does nothing.
module checkpoint_file
   use, intrinsic :: iso_c_binding, only: c_loc, c_ptr
   use, intrinsic :: iso_fortran_env, only: int32, int64
   use hdf5, only: h5kind_to_type, h5_integer_kind, h5_real_kind, hid_t
   use hdf5_dataset, only: write_string, write_values
   use hdf5_file, only: hdf5_file_t
   use hdf5_input, only: hdf5_input_t
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: checkpoint_file_t

   !> An open checkpoint.
   type :: checkpoint_file_t
      logical :: is_read = .false.
      !> The file that is written, or the one that is read.
      type(hdf5_file_t) :: file
      type(hdf5_input_t) :: reader
   contains
      procedure :: visit_text, visit_vector, visit_plain, has
      generic :: visit => visit_reals, visit_integers, visit_longs
      procedure, private :: visit_reals, visit_integers, visit_longs
   end type checkpoint_file_t

contains

   !> Reals.
   subroutine visit_reals(self, path, values)
      class(checkpoint_file_t), intent(inout) :: self
      character(*), intent(in) :: path
      real(wp), intent(inout), contiguous, target :: values(..)

      call visit_numbers(self, path, h5kind_to_type(wp, h5_real_kind), shape(values), c_loc(values))
   end subroutine visit_reals

   !> Integers.
   subroutine visit_integers(self, path, values)
      class(checkpoint_file_t), intent(inout) :: self
      character(*), intent(in) :: path
      integer, intent(inout), contiguous, target :: values(..)

      call visit_numbers(self, path, h5kind_to_type(kind(values), h5_integer_kind), &
         shape(values), c_loc(values))
   end subroutine visit_integers

   !> Integers of 64 bits.
   subroutine visit_longs(self, path, values)
      class(checkpoint_file_t), intent(inout) :: self
      character(*), intent(in) :: path
      integer(int64), intent(inout), contiguous, target :: values(..)

      call visit_numbers(self, path, h5kind_to_type(int64, h5_integer_kind), shape(values), &
         c_loc(values))
   end subroutine visit_longs

   !> A text.
   subroutine visit_text(self, path, text)
      class(checkpoint_file_t), intent(inout) :: self
      character(*), intent(in) :: path
      character(:), allocatable, intent(inout) :: text

      if (self%is_read) then
         text = self%reader%text(path)
      else
         call write_string(self%file, path, text)
      end if
   end subroutine visit_text

   !> Reals (n); while the file is read the vector becomes as long as it was.
   subroutine visit_vector(self, path, values)
      class(checkpoint_file_t), intent(inout) :: self
      character(*), intent(in) :: path
      real(wp), allocatable, intent(inout) :: values(:)

      if (self%is_read) then
         values = self%reader%reals(path)
      else
         call self%visit(path, values)
      end if
   end subroutine visit_vector

   !> A value of so many `bits`, of a type without allocatable components: its bits.
   subroutine visit_plain(self, path, value, bits)
      class(checkpoint_file_t), intent(inout) :: self
      character(*), intent(in) :: path
      type(*), intent(inout), target :: value
      integer, intent(in) :: bits

      call visit_numbers(self, path, h5kind_to_type(int32, h5_integer_kind), &
         [bits/storage_size(1_int32)], c_loc(value))
   end subroutine visit_plain

   !> Numbers of `type_id` at an address, with their extents.
   subroutine visit_numbers(self, path, type_id, extents, address)
      type(checkpoint_file_t), intent(inout) :: self
      character(*), intent(in) :: path
      integer(hid_t), intent(in) :: type_id
      integer, intent(in) :: extents(:)
      type(c_ptr), intent(in) :: address

      if (self%is_read) then
         call self%reader%read_numbers(path, product(int(extents, int64)), type_id, address)
      else
         call write_values(self%file, path, type_id, extents, address)
      end if
   end subroutine visit_numbers

   !> Whether there is something at `path`.
   logical function has(self, path, is_kept)
      class(checkpoint_file_t), intent(inout) :: self
      character(*), intent(in) :: path
      logical, intent(in) :: is_kept

      has = is_kept
      if (self%is_read) has = self%reader%has(path)
   end function has

end module checkpoint_file
