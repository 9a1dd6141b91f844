!> An HDF5 file being written: open, groups, close. Datasets, series that are written block by block
!> and attributes are in `hdf5_dataset`.
!>
!> Every return code is checked. The first failure stays in `file%failure` (with HDF5's reason and
!> the name of the file); what follows it does nothing, so a writer checks once, at `close`. No
!> object carries a time stamp: equal contents make equal files.
module hdf5_file
   use, intrinsic :: iso_c_binding, only: c_f_pointer, c_int, c_int64_t, c_loc, c_null_char
   use, intrinsic :: iso_fortran_env, only: int64, real32
   use c_library, only: c_close, c_open
   use disk_file, only: any_mark, early_place, early_words, place_fault
   use errors, only: error_t, fail, output_error
   use file_bytes, only: open_positional_file, positional_file_t
   use hdf5, only: h5_integer_kind, h5_real_kind, h5f_acc_trunc_f, h5f_scope_global_f, &
      h5fclose_f, h5fcreate_f, h5fflush_f, h5gcreate_f, h5kind_to_type, h5oclose_f, h5oopen_f, hid_t
   use hdf5_library, only: file_access, hdf5_handle_t, link_creation
   use kinds, only: are_finite, wp
   use summary_row, only: summary_row_t
   implicit none (type, external)
   private

   public :: axis_t, axis_use_t, create_hdf5_file, hdf5_file_t

   !> O_WRONLY + O_TRUNC.
   integer(c_int), parameter :: truncate = 513_c_int

   !> An element of REFERENCE_LIST: a dataset, by its address, and the number of a dimension of it
   !> that has a coordinate (0 = the slowest).
   type, bind(c) :: axis_use_t
      integer(c_int64_t) :: user
      integer(c_int) :: dimension
      !> Fills the 16 bytes, so that equal contents make equal files.
      integer(c_int) :: nothing = 0_c_int
   end type axis_use_t

   !> A coordinate of datasets in a file, or a second name of one (see `hdf5_axes`).
   type :: axis_t
      character(:), allocatable :: path
      !> The open dataset; -1: it is another name.
      integer(hid_t) :: object = -1_hid_t
      !> Its address in references, and its users.
      integer(int64) :: place = 0
      type(axis_use_t), allocatable :: uses(:)
   end type axis_t

   !> An open file for writing.
   type, extends(hdf5_handle_t) :: hdf5_file_t
      !> The row of a table, into which single values go in place of a file.
      type(summary_row_t), allocatable :: row
      !> HDF5 types of real(wp), real(real32) and integer(int64).
      integer(hid_t) :: real_type = -1_hid_t, single_type = -1_hid_t, integer_type = -1_hid_t
      !> Coordinates so far.
      type(axis_t), allocatable :: axes(:)
      !> The first dataset whose values are no answer, and why; unallocated: none so far.
      character(:), allocatable :: nonsense
      !> The object of the last attribute, kept open (to look up its path costs as much as one), and
      !> its path; empty: none.
      character(:), allocatable, private :: object_path
      integer(hid_t), private :: object = -1_hid_t
   contains
      procedure :: keep_object, object_at, check_values, create_group
      procedure :: close => close_file
   end type hdf5_file_t

