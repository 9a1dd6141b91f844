!> Main quantities of a point contact in the table of line contacts (module quantities), those of a
!> line on y = 0, and their errors from the grids of its nested start and a longer domain.
module point_quantities
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use eyring_plane, only: least_sigma, plane_flow, plane_flow_t
   use error_bars, only: domain_change_t
   use features, only: surface_height
   use film_shear, only: film_limits
   use grid_errors, only: error_on_grids, safety
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
   use quantities, only: exit_between_nodes, friction_coefficient, h_central, h_min, h_min_node, &
      p_max, quantity_count, quantity_rows, rolling_coefficient, rule_between, sliding_power, &
      sliding_rows
   implicit none (type, external)
   private

   public :: estimate_point_errors, fill_point_state, summary_of_point

   !> Rows of films.
   integer, parameter :: films(*) = [h_min, h_min_node, h_central]
   !> Pressures over the largest one that count as none: what the tolerance leaves behind the exit.
   real(wp), parameter :: least_share = 1.0e-7_wp
   !> Bounds of observed orders, the lowest where a single change is known; orders of sliding
   !> friction from a single change, most of it by the film, and from several, on whose grids the
   !> edge of the cavity shows; that of rolling friction.
   real(wp), parameter :: orders(2) = [1.15_wp, 2.0_wp], orders_sliding(2) = [1.5_wp, 0.87_wp], &
      order_rolling = 1.0_wp
   !> The error by the domain over its change by 1.5 times the length, with whose power 3/2 it falls
   !> at least.
   real(wp), parameter :: domain_factor = 1/(1 - 1.5_wp**(-1.5_wp))
   !> Films err by at least this share of the largest relative error of a film: that of one may be
   !> small by chance. In a passage the film at X = Y = 0 by all of it, friction by that of a film.
   real(wp), parameter :: share_of_film = 0.4_wp, share_in_passage = 0.6_wp
   !> What twice the intervals at least divide the errors of a passage by.
   real(wp), parameter, public :: next_fall = 3.0_wp
   !> A corner of the pressure rises by at least the first share of its possible height, and by the
   !> second one times the share of that on half of the intervals that came true.
   real(wp), parameter :: corner_shares(2) = [0.15_wp, 3.0_wp]

