!> /momentum of a result file: the film by its full momentum equations, over X and zeta.
module momentum_section
   use film_fields, only: film_fields_t
   use film_passage, only: film_passage_t
   use hdf5_attribute, only: write_attribute
   use hdf5_axes, only: link_object, make_axis, name_axes
   use hdf5_dataset, only: label_t, new_label, write_dataset
   use hdf5_file, only: hdf5_file_t
   use kinds, only: wp
   use quantity_text, only: number_text
   use scaling, only: scaling_t
   use text, only: to_text
   implicit none (type, external)
   private

   public :: difference_sentence, write_film_passage, write_momentum

   character(*), parameter :: group = '/momentum/'

contains

   !> Writes /momentum; of a transient that of its last time.
   subroutine write_momentum(file, fields, scaling, is_transient)
      class(hdf5_file_t), intent(inout) :: file
      type(film_fields_t), intent(in) :: fields
      type(scaling_t), intent(in) :: scaling
      logical, intent(in) :: is_transient
      character(*), parameter :: about = 'the film by its full momentum equations, at the '// &
         'nodes /solution/x in layers at zeta = (z - z1)/h; '

      call file%create_group('/momentum')
      if (is_transient) then
         call write_attribute(file, '/momentum', 'about', about//'fields of the last time, '// &
            'differences of the extremes of the passage; /solution, /summary and '// &
            '/transient are those of the Reynolds equation')
      else
         call write_attribute(file, '/momentum', 'about', about//'/solution has its mean '// &
            'pressure and its film; beside it the Reynolds equation on the same nodes')
      end if
      call write_dataset(file, group//'zeta', fields%zeta, &
         new_label('place across the film, 0 at surface 1, 1 at surface 2', '1'))
      call make_axis(file, group//'zeta')
      call link_object(file, '/solution/x', group//'x')
      call write_field('u', fields%u, new_label('velocity along the film, u/u_s', 'm/s', &
         scaling%speed_sum))
      call write_field('w', fields%w, new_label('velocity across the film, from surface 1 to '// &
         'surface 2, w/u_s', 'm/s', scaling%speed_sum))
      call write_field('layer_pressure', fields%pressure, new_label('pressure of the layers, '// &
         'P = p/p_h; cavitation is decided by its mean', 'Pa', scaling%hertz_pressure))
      call write_field('shear_stress', fields%shear_stress, new_label( &
         'shear stress tau_xz/p_h', 'Pa', scaling%hertz_pressure))
      call write_field('viscosity', fields%viscosity, new_label( &
         'viscosity under shear over ambient viscosity', 'Pa s', scaling%viscosity))
      call write_dataset(file, group//'reynolds_pressure', fields%reynolds_pressure, new_label( &
         'pressure by the Reynolds equation, P = p/p_h', 'Pa', scaling%hertz_pressure))
      call write_dataset(file, group//'reynolds_film_thickness', fields%reynolds_film, &
         new_label('film thickness by the Reynolds equation, H = h R/b^2', 'm', scaling%film))
      call name_axes(file, group//'reynolds_pressure', group//'x')
      call name_axes(file, group//'reynolds_film_thickness', group//'x')
      call write_number('difference_h_min', fields%h_min, &
         'h_min over that of the Reynolds equation, less 1')
      call write_number('difference_h_central', fields%h_central, &
         'h_central over that of the Reynolds equation, less 1')
      call write_number('difference_p_max', fields%p_max, &
         'p_max over that of the Reynolds equation, less 1')
      call write_number('difference_pressure', fields%pressure_change, &
         'largest difference of the mean pressure from the Reynolds equation, over p_h')
      call write_number('pressure_variation', fields%pressure_variation, &
         'largest difference of pressures across the film, over p_h')
      call write_number('stress_rise', fields%stress_rise, &
         'T_max, largest d tau/dp at a given shear rate: a solution needs less than 1')
      call write_attribute(file, '/momentum', 'newton_steps', fields%steps)
      call write_attribute(file, '/momentum', 'factorisations', fields%factorisations)
      call write_attribute(file, '/momentum', 'linear_iterations', fields%linear_iterations)

   contains

      !> A field (layers, nx) with its axes.
      subroutine write_field(name, values, label)
         character(*), intent(in) :: name
         real(wp), intent(in), contiguous :: values(:, :)
         type(label_t), intent(in) :: label

         call write_dataset(file, group//name, values, label)
         call name_axes(file, group//name, group//'zeta', group//'x')
      end subroutine write_field

      !> A pure number.
      subroutine write_number(name, value, text)
         character(*), intent(in) :: name, text
         real(wp), intent(in) :: value

         call write_dataset(file, group//name, value, new_label(text, '1'))
      end subroutine write_number

   end subroutine write_momentum

   !> Writes /momentum/transient.
   subroutine write_film_passage(file, passage, scaling)
      class(hdf5_file_t), intent(inout) :: file
      type(film_passage_t), intent(in) :: passage
      type(scaling_t), intent(in) :: scaling
      character(len=*), parameter :: x = group//'transient/x', &
         profile_time = group//'transient/profile_time'
      integer :: profiles

      profiles = passage%last/passage%stride
      associate (t => passage%time(:passage%last), s => passage%series(:, :passage%last), &
         film => scaling%film, p_h => scaling%hertz_pressure)
         call write_series('time', t, 'T = t u_s/(2 b)', 's', scaling%time)
         call write_series('h_min', s(1, :), 'smallest film by the full momentum equations', &
            'm', film)
         call write_series('h_central', s(2, :), 'film at X = 0 likewise', 'm', film)
         call write_series('p_max', s(3, :), 'largest mean pressure likewise', 'Pa', p_h)
         call write_series('difference_h_min', s(1, :)/s(4, :) - 1, &
            'h_min over that of the Reynolds equation, less 1', '1', 1.0_wp)
         call write_series('difference_h_central', s(2, :)/s(5, :) - 1, &
            'h_central over that of the Reynolds equation, less 1', '1', 1.0_wp)
         call write_series('difference_p_max', s(3, :)/s(6, :) - 1, &
            'p_max over that of the Reynolds equation, less 1', '1', 1.0_wp)
         call write_series('difference_pressure', s(7, :), &
            'largest difference of the mean pressure from the Reynolds equation', 'Pa', p_h)
         call write_series('difference_film', s(8, :), &
            'largest difference of the film from the Reynolds equation', 'm', film)
         call write_series('pressure_variation', s(9, :), &
            'largest difference of pressures across the film', 'Pa', p_h)
         call write_series('profile_time', passage%time(:profiles*passage%stride:passage%stride), &
            'T of the profiles', 's', scaling%time)
      end associate
      call write_dataset(file, group//'transient/pressure', passage%pressure(:, :profiles), &
         new_label('mean pressure, P = p/p_h', 'Pa', scaling%hertz_pressure))
      call write_dataset(file, group//'transient/film_thickness', passage%film(:, :profiles), &
         new_label('film thickness, H = h R/b^2', 'm', scaling%film))
      call link_object(file, '/solution/x', group//'transient/x')
      call name_axes(file, group//'transient/pressure', x, profile_time)
      call name_axes(file, group//'transient/film_thickness', x, profile_time)

   contains

      !> One series.
      subroutine write_series(name, values, text, units, scale)
         character(*), intent(in) :: name, text, units
         real(wp), intent(in) :: values(:), scale
         real(wp) :: copy(size(values))

         copy = values
         call write_dataset(file, group//'transient/'//name, copy, new_label(text, units, scale))
         if (name == 'time' .or. name == 'profile_time') then
            call make_axis(file, group//'transient/'//name)
         else
            call name_axes(file, group//'transient/'//name, group//'transient/time')
         end if
      end subroutine write_series

   end subroutine write_film_passage

   !> How far the Reynolds equation is off, for the user.
   pure function difference_sentence(fields) result(words)
      type(film_fields_t), intent(in) :: fields
      character(:), allocatable :: words

      words = 'full momentum equations on '//to_text(size(fields%zeta))//' layers; beside '// &
         "Reynolds' equation on the same grid h_min "//percent(fields%h_min)//', h_central ' &
         //percent(fields%h_central)//', p_max '//percent(fields%p_max)// &
         ', pressures up to '//percent(fields%pressure_change)//' of p_h'

   contains

      !> A share with its sign.
      pure function percent(share)
         real(wp), intent(in) :: share
         character(:), allocatable :: percent

         percent = number_text(100*share, 3)//' %'
         if (share > 0.0_wp) percent = '+'//percent
      end function percent

   end function difference_sentence

end module momentum_section
