!> The result of a lubricated case: what is known, written into its file at the end.
module result_writer
   use adequacy, only: adequacy_t, judge, model_choice_t
   use adequacy_section, only: write_adequacy, write_decision, write_validity
   use case_record, only: case_t
   use checkpoint, only: checkpoint_t
   use error_bars, only: apply_error_bars, error_bars_t, missing_estimate
   use errors, only: error_t
   use film_fields, only: film_fields_t
   use film_heating, only: heating_t, largest_rise
   use film_statistics, only: add_start, add_time, new_statistics
   use hdf5_axes, only: make_counter
   use hdf5_dataset, only: write_attribute
   use iteration_report, only: report_t
   use kinds, only: not_known, wp
   use line_state, only: line_state_t
   use line_summary, only: line_summary_t, summary_of, copy_values
   use field_sections, only: write_formulas, write_momentum, write_solution, write_statistics, &
      write_velocity
   use result_file, only: result_file_t
   use result_sections, only: write_breakdown, write_mean_power, write_scaling, write_summary
   use transient_store, only: in_full, in_time
   use validity, only: limit_t, mixed_lubrication
   implicit none (type, external)
   private

   public :: result_writer_t

   !> The file being written, and what is known of the solution.
   type, extends(result_file_t) :: result_writer_t
      !> What the run has gathered so far, and its quantities when the result is finished; why one
      !> whose error is NaN has none, if that is known before.
      type(checkpoint_t) :: run
      type(line_summary_t) :: summary
      character(:), allocatable :: missing
      !> How warm sliding would make the film of a time step, if that is to be known.
      type(heating_t) :: heating
      !> Coarse runs that tell how far off the quantities may be.
      type(error_bars_t) :: bars
      !> How the solution stands to the limits of its model, if it is known.
      type(limit_t), allocatable :: limits(:)
      !> Film formulas hold for the contact.
      logical :: has_formulas = .false.
      !> Newton steps and iterations of GMRES on each grid of a point contact (2, grids), the first
      !> the coarsest.
      real(wp), allocatable :: work(:, :)
      !> The film by its full momentum equations, and the solution of the Reynolds equation that
      !> they began with, of which the error bars are; not allocated: not asked for, or none.
      type(film_fields_t), allocatable :: momentum
      type(line_state_t), allocatable :: reynolds
      !> What the ingredients of the model change.
      type(adequacy_t) :: adequacy
      !> The model that the program has chosen, if it was to.
      type(model_choice_t) :: choice
   contains
      procedure :: store_step, forget_steps, quantities_of, quantities_at_end, finish
   end type result_writer_t

