!> Quantities of a dry contact under one load. One table defines them; results, error estimates,
!> targets, adequacy and the closing table read it. SI; loads and energies of a line per metre of
!> its length.
module dry_quantities
   use, intrinsic :: iso_fortran_env, only: real32
   use contact_edges, only: crest_of, find_edges, line_excess
   use dry_problem, only: dry_problem_t, dry_scaling_t, dry_solution_t, kernel_open
   use kinds, only: pi, wp
   use roughness, only: roughness_t
   implicit none (type, external)
   private

   public :: compared_values, fill_row, yields

   !> Rows of the table.
   integer, parameter, public :: mean_pressure = 1, load = 2, contact_area = 3, &
      corrected_area = 4, plastic_area = 5, plasticity_index = 6, mean_separation = 7, &
      separation = 8, datum = 9, p_max = 10, dp_max = 11, dp_mean = 12, elastic_energy = 13, &
      dissipated_energy = 14

   !> Kinds of factors of the error estimates.
   integer, parameter :: factor_area = 1, factor_corrected = 2, factor_separation = 3, &
      factor_pressure = 4, factor_energy = 5
   integer, parameter, public :: factor_count = 5

   !> Definition of a quantity.
   type, public :: dry_quantity_t
      !> Name in the result.
      character(len=31) :: name
      !> Text of its data set.
      character(len=54) :: text
      !> Unit, for a line and for an area; empty: not stored.
      character(len=3) :: units(2)
      integer :: factor
      !> Whether /summary has that of the last load.
      logical :: is_summary = .false.
   end type dry_quantity_t

   character(len=3), parameter :: none(2) = '1', metres(2) = 'm', pascals(2) = 'Pa', &
      newtons(2) = [character(len=3) :: 'N/m', 'N'], joules(2) = [character(len=3) :: 'J/m', 'J']
   type(dry_quantity_t), parameter, public :: dry_table(*) = [ &
      dry_quantity_t('mean_pressure', 'load over nominal area', pascals, factor_separation), &
      dry_quantity_t('load', 'load', newtons, factor_separation), &
      dry_quantity_t('contact_area_fraction', 'nodes with p > 0 over all', none, factor_area, &
         .true.), &
      dry_quantity_t('contact_area_fraction_corrected', &
         'contact area less (pi - 1 + ln 2)/24 of its perimeter', &
         [character(len=3) :: '', '1'], factor_corrected), &
      dry_quantity_t('plastic_area_fraction', 'nodes with p = hardness over all', none, &
         factor_area, .true.), &
      dry_quantity_t('plasticity_index', 'plastic over contact area', none, factor_area), &
      dry_quantity_t('mean_separation', 'plane to mean of the loaded surface', metres, &
         factor_separation, .true.), &
      dry_quantity_t('separation', 'plane to mean of the undeformed surface', metres, &
         factor_separation), &
      dry_quantity_t('datum', 'mean of deflection less height where 0 < p < hardness', metres, &
         factor_separation), &
      dry_quantity_t('p_max', 'largest pressure', pascals, factor_pressure, .true.), &
      dry_quantity_t('dp_max', 'largest plastic deformation', metres, factor_energy), &
      dry_quantity_t('dp_mean', 'mean plastic deformation', metres, factor_energy), &
      dry_quantity_t('elastic_energy', 'stored elastic energy', joules, factor_energy), &
      dry_quantity_t('dissipated_energy', 'energy dissipated by plastic deformation', joules, &
         factor_energy)]

   integer, parameter, public :: dry_count = size(dry_table)

   !> One load: its quantities, the data of their errors, and how it was solved.
   type, public :: dry_row_t
      real(wp) :: values(dry_count) = 0.0_wp
      !> Largest pressure between the nodes [Pa].
      real(wp) :: p_crest = 0.0_wp
      integer :: nodes = 0
      !> Pairs of neighbours of which only one is in contact (second: at the hardness), and the
      !> random share of the load due to the former; see `find_edges`.
      integer :: edges(2) = 0
      real(wp) :: edge_load = 0.0_wp
      !> Error measure reached [-].
      real(wp) :: kkt = huge(1.0_wp)
      integer :: fft_pairs = 0, cycles = 0
      logical :: is_converged = .false.
      !> Why the iteration ended.
      character(:), allocatable :: reason
      !> Of the undeformed, the loaded and the unloaded surface.
      type(roughness_t) :: roughness(3)
   end type dry_row_t

   !> Fields of the last load, SI, each (nx*ny). Without a hardness the last two are not allocated:
   !> the unloaded surface is the undeformed one.
   type, public :: dry_fields_t
      real(wp), allocatable :: pressure(:), gap(:), height_loaded(:)
      real(wp), allocatable :: height_unloaded(:), plastic_deformation(:)
   end type dry_fields_t

   !> Quantities of all loads, fields and solution of the last.
   type, public :: dry_outcome_t
      type(dry_row_t), allocatable :: rows(:)
      !> Estimated errors of their quantities (quantity, load), NaN: not known; not allocated: not
      !> estimated.
      real(wp), allocatable :: errors(:, :)
      type(dry_fields_t) :: fields
      type(dry_solution_t) :: solution
      type(dry_scaling_t) :: scaling
      !> Pressures of all loads (nx*ny, loads), dimensionless, if the settings ask for them.
      real(real32), allocatable :: pressures(:, :)
      !> Processor time of preparing (planning of transforms) and of solving, wall time of solving,
      !> for all loads [s].
      real(wp) :: seconds(3) = 0.0_wp
      !> Transforms of all loads, as in a solution.
      integer, allocatable :: transforms(:, :)
   end type dry_outcome_t

   !> Share of a cell by which counted nodes overestimate the contact area for each pair of
   !> neighbours in and out of contact (V. A. Yastrebov, G. Anciaux and J.-F. Molinari, Tribol.
   !> Lett. 56, 2014, 171).
   real(wp), parameter :: border_share = (pi - 1.0_wp + log(2.0_wp))/24.0_wp