contains

   !> Creates `path`, replacing an older file of that name that this program has written. Before the
   !> library writes what the file begins with, its mark stands there.
   subroutine create_hdf5_file(file, path, error)
      type(hdf5_file_t), intent(out) :: file
      character(*), intent(in) :: path
      type(error_t), allocatable, intent(out) :: error
      type(positional_file_t) :: raw
      character(:), allocatable :: fault
      integer :: status

      file%path = path
      file%object_path = ''
      allocate (file%axes(0))
      fault = place_fault(path, any_mark)
      if (fault /= '') call fail(file%failure, output_error, 'cannot write '//path//fault)
      call file%start_hdf5()
      if (.not. allocated(file%failure)) then
         file%real_type = h5kind_to_type(wp, h5_real_kind)
         file%single_type = h5kind_to_type(real32, h5_real_kind)
         file%integer_type = h5kind_to_type(int64, h5_integer_kind)
         call h5fcreate_f(path, h5f_acc_trunc_f, file%id, status, access_prp=file_access)
         file%is_open = status >= 0
         call file%check(status, 'creating the file')
         if (file%is_open) then
            call open_positional_file(raw, path, for_writing=.true.)
            call raw%write_reals(early_place, transfer(early_words, [0.0_wp]))
            call raw%close()   ! a full disk the library finds as well
         end if
      end if
      if (allocated(file%failure)) error = file%failure
   end subroutine create_hdf5_file

   !> Checks every number of a solution before it is written: finite, and pressures not negative.
   !> Input and the report of an iteration are exempt.
   subroutine check_values(self, path, values)
      class(hdf5_file_t), intent(inout) :: self
      character(*), intent(in) :: path
      real(wp), intent(in), contiguous, target :: values(..)
      real(wp), pointer, contiguous :: flat(:)

      if (allocated(self%nonsense) .or. index(path, '/report/') == 1 .or. index(path, &
         '/input/') == 1) return
      call c_f_pointer(c_loc(values), flat, [size(values)])
      if (.not. are_finite(flat)) then
         self%nonsense = path//' holds values that are not finite'
      else if (index(path, '/pressure', back=.true.) == len(path) - len('/pressure') + 1) then
         if (any(flat < 0.0_wp)) self%nonsense = path//' holds values below zero'
      end if
   end subroutine check_values

   !> Makes a group and those above it.
   subroutine create_group(self, path)
      class(hdf5_file_t), intent(inout) :: self
      character(*), intent(in) :: path
      integer(hid_t) :: group
      integer :: status

      if (allocated(self%failure) .or. allocated(self%row)) return
      call h5gcreate_f(self%id, path, group, status, lcpl_id=link_creation)
      call self%check(status, path)
      if (.not. allocated(self%failure)) call self%keep_object(path, group)
   end subroutine create_group

   !> Takes over the open `object` at `path`; the one that was kept open is closed.
   subroutine keep_object(self, path, object)
      class(hdf5_file_t), intent(inout) :: self
      character(*), intent(in) :: path
      integer(hid_t), intent(in) :: object
      integer :: status

      status = 0
      if (self%object_path /= '') call h5oclose_f(self%object, status)
      call self%check(status, self%object_path)
      self%object_path = path
      self%object = object
   end subroutine keep_object

   !> The open object at `path`, to be left open; nothing sensible after a failure.
   function object_at(self, path) result(object)
      class(hdf5_file_t), intent(inout) :: self
      character(*), intent(in) :: path
      integer(hid_t) :: object
      integer :: status

      object = self%object
      if (self%object_path == path) return
      call h5oopen_f(self%id, path, object, status)
      call self%check(status, path)
      if (.not. allocated(self%failure)) call self%keep_object(path, object)
   end function object_at

   !> Closes the file, once, and all in it, or empties a failed one; `error`: the first failure.
   subroutine close_file(self, error)
      class(hdf5_file_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error
      integer :: status

      if (self%is_open) then
         status = 0
         if (.not. allocated(self%failure)) call h5fflush_f(self%id, h5f_scope_global_f, status)
         call self%check(status, 'writing to the disk')
         self%is_open = .false.
         if (allocated(self%failure)) then
            ! The library would fail again, and keep objects of it that the next file has to close.
            ! Left open it is no other file's; empty it needs no room on a full disk.
            status = c_close(c_open(self%path//c_null_char, truncate))
         else
            call self%keep_object('', -1_hid_t)
            call h5fclose_f(self%id, status)
            call self%check(status, 'closing the file')
         end if
      end if
      if (allocated(self%failure)) error = self%failure
   end subroutine close_file

end module hdf5_file
