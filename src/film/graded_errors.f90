!> What each element of a graded grid adds to the error of each quantity of its solution, by one
!> solution of the transposed Newton system for each.
!>
!> With z that solution for a quantity J and y = z/diagonal (0 where cavitated), an element has the
!> share
!>
!>     s = (y(i) - y(i-1)) tau + (g - z_load) beta + quadrature
!>
!> of J_true - J. tau: error of its flux against better values of P, H and dP/dX in its middle, by
!> second differences; where P of a Newtonian oil rises or falls over three elements, within the
!> bounds of a monotone cubic, as they exceed it behind a spike. beta = -h^3/12 P'': load that the
!> straight line misses; g: what that does to J by the film. quadrature: what the sum for J itself
!> misses. The bound of the error of J is 0.65 sum |s| + 2 |sum s|.
!>
!> Fluxes in the flank of a spike that is not resolved tell nothing, and the height of its top hangs
!> on where between two nodes it lies. In front of it P = P_0 - C sqrt(distance): the grid may miss
!> the last C sqrt(spacing), half of the rise over the last four spacings. The bound of the height
!> is twice that, and the bound of P in front of them.
module graded_errors
   use graded_line, only: graded_line_t, margin, point_mobility, steep_elements
   use graded_quantities, only: evaluate_quantities, functional_count, functional_t, &
      rolling_power, second_differences, spike, top
   use graded_system, only: factorise, graded_factors_t, solve_system
   use kinds, only: wp
   use lubricant, only: fluid_density, fluid_viscosity, thins
   implicit none (type, external)
   private

   public :: estimate_errors, find_flank, hidden_spike

   !> Part of itself by which a share may be wrong: 97 % of errors are below their bounds.
   real(wp), parameter, public :: share_doubt = 0.65_wp
   !> Remainder of an adjoint over its right side.
   real(wp), parameter :: adjoint_tolerance = 1.0e-3_wp

