!> The sections of a dry result, all in SI: /scaling, /solution, /sweep and /summary; /surface by
!> module dry_surface_section.
module dry_result
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use, intrinsic :: iso_fortran_env, only: int64
   use analytic_heights, only: node_positions
   use adequacy_section, only: from_estimates, write_influence
   use dry_adequacy, only: coarsening, compared, dry_adequacy_t
   use dry_case, only: dry_case_t
   use dry_problem, only: no_hardness
   use dry_scaling, only: dry_scaling_t, load_number
   use dry_surface_section, only: write_surface
   use dry_quantities, only: describe, dry_count, dry_fields_t, dry_outcome_t, dry_table, load, &
      mean_pressure
   use errors, only: error_t
   use hdf5_axes, only: link_object, make_counter, name_axes, write_field
   use hdf5_dataset, only: label_t, new_label, write_attribute, write_dataset, write_zeros
   use hdf5_file, only: hdf5_file_t
   use kinds, only: wp
   use missing_value, only: not_known
   use quantity_text, only: number_text
   use roughness, only: roughness_t
   use text, only: joined
   implicit none (type, external)
   private

   public :: write_dry_adequacy, write_dry_result

   !> States of the surface with a roughness.
   character(len=10), parameter :: states(3) = [character(len=10) :: 'undeformed', 'loaded', &
      'unloaded']
   character(len=15), parameter :: times(3) = [character(len=15) :: 'before loading', &
      'under load', 'after unloading']

