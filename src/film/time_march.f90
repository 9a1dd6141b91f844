!> The march in time of a lubricated line or point contact: its steps and their parts, what the
!> listener gets of them, and when it ends. The contact solves a part.
!>
!> Steps are divided into the parts of their scheme (module march_state), or by an estimate of the
!> error of a part, and where load, radius or speeds have a kink. A passage whose duty repeats
!> itself goes on until its film does.
module time_march
   use duty, only: span_of
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_contact, only: intervals_for_waves, min_in_wave, rough_contact_t, solver_settings_t, &
      time_settings_t
   use line_state, only: line_state_t
   use listener, only: listener_t
   use march_state, only: judge_part, least_part, march_state_t, most_parts, next_end, part_ends, &
      step_weights, time_part_t
   use text, only: counted, to_text
   implicit none (type, external)
   private

   public :: march, refuse

   !> A contact on its grid, in time.
   type, abstract, public :: marcher_t
      !> Its last solutions; what it is at their time.
      type(march_state_t) :: history
      class(rough_contact_t), pointer :: contact => null()
      type(solver_settings_t) :: settings
      type(time_settings_t) :: time
      !> Ends of the parts of the present step, shares of it.
      real(wp), allocatable :: ends(:)
      !> How many more parts may have no solution, of all steps.
      integer :: failures_left = huge(1)
      !> The parts of the last step.
      type(time_part_t), allocatable :: parts(:)
   contains
      procedure(part_interface), deferred :: solve_part
      procedure(end_interface), deferred :: end_step
      procedure(fill_interface), deferred :: fill
   end type marcher_t

   abstract interface
      !> Solves a part of the next step, which gets its solution if there is a follower, and adds it
      !> to the history; `error`: that of the scheme, relative to the film, if there is a bound on
      !> it.
      subroutine part_interface(self, part, listener, error, report)
         import :: listener_t, marcher_t, report_t, time_part_t, wp
         class(marcher_t), intent(inout) :: self
         type(time_part_t), intent(inout) :: part
         class(listener_t), intent(inout), target :: listener
         real(wp), intent(inout) :: error
         type(report_t), intent(inout) :: report
      end subroutine part_interface

      !> Records a film below its floor at the end of a `step`; the film of the last one as a run
      !> that resumes here finds it, to the bit.
      subroutine end_interface(self, step, is_last, report)
         import :: marcher_t, report_t
         class(marcher_t), intent(inout) :: self
         integer, intent(in) :: step
         logical, intent(in) :: is_last
         type(report_t), intent(inout) :: report
      end subroutine end_interface

      !> Sets `state` to the present film, at a `time`.
      subroutine fill_interface(self, time, state, has_stresses)
         import :: line_state_t, marcher_t, wp
         class(marcher_t), intent(in) :: self
         real(wp), intent(in) :: time
         type(line_state_t), intent(inout) :: state
         logical, intent(in) :: has_stresses
      end subroutine fill_interface
   end interface

   !> Where the film is thinner than this share of it at both neighbours, the grid does not hold it.
   real(wp), parameter :: held = 0.5_wp
   !> Parts without a solution after which a coarse run is given up: it would need many more.
   integer, parameter :: coarse_failures = 100
   !> A kink nearer to an end of a step than this share of it does not divide the step: a part of
   !> hardly any length has no slope but that of rounding.
   real(wp), parameter :: nearest_kink = 1.0e-3_wp
   !> The film at the end of a cycle repeats the one before within this share; most cycles.
   real(wp), parameter :: same_film = 1.0e-3_wp, most_cycles = 20.0_wp