contains

   !> Quantities compared between grids: the crest of the pressure replaces its largest node.
   pure function compared_values(row) result(values)
      type(dry_row_t), intent(in) :: row
      real(wp) :: values(dry_count)

      values = row%values
      values(p_max) = row%p_crest
   end function compared_values

   !> Whether any node yields under a load.
   pure logical function yields(row)
      type(dry_row_t), intent(in) :: row

      yields = row%values(plastic_area) > 0.0_wp
   end function yields

   !> Fills row `i` of `outcome`, whose solution and fields are those of this load of mean pressure
   !> `pressure` [Pa], from the heights `z` [m] and the `plastic` deformation of this load alone,
   !> dimensionless.
   subroutine fill_row(problem, z, plastic, pressure, i, outcome)
      type(dry_problem_t), intent(in) :: problem
      real(wp), contiguous, intent(in) :: z(:)
      real(wp), intent(in) :: plastic(:), pressure
      integer, intent(in) :: i
      type(dry_outcome_t), intent(inout) :: outcome
      real(wp) :: area

      associate (row => outcome%rows(i), solution => outcome%solution, fields => outcome%fields, &
         scaling => outcome%scaling, n => size(z), nx => problem%grid%nx, ny => problem%grid%ny)
         row%kkt = solution%kkt
         row%fft_pairs = int(solution%report%cost%fft_pairs)
         row%cycles = solution%report%cycles
         row%is_converged = solution%report%converged
         row%reason = solution%report%reason
         row%nodes = n
         call find_edges(nx, ny, solution%pressure, problem%hardness, row%edges, row%edge_load)
         row%p_crest = crest_of(problem%grid, fields%pressure)
         if (problem%is_capped()) row%p_crest = min(row%p_crest, scaling%pressure*problem%hardness)
         area = scaling%length   ! [m] of a line, [m^2] of an area
         if (ny > 1) area = area*scaling%length*problem%grid%aspect
         associate (values => row%values)
            values(mean_pressure) = pressure
            values(load) = pressure*area
            values(contact_area) = real(solution%contacts, wp)/n
            values(plastic_area) = real(solution%capped, wp)/n
            values(plasticity_index) = real(solution%capped, wp)/solution%contacts
            values(corrected_area) = values(contact_area) - border_share*row%edges(1)/n
            if (ny == 1) values(corrected_area) = values(contact_area) &
               - line_excess(solution%pressure)/n
            values(mean_separation) = scaling%height*(sum(solution%v)/n - solution%datum &
               + sum(plastic)/n)
            ! The problem's heights have zero mean; the datum is that of the heights as given.
            values(datum) = scaling%height*solution%datum - sum(z)/n
            values(separation) = -(scaling%height*solution%datum)
            if (problem%grid%kernel == kernel_open) values(separation) = merge(0.0_wp, &
               scaling%height*(problem%top + solution%datum), ny == 1)
            values(p_max) = maxval(fields%pressure)
            values(elastic_energy) = (0.5_wp*area/n)*scaling%pressure*scaling%height &
               *sum(solution%pressure*(solution%v + problem%height))
            if (problem%is_capped()) then
               values(dp_max) = maxval(fields%plastic_deformation)
               values(dp_mean) = sum(fields%plastic_deformation)/n
               values(dissipated_energy) = scaling%pressure*problem%hardness*area*values(dp_mean)
            end if
         end associate
      end associate
   end subroutine fill_row

end module dry_quantities
