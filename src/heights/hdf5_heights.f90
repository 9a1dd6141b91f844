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
   use length_units, only: height_units_t, settle_unit, units_per_metre
   use text, only: to_text
   implicit none (type, external)
   private

   public :: hdf5_heights_t, open_hdf5_heights

   !> Spacing of a dataset without that attribute; any number of values.
   real(wp), parameter :: no_spacing = -huge(1.0_wp)
   integer(int64), parameter :: any_count = -1_int64
   !> Relative difference of two scales that are the same.
   real(wp), parameter :: same_scale = 1.0e-6_wp
   !> Most nodes.
   real(wp), parameter :: max_nodes = 1.0e18_wp

   !> A dataset (nx) or, as h5py sees it, (ny, nx); x runs fastest. The file is open only while it
   !> is read.
   type, extends(height_source_t) :: hdf5_heights_t
      character(:), allocatable, private :: file, dataset
      !> nx, ny; and metres in one unit of the dataset.
      integer(int64) :: grid(2) = 0_int64
      real(wp), private :: si_scale = 1.0_wp
      !> Units of the dataset in a metre, beside si_scale = 1.
      real(wp), private :: per_metre = 1.0_wp
   contains
      procedure :: get
   end type hdf5_heights_t

contains

   !> Heights of `dataset` in `file`, in the unit of its attribute `units` or `unit`, or times its
   !> attribute `si_scale`. `spacing` (2) [m] from its attributes `spacing_x`, `spacing_y` or
   !> `spacing`, in the unit of `spacing_units` or `spacing_unit`; 0 where there is none. `units`
   !> are those that the keys say. Errors (input_error): no such file or dataset, another number of
   !> dimensions; units that are unknown or contradict each other.
   subroutine open_hdf5_heights(source, file, dataset, units, spacing, error)
      type(hdf5_heights_t), intent(out) :: source
      character(*), intent(in) :: file, dataset
      type(height_units_t), intent(in) :: units
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
            call look_at_dataset(reader, source, values, units, spacing)
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
   subroutine look_at_dataset(reader, source, values, units, spacing)
      type(hdf5_input_t), intent(inout) :: reader
      type(hdf5_heights_t), intent(inout) :: source
      type(hdf5_source_t), intent(in) :: values
      type(height_units_t), intent(in) :: units
      real(wp), intent(inout) :: spacing(2)
      character(len=*), parameter :: names(3) = ['spacing  ', 'spacing_x', 'spacing_y']
      character(:), allocatable :: fault, unit
      real(wp) :: per_metre, stated
      integer :: i

      call reader%refuse(source%dataset, values%fault(number_class, any_count))
      call reader%refuse(source%dataset, values%fault_of_size())
      unit = unit_in(reader, source%dataset, 'spacing_')
      call settle_unit(unit, units%x, 'the attribute of the spacing', 'x_unit', per_metre, fault)
      call reader%refuse(source%dataset, fault)
      do i = 1, size(names)
         stated = reader%number_of(source%dataset, trim(names(i)), no_spacing)
         if (ieee_is_finite(stated)) then
            if (stated <= no_spacing) cycle
         end if
         stated = stated/per_metre
         call reader%refuse(trim(names(i)), spacing_fault(stated))
         if (i == 1) then
            spacing = stated
         else
            spacing(i - 1) = stated
         end if
      end do
      call find_scale(reader, source, units%z)
   end subroutine look_at_dataset

   !> Metres in one unit of the dataset: from `si_scale`, from its units or from `wanted`, the unit
   !> of the key. Failures: two of them contradict each other.
   subroutine find_scale(reader, source, wanted)
      type(hdf5_input_t), intent(inout) :: reader
      type(hdf5_heights_t), intent(inout) :: source
      character(*), intent(in) :: wanted
      character(:), allocatable :: fault, unit, word
      real(wp) :: per_metre

      source%si_scale = reader%number_of(source%dataset, 'si_scale', no_spacing)
      unit = unit_in(reader, source%dataset, '')
      if (ieee_is_finite(source%si_scale)) then
         if (source%si_scale <= no_spacing) then
            call settle_unit(unit, wanted, 'the attributes of '//source%dataset, 'z_unit', &
               per_metre, fault)
            call reader%refuse(source%dataset, fault)
            source%si_scale = 1.0_wp
            source%per_metre = per_metre
            return
         end if
      end if
      call reader%refuse('si_scale', scale_fault(source%si_scale))
      if (allocated(reader%failure)) return
      if (wanted /= '') unit = wanted
      call units_per_metre(unit, per_metre, word)
      if (word == '') return
      if (abs(abs(source%si_scale)*per_metre - 1.0_wp) > same_scale) call &
         reader%refuse(source%dataset, 'found si_scale = '//to_text(source%si_scale, 4)// &
         ' [m] beside the unit '//word//trim(merge(' of the key z_unit', '                  ', &
         wanted /= ''))//', expected the same of both')
   end subroutine find_scale

   !> The unit that an attribute of a dataset says: `units` or `unit`, behind `front`.
   function unit_in(reader, dataset, front) result(unit)
      type(hdf5_input_t), intent(inout) :: reader
      character(*), intent(in) :: dataset, front
      character(:), allocatable :: unit

      unit = reader%text_of(dataset, front//'units')
      if (unit == '') unit = reader%text_of(dataset, front//'unit')
   end function unit_in

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
            z = values*self%si_scale/self%per_metre
         end if
         call h5sclose_f(memory_space, status)
         call h5sclose_f(file_space, status)
         call source%close()
      end if
      call reader%close(error)   ! error: handed up
   end subroutine get

end module hdf5_heights