contains

   !> Writes the quantities of every load of an `outcome` with their estimated errors and the
   !> fields of the last. Fails (internal_error) if FFTW does.
   subroutine write_dry_result(file, dry, outcome, error)
      class(hdf5_file_t), intent(inout) :: file
      type(dry_case_t), intent(in) :: dry
      type(dry_outcome_t), intent(in) :: outcome
      type(error_t), allocatable, intent(out) :: error
      integer :: k

      associate (rows => outcome%rows)
         call write_scaling(file, dry, outcome%scaling, rows(size(rows))%values(mean_pressure))
         call write_fields(file, dry, outcome%fields)
         call make_counter(file, '/sweep/step', size(rows), 'number of the load')
         do k = 1, dry_count
            call write_quantity(file, dry, outcome, k)
         end do
         call write_column(file, 'kkt', rows%kkt, &
            new_label('violation of the contact conditions', '1'))
         call write_dataset(file, '/sweep/fft_pairs', int(rows%fft_pairs, int64), &
            new_label('pairs of transforms, in pairs of the full grid', '1'))
         call name_axes(file, '/sweep/fft_pairs', 'step')
         do k = 1, size(states)
            call write_roughness(file, k, rows%roughness(k), dry%grid%ny == 1)
         end do
      end associate
      call write_costs(file, outcome)
      call write_surface(file, dry, outcome%fields, error)
   end subroutine write_dry_result

   !> What the solution took: /report/cpu_..., /report/transforms.
   subroutine write_costs(file, outcome)
      class(hdf5_file_t), intent(inout) :: file
      type(dry_outcome_t), intent(in) :: outcome

      call write_dataset(file, '/report/cpu_seconds', sum(outcome%seconds(:2)), &
         new_label('processor time of the solution, planning of the transforms included', 's'))
      call write_dataset(file, '/report/cpu_prepare_seconds', outcome%seconds(1), &
         new_label('the part for planning', 's'))
      call write_dataset(file, '/report/wall_solve_seconds', outcome%seconds(3), &
         new_label('wall time of the solution without planning', 's'))
      call write_dataset(file, '/report/transforms', real(outcome%transforms, wp), &
         new_label('transforms: size in x, in y, pairs in double, pairs in single precision', '1'))
      call make_counter(file, '/report/grid', size(outcome%transforms, 2), &
         'number of the grid of the transforms')
      call make_counter(file, '/report/transform_column', size(outcome%transforms, 1), &
         'number of: size in x, in y, pairs in double, pairs in single precision')
      call name_axes(file, '/report/transforms', 'transform_column grid')
   end subroutine write_costs

   !> /scaling: E', and of a periodic rough surface the numbers of the last load on which a contact
   !> of its shape depends, by (3.19) of the thesis E' s/(4 w), with a hardness H_s L/w too; w is
   !> the mean pressure times L. Without load there are none.
   subroutine write_scaling(file, dry, scaling, mean_pressure)
      class(hdf5_file_t), intent(inout) :: file
      type(dry_case_t), intent(in) :: dry
      type(dry_scaling_t), intent(in) :: scaling
      real(wp), intent(in) :: mean_pressure

      call file%create_group('/scaling')
      call write_attribute(file, '/scaling', 'reduced_modulus', dry%reduced_modulus, 'Pa')
      if (.not. dry%is_periodic .or. scaling%is_flat .or. .not. mean_pressure > 0.0_wp) return
      call write_attribute(file, '/scaling', 'similarity_number', load_number(scaling%pressure, &
         mean_pressure), '1')
      if (dry%loads%hardness < no_hardness) call write_attribute(file, '/scaling', &
         'hardness_number', load_number(dry%loads%hardness, mean_pressure), '1')
   end subroutine write_scaling

   !> /solution.
   subroutine write_fields(file, dry, fields)
      class(hdf5_file_t), intent(inout) :: file
      type(dry_case_t), intent(in) :: dry
      type(dry_fields_t), intent(in) :: fields
      character(:), allocatable :: axes
      character(*), parameter :: unloaded = 'composite height after unloading', &
         deformation = 'plastic deformation'

      axes = trim(merge('x  ', 'x y', dry%grid%ny == 1))
      call write_field(file, '/solution/x', node_positions(dry%grid%nx, dry%lengths(1), &
         dry%is_periodic), new_label('position', 'm'), '=')
      if (dry%grid%ny > 1) call write_field(file, '/solution/y', node_positions(dry%grid%ny, &
         dry%lengths(2), dry%is_periodic), new_label('position across', 'm'), '=')
      call put('pressure', 'contact pressure', 'Pa', fields%pressure)
      call put('gap', 'gap between the surfaces', 'm', fields%gap)
      call put('height_undeformed', 'composite height before loading', 'm', dry%height)
      call put('height_loaded', 'composite height under load', 'm', fields%height_loaded)
      if (allocated(fields%height_unloaded)) then
         call put('height_unloaded', unloaded, 'm', fields%height_unloaded)
         call put('plastic_deformation', deformation, 'm', fields%plastic_deformation)
      else
         call put('height_unloaded', unloaded, 'm', dry%height)
         call put('plastic_deformation', deformation, 'm')
      end if
      call file%create_group('/si')
      call link_object(file, '/solution', '/si/solution')

   contains

      !> One field (nx, ny), if it is to be stored; without values it is zero everywhere.
      subroutine put(name, long_name, units, values)
         character(*), intent(in) :: name, long_name, units
         real(wp), intent(in), optional :: values(dry%grid%nx, dry%grid%ny)
         character(:), allocatable :: path
         type(label_t) :: label

         if (size(dry%stored_fields) > 0 .and. .not. any(dry%stored_fields == name)) return
         path = '/solution/'//name
         label = new_label(long_name, units)
         associate (nx => dry%grid%nx, ny => dry%grid%ny)
            if (.not. present(values)) then
               call write_zeros(file, path, pack([nx, ny], [.true., ny > 1]), label, dry%is_single)
            else if (ny == 1) then
               call write_dataset(file, path, values(:, 1), label, dry%is_single)
            else
               call write_dataset(file, path, values, label, dry%is_single)
            end if
            call name_axes(file, path, axes)
         end associate
      end subroutine put

   end subroutine write_fields

   !> Quantity `k` of the table, one value for each load, with its estimated errors unless it is
   !> given; that of the last load in /summary.
   subroutine write_quantity(file, dry, outcome, k)
      class(hdf5_file_t), intent(inout) :: file
      type(dry_case_t), intent(in) :: dry
      type(dry_outcome_t), intent(in) :: outcome
      integer, intent(in) :: k
      real(wp) :: errors(size(outcome%rows))
      character(:), allocatable :: missing, name, text, unit

      call describe(k, dry%grid, text, unit)
      if (unit == '') return
      name = trim(dry_table(k)%name)
      call write_column(file, name, outcome%rows%values(k), new_label(text, unit))
      if (any(k == [load, mean_pressure]) .and. allocated(dry%loads%mean_pressure)) return
      errors = not_known()
      missing = 'no other grids are compared'
      if (allocated(outcome%errors)) then
         errors = outcome%errors(k, :)
         missing = 'no solution, or too few other grids with one'
      end if
      call write_attribute(file, '/sweep/'//name, 'error_estimate', errors)
      if (.not. all(ieee_is_finite(errors))) call write_attribute(file, '/sweep/'//name, &
         'no_estimate', missing)
      if (.not. dry_table(k)%is_summary) return
      associate (last => size(errors), path => '/summary/'//name)
         call write_dataset(file, path, outcome%rows(last)%values(k), new_label(text, unit))
         if (unit == '1') call write_attribute(file, path, 'units', unit)
         call write_attribute(file, path, 'error_estimate', errors(last))
         if (.not. ieee_is_finite(errors(last))) call write_attribute(file, path, 'no_estimate', &
            missing)
      end associate
   end subroutine write_quantity

   !> One column of /sweep.
   subroutine write_column(file, name, values, label)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: name
      real(wp), intent(in) :: values(:)
      type(label_t), intent(in) :: label
      real(wp) :: copy(size(values))

      copy = values
      call write_field(file, '/sweep/'//name, copy, label, 'step')
   end subroutine write_column

   !> /sweep/<name>_<state>: the roughness parameters of state `k` for each load.
   subroutine write_roughness(file, k, roughness, is_line)
      class(hdf5_file_t), intent(inout) :: file
      integer, intent(in) :: k
      type(roughness_t), intent(in) :: roughness(:)
      logical, intent(in) :: is_line
      character(*), parameter :: names(*) = [character(len=3) :: 'ra', 'rq', 'rz', 'rsk', 'rku']
      character(len=44) :: texts(size(names))
      real(wp) :: values(size(roughness), size(names))
      integer :: i

      texts = [character(len=44) :: 'arithmetic mean height', 'rms height', &
         'highest less lowest'//merge(', mean of five parts', repeat(' ', 20), is_line), &
         'skewness', 'kurtosis']
      values = reshape([roughness%ra, roughness%rq, roughness%rz, roughness%rsk, roughness%rku], &
         shape(values))
      do i = 1, size(names)
         call write_column(file, trim(names(i))//'_'//trim(states(k)), values(:, i), &
            new_label(trim(texts(i))//' '//trim(times(k)), merge('m', '1', i <= 3)))
      end do
   end subroutine write_roughness

   !> /adequacy: a group for each ingredient, with a dataset for each known change.
   subroutine write_dry_adequacy(file, adequacy)
      class(hdf5_file_t), intent(inout) :: file
      type(dry_adequacy_t), intent(in) :: adequacy
      character(:), allocatable :: source
      integer :: i

      if (.not. allocated(adequacy%rows)) return
      do i = 1, size(adequacy%rows)
         associate (row => adequacy%rows(i))
            source = 'grids with '//number_text(adequacy%ratio, 3)//' and ' &
               //number_text(coarsening*adequacy%ratio, 3)//' times the spacing'
            if (row%name == 'area') source = 'the nodes of the result'
            if (row%is_numerical) source = from_estimates
            call write_influence(file, row, source, dry_table(compared)%name, row%change, row%error)
         end associate
      end do
      if (size(adequacy%rows) == 0) call file%create_group('/adequacy')
      call write_attribute(file, '/adequacy', 'about', 'relative change under '// &
         'mean_pressure, the largest of the sweep, where an ingredient is left out, measured '// &
         'on coarser grids; of the grid the error estimate; attribute error_estimate: error '// &
         'of the change; no dataset: not known')
      call write_attribute(file, '/adequacy', 'accuracy', adequacy%accuracy)
      call write_attribute(file, '/adequacy', 'mean_pressure', adequacy%mean_pressure)
      call write_attribute(file, '/adequacy', 'judged_by', joined(dry_table(compared)%name, ', '))
   end subroutine write_dry_adequacy

end module dry_result
