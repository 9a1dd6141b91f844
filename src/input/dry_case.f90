!> A dry contact as it will be solved: grid, heights, loads, in SI; its heights from its two
!> surfaces, on its first grid and on finer ones.
module dry_case
   use dry_problem, only: dry_grid_t, dry_loads_t, dry_settings_t, max_nodes_to_refine
   use features, only: feature_heights, node_positions, parabola_heights
   use errors, only: error_t, fail, input_error
   use file_heights, only: level_surface, read_surface
   use measured_heights, only: heights_t
   use height_form, only: trend_t
   use input_values, only: features_of, has_shape, input_values_t, read_synthesis, surfaces
   use kinds, only: wp
   use line_contact, only: word_length
   use resampling, only: resample_heights
   use signals, only: begin_activity
   use synthetic_surface, only: synthesis_t, synthetic_heights, truncate_harmonics
   use system_limits, only: dry_memory
   use text, only: to_text
   implicit none (type, external)
   private

   public :: dry_case_t, is_refinable, make_heights, prepare_files, refine_heights, same_length

   !> Relative difference of two lengths that are the same.
   real(wp), parameter :: same_length = 1.0e-3_wp

   !> From what the heights are made on any grid.
   type :: dry_bodies_t
      !> What its namelist says, from which the heights are made on any grid, and the findings.
      type(input_values_t), allocatable :: values
      !> Folder of the namelist, with its slash.
      character(:), allocatable :: folder
      !> Heights of the files of both surfaces, once they are read.
      type(heights_t) :: files(2)
      !> What was taken off them.
      type(trend_t) :: trends(2)
      !> R of a parabola [m]; 0: there is none.
      real(wp) :: radius = 0.0_wp
      !> The first grid, on which synthetic heights are made; finer ones have the same Fourier
      !> series.
      integer :: first_nodes(2) = 0
   end type dry_bodies_t

   !> Made by `fill_dry_case` of module dry_input.
   type, extends(dry_bodies_t) :: dry_case_t
      type(dry_grid_t) :: grid
      !> Lx, Ly [m]; a line has Ly = 0.
      real(wp) :: lengths(2)
      logical :: is_periodic
      !> Composite height z_1 + z_2 (nx*ny) [m].
      real(wp), allocatable :: height(:)
      !> E' [Pa].
      real(wp) :: reduced_modulus
      type(dry_loads_t) :: loads
      type(dry_settings_t) :: settings
      !> Errors are estimated.
      logical :: has_error_bars
      !> What each ingredient of the model changes is measured.
      logical :: wants_adequacy = .true.
      !> Fields that are stored (none: all), and whether in single precision.
      character(len=word_length), allocatable :: stored_fields(:)
      logical :: is_single = .false.
      !> Relative error of the contact area for which the grid is chosen; 0: it is given.
      real(wp) :: target = 0.0_wp
      !> What the reader of the result should know about it; not allocated: nothing.
      character(:), allocatable :: note
   contains
      procedure :: is_compared, memory_on
   end type dry_case_t

