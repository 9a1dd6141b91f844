!> Chooses, before the run, the leanest model that is adequate for a target accuracy.
!>
!> Only savings are examined. A steady contact is solved with every ingredient, which costs less
!> than finding out what it could do without. Transients keep all ingredients of oil and bodies:
!> time steps cost as much with a leaner law (docs/decisions.md). What saves is a steady solution in
!> place of a transient. If nothing rough moves, d/dT is 0 once the start is forgotten, and no
!> measurement is needed. If low roughness moves, its influence is measured by transients with and
!> without it on two coarse grids; so is that of the squeeze term where load, radius or speeds
!> change, without which each moment is a steady contact.
module model_choice
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use ablations, only: has_roughness, ingredient_t, ingredients_of, is_of_surfaces, roughness, &
      squeeze
   use adequacy, only: at_rest, changes_little, cheap_in_motion, cheap_passage, compared, &
      cheap_steady, goes_along, may_matter, model_choice_t, never_steady, &
      new_influence, not_measured, solves_moments, solves_rough, solves_smooth, start_counts, &
      too_high, wanted
   use entry_zone, only: is_moving
   use contact_moment, only: film_estimate
   use experiment, only: coarser, experiment_t
   use features, only: rough_surface_t
   use kinds, only: wp
   use line_contact, only: line_contact_t, move_profiles, solver_settings_t
   use listener, only: listener_t
   use measured_adequacy, only: coarse_tolerance, max_cycles, measure_change, new_pair, &
      passage_pair_t, run_pair, sees_all
   use passage_times, only: new_passage_times
   use quantities, only: h_central, h_min
   implicit none (type, external)
   private

   public :: choose_model

   !> What is left out may change a quantity by this share of the target, its error included; grid,
   !> time step and domain use the remainder.
   real(wp), parameter :: leave_share = 0.25_wp
   !> Roughness higher than this many times the target times the film is not measured: of 20
   !> transients that could do without it (seeds 12 and 13 of bench/auto.py) four were higher, and
   !> so were nearly all that could not.
   real(wp), parameter :: highest = 0.75_wp
   !> Budget of the measurement: share of the cost of the transient on the default grid, and at
   !> least this many nodes times Newton steps.
   real(wp), parameter :: cost_share = 0.2_wp, least_cost = 2.0e4_wp
   !> Typical Newton steps of a time step.
   real(wp), parameter :: newton_per_step = 2.5_wp
   !> The space scheme of a transient, which errs least on coarse grids, and the one to use if that
   !> finds no solution.
   character(len=*), parameter :: schemes(2) = [character(len=7) :: 'kappa', 'upwind2']

