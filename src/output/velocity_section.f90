!> /velocity of a result file: the velocity of the oil across the film.
module velocity_section
   use hdf5_attribute, only: write_attribute
   use hdf5_axes, only: link_object, make_axis, name_axes
   use hdf5_dataset, only: new_label, write_dataset
   use hdf5_file, only: hdf5_file_t
   use kinds, only: wp
   use scaling, only: scaling_t
   implicit none (type, external)
   private

   public :: write_velocity

contains

   !> Writes /velocity; `u` (layers + 1, nx) as module shear_stresses computes it.
   subroutine write_velocity(file, u, scaling)
      class(hdf5_file_t), intent(inout) :: file
      real(wp), intent(in), contiguous :: u(:, :)
      type(scaling_t), intent(in) :: scaling
      integer :: i

      call file%create_group('/velocity')
      call write_attribute(file, '/velocity', 'about', 'velocity of the oil at the nodes '// &
         '/solution/x, of the same time, by the Reynolds equation; a straight line where P = 0')
      call link_object(file, '/solution/x', '/velocity/x')
      call write_dataset(file, '/velocity/zeta', [(real(i, wp)/(size(u, 1) - 1), i=0, size(u, 1) &
         - 1)], new_label('place across the film, z/h: 0 at surface 1, 1 at surface 2', '1'))
      call make_axis(file, '/velocity/zeta')
      call write_dataset(file, '/velocity/u', u, new_label('velocity along the film, u/u_s', &
         'm/s', scaling%speed_sum))
      call name_axes(file, '/velocity/u', '/velocity/zeta', '/velocity/x')
   end subroutine write_velocity

end module velocity_section
