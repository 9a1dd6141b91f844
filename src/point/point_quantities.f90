!> Main quantities of a point contact in the table of line contacts (module quantities), those of a
!> line on y = 0, and their errors from the grids of its nested start and a longer domain.
module point_quantities
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use eyring_plane, only: least_sigma, plane_flow, plane_flow_t
   use features, only: surface_height
   use film_shear, only: film_limits
   use grid_errors, only: error_on_grids, orders, safety
   use kinds, only: exceeds, larger, not_known, pi, wp
   use line_contact, only: finest_wave
   use line_state, only: friction_t, line_state_t, stressed_share, turned, unknown_limits, &
      widen_limits
   use line_summary, only: line_summary_t, summary_of
   use lubricant, only: evaluate_stress, fluid_viscosity, limited_stress, wall_stress
   use point_contact, only: point_contact_t
   use point_level, only: point_level_t
   use pressure_errors, only: allow_for_spike, estimate_crest, pressure_safety, shear_doubt, &
      spike_law_t
   use quantities, only: exit_between_nodes, friction_coefficient, h_min, h_min_node, p_max, &
      quantity_count, quantity_rows, rolling_coefficient, rule_between, sliding_power, sliding_rows
   implicit none (type, external)
   private

   public :: estimate_point_errors, fill_heights, fill_point_state, summary_of_point

   !> Rows of forces.
   integer, parameter :: forces(*) = [sliding_rows, rolling_coefficient]
   !> Pressures over the largest one that count as none: what the tolerance leaves behind the exit.
   real(wp), parameter :: least_share = 1.0e-7_wp

