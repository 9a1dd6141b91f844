!> Heights in an HDF5 file: a dataset of one or two dimensions and the spacing of its nodes, read a
!> stretch at a time.
module hdf5_heights
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use, intrinsic :: iso_c_binding, only: c_loc, c_ptr
   use, intrinsic :: iso_fortran_env, only: int64
   use errors, only: error_t, fail, input_error
   use findings, only: quoted
   use hdf5, only: h5dget_space_f, h5dread_f, h5s_select_set_f, h5sclose_f, h5screate_simple_f, &
      h5sselect_hyperslab_f, h5t_native_double, hid_t, hsize_t
   use hdf5_input, only: hdf5_input_t, open_hdf5_input
   use hdf5_source, only: hdf5_source_t, number_class
   use height_limits, only: scale_fault, spacing_fault
   use height_source, only: height_source_t
   use kinds, only: wp
   use text, only: to_text
   implicit none (type, external)
   private

   public :: hdf5_heights_t, open_hdf5_heights

   !> Spacing of a dataset without that attribute; any number of values.
   real(wp), parameter :: no_spacing = -huge(1.0_wp)
   integer(int64), parameter :: any_count = -1_int64
   !> Most nodes.
   real(wp), parameter :: max_nodes = 1.0e18_wp

   !> A dataset (nx) or, as h5py sees it, (ny, nx); x runs fastest. The file is open only while it
   !> is read.
   type, extends(height_source_t) :: hdf5_heights_t
      character(:), allocatable, private :: file, dataset
      !> nx, ny; and metres in one unit of the dataset.
      integer(int64) :: grid(2) = 0_int64
      real(wp), private :: si_scale = 1.0_wp
   contains
      procedure :: get
   end type hdf5_heights_t

contains

   !> Heights of `dataset` in `file`, times its attribute `si_scale` if it has one. `spacing` (2)
   !> [m] from its attributes `spacing_x`, `spacing_y` or `spacing`; 0 where there is none. Errors
   !> (input_error): no such file or dataset, another number of dimensions.
   subroutine open_hdf5_heights(source, file, dataset, spacing, error)
      type(hdf5_heights_t), intent(out) :: source
      character(*), intent(in) :: file, dataset
      real(wp), intent(out) :: spacing(2)
      type(error_t), allocatable, intent(out) :: error
      type(hdf5_input_t) :: reader
      type(hdf5_source_t) :: values
      logical :: exists

      source%file = file
      source%dataset = dataset
      spacing = 0.0_wp
      call open_hdf5_input(reader, file, error)
      if (allocated(error)) return
      exists = reader%has(dataset)
      if (exists) then
         call reader%open(values, dataset)
         if (.not. allocated(reader%failure)) then
            call look_at_dataset(reader, source, values, spacing)
            call values%close()
         end if
      end if
      call reader%close(error)
      if (allocated(error)) return
      if (.not. exists) then
         call fail(error, input_error, file//': found no dataset '//quoted(dataset))
      else if (size(values%extents) < 1 .or. size(values%extents) > 2) then
         call fail(error, input_error, file//': found '//to_text(size(values%extents)) &
            //' dimensions in '// &
            dataset//', expected 1 or 2')
      else
         source%grid = 1
         source%grid(:size(values%extents)) = values%extents
         if (product(real(source%grid, wp)) > max_nodes) call fail(error, input_error, &
            file//': found too many nodes in '//dataset)
         if (.not. allocated(error)) source%nodes = product(source%grid)
      end if
   end subroutine open_hdf5_heights

   !> Spacing and scale of an open dataset. Failures: it holds no numbers or does not store them;
   !> attributes that are no single numbers or of no use.
   subroutine look_at_dataset(reader, source, values, spacing)
      type(hdf5_input_t), intent(inout) :: reader
      type(hdf5_heights_t), intent(inout) :: source
      type(hdf5_source_t), intent(in) :: values
      real(wp), intent(inout) :: spacing(2)
      character(len=*), parameter :: names(3) = ['spacing  ', 'spacing_x', 'spacing_y']
      real(wp) :: stated
      integer :: i

      call reader%refuse(source%dataset, values%fault(number_class, any_count))
      call reader%refuse(source%dataset, values%fault_of_size())
      do i = 1, size(names)
         stated = reader%number_of(source%dataset, trim(names(i)), no_spacing)
         if (ieee_is_finite(stated)) then
            if (stated <= no_spacing) cycle
         end if
         call reader%refuse(trim(names(i)), spacing_fault(stated))
         if (i == 1) then
            spacing = stated
         else
            spacing(i - 1) = stated
         end if
      end do
      source%si_scale = reader%number_of(source%dataset, 'si_scale', 1.0_wp)
      call reader%refuse('si_scale', scale_fault(source%si_scale))
   end subroutine look_at_dataset

   !> Heights from number `first` on; of an area all of them. Error: they cannot be read.
   subroutine get(self, first, z, error)
      class(hdf5_heights_t), intent(in) :: self
      integer(int64), intent(in) :: first
      real(wp), intent(out) :: z(:)
      type(error_t), allocatable, intent(out) :: error
      type(hdf5_input_t) :: reader
      real(wp), allocatable, target :: values(:)
      type(hdf5_source_t) :: source
      integer(hid_t) :: file_space, memory_space
      integer(hsize_t) :: extents(2), offset(2)
      type(c_ptr) :: place
      integer :: status

      z = 0.0_wp
      call open_hdf5_input(reader, self%file, error)
      if (allocated(error)) return
      offset = [int(first, hsize_t), 0_hsize_t]
      extents = [size(z, kind=hsize_t), 1_hsize_t]
      if (self%grid(2) > 1) extents = self%grid
      allocate (values(size(z)))
      place = c_loc(values)
      call reader%open(source, self%dataset)
      if (.not. allocated(reader%failure)) then
         call h5dget_space_f(source%id, file_space, status)
         call reader%check(status, self%dataset)
         call h5sselect_hyperslab_f(file_space, h5s_select_set_f, offset, extents, status)
         call reader%check(status, self%dataset//': fewer nodes than before')
         call h5screate_simple_f(1, [size(z, kind=hsize_t)], memory_space, status)
         call reader%check(status, self%dataset)
         if (.not. allocated(reader%failure)) then
            call h5dread_f(source%id, h5t_native_double, place, status, memory_space, file_space)
            call reader%check(status, self%dataset//' as real numbers')
            z = values*self%si_scale
         end if
         call h5sclose_f(memory_space, status)
         call h5sclose_f(file_space, status)
         call source%close()
      end if
      call reader%close(error)   ! error: handed up
   end subroutine get

end module hdf5_heights