contains

   !> Whether other grids are solved for error bars or for the adequacy of the model.
   pure logical function is_compared(self)
      class(dry_case_t), intent(in) :: self

      is_compared = self%has_error_bars .or. self%wants_adequacy
   end function is_compared

   !> The memory needed at most on so many nodes [bytes]; a target compares coarser grids first.
   pure function memory_on(self, nodes) result(bytes)
      class(dry_case_t), intent(in) :: self
      integer, intent(in) :: nodes(2)
      real(wp) :: bytes, refined

      refined = 0.0_wp
      if (self%is_compared()) refined = product(real(nodes, wp))
      if (refined > max_nodes_to_refine) refined = merge(real(max_nodes_to_refine, wp), 0.0_wp, &
         self%target > 0.0_wp)
      bytes = dry_memory(nodes, self%is_periodic, refined)
   end function memory_on

   !> Fills the heights on the grid of `dry`. Findings: what the surfaces find.
   subroutine make_heights(dry)
      type(dry_case_t), intent(inout) :: dry
      integer :: i

      do i = 1, size(surfaces)
         call add_surface(dry, i)
      end do
      if (.not. allocated(dry%height)) allocate (dry%height(dry%grid%nx*dry%grid%ny), source=0.0_wp)
   end subroutine make_heights

   !> The surface on `nodes` in x and y: formulas at the new nodes, synthetic and periodic heights
   !> by their Fourier series. Errors (input_error): as the findings of `make_heights`.
   subroutine refine_heights(dry, nodes, error)
      type(dry_case_t), intent(inout) :: dry
      integer, intent(in) :: nodes(2)
      type(error_t), allocatable, intent(out) :: error

      dry%grid%nx = nodes(1)
      dry%grid%ny = nodes(2)
      deallocate (dry%height)
      call make_heights(dry)
      associate (findings => dry%values%findings)
         if (findings%count > 0) call fail(error, input_error, findings%report('finer grid'))
      end associate
   end subroutine refine_heights

   !> False where a file without a period gives the heights at its nodes only: no Fourier series.
   pure logical function is_refinable(dry)
      type(dry_case_t), intent(in) :: dry

      is_refinable = dry%is_periodic .or. .not. any(has_shape(dry%values, surfaces, 'file'))
   end function is_refinable

   !> Reads the files of both surfaces, once the lengths of the domain are known, and subtracts
   !> tilt, form and the waves beyond the cut-offs. Findings: a file; heights that cannot be.
   subroutine prepare_files(dry)
      type(dry_case_t), intent(inout) :: dry
      integer :: i

      do i = 1, size(surfaces)
         if (.not. has_shape(dry%values, surfaces(i), 'file')) cycle
         if (.not. allocated(dry%files(i)%z)) call read_surface(dry%values, surfaces(i), &
            dry%folder, dry%files(i))
         if (dry%values%findings%count > 0) return
         associate (file => dry%files(i))
            where (file%spacing <= 0.0_wp) file%spacing = dry%lengths/file%grid
            call level_surface(dry%values, surfaces(i), dry%is_periodic, file, dry%trends(i), &
               dry%note)
         end associate
      end do
   end subroutine prepare_files

   !> Adds the heights of surface `i` to those of `dry`. Findings: what the surface itself finds.
   subroutine add_surface(dry, i)
      type(dry_case_t), intent(inout) :: dry
      integer, intent(in) :: i
      type(error_t), allocatable :: error
      type(synthesis_t) :: wanted
      real(wp), allocatable :: x(:), y(:), z(:)

      x = node_positions(dry%grid%nx, dry%lengths(1), dry%is_periodic)
      y = node_positions(dry%grid%ny, dry%lengths(2), dry%is_periodic)   ! of a line 0 alone
      select case (dry%values%word_value(surfaces(i), 'shape'))
      case ('file')
         call add_file(dry, i, z)
      case ('synthetic')
         call read_synthesis(dry%values, surfaces(i), maxval(dry%lengths), &
            2.0_wp*dry%lengths(1)/dry%first_nodes(1), wanted)
         if (dry%values%findings%count > 0) return
         call begin_activity('making the surface')
         call synthetic_heights(wanted, dry%first_nodes, dry%lengths(1), max(dry%lengths(2), &
            tiny(1.0_wp)), z, error)
         if (allocated(error)) then
            call dry%values%refuse(surfaces(i), 'shape', error%message)
         else if (any([dry%grid%nx, dry%grid%ny] /= dry%first_nodes)) then
            call resample_heights(dry%first_nodes, [dry%grid%nx, dry%grid%ny], z, &
               at_centres=.not. dry%is_periodic)
         end if
      case ('parabola')
         z = parabola_heights(dry%radius, x, y, dry%lengths, dry%is_periodic)
      case ('feature', 'sinusoid')
         z = feature_heights(features_of(dry%values, surfaces(i)), x, dry%grid%ny, &
            dry%lengths(1), dry%is_periodic)
      case default   ! smooth, or refused
         return
      end select
      if (dry%values%findings%count > 0) return
      if (dry%values%is_given(surfaces(i), 'harmonics')) then   ! the truncated series, (4.1)
         if (dry%is_periodic) then
            call truncate_harmonics(dry%values%integer_value(surfaces(i), 'harmonics'), &
               [dry%grid%nx, dry%grid%ny], z, error)
         else
            call fail(error, input_error, 'found harmonics with periodic = .false., expected '// &
               '.true.')
         end if
         if (allocated(error)) call dry%values%refuse(surfaces(i), 'harmonics', error%message)
      end if
      if (allocated(dry%height)) then
         dry%height = dry%height + z
      else
         call move_alloc(z, dry%height)
      end if
   end subroutine add_surface

   !> Heights of a file, resampled if periodic. Findings: another length; other nodes if open.
   subroutine add_file(dry, i, z)
      type(dry_case_t), intent(inout) :: dry
      integer, intent(in) :: i
      real(wp), allocatable, intent(out) :: z(:)
      character(:), allocatable :: fault
      real(wp) :: length
      integer :: k

      fault = ''
      associate (file => dry%files(i), nodes => [dry%grid%nx, dry%grid%ny])
         do k = merge(2, 1, dry%grid%ny > 1), 1, -1
            length = file%grid(k)*file%spacing(k)
            if (length <= 0.0_wp) cycle
            if (abs(length - dry%lengths(k)) > same_length*dry%lengths(k)) fault = &
               'found nodes times spacing ' // to_text(length) // ' m, expected the '// &
               'length of the domain, ' // to_text(dry%lengths(k)) // ' m'
         end do
         call begin_activity('making the surface')
         if (fault == '' .and. any(file%grid /= nodes) .and. .not. dry%is_periodic) fault = &
            'found ' // to_text(file%grid(1)) // ' x ' // to_text(file%grid(2)) &
            // ' nodes, expected ' // to_text(nodes(1)) // ' x ' // to_text(nodes(2)) &
            // ' as in the other surface'
         if (fault == '') then
            z = file%z
            if (any(file%grid /= nodes)) call resample_heights(file%grid, nodes, z)
         end if
      end associate
      if (fault /= '') call dry%values%refuse(surfaces(i), 'file', fault)
   end subroutine add_file

end module dry_case
