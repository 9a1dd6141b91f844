!> &asperities: the law of rough surfaces in contact, from its keys or a table.
module asperities_input
   use asperities, only: asperities_t, greenwood_tripp, new_law
   use column_table, only: column_table_t, read_columns
   use errors, only: error_t, fail, input_error
   use hdf5_input, only: hdf5_input_t, is_hdf5, open_hdf5_input
   use input_values, only: input_values_t
   use kinds, only: wp
   use text, only: to_text
   implicit none (type, external)
   private

   public :: read_asperities

   !> Columns of a table, and their names in the result of a dry sweep.
   character(len=24), parameter :: columns(2) = [character(len=24) :: 'gap [m]', 'pressure [Pa]']
   character(len=22), parameter :: datasets(2) = [character(len=22) :: '/sweep/mean_separation', &
      '/sweep/mean_pressure']
   !> Decay length of Persson's law over rms height, where it is not given.
   real(wp), parameter :: usual_decay = 0.45_wp

contains

   !> Reads &asperities, if any, with the table `file`; `modulus` [Pa]. Findings: the table.
   subroutine read_asperities(values, file, modulus, law)
      type(input_values_t), intent(inout) :: values
      character(*), intent(in) :: file
      real(wp), intent(in) :: modulus
      type(asperities_t), allocatable, intent(out) :: law
      type(error_t), allocatable :: error
      real(wp), allocatable :: rows(:, :)
      real(wp) :: roughness, decay

      if (.not. values%has_group('asperities')) return
      allocate (law)
      roughness = values%real_value('asperities', 'rms_height')
      select case (values%word_value('asperities', 'law'))
      case ('exponential')
         decay = values%real_value('asperities', 'decay_length', usual_decay*roughness)
         law = new_law(roughness, [0.0_wp, decay], values%real_value('asperities', &
            'contact_pressure')*[1.0_wp, exp(-1.0_wp)])
      case ('greenwood_tripp')
         law = greenwood_tripp(roughness, values%real_value('asperities', &
            'density_radius_height'), values%real_value('asperities', 'height_over_radius'), &
            modulus)
      case default
         call read_law(file, rows, error)
         if (allocated(error)) then
            call values%refuse('asperities', 'file', error%message)
            deallocate (law)
            return
         end if
         law = new_law(roughness, rows(:, 1), rows(:, 2))
      end select
      law%has_flow_factor = values%word_value('asperities', 'flow') == 'patir_cheng'
      law%boundary_friction = values%real_value('asperities', 'boundary_friction')
   end subroutine read_asperities

   !> Reads gaps [m], made rising, and pressures [Pa] (rows, 2). Errors: a file of another form; a
   !> pressure that does not fall.
   subroutine read_law(file, rows, error)
      character(*), intent(in) :: file
      real(wp), allocatable, intent(out) :: rows(:, :)
      type(error_t), allocatable, intent(out) :: error
      type(column_table_t) :: table
      integer :: i, n

      if (is_hdf5(file)) then
         call read_sweep(file, rows, error)
      else
         table = column_table_t(columns, [-1.0e-3_wp, 1.0e-3_wp], [1.0e-3_wp, 1.0e13_wp])
         call read_columns(file, table, error)
         if (.not. allocated(error)) call move_alloc(table%values, rows)
      end if
      if (allocated(error)) return
      n = size(rows, 1)
      i = findloc(rows(2:, 1) > rows(:n - 1, 1) .and. rows(2:, 2) < rows(:n - 1, 2), .false., dim=1)
      if (i > 0) call fail(error, input_error, file//': found '//to_text(rows(i + 1, 2), 4)// &
         ' Pa at '//to_text(rows(i + 1, 1), 4)//' m behind '//to_text(rows(i, 2), 4)//' Pa at '// &
         to_text(rows(i, 1), 4)//' m, expected a pressure that falls as the gap grows')
   end subroutine read_law

   !> Reads the loads of a dry sweep, from the heaviest to the lightest that leaves a gap.
   subroutine read_sweep(file, rows, error)
      character(*), intent(in) :: file
      real(wp), allocatable, intent(out) :: rows(:, :)
      type(error_t), allocatable, intent(out) :: error
      type(hdf5_input_t) :: reader
      real(wp), allocatable :: gaps(:), pressures(:)

      call open_hdf5_input(reader, file, error)
      if (allocated(error)) return
      gaps = reader%reals(datasets(1))
      pressures = reader%reals(datasets(2))
      call reader%close(error)
      if (allocated(error)) return
      rows = reshape([gaps(size(gaps):1:-1), pressures(size(gaps):1:-1)], [size(gaps), 2])
      if (size(gaps) < 2) call fail(error, input_error, file//': found '//to_text(size(gaps)) &
         //' load, expected a dry sweep with two or more')
   end subroutine read_sweep

end module asperities_input