contains

   !> Decides on every ingredient of an `experiment` for a relative error `target` > 0;
   !> `needs_passage`: it must stay transient.
   subroutine choose_model(experiment, target, needs_passage, choice, listener)
      type(experiment_t), intent(in) :: experiment
      real(wp), intent(in) :: target
      logical, intent(in) :: needs_passage
      type(model_choice_t), intent(out) :: choice
      class(listener_t), intent(inout), target :: listener
      type(experiment_t) :: whole
      integer :: i, kind

      choice%rows = new_influence(ingredients_of(experiment%contact, experiment%time%is_transient))
      if (.not. experiment%time%is_transient) return
      ! of smooth surfaces the squeeze term is decided on without a measurement
      if (.not. any(choice%rows%kind == squeeze)) choice%rows = [choice%rows, &
         new_influence(ingredient_t(squeeze, 'squeeze', 'the steady solution'))]
      choice%rows%why = wanted
      if (needs_passage .and. .not. allocated(experiment%contact%duty)) return
      choice%rows%why = cheap_passage
      whole = experiment
      if (allocated(whole%time%resume_from)) deallocate (whole%time%resume_from)
      call move_profiles(whole%contact, 0.0_wp, listener%error)
      if (allocated(listener%error)) return
      call listener%on_stage('measuring what the model needs')
      call give_reasons(whole, target, choice, kind)
      i = findloc(choice%rows%kind, kind, 1)
      if (i == 0) return
      call measure(whole, target, choice, i, listener)
      if (choice%rows(i)%why /= changes_little) return
      choice%solved = merge(solves_moments, solves_smooth, kind == squeeze)
      if (kind == squeeze) return
      where (is_of_surfaces(choice%rows%kind)) choice%rows%why = goes_along
      choice%rows(i)%why = changes_little
   end subroutine choose_model

   !> Gives the reasons that need no measurement; `kind`: what is to be measured, 0: nothing.
   pure subroutine give_reasons(experiment, target, choice, kind)
      type(experiment_t), intent(in) :: experiment
      real(wp), intent(in) :: target
      type(model_choice_t), intent(inout) :: choice
      integer, intent(out) :: kind

      kind = 0
      associate (contact => experiment%contact, rows => choice%rows, &
         times => new_passage_times(experiment%contact, experiment%time))
         if (allocated(contact%duty)) then
            where (rows%kind == squeeze) rows%why = never_steady
            if (contact%duty%always_moves(0.0_wp)) kind = squeeze
         else if (moves(contact%surface_1) .or. moves(contact%surface_2)) then
            where (rows%kind == squeeze) rows%why = cheap_in_motion
            where (rows%kind == roughness) rows%why = too_high
            if (height_on(contact%surface_1) + height_on(contact%surface_2) &
               <= highest*target*film_estimate(contact)) kind = roughness
         else if (times%counts_from >= times%settled_from .and. times%end_time &
            >= times%needed_end) then   ! the quantities count once the start is forgotten
            where (is_of_surfaces(rows%kind)) rows%why = cheap_steady
            where (rows%kind == squeeze) rows%why = at_rest
            choice%solved = merge(solves_rough, solves_smooth, any(rows%kind == roughness))
         else
            rows%why = start_counts
         end if
      end associate
   end subroutine give_reasons

   !> Measures the changes of all quantities without an ingredient, row `i`, on the two finest grids
   !> within the budget, by the first scheme that finds all solutions; the reason becomes
   !> `changes_little` if so. What a spike may add to both pressures alike is not counted.
   subroutine measure(experiment, target, choice, i, listener)
      type(experiment_t), intent(in) :: experiment
      real(wp), intent(in) :: target
      type(model_choice_t), intent(inout) :: choice
      integer, intent(in) :: i
      class(listener_t), intent(inout), target :: listener
      type(passage_pair_t) :: pair
      type(experiment_t) :: own
      integer :: factor, k

      choice%rows(i)%why = not_measured
      factor = coarsening(experiment)
      if (factor == 0) return
      own = experiment
      do k = 1, size(schemes)
         own%settings = solver_settings_t(method='newton_krylov', tolerance=coarse_tolerance, &
            max_cycles=max_cycles, explains_failure=.false., space_scheme=schemes(k))
         pair = new_pair(own, [factor, 2*factor])
         pair%counts_spikes = .false.
         choice%grids = pair%runs%contact%domain%intervals
         call run_pair(pair, listener)
         if (listener%is_stopping) return
         if (pair%is_known) call measure_change(pair, choice%rows(i), listener)
         if (.not. choice%rows(i)%is_open) exit
      end do
      associate (row => choice%rows(i))
         if (.not. all(ieee_is_finite(row%change([h_min, h_central])))) return
         row%why = may_matter
         if (any(pack(abs(row%change) + row%error, ieee_is_finite(row%change) &
            .and. compared) > leave_share*target)) return
         choice%influence = abs(row%change) + row%error
         row%why = changes_little
      end associate
   end subroutine measure

   !> How many times fewer intervals the finer of two grids within the budget has: 2, 4 ...; 0: none
   !> that resolves all waves.
   pure integer function coarsening(experiment) result(factor)
      type(experiment_t), intent(in) :: experiment
      real(wp) :: cost

      associate (time => experiment%time, n => experiment%contact%domain%intervals)
         cost = newton_per_step*n*time%end_time/time%time_step
         factor = 2
         do while (1.25_wp*cost/factor**2 > max(cost_share*cost, least_cost))
            factor = 2*factor
         end do
         if (.not. sees_all(coarser(experiment, 2*factor))) factor = 0
      end associate
   end function coarsening

   !> Largest height of a surface [b^2/R], as far as known.
   pure real(wp) function height_on(surface) result(height)
      type(rough_surface_t), intent(in) :: surface

      height = 0.0_wp
      if (allocated(surface%features)) height = sum(abs(surface%features%amplitude))
      if (.not. allocated(surface%profile)) return
      if (allocated(surface%profile%heights)) height = height &
         + maxval([0.0_wp, abs(surface%profile%heights)])
   end function height_on

   !> Whether a surface is rough and moves.
   pure logical function moves(surface)
      type(rough_surface_t), intent(in) :: surface

      moves = has_roughness(surface) .and. is_moving(surface)
   end function moves

end module model_choice