contains

   !> Marches from the newest solution of the history, of the start or of an earlier run, to the end
   !> time, or until a film repeats itself; the listener receives each step. Ends early, not
   !> converged, if a step has no solution; `state` is that of the history, and then the last good
   !> one.
   subroutine march(self, listener, state, report)
      class(marcher_t), intent(inout) :: self
      class(listener_t), intent(inout), target :: listener
      type(line_state_t), intent(inout) :: state
      type(report_t), intent(inout) :: report
      integer :: steps

      associate (time => self%time, history => self%history)
         steps = max(nint(time%end_time/time%time_step), history%steps)
         if (.not. self%settings%explains_failure) self%failures_left = coarse_failures
         if (.not. allocated(time%resume_from)) call hand_out()
         do while (history%step < steps)
            if (listener%wants_stop()) then
               call refuse(report, 'stopped from outside')
               return
            end if
            call march_step(self, listener, report)
            if (report%converged .and. allocated(listener%follower)) call advance_follower()
            if (.not. report%converged) then
               call refuse(report, 'time step '//to_text(history%step + 1)//' of ' &
                  //to_text(steps)//' (T = '//to_text((history%step + 1)*time%time_step)//'): ' &
                  //report%reason//hints(self%contact, state))
               return
            end if
            call self%end_step(history%step + 1, history%step + 1 == steps, report)
            if (.not. report%converged) return
            history%step = history%step + 1
            report%steps = history%step
            call hand_out()
         end do
         report%converged = .true.
         report%reason = 'converged'
         if (history%cycle_change > same_film) call refuse(report, 'the film does not repeat '// &
            'itself: the last of '//to_text(nint(steps*time%time_step/span_of(self%contact%duty))) &
            //' cycles changed it by '//to_text(100*history%cycle_change, 2)//' %')
      end associate

   contains

      !> Passes the state after a step and the state of the march to the listener.
      subroutine hand_out()
         associate (time => self%time, history => self%history, stride => listener%stress_stride)
            call self%fill(history%step*time%time_step, state, stride > 0 &
               .and. mod(history%step, max(stride, 1)) == 0)
            if (time%may_lengthen) call look_back(state, nint(span_of(self%contact%duty) &
               /time%time_step), history, steps)
            call listener%on_step(history%step, steps, state, history, report)
         end associate
      end subroutine hand_out

      !> Advances the follower over the same parts of a step; if it fails, nothing has converged.
      subroutine advance_follower()
         character(:), allocatable :: reason
         integer :: i

         do i = 1, size(self%ends)
            call listener%follower%advance(self%parts(i), reason)
            if (allocated(reason)) call refuse(report, reason)
            if (allocated(reason)) return
         end do
      end subroutine advance_follower

   end subroutine march

   !> At the end of a cycle compares its film with that of the last one; adds a cycle to the `steps`
   !> if it would be the last and does not repeat that.
   pure subroutine look_back(state, cycle_steps, history, steps)
      type(line_state_t), intent(in) :: state
      integer, intent(in) :: cycle_steps
      type(march_state_t), intent(inout) :: history
      integer, intent(inout) :: steps

      if (modulo(history%step, cycle_steps) /= 0) return
      if (history%step > 0) history%cycle_change = maxval(abs(state%film_thickness &
         /history%cycle_film - 1), state%pressure > 0.0_wp)
      history%cycle_film = state%film_thickness
      if (history%step == steps .and. history%cycle_change > same_film &
         .and. steps < most_cycles*cycle_steps) steps = steps + cycle_steps
      history%steps = steps
   end subroutine look_back

   !> End of a reason: the smallest film of the last good step and its position, whether the grid
   !> does not hold it, and the intervals in the finest wave of the surfaces, if too few. (A ridge
   !> of 1.2 central films and 12 intervals closes the film of Case 1 at any time step; on 46 it
   !> passes.)
   pure function hints(contact, state) result(words)
      class(rough_contact_t), intent(in) :: contact
      type(line_state_t), intent(in) :: state
      character(:), allocatable :: words
      real(wp) :: share
      integer :: node

      associate (h => state%film_thickness, nx => size(state%x))
         node = minloc(h, 1)
         words = '; smallest film before it: H = '//to_text(h(node), 3)//' at X = ' &
            //to_text(state%x(modulo(node - 1, nx) + 1), 4)
         if (allocated(state%y)) words = words//', Y = '//to_text(state%y((node - 1)/nx + 1), 4)
         if (h(node) < held*min(h(max(node - 1, 1)), h(min(node + 1, size(h))))) words = words// &
            ', where it closes between two nodes: it takes more &domain ' &
            //trim(merge('intervals_x', 'intervals  ', allocated(state%y)))
      end associate
      share = real(contact%domain%intervals, wp)/intervals_for_waves(contact)
      if (share < 1.0_wp) words = words//'; the finest wave of the surfaces has ' &
         //to_text(share*min_in_wave, 2)//' intervals'
   end function hints

   !> Marks the report as not converged for a reason.
   pure subroutine refuse(report, reason)
      type(report_t), intent(inout) :: report
      character(*), intent(in) :: reason

      report%converged = .false.
      report%reason = reason
   end subroutine refuse

   !> Makes one step, in its parts or divided until their error is within the tolerance; the history
   !> then begins with its end. The listener receives the state between the latter: an extreme may
   !> last shorter than a step. A step of the start whose parts have no solution (a smoother on a
   !> fine grid) is made in one piece, and counted.
   subroutine march_step(self, listener, report)
      class(marcher_t), intent(inout) :: self
      class(listener_t), intent(inout), target :: listener
      type(report_t), intent(inout) :: report
      type(march_state_t) :: start
      type(line_state_t) :: between
      type(time_part_t) :: part
      real(wp) :: error, first, last, length
      integer :: i, made
      logical :: by_error, is_good

      associate (history => self%history, time => self%time)
         by_error = time%tolerance > 0.0_wp
         call divide_step(self)
         if (allocated(self%parts)) deallocate (self%parts)
         allocate (self%parts(size(self%ends)))
         first = 0.0_wp
         i = 1
         do made = 1, most_parts
            ! may be made again
            if (any([by_error, all([made == 1, size(self%ends) > 1])])) start = history
            last = self%ends(i)
            if (by_error) last = next_end(history, first, last, time%time_step)
            length = (last - first)*time%time_step
            part%length = last*time%time_step - first*time%time_step
            part%time = (history%step + last)*time%time_step
            part%weights = step_weights(history, time%scheme, part%length)
            error = huge(error)
            call self%solve_part(part, listener, error, report)
            is_good = report%converged
            if (by_error) call judge_part(history, error, length, time%tolerance, is_good)
            if (is_good .or. (report%converged .and. length < least_part)) then
               first = last
               self%parts(i) = part
               if (.not. first < self%ends(i)) i = i + 1
               if (i > size(self%ends)) return
               if (.not. by_error) cycle
               call self%fill((history%step + first)*time%time_step, between, .false.)
               call listener%on_part(between)
            else
               if (.not. may_repeat()) return
               history = start
            end if
         end do
      end associate
      call refuse(report, 'its error is too large in '//counted(most_parts, 'part'))

   contains

      !> Whether a part, or a step in one piece, is made again; prepares that.
      logical function may_repeat()
         if (by_error) then
            if (.not. report%converged) self%failures_left = self%failures_left - 1
            may_repeat = all([length >= least_part, self%failures_left >= 0])
            start%next_length = self%history%next_length
            return
         end if
         may_repeat = size(self%ends) > 1
         self%ends = [1.0_wp]
         first = 0.0_wp
         i = 1
         start%way = 1
         if (may_repeat) report%fit%uncut_steps = report%fit%uncut_steps + 1
      end function may_repeat

   end subroutine march_step

   !> Divides the next step: into the parts of its scheme, unless an error estimate will do that,
   !> and where the duty of the contact changes its slope.
   pure subroutine divide_step(self)
      class(marcher_t), intent(inout) :: self
      real(wp) :: begin
      integer :: i

      associate (history => self%history, length => self%time%time_step, &
         by_error => self%time%tolerance > 0.0_wp)
         self%ends = [1.0_wp]
         if (.not. by_error) self%ends = part_ends(self%time%scheme, history%step + 1, length)
         if (allocated(self%contact%duty)) then
            begin = history%step*length
            associate (cuts => (self%contact%duty%kinks(begin, begin + length) - begin)/length)
               do i = 1, size(cuts)
                  if (min(cuts(i), 1 - cuts(i)) < nearest_kink) cycle
                  if (any(abs(self%ends - cuts(i)) < least_part)) cycle
                  self%ends = [pack(self%ends, self%ends < cuts(i)), cuts(i), pack(self%ends, &
                     self%ends > cuts(i))]
               end do
            end associate
         end if
         ! undivided steps are easier for a smoother than their parts
         if (by_error .or. size(self%ends) > 1) return
         if (history%lengths(1) < length) history%way = 1
      end associate
   end subroutine divide_step

end module time_march
