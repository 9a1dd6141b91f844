!> What a result is compared with once it is known: what a tail in front of the inlet leaves out or
!> an inlet without one starves, what the thesis's scheme finds; whether the outlet cuts the film
!> off, by how much that changes the quantities, and a note on it.
module outlet_check
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use case_notes, only: add_note
   use case_record, only: case_t
   use coarse_runs, only: run_farther, run_longer, run_other_scheme
   use domain_choice, only: chosen_outlet
   use error_bars, only: error_bars_t, outlet_error
   use errors, only: error_t
   use features, only: rough_surface_t
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use run_observer, only: run_observer_t
   use text, only: to_text
   implicit none (type, external)
   private

   public :: check_ends

   !> Relative change of the quantities by the outlet above which a note is given.
   real(wp), parameter :: noted_change = 1.0e-3_wp

contains

   !> Both ends of the domain of the solved `contact`, for the error bars of the result. Error:
   !> memory or a library failed.
   subroutine check_ends(case, contact, listener, report, error)
      type(case_t), intent(in) :: case
      type(line_contact_t), intent(in) :: contact
      type(run_observer_t), intent(inout) :: listener
      type(report_t), intent(inout) :: report
      type(error_t), allocatable, intent(out) :: error
      type(error_bars_t) :: bars
      type(line_contact_t) :: at_rest

      if (.not. report%converged) return
      bars = listener%writer%bars
      if (case%accuracy%has_error_bars) then
         at_rest = contact
         if (case%time%is_transient) then   ! what passes comes and goes, the inlet stays
            at_rest%surface_1 = rough_surface_t(speed=contact%surface_1%speed)
            at_rest%surface_2 = rough_surface_t(speed=contact%surface_2%speed)
         end if
         call run_farther(bars, at_rest, case%solver, listener, error)
         if (allocated(error)) return
         ! a target has chosen its grid by the estimate from coarser ones
         if (.not. (case%time%is_transient .or. case%accuracy%target > 0.0_wp)) call &
            run_other_scheme(bars, contact, case%solver, listener, error)
         if (allocated(error)) return
      end if
      if (report%outlet_pressure > 0.0_wp) then
         bars%is_cut = .true.
         if (case%accuracy%has_error_bars) then
            call run_longer(bars, contact, case%solver, case%time, listener, error)
            if (allocated(error)) return
         end if
         call note_outlet(case, contact, outlet_error(bars), listener, report)
      end if
      listener%writer%bars = bars
   end subroutine check_ends

   !> Adds a note to the report that the outlet cuts the film off, unless that is known to change
   !> the quantities only a little; `change`: by how much, NaN if it is not known.
   subroutine note_outlet(case, contact, change, listener, report)
      type(case_t), intent(in) :: case
      type(line_contact_t), intent(in) :: contact
      real(wp), intent(in) :: change
      type(run_observer_t), intent(inout) :: listener
      type(report_t), intent(inout) :: report

      if (ieee_is_finite(change)) then
         if (change <= noted_change) return
      end if
      call add_note(case, listener, outlet_note(contact, change), report%note)
   end subroutine note_outlet

   !> What is wrong with the outlet and how to mend it; `change`: of the quantities, NaN if unknown.
   pure function outlet_note(contact, change) result(note)
      type(line_contact_t), intent(in) :: contact
      real(wp), intent(in) :: change
      character(:), allocatable :: note
      real(wp) :: chosen

      note = 'the film is still under pressure at the outlet X = ' &
         //to_text(contact%domain%x_outlet, 4)
      if (ieee_is_finite(change)) then
         note = note//', which changes its quantities by up to '//to_text(100*change, 2)//' %'
      else
         note = note//', and what that changes is not known'
      end if
      chosen = chosen_outlet(contact)
      if (chosen > contact%domain%x_outlet) then
         note = note//': without x_outlet the program takes '//to_text(chosen, 4)
      else
         note = note//': x_outlet farther out cures it'
      end if
   end function outlet_note

end module outlet_check