contains

   !> Fields of the level at a `time`, friction and limits. Forces in p_h a^3/Rx, powers in that
   !> times u_s; `load` such that coefficients are those of a line.
   pure subroutine fill_point_state(level, contact, time, state)
      type(point_level_t), intent(in) :: level
      type(point_contact_t), intent(in) :: contact
      real(wp), intent(in) :: time
      type(line_state_t), intent(inout) :: state
      integer :: i

      state%x = level%x(:)
      state%y = level%y(:)
      state%pressure = reshape(level%pressure, [size(level%pressure)])
      state%film_thickness = reshape(level%film, [size(level%film)])
      state%rigid_displacement = level%rigid_displacement
      state%time = time
      state%moment = contact%moment
      state%moment%speeds = level%direction*contact%moment%speeds
      if (allocated(state%friction)) deallocate (state%friction)
      if (allocated(state%shear_stress_mean)) deallocate (state%shear_stress_mean)
      allocate (state%friction, source=friction_t(not_known(), not_known(), not_known(), &
         not_known(), not_known()))
      state%limits = unknown_limits()
      if (all(level%film > 0.0_wp)) then   ! else of an iterate
         call sum_forces(level, contact, [0, level%ny], state%friction, state%shear_stress_mean)
         associate (p => level%pressure, h => level%film, top => maxval(level%pressure))
            do i = 0, level%ny
               call widen_limits(state%limits, film_limits(contact%fluid, contact%lambda, &
                  level%direction*contact%slide_to_roll, level%x, p(:, i), h(:, i), top))
            end do
            do i = 0, level%nx
               call widen_limits(state%limits, film_limits(contact%fluid, contact%lambda, &
                  not_known(), level%y, p(i, :), h(i, :), top))
            end do
         end associate
         state%limits%stress_share = state%friction%stress_share
         if (.not. ieee_is_finite(contact%slide_to_roll)) deallocate (state%shear_stress_mean)
      end if
      state%friction%load = 2/pi*contact%load*contact%moment%load
      if (level%direction < 0.0_wp) state = turned(state)
   end subroutine fill_point_state

   !> Adds the heights of the surfaces at the time of a `state`, unless they are smooth.
   pure subroutine fill_heights(contact, state)
      type(point_contact_t), intent(in) :: contact
      type(line_state_t), intent(inout) :: state
      integer :: j

      if (finest_wave(contact) >= huge(1.0_wp)) return
      associate (x => state%x, y => state%y, time => state%time)
         state%roughness_1 = [(surface_height(contact%surface_1, x, time, y(j)), j=1, size(y))]
         state%roughness_2 = [(surface_height(contact%surface_2, x, time, y(j)), j=1, size(y))]
      end associate
   end subroutine fill_heights

   !> Quantities of the level.
   pure function summary_of_point(level, contact) result(summary)
      type(point_level_t), intent(in) :: level
      type(point_contact_t), intent(in) :: contact
      type(line_summary_t) :: summary
      type(line_state_t) :: state

      call fill_point_state(level, contact, 0.0_wp, state)
      summary = summary_of(state)
      summary%of(sliding_rows)%error_grid = summary%of(sliding_rows)%value*shear_on_highest(level, &
         contact, summary)
   end function summary_of_point

   !> Share of the friction on the row of the largest pressure that a spike there may add on finer
   !> grids; NaN: not known.
   pure real(wp) function shear_on_highest(level, contact, summary) result(share)
      type(point_level_t), intent(in) :: level
      type(point_contact_t), intent(in) :: contact
      type(line_summary_t), intent(in) :: summary
      type(line_summary_t) :: line
      type(friction_t) :: forces
      integer :: row

      row = maxloc(maxval(level%pressure, 1), 1) - 1
      call sum_forces(level, contact, [row, row], forces)
      line = summary
      line%of(friction_coefficient)%value = abs(forces%sliding)/level%hy*2/pi
      line%of(sliding_power)%value = forces%sliding/level%hy*forces%sliding_speed
      share = shear_doubt(spike_law_t(contact%fluid, contact%lambda), level%hx, line, &
         friction_coefficient)
   end function shear_on_highest

   !> Forces and the power of flow by the pressure, by the trapezoidal rule over the nodes with
   !> pressure of the first to the last of the `rows`, those on the border with differences to one
   !> side; sliding up to the exit between the nodes of each row. `stresses` (nx rows): mean shear
   !> stress at every node, 0 where there is no pressure.
   pure subroutine sum_forces(level, contact, rows, forces, stresses)
      type(point_level_t), intent(in) :: level
      type(point_contact_t), intent(in) :: contact
      integer, intent(in) :: rows(2)
      type(friction_t), intent(out) :: forces
      real(wp), allocatable, intent(out), optional :: stresses(:)
      real(wp), dimension(0:level%nx) :: ln_mu, stress
      real(wp) :: cell, flow, least, rest, sigma(2), slope(2), stressed
      type(plane_flow_t) :: plane
      integer :: i, j, x(2), y(2)

      forces%sliding_speed = 0.5_wp*level%direction*contact%slide_to_roll
      stressed = stressed_share*maxval(level%pressure)
      least = least_share*maxval(level%pressure)
      if (present(stresses)) allocate (stresses((rows(2) - rows(1) + 1)*size(stress)))
      associate (p => level%pressure, h => level%film, dx => level%hx, dy => level%hy)
         each_row: do j = rows(1), rows(2)
            call fluid_viscosity(contact%fluid, p(:, j), ln_mu)
            call evaluate_stress(contact%fluid, contact%lambda/6*forces%sliding_speed, 0*ln_mu, &
               1/h(:, j), ln_mu, stress)
            y = [max(j - 1, 0), min(j + 1, level%ny)]
            each_node: do i = 0, level%nx
               x = [max(i - 1, 0), min(i + 1, level%nx)]
               cell = 0.25_wp*(x(2) - x(1))*(y(2) - y(1))*dx*dy
               slope = [(p(x(2), j) - p(x(1), j))/((x(2) - x(1))*dx), &
                  (p(i, y(2)) - p(i, y(1)))/((y(2) - y(1))*dy)]
               forces%rolling = forces%rolling + cell*0.5_wp*h(i, j)*slope(1)
               if (.not. p(i, j) > least) cycle each_node
               flow = 0.5_wp*h(i, j)**3*exp(-ln_mu(i))/contact%lambda*sum(slope**2)
               sigma = wall_stress(contact%fluid, h(i, j)*slope)
               if (norm2(sigma) > least_sigma) then
                  plane = plane_flow(sigma, contact%fluid%rheology%ln_b_scale + ln_mu(i) &
                     - log(h(i, j)))
                  flow = flow*dot_product(plane%flow, sigma)/sum(sigma**2)*exp(plane%growth)
                  if (abs(stress(i)) > 0.0_wp) stress(i) = sign(0.5_wp*plane%stress(1) &
                     /contact%fluid%rheology%sigma_scale, stress(i))
               end if
               stress(i) = limited_stress(contact%fluid, p(i, j), stress(i))
               forces%sliding = forces%sliding + cell*stress(i)
               if (p(i, j) > stressed) forces%stress_share = max(forces%stress_share, &
                  abs(stress(i))/p(i, j))
               forces%rolling_power = forces%rolling_power + cell*flow
            end do each_node
            i = findloc(p(:, j) > least, .true., 1, back=.true.) - 1
            rest = exit_between_nodes(level%x, merge(p(:, j), 0.0_wp, p(:, j) > least)) &
               - (level%x(max(i, 0)) + 0.5_wp*dx)
            if (ieee_is_finite(rest)) forces%sliding = forces%sliding + 0.5_wp*(y(2) - y(1))*dy &
               *rest*stress(i)
            if (present(stresses)) stresses((j - rows(1))*size(stress) + 1: &
               (j - rows(1) + 1)*size(stress)) = merge(stress, 0.0_wp, p(:, j) > least)
         end do each_row
      end associate
   end subroutine sum_forces

   !> Sets the errors of `summary` from those on half and a quarter of the intervals and so on,
   !> `coarser`, from the residual, and from `near` and `far`, the domain and a longer one on the
   !> same coarse grid; without coarser grids they are not known. A spike may add to pressure and
   !> friction what it does to those of a line contact on the row of the largest pressure.
   pure subroutine estimate_point_errors(summary, contact, coarser, residual, near, far)
      type(line_summary_t), intent(inout) :: summary
      type(point_contact_t), intent(in) :: contact
      type(line_summary_t), intent(in) :: coarser(:)
      real(wp), intent(in) :: residual
      type(line_summary_t), intent(in), optional :: near, far
      real(wp) :: both(2), change, spike, values(4)
      integer :: i, k

      do i = 1, quantity_count
         associate (of => summary%of(i))
            values = not_known()
            values(1) = of%between
            do k = 1, min(size(coarser), 3)
               values(1 + k) = coarser(k)%of(i)%between
            end do
            ! with the edge of the cavity forces may err to first order
            both = error_on_grids(values, merge(orders, orders(1), all(i /= forces)), lasts=.true.)
            if (i == p_max) both(1) = pressure_safety/safety*both(1)
            spike = 0.0_wp
            if (any(i == sliding_rows)) spike = of%error_grid
            of%error_grid = quantity_rows(i)%widening*both(1) + abs(of%value - of%between)
            if (i == h_min) of%error_grid = of%error_grid + abs(of%value &
               - summary%of(h_min_node)%value)
            if (.not. exceeds(of%error_grid - abs(spike), 0.0_wp)) of%error_grid = abs(spike)
            if (quantity_rows(i)%rule /= rule_between) of%extrapolated = both(2)
            if (i == p_max .and. size(coarser) > 1) call estimate_crest(values(:3), [of%value, &
               coarser(:2)%of(i)%value], of)
         end associate
      end do
      ! A of P = B + A/sqrt(dX) by the last rise, or by half of the one before
      do k = 1, min(size(coarser), 2)
         change = summary%crests%spike - coarser(1)%crests%spike
         if (k == 2) change = 0.5_wp*(coarser(1)%crests%spike - coarser(2)%crests%spike)
         summary%crests%growing = larger(summary%crests%growing, change/(1 - sqrt(0.5_wp)))
      end do
      call allow_for_spike(spike_law_t(contact%fluid, contact%lambda), (contact%domain%x_outlet &
         - contact%domain%x_inlet)/contact%domain%intervals, summary)
      do i = 1, quantity_count
         associate (of => summary%of(i))
            if (present(near) .and. present(far)) of%error_domain = safety*abs(near%of(i)%between &
               - far%of(i)%between)
            of%error_iteration = residual*abs(of%value)
            of%error_estimate = of%error_grid + of%error_domain + of%error_iteration
         end associate
      end do
   end subroutine estimate_point_errors

end module point_quantities
