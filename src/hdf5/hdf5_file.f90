!> An HDF5 file being written: open, groups, flush, close. Attributes are in `hdf5_attribute`,
!> datasets in `hdf5_dataset`, series that grow row by row in `hdf5_series`.
!>
!> Every return code is checked. The first failure stays in `file%failure` (with HDF5's reason and
!> the name of the file); what follows it does nothing, so a writer checks once, at `close`. No
!> object carries a time stamp: equal contents make equal files.
module hdf5_file
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use, intrinsic :: iso_c_binding, only: c_f_pointer, c_loc
   use, intrinsic :: iso_fortran_env, only: int64
   use errors, only: error_t, output_error
   use hdf5, only: h5f_acc_trunc_f, h5f_close_strong_f, h5f_scope_global_f, h5fclose_f, &
      h5fcreate_f, h5fflush_f, h5gclose_f, h5gcreate_f, h5kind_to_type, h5_integer_kind, &
      h5_real_kind, h5p_file_access_f, h5p_link_create_f, h5pclose_f, h5pcreate_f, &
      h5pset_create_inter_group_f, h5pset_fclose_degree_f, h5pset_libver_bounds_f, &
      h5f_libver_earliest_f, h5f_libver_latest_f, hid_t
   use hdf5_library, only: start_hdf5
   use hdf5_reason, only: keep_hdf5_failure
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: create_hdf5_file, hdf5_file_t

   !> An open file for writing.
   type :: hdf5_file_t
      !> Name of the file as given.
      character(:), allocatable :: path
      !> The first thing that went wrong; allocated = nothing is written any more.
      type(error_t), allocatable :: failure
      !> HDF5 identifiers, for the hdf5_* modules only: the file, and properties of new links
      !> (groups above are made as well).
      integer(hid_t) :: id = -1_hid_t
      integer(hid_t) :: link_creation = -1_hid_t
      !> HDF5 types of real(wp) and integer(int64).
      integer(hid_t) :: real_type = -1_hid_t
      integer(hid_t) :: integer_type = -1_hid_t
      !> The first dataset whose values are no answer, and why; unallocated: none so far.
      character(:), allocatable :: nonsense
      logical, private :: is_open = .false.
   contains
      !> Looks at numbers that are written.
      procedure :: look_at
      !> Makes a group, and those above it.
      procedure :: create_group
      !> Hands everything to the operating system.
      procedure :: flush => flush_file
      !> Closes the file, whatever its state; `error` is the first failure of its whole life.
      procedure :: close => close_file
      !> Keeps the first failure.
      procedure :: check
   end type hdf5_file_t

contains

   !> Creates `path`, replacing an older file of that name.
   subroutine create_hdf5_file(file, path, error)
      type(hdf5_file_t), intent(out) :: file
      character(*), intent(in) :: path
      type(error_t), allocatable, intent(out) :: error
      integer(hid_t) :: access
      integer :: status

      file%path = path
      call start_hdf5(status)
      call file%check(status, 'starting the HDF5 library')
      if (.not. allocated(file%failure)) then
         file%real_type = h5kind_to_type(wp, h5_real_kind)
         file%integer_type = h5kind_to_type(int64, h5_integer_kind)
         call h5pcreate_f(h5p_file_access_f, access, status)
         if (status >= 0) call h5pset_fclose_degree_f(access, h5f_close_strong_f, status)
         if (status >= 0) call h5pset_libver_bounds_f(access, h5f_libver_earliest_f, &
            h5f_libver_latest_f, status)
         if (status >= 0) call h5pcreate_f(h5p_link_create_f, file%link_creation, status)
         if (status >= 0) call h5pset_create_inter_group_f(file%link_creation, 1, status)
         if (status >= 0) call h5fcreate_f(path, h5f_acc_trunc_f, file%id, status, &
            access_prp=access)
         file%is_open = status >= 0
         if (status >= 0) call h5pclose_f(access, status)
         call file%check(status, 'creating the file')
      end if
      if (allocated(file%failure)) error = file%failure
   end subroutine create_hdf5_file

   !> Keeps the first failure: `status` < 0 while `doing`.
   subroutine check(self, status, doing)
      class(hdf5_file_t), intent(inout) :: self
      integer, intent(in) :: status
      character(*), intent(in) :: doing

      call keep_hdf5_failure(self%failure, output_error, 'cannot write ' // self%path, status, &
         doing)
   end subroutine check

   !> Checks every number of a solution before it is written: finite, and pressures not negative.
   !> Input and the report of an iteration are exempt.
   subroutine look_at(self, path, values)
      class(hdf5_file_t), intent(inout) :: self
      character(*), intent(in) :: path
      real(wp), intent(in), contiguous, target :: values(..)
      real(wp), pointer :: flat(:)

      if (allocated(self%nonsense) .or. index(path, '/report/') == 1 .or. index(path, &
         '/input/') == 1) return
      call c_f_pointer(c_loc(values), flat, [size(values)])
      if (.not. all(ieee_is_finite(flat))) then
         self%nonsense = path//' holds values that are not finite'
      else if (index(path, '/pressure', back=.true.) == len(path) - len('/pressure') + 1) then
         if (any(flat < 0.0_wp)) self%nonsense = path//' holds values below zero'
      end if
   end subroutine look_at

   !> Makes a group and those above it.
   subroutine create_group(self, path)
      class(hdf5_file_t), intent(inout) :: self
      character(*), intent(in) :: path
      integer(hid_t) :: group
      integer :: status

      if (allocated(self%failure)) return
      call h5gcreate_f(self%id, path, group, status, lcpl_id=self%link_creation)
      if (status >= 0) call h5gclose_f(group, status)
      call self%check(status, path)
   end subroutine create_group

   !> Hands everything written so far to the operating system.
   subroutine flush_file(self)
      class(hdf5_file_t), intent(inout) :: self
      integer :: status

      if (allocated(self%failure) .or. .not. self%is_open) return
      call h5fflush_f(self%id, h5f_scope_global_f, status)
      call self%check(status, 'writing to the disk')
   end subroutine flush_file

   !> Closes the file and all that is open in it; `error` is the first failure of its whole life.
   !> Closing twice does nothing.
   subroutine close_file(self, error)
      class(hdf5_file_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error
      integer :: status

      call self%flush()
      if (self%is_open) then
         self%is_open = .false.
         call h5pclose_f(self%link_creation, status)
         call self%check(status, 'link properties')
         call h5fclose_f(self%id, status)
         call self%check(status, 'closing the file')
      end if
      if (allocated(self%failure)) error = self%failure
   end subroutine close_file

end module hdf5_file
