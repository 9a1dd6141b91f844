!> Numbers of a part of a dataset: scale_factor and add_offset applied, missing ones refused.
module hdf5_part
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use, intrinsic :: iso_c_binding, only: c_loc, c_ptr
   use, intrinsic :: iso_fortran_env, only: int64
   use hdf5, only: h5dget_space_f, h5dread_f, h5s_select_set_f, h5sclose_f, h5screate_simple_f, &
      h5sselect_hyperslab_f, h5t_native_double, hid_t, hsize_t
   use hdf5_input, only: hdf5_input_t
   use hdf5_source, only: hdf5_source_t
   use kinds, only: wp
   use text, only: to_text
   implicit none (type, external)
   private

   public :: place_words, read_part

   !> Relative difference of a mark of missing numbers that was rounded to single precision.
   real(wp), parameter :: same_mark = 1.0e-7_wp

contains

   !> Numbers of `dataset` from `offset` on, `extents` of them along each of its dimensions. What
   !> cannot be read stays in the reader.
   subroutine read_part(reader, dataset, offset, extents, z)
      type(hdf5_input_t), intent(inout) :: reader
      character(*), intent(in) :: dataset
      integer(int64), intent(in) :: offset(2)
      integer(hsize_t), intent(in) :: extents(2)
      real(wp), contiguous, target, intent(out) :: z(:)
      type(hdf5_source_t) :: source
      integer(hid_t) :: file_space, memory_space
      integer(hsize_t) :: start(2)
      type(c_ptr) :: place
      integer :: status

      start = offset
      place = c_loc(z)
      call reader%open(source, dataset)
      if (allocated(reader%failure)) return
      call h5dget_space_f(source%id, file_space, status)
      call reader%check(status, dataset)
      call h5sselect_hyperslab_f(file_space, h5s_select_set_f, start, extents, status)
      call reader%check(status, dataset//': fewer nodes than before')
      call h5screate_simple_f(1, [size(z, kind=hsize_t)], memory_space, status)
      call reader%check(status, dataset)
      if (.not. allocated(reader%failure)) then
         call h5dread_f(source%id, h5t_native_double, place, status, memory_space, file_space)
         call reader%check(status, dataset//' as real numbers')
      end if
      call h5sclose_f(memory_space, status)
      call h5sclose_f(file_space, status)
      call source%close()
      if (.not. allocated(reader%failure)) call unpack(reader, dataset, offset, extents, z)
   end subroutine read_part

   !> Applies the attributes of packing. Failures: a number is missing or not valid; bad attributes.
   subroutine unpack(reader, dataset, offset, extents, z)
      type(hdf5_input_t), intent(inout) :: reader
      character(*), intent(in) :: dataset
      integer(int64), intent(in) :: offset(2)
      integer(hsize_t), intent(in) :: extents(2)
      real(wp), intent(inout) :: z(:)
      real(wp) :: factor, marks(2), shift, valid(2)
      integer :: i

      if (reader%text_of(dataset, '_Unsigned') == 'true') call reader%refuse(dataset, &
         'found _Unsigned = true, expected an unsigned type of HDF5')
      marks = [reader%number_of(dataset, '_FillValue', huge(1.0_wp)), &
         reader%number_of(dataset, 'missing_value', huge(1.0_wp))]
      valid = [reader%number_of(dataset, 'valid_min', -huge(1.0_wp)), &
         reader%number_of(dataset, 'valid_max', huge(1.0_wp))]
      factor = reader%number_of(dataset, 'scale_factor', 1.0_wp)
      shift = reader%number_of(dataset, 'add_offset', 0.0_wp)
      if (.not. all(ieee_is_finite([factor, shift]))) then
         call reader%refuse(dataset, 'found '//to_text(factor, 4)//' and '//to_text(shift, 4)// &
            ' in scale_factor and add_offset, expected numbers')
      else if (abs(factor) <= 0.0_wp) then
         call reader%refuse('scale_factor', 'found 0, expected a number other than 0')
      end if
      if (allocated(reader%failure)) return
      do i = 1, size(z)
         if (.not. is_missing(z(i), marks, valid)) cycle
         call reader%refuse(dataset, 'node '//to_text(offset(1) + i)//': found '// &
            to_text(z(i), 4)//', the mark of a missing point (_FillValue, missing_value, '// &
            'valid_min, valid_max), expected numbers without gaps'// &
            place_words(offset(1) + i, int(extents, int64)))
         return
      end do
      if (abs(factor - 1.0_wp) > 0.0_wp .or. abs(shift) > 0.0_wp) z = z*factor + shift
   end subroutine unpack

   !> Whether a number is one of the marks or not valid; comparing what is not finite would trap.
   pure logical function is_missing(z, marks, valid)
      real(wp), intent(in) :: z, marks(2), valid(2)
      integer :: i

      is_missing = .false.
      if (.not. ieee_is_finite(z)) return
      do i = 1, 2
         if (ieee_is_finite(marks(i))) is_missing = is_missing .or. abs(z - marks(i)) &
            <= same_mark*abs(marks(i))
         if (ieee_is_finite(valid(i))) is_missing = is_missing .or. merge(z < valid(i), &
            z > valid(i), i == 1)
      end do
   end function is_missing

   !> Where node `number` of an area lies, in brackets; empty for a profile.
   pure function place_words(number, grid) result(words)
      integer(int64), intent(in) :: number, grid(2)
      character(:), allocatable :: words

      words = ''
      if (grid(2) > 1) words = ' (node '//to_text(modulo(number - 1, grid(1)) + 1)//' in x, '// &
         to_text((number - 1)/grid(1) + 1)//' in y)'
   end function place_words

end module hdf5_part
