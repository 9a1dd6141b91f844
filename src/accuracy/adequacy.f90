!> How much each ingredient of the model and each numerical choice changes the quantities of a
!> result, and the verdict: needed, small or irrelevant at the accuracy that counts; and decisions
!> on the ingredients before a run, their reasons, and their consequences for the contact and for
!> the errors of its result.
!>
!> The change of a quantity is that by leaving the ingredient out, relative to its value with it.
!> Changes by ingredients come from coarse runs (module ablation_runs); those by numerical choices
!> are the error estimates of the result.
module adequacy
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use ablations, only: ingredient_t
   use kinds, only: exceeds, larger, not_known, quotient, wp
   use line_contact, only: line_contact_t, time_settings_t, without_surfaces
   use line_summary, only: line_summary_t
   use quantities, only: p_central, quantity_count, quantity_rows
   use text, only: joined
   implicit none (type, external)
   private

   public :: accuracy_for, adequacy_t, apply_model, influence_t, is_plainly_needed, judge, &
      judge_at_rest, model_choice_t, new_influence, number_choice_t, verdict_of, verdict_on, &
      verdict_text, why_unknown

   integer, parameter, public :: verdict_unknown = 0, verdict_needed = 1, verdict_small = 2, &
      verdict_irrelevant = 3
   character(*), parameter :: verdict_words(0:3) = [character(len=26) :: 'not known', 'needed', &
      'matters below the accuracy', 'irrelevant']

   !> Relative error that counts without a target, and the share of it below which a change is
   !> irrelevant.
   real(wp), parameter :: usual_accuracy = 0.01_wp
   real(wp), parameter :: irrelevant_share = 0.1_wp

   !> Why a change is not known.
   character(*), parameter, public :: no_solution = 'coarse grids have no solution without it', &
      too_costly = 'measuring it would cost more than is allowed'
   !> Whence the errors of numerical choices.
   character(*), parameter, public :: from_estimates = 'error estimates of the result'

   !> An ingredient or a numerical choice, and the verdict on it.
   type, extends(ingredient_t) :: influence_t
      !> Whether it is a numerical choice, whose change is the error estimate of the result.
      logical :: is_numerical = .false.
      integer :: verdict = verdict_unknown
      !> Why the change of some quantity is not known, and why the verdict is not although all
      !> changes are; where the changes come from.
      character(len=80) :: unknown = too_costly
      character(len=80) :: doubt = &
         'with their errors the changes lie on both sides of the accuracy'
      character(len=80) :: measured_on = 'the case on coarser grids'
      !> Relative change of each quantity and its error, in the order of the table of the
      !> quantities, lubricated or dry; NaN: not known.
      real(wp) :: change(quantity_count), error(quantity_count)
      !> Lower bound of a change that is not known; 0: none.
      real(wp) :: least(quantity_count) = 0.0_wp
      !> Fraction that was left out.
      real(wp) :: left_out = 1.0_wp
      !> Of a transient: whether it was measured on the smooth steady contact; whether it is yet to
      !> be measured.
      logical :: is_at_rest = .false., is_open = .true.
      !> Before the run: row of `reasons` to keep it or to leave it out.
      integer :: why = 1
   end type influence_t

   !> Whether a quantity is compared: those of the closing table, where the largest pressure also
   !> stands for the central one.
   logical, parameter, public :: compared(*) = quantity_rows%short /= '' &
      .and. quantity_rows%name /= quantity_rows(p_central)%name

   !> A change of the smooth steady contact this many times the accuracy, and this large, is no less
   !> than the accuracy in a transient.
   real(wp), parameter :: plain_factor = 5.0_wp, plain_change = 0.05_wp
   !> Without an ingredient roughness changes a quantity at most this many times as much as with it;
   !> beyond half of the quantity nothing is known.
   real(wp), parameter :: other_roughness = 2.0_wp, largest_roughness = 0.5_wp

   !> Adequacy of a model.
   type :: adequacy_t
      !> Not allocated: nothing was measured.
      type(influence_t), allocatable :: rows(:)
      !> Row of the time step of a transient.
      type(influence_t), allocatable :: time_step
      !> The relative error that counts.
      real(wp) :: accuracy = usual_accuracy
      !> Whether everything of a transient is measured, at any cost; whether what is plainly needed
      !> is not measured any further.
      logical :: is_full = .false., ends_early = .false.
      !> Nodes times Newton steps that may still be spent.
      real(wp) :: budget = 0.0_wp
      !> Intervals of the two grids on which changes were measured, at rest and in time; 0: none
      !> were.
      integer :: at_rest(2) = 0, in_time(2) = 0
      !> Of a dry contact: mean pressure of the measurement, the largest of the sweep [Pa].
      real(wp) :: mean_pressure = 0.0_wp
   end type adequacy_t

   !> Why an ingredient is kept or left out, short for the closing table and in full.
   type :: reason_t
      character(len=8) :: decision
      character(len=22) :: short
      character(len=72) :: text
   end type reason_t

   integer, parameter, public :: cheap_steady = 1, cheap_passage = 2, cheap_in_motion = 3, &
      too_high = 4, not_measured = 5, may_matter = 6, changes_little = 7, goes_along = 8, &
      wanted = 9, at_rest = 10, start_counts = 11, never_steady = 12
   type(reason_t), parameter, public :: reasons(*) = [ &
      reason_t('kept', 'cheap at rest', 'a steady contact is solved faster than measured'), &
      reason_t('kept', 'no cheaper without', 'a time step without it costs as much'), &
      reason_t('kept', 'no cheaper without', &
         'steady solutions at all places cost as much as time steps'), &
      reason_t('kept', 'too high', 'the roughness is too high for the film to leave it out'), &
      reason_t('kept', 'not measured', 'its influence could not be measured on coarse grids'), &
      reason_t('kept', 'may matter', 'it may change more than a quarter of the target'), &
      reason_t('left out', '', 'it surely changes less than a quarter of the target'), &
      reason_t('left out', 'with roughness', 'it belongs to the roughness, which is left out'), &
      reason_t('kept', 'passage is wanted', 'film_thresholds and checkpoints need the passage'), &
      reason_t('left out', 'at rest', 'nothing that is rough moves, and the start is forgotten'), &
      reason_t('kept', 'the start counts', &
         'the quantities count from before the start is forgotten'), &
      reason_t('kept', 'stops or reverses', 'the contact stops or reverses: no steady film there')]

   !> A number of the solution that was chosen or given.
   type :: number_choice_t
      !> Name; the numerical choice in /adequacy that its error belongs to (blank: none); whether it
      !> was chosen or given; its value.
      character(len=9) :: name
      character(len=9) :: judged_as
      character(len=12) :: decision
      character(len=40) :: text
   end type number_choice_t

   !> What is solved.
   integer, parameter, public :: solves_all = 1, solves_smooth = 2, solves_rough = 3, &
      solves_moments = 4
   character(*), parameter, public :: solved_texts(*) = [character(len=64) :: &
      'the case with every ingredient', &
      'the steady contact with smooth surfaces, in place of the passage', &
      'the steady contact with its roughness, in place of the passage', &
      'the steady contact of each moment, without squeeze']

   !> The decision on each ingredient.
   type :: model_choice_t
      !> Not allocated: there was nothing to decide. Changes are known if they were measured.
      type(influence_t), allocatable :: rows(:)
      !> One of the above.
      integer :: solved = solves_all
      !> Bound on the relative change of each quantity by what is left out; NaN: not known.
      real(wp) :: influence(quantity_count) = 0.0_wp
      !> Intervals of the grids on which it was measured; 0: it was not.
      integer :: grids(2) = 0
      !> Grid, domain, time step and method of the run; not allocated: not known yet.
      type(number_choice_t), allocatable :: numbers(:)
   end type model_choice_t

