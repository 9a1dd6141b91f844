!> The verdict on a change by leaving something out: needed, small or irrelevant at the accuracy
!> that counts.
module verdicts
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use kinds, only: wp
   use missing_value, only: not_known
   use text, only: joined
   implicit none (type, external)
   private

   public :: begin_row, judged_t, verdict_of, verdict_text, why_unknown

   integer, parameter, public :: verdict_unknown = 0, verdict_needed = 1, verdict_small = 2, &
      verdict_irrelevant = 3

   !> Relative error that counts without a target, and the share of it below which a change is
   !> irrelevant.
   real(wp), parameter, public :: usual_accuracy = 0.01_wp
   real(wp), parameter, public :: irrelevant_share = 0.1_wp

   !> Why a change is not known.
   character(len=*), parameter, public :: no_solution = &
      'coarse grids have no solution without it'

   !> An ingredient or a numerical choice, and the verdict on it.
   type :: judged_t
      character(len=20) :: name = ''
      !> What replaced it.
      character(len=64) :: text = ''
      !> Whether it is a numerical choice, whose change is the error estimate of the result.
      logical :: is_numerical = .false.
      integer :: verdict = verdict_unknown
      !> Why the change of some quantity is not known, and why the verdict is not although all
      !> changes are.
      character(len=80) :: unknown = 'measuring it would cost more than is allowed'
      character(len=80) :: doubt = &
         'with their errors the changes lie on both sides of the accuracy'
   end type judged_t

contains

   !> A row of which nothing is known yet, with its changes and their errors.
   pure subroutine begin_row(name, text, row, change, error)
      character(*), intent(in) :: name, text
      type(judged_t), intent(out) :: row
      real(wp), intent(out) :: change(:), error(:)

      row%name = name
      row%text = text
      change = not_known()
      error = not_known()
   end subroutine begin_row

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

      select case (verdict)
      case (verdict_needed)
         text = 'needed'
         if (is_numerical) text = 'too coarse'
      case (verdict_small)
         text = 'matters below the accuracy'
      case (verdict_irrelevant)
         text = 'irrelevant'
      case default   ! verdict_unknown
         text = 'not known'
      end select
   end function verdict_text

   !> Why a `row` lacks the change of some of `quantities` (`is_told`: those known) or a verdict;
   !> empty: it lacks nothing.
   pure function why_unknown(row, quantities, is_told) result(text)
      class(judged_t), intent(in) :: row
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

end module verdicts