contains

   !> Evaluates the quantities of a solved line, `values`, and the share of every element in their
   !> errors (n, functional_count); 0 where there is no such quantity.
   subroutine estimate_errors(line, slide_to_roll, factors, values, shares)
      type(graded_line_t), intent(in) :: line
      real(wp), intent(in) :: slide_to_roll
      type(graded_factors_t), intent(inout) :: factors
      real(wp), intent(out) :: values(functional_count)
      real(wp), allocatable, intent(out) :: shares(:, :)
      type(functional_t) :: list(functional_count)
      real(wp) :: z(line%n)
      real(wp), dimension(0:line%n) :: y, by_film, at_nodes
      real(wp), dimension(line%n) :: flux_error, lost_load, power_error
      integer :: first, i, j, last, n, o, of, summit

      n = line%n
      call evaluate_quantities(line, slide_to_roll, list)
      values = list%value
      call find_flank(line, first, summit, last)
      if (first > 0) then
         of = merge(top, spike, line%state%pressure(summit) >= maxval(line%state%pressure))
         list(of)%by_pressure = [(merge(1.0_wp, 0.0_wp, i == first - 1), i=0, n)]
      end if
      allocate (shares(n, functional_count), source=0.0_wp)
      call factorise(line, factors)
      if (.not. factors%is_sound) then
         shares = huge(1.0_wp)
         return
      end if
      call find_sources(line, flux_error, lost_load, power_error)
      do j = 1, functional_count
         if (.not. abs(values(j)) > 0.0_wp) cycle   ! there is none
         by_film = list(j)%by_film
         call factors%system%kernel%multiply_transposed(by_film, at_nodes)
         z = [list(j)%by_pressure(1:n - 1) - at_nodes(1:n - 1), sum(by_film)]
         call solve_system(factors, adjoint_tolerance, z, is_transposed=.true.)
         y = [0.0_wp, merge(0.0_wp, z(:n - 1)/line%diagonal, line%is_cavitated), 0.0_wp]
         do i = 1, n - 1
            o = max(-2, -i)
            by_film(i + o:i + 1) = by_film(i + o:i + 1) - y(i)*line%by_film(o:, i)
         end do
         call factors%system%kernel%multiply(by_film/line%elastic%weights, at_nodes)
         shares(:, j) = (y(1:) - y(:n - 1))*flux_error + list(j)%quadrature &
            - (0.5_wp*(at_nodes(1:) + at_nodes(:n - 1)) + z(n))*lost_load
      end do
      shares(:, rolling_power) = shares(:, rolling_power) + power_error
      if (first > 0) shares(first:last, of) = (line%state%pressure(summit) &
         - line%state%pressure(first - 1))/((2 + share_doubt)*(last - first + 1))
   end subroutine estimate_errors

   !> Error of the flux of every element, load that its straight line misses, and error of its
   !> rolling power.
   pure subroutine find_sources(line, flux_error, lost_load, power_error)
      type(graded_line_t), intent(in) :: line
      real(wp), intent(out), dimension(line%n) :: flux_error, lost_load, power_error
      real(wp), dimension(0:line%n) :: bend_p, bend_h
      real(wp), dimension(line%n) :: pressure, film, rise, slope, e, rho
      real(wp) :: unused(line%n, 3)
      logical :: is_monotone(line%n)
      integer :: last

      associate (p => line%state%pressure, h => line%state%film, n => line%n, d => line%spacing)
         last = findloc(p > 0.0_wp, .true., 1, back=.true.) - 1
         bend_p = second_differences(line, p)
         bend_h = second_differences(line, h)
         bend_p(last + 1:) = 0.0_wp
         rise = p(1:) - p(:n - 1)
         is_monotone = [.false., min(rise(2:n - 1)*rise(:n - 2), rise(2:n - 1)*rise(3:)) > 0.0_wp &
            .and. .not. thins(line%fluid), .false.]
         pressure = -d**2/16*(bend_p(1:) + bend_p(:n - 1))
         slope = -d**2/24*(bend_p(1:) - bend_p(:n - 1))
         where (is_monotone)   ! the bounds of a monotone cubic
            pressure = sign(min(abs(pressure), 0.375_wp*abs(rise)), pressure)
            slope = rise*max(-1.0_wp, min(slope/rise, 0.5_wp))
         end where
         pressure = max(0.5_wp*(p(1:) + p(:n - 1)) + pressure, 0.0_wp)
         film = 0.5_wp*(h(1:) + h(:n - 1)) - d**2/16*(bend_h(1:) + bend_h(:n - 1))
         film = max(film, 0.5_wp*min(h(1:), h(:n - 1)))
         slope = (rise + slope)/d
         call point_mobility(line%fluid, pressure, film, slope, e, unused)
         call fluid_density(line%fluid, pressure, rho)
         flux_error = rho*film - e*slope/line%lambda - line%flux
         lost_load = -d**3/24*(bend_p(1:) + bend_p(:n - 1))
         power_error = 0.5_wp*d*e/rho*slope**2/line%lambda - rise**2*line%oil%face_mobility &
            /(line%lambda*d*(line%oil%density(1:) + line%oil%density(:n - 1)))
         flux_error(last + 2:) = 0.0_wp
         power_error(last + 2:) = 0.0_wp
         lost_load(last + 2:) = 0.0_wp
      end associate
   end subroutine find_sources

   !> The flank of a spike that is not resolved, from element `first`, four spacings in front of its
   !> top at node `summit`, to `last`, behind the steep fall; 0: there is none. Newtonian oils only.
   pure subroutine find_flank(line, first, summit, last)
      type(graded_line_t), intent(in) :: line
      integer, intent(out) :: first, summit, last
      logical :: is_falling(line%n)
      integer :: exit_node

      first = 0
      if (thins(line%fluid)) return
      associate (p => line%state%pressure, n => line%n)
         is_falling = steep_elements(line, p) .and. p(:n - 1) > p(1:)
         first = findloc(is_falling, .true., 1)
         if (first == 0) return
         exit_node = findloc(p > 0.0_wp, .true., 1, back=.true.) - 1
         first = max(first - 1 - margin, 0)   ! the fall starts less steeply
         summit = first - 1 + maxloc(p(first:exit_node), 1)
         last = min(max(findloc(is_falling, .true., 1, back=.true.), summit) + margin, n)
         first = count(line%x <= line%x(summit) - 4*maxval(line%spacing(summit:summit + 1)))
      end associate
   end subroutine find_flank

   !> Marks the elements at the top of a spike that is not resolved and may pass the crest: the
   !> spacing is above the length at which it ends, and the pressure, growing with the root of the
   !> inverse spacing, would pass the crest until then.
   pure function hidden_spike(line) result(is_marked)
      type(graded_line_t), intent(in) :: line
      logical :: is_marked(line%n)
      real(wp) :: ln_mu(1), rho(1), rho_p(1), crest, length, spacing
      integer :: first, last, summit

      is_marked = .false.
      call find_flank(line, first, summit, last)
      if (first == 0) return
      associate (p => line%state%pressure, n => line%n)
         crest = maxval(p)
         call fluid_viscosity(line%fluid, [crest], ln_mu)
         call fluid_density(line%fluid, [crest], rho, rho_p)
         length = max(sqrt(line%state%film(summit)**3*exp(-min(ln_mu(1), 600.0_wp)) &
            /line%lambda), line%state%film(summit)*rho_p(1)/rho(1), 1.0e-12_wp)
         spacing = min(line%spacing(max(summit, 1)), line%spacing(min(summit + 1, n)))
         is_marked(max(summit - 1, 1):min(summit + 2, n)) = spacing > length &
            .and. p(summit)*sqrt(spacing/length) > crest
      end associate
   end function hidden_spike

end module graded_errors