contains

   !> Fields of the level at a `time`, heights of rough surfaces, friction and limits. Forces in p_h
   !> a^3/Rx, powers in that times u_s; `load` such that coefficients are those of a line.
   pure subroutine fill_point_state(level, contact, time, state)
      type(point_level_t), intent(in) :: level
      type(point_contact_t), intent(in) :: contact
      real(wp), intent(in) :: time
      type(line_state_t), intent(out) :: state
      integer :: i

      state%x = level%x(:)
      state%y = level%y(:)
      state%pressure = reshape(level%pressure, [size(level%pressure)])
      state%film_thickness = reshape(level%film, [size(level%film)])
      state%rigid_displacement = level%rigid_displacement
      state%time = time
      state%moment = contact%moment
      state%moment%speeds = level%direction*contact%moment%speeds
      state%friction = friction_t(not_known(), not_known(), not_known(), not_known(), not_known())
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
      if (finest_wave(contact) >= huge(1.0_wp)) return
      state%roughness_1 = [(surface_height(contact%surface_1, state%x, time, state%y(i)), i=1, &
         size(state%y))]
      state%roughness_2 = [(surface_height(contact%surface_2, state%x, time, state%y(i)), i=1, &
         size(state%y))]
   end subroutine fill_point_state

   !> Quantities of the level; errors of the largest pressure and of sliding friction are what a
   !> spike may add to them on finer grids; NaN: not known.
   pure function summary_of_point(level, contact) result(summary)
      type(point_level_t), intent(in) :: level
      type(point_contact_t), intent(in) :: contact
      type(line_summary_t) :: summary
      type(line_state_t) :: state

      call fill_point_state(level, contact, 0.0_wp, state)
      summary = summary_of(state)
      summary%of(sliding_rows)%error_grid = summary%of(sliding_rows)%value*shear_on_highest(level, &
         contact, summary)
      summary%of(p_max)%error_grid = 0.0_wp
      call allow_for_spike(spike_law_t(contact%fluid, contact%lambda), level%hx, summary)
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
   !> `coarser`, from the residual, and from the change by a longer domain on a coarse grid; without
   !> coarser grids they are not known. A spike may add to pressure and friction what it does to
   !> those of a line contact on the row of the largest pressure. Extremes of a passage err by at
   !> least the `error_grid` that `summary` has before.
   pure subroutine estimate_point_errors(summary, contact, coarser, residual, is_passage, longer)
      type(line_summary_t), intent(inout) :: summary
      type(point_contact_t), intent(in) :: contact
      type(line_summary_t), intent(in) :: coarser(:)
      real(wp), intent(in) :: residual
      logical, intent(in) :: is_passage
      type(domain_change_t), intent(in), optional :: longer
      type(line_summary_t) :: grids(1 + size(coarser))
      real(wp) :: grid(2, quantity_count), spike
      integer :: i

      grids = [summary, coarser]
      grid = errors_by_grids(grids, contact, is_passage)
      do i = 1, quantity_count
         associate (of => summary%of(i))
            spike = 0.0_wp
            if (any(i == sliding_rows)) spike = of%error_grid
            of%error_grid = quantity_rows(i)%widening*grid(1, i) + abs(of%value - of%between)
            if (i == h_min) of%error_grid = of%error_grid + abs(of%value &
               - summary%of(h_min_node)%value)
            if (.not. ieee_is_finite(spike)) of%error_grid = spike
            if (exceeds(abs(spike) - of%error_grid, 0.0_wp)) of%error_grid = abs(spike)
            if (quantity_rows(i)%rule /= rule_between) of%extrapolated = grid(2, i)
            if (i == p_max .and. size(coarser) > 1) call estimate_crest(grids(:3)%of(i)%between, &
               grids(:3)%of(i)%value, of)
         end associate
      end do
      if (size(coarser) > 0) call limit_crests(coarser, summary)
      call allow_for_spike(spike_law_t(contact%fluid, contact%lambda), (contact%domain%x_outlet &
         - contact%domain%x_inlet)/contact%domain%intervals, summary)
      associate (of => summary%of)
         if (present(longer)) of%error_domain = domain_factor*abs(longer%near%of%between &
            - longer%far%of%between)
         of%error_iteration = residual*abs(of%value)
         of%error_estimate = of%error_grid + of%error_domain + of%error_iteration + of%error_start
      end associate
   end subroutine estimate_point_errors

   !> Errors and limits of quantities between the nodes of `grids`, the finest first; of films, and
   !> of friction by the film, at least a share of the largest relative error of a film. A single
   !> change of a passage falls with `next_fall`, but pressures only where no spike stands.
   pure function errors_by_grids(grids, contact, is_passage) result(grid)
      type(line_summary_t), intent(in) :: grids(:)
      type(point_contact_t), intent(in) :: contact
      logical, intent(in) :: is_passage
      real(wp) :: bounds(2), grid(2, quantity_count), least(quantity_count), share, stress
      logical :: is_single, is_smooth
      integer :: i

      is_single = size(grids) < 3
      share = merge(share_in_passage, share_of_film, is_passage)
      is_smooth = is_passage .and. .not. ieee_is_finite(grids(1)%crests%spike)
      do i = 1, quantity_count
         bounds = orders
         if (all([is_passage, is_single, is_smooth .or. any(i == films)])) bounds(1) = &
            log(next_fall)/log(2.0_wp)
         if (any(i == sliding_rows)) bounds = orders_sliding(merge(1, 2, is_single))
         if (i == rolling_coefficient) bounds = order_rolling
         grid(:, i) = error_on_grids(grids%of(i)%between, bounds, lasts=.true.)
      end do
      associate (error => grid(1, :), of => grids(1)%of)
         if (.not. is_smooth) error(p_max) = pressure_safety/safety*error(p_max)
         if (is_passage) where (exceeds(of%error_grid - error, 0.0_wp)) error = of%error_grid
         least = 0.0_wp
         least(films) = larger(error(h_min)/of(h_min)%value, error(h_central)/of(h_central)%value) &
            *[share_of_film, share_of_film, merge(1.0_wp, share_of_film, is_passage)]
         ! arsinh(B), the mean stress of an Eyring oil over its own, falls with the film by tanh
         stress = larger(wall_stress(contact%fluid, 4*of(friction_coefficient)%value/3), &
            tiny(1.0_wp))
         least(sliding_rows) = share*larger(error(h_central)/of(h_central)%value, &
            least(h_central))*tanh(stress)/stress
         least = least*abs(of%value)
         where (exceeds(least - error, 0.0_wp)) error = least
      end associate
   end function errors_by_grids

   !> Limits what the largest pressure may rise by what it has risen from `coarser` grids on: A of a
   !> spike P = B + A/sqrt(dX), by its flank, to once or twice that by its last change or by half of
   !> the one before, and the possible height of a corner by how much came true of that before. A
   !> spike keeps its fall over two spacings on finer grids, a corner halves it, a smooth crest
   !> quarters it: from 1/sqrt(2) on its flank gets no steeper, and ends half a spacing further.
   pure subroutine limit_crests(coarser, summary)
      type(line_summary_t), intent(in) :: coarser(:)
      type(line_summary_t), intent(inout) :: summary
      real(wp) :: change, rise, tops(0:2)
      integer :: k

      tops(0) = summary%crests%spike
      change = not_known()
      do k = 1, min(size(coarser), 2)
         tops(k) = coarser(k)%crests%spike
         if (.not. ieee_is_finite(tops(k))) tops(k) = coarser(k)%of(p_max)%value
         change = larger(change, abs(tops(k - 1) - tops(k))/k/(1 - sqrt(0.5_wp)))
      end do
      associate (own => summary%crests, last => coarser(1)%crests)
         if (own%fall > 0.0_wp .and. sqrt(2.0_wp)*own%fall <= last%fall) own%limit = own%spike*(1 &
            + 0.25_wp*own%fall)
         if (ieee_is_finite(change)) own%growing = min(max(own%growing, change), 2*change)
         if (min(own%corner_top - own%corner, last%corner_top - last%corner) <= 0.0_wp) return
         rise = max(abs(own%highest - last%highest), abs(summary%of(p_max)%value &
            - coarser(1)%of(p_max)%value))/(last%corner_top - last%corner)
         own%corner_top = own%corner + (own%corner_top - own%corner)*min(corner_shares(1) &
            + corner_shares(2)*rise, 1.0_wp)
      end associate
   end subroutine limit_crests

end module point_quantities
