!> Coarse runs of a transient that error bars come from. They do not depend on the run itself:
!> another thread may make them while it goes on.
module companion_runs
   use coarse_runs, only: run_coarser
   use error_bars, only: error_bars_t, new_error_bars
   use errors, only: error_t
   use line_contact, only: line_contact_t
   use line_summary, only: line_summary_t
   use observer, only: observer_t
   use run_collector, only: collector_t
   use solver_settings, only: solver_settings_t, time_settings_t
   implicit none (type, external)
   private

   public :: companions_t, make_companion_runs, new_companions, take_companions

   !> One run, on `factor` times fewer intervals with time steps as much larger.
   type :: companion_t
      integer :: factor
      !> Without its solution the other ones are of no use.
      logical :: is_needed
      logical :: is_known = .false.
      type(line_summary_t) :: summary
      type(error_t), allocatable :: error
   end type companion_t

   !> The runs, in the order in which they begin.
   type :: companions_t
      type(line_contact_t) :: contact
      type(solver_settings_t) :: settings
      type(time_settings_t) :: time
      type(companion_t), allocatable :: runs(:)
      !> So many have begun.
      integer :: begun = 0
      !> They are of no use any more.
      logical :: are_off = .false.
   end type companions_t

contains

   !> Of a `contact` on its grid and with its time steps: n/2 and n/4 intervals, with the scheme of
   !> second order; of a transient of first order, first its own grid with that scheme.
   pure function new_companions(contact, settings, time) result(companions)
      type(line_contact_t), intent(in) :: contact
      type(solver_settings_t), intent(in) :: settings
      type(time_settings_t), intent(in) :: time
      type(companions_t) :: companions
      type(error_bars_t) :: bars

      companions%contact = contact
      companions%settings = settings
      companions%time = time
      if (allocated(time%resume_from)) deallocate (companions%time%resume_from)
      companions%runs = [companion_t(2, is_needed=.false.), companion_t(4, is_needed=.false.)]
      bars = new_error_bars(contact, time, settings%space_scheme)
      if (bars%is_first_order) companions%runs = [companion_t(1, is_needed=.true.), &
         companions%runs]
   end function new_companions

   !> Makes the runs that nobody has begun, one after the other, until they are of no use. Any
   !> number of threads may do so; `watcher` is that of the thread and may stop a run, whose
   !> quantities are then unknown.
   subroutine make_companion_runs(companions, watcher)
      type(companions_t), intent(inout) :: companions
      class(observer_t), intent(inout), target :: watcher
      type(collector_t) :: collector
      type(time_settings_t) :: time
      logical :: are_off
      integer :: i

      collector%watcher => watcher
      time = companions%time
      time%scheme = 'bdf2'
      do
         !$omp atomic capture
         companions%begun = companions%begun + 1
         i = companions%begun
         !$omp end atomic
         !$omp atomic read
         are_off = companions%are_off
         if (are_off .or. i > size(companions%runs)) return
         associate (run => companions%runs(i))
            call run_coarser(companions%contact, companions%settings, time, run%factor, collector, &
               run%is_known, run%error)
            run%summary = collector%summary
            if (run%is_known .or. .not. (run%is_needed .or. allocated(run%error))) cycle
         end associate
         !$omp atomic write
         companions%are_off = .true.
      end do
   end subroutine make_companion_runs

   !> What the runs are for; `error` is the first of theirs.
   subroutine take_companions(companions, bars, error)
      type(companions_t), intent(in) :: companions
      type(error_bars_t), intent(out) :: bars
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      bars = new_error_bars(companions%contact, companions%time, companions%settings%space_scheme)
      do i = 1, size(companions%runs)
         associate (run => companions%runs(i))
            if (allocated(run%error)) error = run%error
            if (allocated(error) .or. (run%is_needed .and. .not. run%is_known)) return
            select case (run%factor)
            case (1)
               bars%second_order = run%summary
            case (2)
               bars%has_half = run%is_known
               bars%half = run%summary
            case default
               bars%has_quarter = run%is_known
               bars%quarter = run%summary
            end select
         end associate
      end do
   end subroutine take_companions

end module companion_runs
