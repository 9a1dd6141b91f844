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

   character(*), parameter :: group = '/momentum/', passage_group = group//'transient/'
   !> Copies in SI lie in the same groups below this.
   character(*), parameter :: si = '/si'

contains

   !> Writes /momentum, of a transient that of its last time; with `has_si` the fields in SI to
   !> /si/momentum.
   subroutine write_momentum(file, fields, scaling, is_transient, has_si)
      class(hdf5_file_t), intent(inout) :: file
      type(film_fields_t), intent(in) :: fields
      type(scaling_t), intent(in) :: scaling
      logical, intent(in) :: is_transient, has_si
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
      if (has_si) then
         call link_object(file, group//'zeta', si//group//'zeta')
         call link_object(file, si//'/solution/x', si//group//'x')
      end if
      associate (u_s => scaling%speed_sum, p_h => scaling%hertz_pressure)
         call write_field('u', fields%u, 'velocity along the film', ', u/u_s', 'm/s', u_s)
         call write_field('w', fields%w, 'velocity across the film, from surface 1 to surface 2', &
            ', w/u_s', 'm/s', u_s)
         call write_field('layer_pressure', fields%pressure, 'pressure of the layers; '// &
            'cavitation is decided by its mean', ', P = p/p_h', 'Pa', p_h)
         call write_field('shear_stress', fields%shear_stress, 'shear stress tau_xz', '/p_h', &
            'Pa', p_h)
         call write_field('viscosity', fields%viscosity, 'viscosity under shear', &
            ' over ambient viscosity', 'Pa s', scaling%viscosity)
         call write_profile('reynolds_pressure', fields%reynolds_pressure, &
            'pressure by the Reynolds equation', ', P = p/p_h', 'Pa', p_h)
         call write_profile('reynolds_film_thickness', fields%reynolds_film, &
            'film thickness by the Reynolds equation', ', H = h R/b^2', 'm', scaling%film)
      end associate
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
         'T_max of the thin film, largest d tau/dp at a given shear rate: less than 1')
      call write_attribute(file, '/momentum', 'newton_steps', fields%steps)
      call write_attribute(file, '/momentum', 'factorisations', fields%factorisations)
      call write_attribute(file, '/momentum', 'linear_iterations', fields%linear_iterations)

   contains

      !> A field (layers, nx) with its axes: what it is, what the stored number is, unit and scale.
      subroutine write_field(name, values, text, definition, units, scale)
         character(*), intent(in) :: name, text, definition, units
         real(wp), intent(in), contiguous :: values(:, :)
         real(wp), intent(in) :: scale

         call write_dataset(file, group//name, values, new_label(text//definition, units, scale))
         call name_axes(file, group//name, group//'zeta', group//'x')
         if (.not. has_si) return
         call write_dataset(file, si//group//name, scale*values, new_label(text, units))
         call name_axes(file, si//group//name, si//group//'zeta', si//group//'x')
      end subroutine write_field

      !> The same of a profile (nx).
      subroutine write_profile(name, values, text, definition, units, scale)
         character(*), intent(in) :: name, text, definition, units
         real(wp), intent(in), contiguous :: values(:)
         real(wp), intent(in) :: scale

         call write_dataset(file, group//name, values, new_label(text//definition, units, scale))
         call name_axes(file, group//name, group//'x')
         if (.not. has_si) return
         call write_dataset(file, si//group//name, scale*values, new_label(text, units))
         call name_axes(file, si//group//name, si//group//'x')
      end subroutine write_profile

      !> A pure number.
      subroutine write_number(name, value, text)
         character(*), intent(in) :: name, text
         real(wp), intent(in) :: value

         call write_dataset(file, group//name, value, new_label(text, '1'))
      end subroutine write_number

   end subroutine write_momentum

   !> Writes /momentum/transient; with `has_si` what is another number in SI to
   !> /si/momentum/transient.
   subroutine write_film_passage(file, passage, scaling, has_si)
      class(hdf5_file_t), intent(inout) :: file
      type(film_passage_t), intent(in) :: passage
      type(scaling_t), intent(in) :: scaling
      logical, intent(in) :: has_si
      integer :: profiles

      profiles = passage%last/passage%stride
      associate (t => passage%time(:passage%last), s => passage%series(:, :passage%last), &
         film => scaling%film, p_h => scaling%hertz_pressure)
         call write_series('time', t, 'time of every step', ', T = t u_s/(2 b)', 's', scaling%time)
         call write_series('h_min', s(1, :), 'smallest film by the full momentum equations', &
            ', H = h R/b^2', 'm', film)
         call write_series('h_central', s(2, :), 'film at X = 0 by the full momentum equations', &
            ', H = h R/b^2', 'm', film)
         call write_series('p_max', s(3, :), &
            'largest mean pressure by the full momentum equations', ', P = p/p_h', 'Pa', p_h)
         call write_series('difference_h_min', s(1, :)/s(4, :) - 1, &
            'h_min over that of the Reynolds equation, less 1', '', '1', 1.0_wp)
         call write_series('difference_h_central', s(2, :)/s(5, :) - 1, &
            'h_central over that of the Reynolds equation, less 1', '', '1', 1.0_wp)
         call write_series('difference_p_max', s(3, :)/s(6, :) - 1, &
            'p_max over that of the Reynolds equation, less 1', '', '1', 1.0_wp)
         call write_series('difference_pressure', s(7, :), &
            'largest difference of the mean pressure from the Reynolds equation', ', over p_h', &
            'Pa', p_h)
         call write_series('difference_film', s(8, :), &
            'largest difference of the film from the Reynolds equation', ', over b^2/R', 'm', film)
         call write_series('pressure_variation', s(9, :), &
            'largest difference of pressures across the film', ', over p_h', 'Pa', p_h)
         call write_series('profile_time', passage%time(:profiles*passage%stride:passage%stride), &
            'time of the profiles', ', T = t u_s/(2 b)', 's', scaling%time)
      end associate
      call write_profiles('', 1.0_wp, 1.0_wp, new_label('mean pressure, P = p/p_h', 'Pa', &
         scaling%hertz_pressure), new_label('film thickness, H = h R/b^2', 'm', scaling%film))
      if (has_si) call write_profiles(si, scaling%hertz_pressure, scaling%film, &
         new_label('mean pressure', 'Pa'), new_label('film thickness', 'm'))

   contains

      !> One series: what it is, what the stored number is, unit and scale; a pure number has no
      !> copy.
      subroutine write_series(name, values, text, definition, units, scale)
         character(*), intent(in) :: name, text, definition, units
         real(wp), intent(in) :: values(:), scale

         call write_copy(passage_group//name, values, new_label(text//definition, units, scale))
         if (has_si .and. units /= '1') call write_copy(si//passage_group//name, scale*values, &
            new_label(text, units))
      end subroutine write_series

      !> A series in one unit, with its axis.
      subroutine write_copy(path, values, label)
         character(*), intent(in) :: path
         real(wp), intent(in) :: values(:)
         type(label_t), intent(in) :: label
         real(wp) :: copy(size(values))

         copy = values
         call write_dataset(file, path, copy, label)
         associate (start => index(path, '/', back=.true.))
            if (path(start + 1:) == 'time' .or. path(start + 1:) == 'profile_time') then
               call make_axis(file, path)
            else
               call name_axes(file, path, path(:start)//'time')
            end if
         end associate
      end subroutine write_copy

      !> Pressures and films of the profiles times their scales, below `root`.
      subroutine write_profiles(root, pressure, film, pressure_label, film_label)
         character(*), intent(in) :: root
         real(wp), intent(in) :: pressure, film
         type(label_t), intent(in) :: pressure_label, film_label
         character(:), allocatable :: path

         path = root//passage_group
         call link_object(file, root//'/solution/x', path//'x')
         call write_dataset(file, path//'pressure', pressure*passage%pressure(:, :profiles), &
            pressure_label)
         call write_dataset(file, path//'film_thickness', film*passage%film(:, :profiles), &
            film_label)
         call name_axes(file, path//'pressure', path//'x', path//'profile_time')
         call name_axes(file, path//'film_thickness', path//'x', path//'profile_time')
      end subroutine write_profiles

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
