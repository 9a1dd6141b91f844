!> A dry contact as it will be solved: grid, heights, loads, in SI.
module dry_case
   use dry_problem, only: dry_grid_t, dry_loads_t, dry_settings_t, max_nodes_to_refine
   use measured_heights, only: heights_t
   use height_form, only: trend_t
   use input_values, only: input_values_t
   use kinds, only: wp
   use line_contact, only: word_length
   use system_limits, only: dry_memory
   implicit none (type, external)
   private

   public :: dry_case_t

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

end module dry_case
