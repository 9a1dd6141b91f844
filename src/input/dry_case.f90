!> A dry contact as it will be solved: grid, heights, loads, in SI; its heights from its two
!> surfaces, on its first grid and on finer ones.
module dry_case
   use dry_problem, only: dry_grid_t, dry_loads_t, dry_settings_t, max_nodes_to_refine
   use features, only: feature_heights, node_positions, parabola_heights
   use errors, only: error_t, fail, input_error
   use file_heights, only: level_surface
   use measured_heights, only: heights_t
   use input_values, only: features_of, input_values_t, read_synthesis, surfaces
   use kinds, only: wp
   use line_contact, only: word_length
   use resampling, only: resample_heights
   use signals, only: begin_activity
   use synthetic_surface, only: synthesis_t, synthetic_heights, truncate_harmonics
   use system_limits, only: dry_memory
   use text, only: to_text
   implicit none (type, external)
   private

   public :: dry_case_t, make_heights, same_length

   !> Relative difference of two lengths that are the same.
   real(wp), parameter :: same_length = 1.0e-3_wp

   !> From what the heights are made on any grid.
   type :: dry_bodies_t
      !> What its namelist says, from which the heights are made on any grid, and the findings.
      type(input_values_t), allocatable :: values
      !> Heights of the files of both surfaces.
      type(heights_t), allocatable :: files(:)
      !> R of a parabola [m]; 0: there is none.
      real(wp) :: radius = 0.0_wp
      !> The first grid, of synthetic heights: finer ones have the same Fourier series.
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

   !> Fills the heights on the grid of `dry`, the first or another one, as the sum of both surfaces:
   !> formulas at the nodes, synthetic and periodic heights by Fourier series. Findings: theirs.
   subroutine make_heights(dry)
      type(dry_case_t), intent(inout) :: dry
      type(error_t), allocatable :: error
      type(synthesis_t) :: wanted
      real(wp), allocatable :: x(:), y(:), z(:)
      integer :: i

      if (allocated(dry%height)) deallocate (dry%height)
      x = node_positions(dry%grid%nx, dry%lengths(1), dry%is_periodic)
      y = node_positions(dry%grid%ny, dry%lengths(2), dry%is_periodic)   ! of a line 0 alone
      do i = 1, size(surfaces)
         select case (dry%values%word_value(surfaces(i), 'shape'))
         case ('file')
            call fit_file(dry, i, z)
         case ('synthetic')
            call read_synthesis(dry%values, surfaces(i), maxval(dry%lengths), &
               2.0_wp*dry%lengths(1)/dry%first_nodes(1), wanted)
            if (dry%values%findings%count > 0) cycle
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
            cycle
         end select
         if (dry%values%findings%count > 0) cycle
         if (dry%values%is_given(surfaces(i), 'harmonics')) then   ! the truncated series, (4.1)
            if (dry%is_periodic) then
               call truncate_harmonics(dry%values%integer_value(surfaces(i), 'harmonics'), &
                  [dry%grid%nx, dry%grid%ny], z, error)
            else
               call fail(error, input_error, &
                  'found harmonics with periodic = .false., expected .true.')
            end if
            if (allocated(error)) call dry%values%refuse(surfaces(i), 'harmonics', error%message)
         end if
         if (allocated(dry%height)) then
            dry%height = dry%height + z
         else
            call move_alloc(z, dry%height)
         end if
      end do
      if (.not. allocated(dry%height)) allocate (dry%height(dry%grid%nx*dry%grid%ny), source=0.0_wp)
   end subroutine make_heights

   !> Heights of file `i`, resampled if periodic; only a target needs those of the file once more.
   !> Findings: another length; other nodes if open.
   subroutine fit_file(dry, i, z)
      type(dry_case_t), intent(inout) :: dry
      integer, intent(in) :: i
      real(wp), allocatable, intent(out) :: z(:)
      character(:), allocatable :: fault
      real(wp) :: length
      integer :: k

      fault = ''
      associate (file => dry%files(i), nodes => [dry%grid%nx, dry%grid%ny], &
         grid => int(dry%files(i)%sums%grid))
         do k = merge(2, 1, dry%grid%ny > 1), 1, -1
            length = grid(k)*file%spacing(k)
            if (length <= 0.0_wp) cycle
            if (abs(length - dry%lengths(k)) > same_length*dry%lengths(k)) fault = &
               'found nodes times spacing ' // to_text(length) // ' m, expected the '// &
               'length of the domain, ' // to_text(dry%lengths(k)) // ' m'
         end do
         call begin_activity('making the surface')
         if (fault == '' .and. any(grid /= nodes) .and. .not. dry%is_periodic) fault = &
            'found ' // to_text(grid(1)) // ' x ' // to_text(grid(2)) &
            // ' nodes, expected ' // to_text(nodes(1)) // ' x ' // to_text(nodes(2)) &
            // ' as in the other surface'
         if (fault /= '') then
            call dry%values%refuse(surfaces(i), 'file', fault)
            return
         end if
         if (dry%target > 0.0_wp) then
            z = file%z
         else
            call move_alloc(file%z, z)
         end if
         if (any(grid /= nodes)) call resample_heights(grid, nodes, z)
      end associate
   end subroutine fit_file

end module dry_case