contains

   !> Adds a time step to the extremes, to what is counted over time, and to NAME.part. A failure
   !> counts as one of the result.
   subroutine store_step(self, step, steps, state, report)
      class(result_writer_t), intent(inout) :: self
      integer, intent(in) :: step, steps
      type(line_state_t), intent(in) :: state
      type(report_t), intent(in) :: report
      type(line_summary_t) :: summary
      logical :: is_first

      if (allocated(self%run%statistics%thresholds)) then
         if (step == 0) call add_start(self%run%statistics, state)
         if (step > 0 .and. state%time >= self%run%passage%times%statistics_from()) call &
            add_time(self%run%statistics, state)
      end if
      summary = self%quantities_of(state)
      call self%run%passage%add(summary, state%time, step == steps)
      is_first = .not. self%is_transient
      self%is_transient = .true.
      if (allocated(self%file%row)) return
      if (is_first) call self%store%begin(self%path//'.part', self%fields, size(state%pressure), &
         self%profile_stride)
      call self%store%append(state, summary, report, self%run%film_passage)
      if (allocated(self%store%file%failure) .and. .not. allocated(self%file%failure)) then
         self%file%failure = self%store%file%failure
      end if
   end subroutine store_step

   !> Forgets the time steps of a trial run of a line contact.
   subroutine forget_steps(self)
      class(result_writer_t), intent(inout) :: self

      self%is_transient = .false.
      self%run%passage%has_counted = .false.
      self%run%passage%has_earlier = .false.
      if (allocated(self%run%statistics%thresholds)) self%run%statistics = &
         new_statistics(self%run%statistics%thresholds)
   end subroutine forget_steps

   !> Quantities of one time.
   pure function quantities_of(self, state) result(summary)
      class(result_writer_t), intent(in) :: self
      type(line_state_t), intent(in) :: state
      type(line_summary_t) :: summary
      type(heating_t) :: heating

      summary = summary_of(state)
      if (.not. (self%heating%is_known .and. allocated(state%shear_stress_mean))) return
      heating = self%heating
      if (any(self%fields == 'speed_1')) heating%speeds = state%moment%speeds &
         *self%file%scaling%speed_sum
      summary%limits%film_heating = largest_rise(heating, state%x, state%shear_stress_mean, &
         state%film_thickness)
   end function quantities_of

   !> The quantities at the end, of a transient extremes; with error bars if it has converged.
   pure function quantities_at_end(self, state, report) result(summary)
      class(result_writer_t), intent(in) :: self
      type(line_state_t), intent(in) :: state
      type(report_t), intent(in) :: report
      type(line_summary_t) :: summary
      integer :: i

      summary = self%run%passage%extremes(summary_of(state))
      i = max(findloc(state%pressure > 0.0_wp, .true., 1, back=.true.), 2)   ! exit, near a spike
      if (report%converged) call apply_error_bars(self%bars, report, state%x(i) - state%x(i - 1), &
         summary)
   end function quantities_at_end

   !> Writes input, last solution, quantities and report, closes the file and gives it its final
   !> name. An error leaves only an older result (and NAME.part, if there is a checkpoint).
   subroutine finish(self, case, state, report, error)
      class(result_writer_t), intent(inout) :: self
      type(case_t), intent(in) :: case
      type(line_state_t), intent(in) :: state
      type(report_t), intent(inout) :: report
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: ratio

      associate (file => self%file, summary => self%summary)
         call self%begin_end(case)
         call write_scaling(file)
         if (allocated(case%point)) call write_attribute(file, '/scaling', 'radius_ratio', &
            case%point%radius_ratio, '1')
         call write_solution(file, state)
         if (.not. allocated(self%missing)) then
            if (allocated(self%reynolds)) then
               summary = self%quantities_at_end(self%reynolds, report)
               call copy_values(summary, summary_of(state))
            else
               summary = self%quantities_at_end(state, report)
            end if
            self%missing = missing_estimate(self%bars, report, state%x(2) - state%x(1), summary)
         end if
         if (all([report%converged, .not. self%run%passage%times%is_settled()])) self%missing = &
            'the start is in the quantities, see /report/note'
         ratio = not_known()
         if (allocated(self%limits)) ratio = self%limits(mixed_lubrication)%value
         call write_summary(file, summary, self%is_transient, self%missing, ratio)
         if (all([allocated(case%duty), .not. allocated(case%point)])) call write_mean_power(file, &
            self%run%passage%counted, self%bars%coarser(:min(self%bars%grids, 2)), self%missing)
         if (self%is_transient) then
            call self%store%copy_into(file, file%scaling, state, file%has_si, in_time)
            associate (times => self%run%passage%times)
               call write_attribute(file, '/summary', 'statistics_from', times%counts_from)
               call write_attribute(file, '/summary', 'settled_from', times%settled_from)
               if (times%period > 0.0_wp) call write_attribute(file, '/summary', 'period', &
                  times%period)
            end associate
         end if
         call write_statistics(file, self%run%statistics, &
            self%run%passage%times%statistics_from())
         if (allocated(self%limits)) call write_validity(file, self%limits)
         if (self%has_formulas) call write_formulas(file, case%contact, summary)
         if (allocated(self%momentum)) then
            call write_momentum(file, self%momentum, self%is_transient)
            call self%store%copy_into(file, file%scaling, state, file%has_si, in_full)
         end if
         call write_velocity(file, case, state)
         call judge(self%adequacy, summary)
         call write_adequacy(file, self%adequacy)
         call write_decision(file, self%choice)
         if (any([.not. allocated(case%point), case%solver%film_floor > 0.0_wp])) call &
            write_breakdown(file, report%breakdown)
         if (allocated(self%work)) then
            call make_counter(file, '/report/grid', size(self%work, 2), 'number of the grid')
            call make_counter(file, '/report/kind_of_work', 2, &
               'number of: Newton steps, iterations of GMRES')
            call file%begin('/report')
            call file%put('grid_work', self%work, 'Newton steps and iterations of GMRES on '// &
               'each grid, the coarsest first', axes='kind_of_work grid')
         end if
      end associate
      call self%publish(report, error)
   end subroutine finish

end module result_writer