contains

   !> The verdict on relative changes with their errors: needed if one surely exceeds `accuracy`;
   !> not known if one may, or is unknown; else irrelevant if all are below a tenth of it, with
   !> `unseen` (default 0) added to each but not their errors.
   pure integer function verdict_of(change, error, accuracy, unseen) result(verdict)
      real(wp), intent(in) :: change(:), error(:), accuracy
      real(wp), intent(in), optional :: unseen(:)
      logical :: is_known(size(change))
      real(wp), allocatable :: known(:), doubt(:)

      verdict = verdict_unknown
      is_known = ieee_is_finite(change) .and. ieee_is_finite(error)
      known = abs(pack(change, is_known))
      doubt = pack(error, is_known)
      if (any(known - doubt > accuracy)) then
         verdict = verdict_needed
      else if (all(is_known)) then
         if (any(known + doubt > accuracy)) return
         if (present(unseen)) known = known + unseen
         verdict = merge(verdict_irrelevant, verdict_small, all(known < irrelevant_share*accuracy))
      end if
   end function verdict_of

   !> A verdict in words; a numerical choice that is needed reads as one to be refined.
   pure function verdict_text(verdict, is_numerical) result(text)
      integer, intent(in) :: verdict
      logical, intent(in) :: is_numerical
      character(:), allocatable :: text

      text = trim(verdict_words(verdict))
      if (is_numerical .and. verdict == verdict_needed) text = 'too coarse'
   end function verdict_text

   !> Why a `row` lacks the change of some of `quantities` (`is_told`: those known) or a verdict;
   !> empty: it lacks nothing.
   pure function why_unknown(row, quantities, is_told) result(text)
      type(influence_t), intent(in) :: row
      character(*), intent(in) :: quantities(:)
      logical, intent(in) :: is_told(:)
      character(:), allocatable :: text

      text = ''
      if (.not. all(is_told)) text = joined(pack(quantities, .not. is_told), ', ')//': ' &
         //trim(row%unknown)
      if (row%verdict /= verdict_unknown .or. .not. any(is_told)) return
      if (text /= '') text = text//'; '
      text = text//'the verdict: '//trim(row%doubt)
   end function why_unknown

   !> A row of which nothing is known yet.
   pure elemental function new_influence(ingredient) result(row)
      type(ingredient_t), intent(in) :: ingredient
      type(influence_t) :: row

      row%ingredient_t = ingredient
      row%change = not_known()
      row%error = not_known()
   end function new_influence

   !> The relative error that counts: `target` if there is one (> 0), else 1 %, or the estimated
   !> relative `error` of the result if that is known and larger.
   pure real(wp) function accuracy_for(target, error) result(accuracy)
      real(wp), intent(in) :: target, error

      accuracy = larger(usual_accuracy, error)
      if (target > 0.0_wp) accuracy = target
   end function accuracy_for

   !> Adds the rows of the numerical choices, whose changes are the estimates in `summary`, and sets
   !> all verdicts.
   pure subroutine judge(self, summary)
      type(adequacy_t), intent(inout) :: self
      type(line_summary_t), intent(in) :: summary
      integer :: i

      if (.not. allocated(self%rows)) return
      associate (of => summary%of)
         self%rows = [self%rows, &
            numerical('grid', 'limit of fine grids and time steps', of%error_grid, of%value), &
            numerical('domain', 'domain without end', of%error_domain, of%value), &
            numerical('iteration', 'exact discrete solution', of%error_iteration, of%value)]
      end associate
      if (allocated(self%time_step)) self%rows = [self%rows, bounded(self%time_step, &
         self%rows(size(self%rows) - 2))]
      do i = 1, size(self%rows)
         associate (row => self%rows(i))
            row%verdict = verdict_on(row, self%accuracy)
            if (row%left_out < 1.0_wp) row%doubt = 'all of it may change more or less than a part'
            if (.not. row%is_at_rest) cycle
            row%measured_on = 'the smooth steady contact on coarser grids'
            row%doubt = 'the smooth steady contact only shows what is clearly needed in a passage'
         end associate
      end do
   end subroutine judge

   !> The row of the time step, bounded by the combined error of grid and step if that is known; if
   !> only that is known, anything between it and 0.
   pure function bounded(time_step, grid) result(row)
      type(influence_t), intent(in) :: time_step, grid
      type(influence_t) :: row

      row = time_step
      where (ieee_is_finite(grid%change) .and. .not. ieee_is_finite(time_step%change))
         row%change = 0.5_wp*grid%change
         row%error = 0.5_wp*grid%change
      else where (exceeds(time_step%change - grid%change, 0.0_wp))
         row%change = grid%change
      end where
   end function bounded

   !> A numerical choice with the estimated `errors` of `values` of a result, both
   !> (quantity_count).
   pure function numerical(name, text, errors, values) result(row)
      character(*), intent(in) :: name, text
      real(wp), intent(in) :: errors(:), values(:)
      type(influence_t) :: row

      row = new_influence(ingredient_t(0, name, text))
      row%is_numerical = .true.
      row%unknown = 'there is no error estimate: no_estimate in /summary says why'
      row%measured_on = from_estimates
      row%change = quotient(errors, abs(values))
      where (ieee_is_finite(row%change)) row%error = 0.0_wp
   end function numerical

   !> The verdict on a row by the quantities with known changes.
   pure integer function verdict_on(row, accuracy) result(verdict)
      type(influence_t), intent(in) :: row
      real(wp), intent(in) :: accuracy
      logical :: is_known(quantity_count)

      is_known = ieee_is_finite(row%change) .and. compared
      ! a fraction of an ingredient is extrapolated at its rate to all of it
      verdict = verdict_of(pack(row%change, is_known)/row%left_out, &
         pack(row%error, is_known)/row%left_out, accuracy)
      if (any(row%least > row%left_out*accuracy)) verdict = verdict_needed
      if (row%is_at_rest) verdict = merge(verdict_needed, verdict_unknown, &
         is_plainly_needed(row, accuracy))
      ! all of it may matter more, or a change with a large lower bound
      if (verdict /= verdict_needed .and. (row%left_out < 1.0_wp &
         .or. any(row%least > irrelevant_share*accuracy))) verdict = verdict_unknown
      if (.not. any(is_known)) verdict = verdict_unknown
   end function verdict_on

   !> Decides whether a `row` of the smooth steady contact leaves the transient open: not if its
   !> change is too large to be small there, nor if the influence of `roughness` cannot alter the
   !> verdict. Changes c and r combine to (1 + c)(1 + r)/(1 + r') - 1 in the transient, r' that of
   !> roughness without the ingredient; the error is widened accordingly.
   pure subroutine judge_at_rest(row, roughness, accuracy)
      type(influence_t), intent(inout) :: row
      type(influence_t), intent(in) :: roughness
      real(wp), intent(in) :: accuracy
      type(influence_t) :: plain, wider, worst
      real(wp) :: rough(quantity_count)

      row%is_open = .not. is_plainly_needed(row, accuracy)
      if (.not. row%is_open .or. roughness%is_at_rest .or. row%left_out < 1.0_wp) return
      plain = row
      plain%is_at_rest = .false.
      wider = plain
      wider%measured_on = 'the smooth steady contact on coarser grids, with the error that '// &
         'roughness adds'
      wider%error = not_known()
      wider%unknown = 'roughness changes too much for the smooth steady contact to tell'
      rough = abs(roughness%change) + roughness%error
      where (.not. exceeds(other_roughness*rough, largest_roughness)) wider%error = row%error &
         + (1 + abs(row%change))*(1 + other_roughness)*rough/(1 - other_roughness*rough)
      if (verdict_on(wider, accuracy) == verdict_unknown) return
      worst = wider
      worst%change = abs(wider%change) + wider%error
      worst%error = 0.0_wp
      ! it may be irrelevant in the transient, too
      if (verdict_on(worst, accuracy) == verdict_small .and. verdict_on(plain, accuracy) &
         == verdict_irrelevant) return
      row = wider
      row%is_open = .false.
   end subroutine judge_at_rest

   !> Whether a change of the smooth steady contact is too large to be small in a transient.
   pure logical function is_plainly_needed(row, accuracy) result(is_needed)
      type(influence_t), intent(in) :: row
      real(wp), intent(in) :: accuracy
      real(wp) :: sure(quantity_count)

      sure = merge(abs(row%change) - row%error, row%least, ieee_is_finite(row%change))
      is_needed = any(compared .and. exceeds(sure, row%left_out*max(plain_factor*accuracy, &
         plain_change)))
   end function is_plainly_needed

   !> Sets contact and time to the chosen model.
   pure subroutine apply_model(choice, contact, time)
      type(model_choice_t), intent(in) :: choice
      type(line_contact_t), intent(inout) :: contact
      type(time_settings_t), intent(inout) :: time

      if (choice%solved == solves_moments) then
         time%scheme = 'quasi_steady'
         time%tolerance = 0.0_wp
      else if (choice%solved /= solves_all) then
         time = time_settings_t()
         ! nothing enters any more
         contact%surface_1%entry_length = 0.0_wp
         contact%surface_2%entry_length = 0.0_wp
         if (choice%solved == solves_smooth) contact = without_surfaces(contact)
      end if
   end subroutine apply_model

end module adequacy
