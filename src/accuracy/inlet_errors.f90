!> Errors by the length of the inlet, by rules or, with an inlet close to the contact, measured:
!> quantities on graded grids of the same domain and of one with a far inlet. A pressure spike is
!> not compared: the largest pressure is that next to it.
module inlet_errors
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use iteration_report, only: report_t
   use kinds, only: quotient, wp
   use line_summary, only: line_summary_t, value_between
   use lubricant, only: fluid_t, fluid_viscosity, thins
   use quantities, only: asperity_share, boundary_friction, h_central, p_max, quantity_count, &
      quantity_rows, rule_crest, sheared_rows
   implicit none (type, external)
   private

   public :: change_by_inlet, domain_change_t, film_loss, inlet_shares

   !> Films err by up to twice the share lost by starvation, and the exit by that share where the
   !> film is thick (M 0.5-500, L 0-30, against four times the domain).
   real(wp), parameter, public :: film_safety = 2.0_wp
   !> Forces err as films do, sliding by up to this many times the share of the pressures in
   !> addition; with a Newtonian oil as its viscosity does, where the largest pressure changes by a
   !> third of that share (M 2-70, L 3-9, against a domain twice as long).
   real(wp), parameter :: shear_safety = 1.5_wp, pressure_part = 1.0_wp/3.0_wp

   !> An estimate is this many times the change plus this share of the largest change, since a
   !> single one may be small by chance.
   real(wp), parameter :: safety = 1.1_wp, doubt = 0.15_wp

   !> Fields whose quantities may be unknown or 0 in a solution.
   character(len=*), parameter :: may_be_unknown(4) = [character(len=20) :: '1', 'x', &
      'friction_coefficient', 'power']

   !> What a longer domain changes: quantities on the same and on the longer one.
   type :: domain_change_t
      logical :: is_known = .false.
      type(line_summary_t) :: near, far
   end type domain_change_t

contains

   !> Relative errors of all quantities by the inlet: from the coarse runs of its `change`, else by
   !> the rules in the report.
   pure function inlet_shares(change, fluid, report, summary) result(shares)
      type(domain_change_t), intent(in) :: change
      type(fluid_t), intent(in) :: fluid
      type(report_t), intent(in) :: report
      type(line_summary_t), intent(in) :: summary
      real(wp) :: shares(quantity_count)
      real(wp) :: ln_mu(1), response

      if (change%is_known) then
         shares = change_by_inlet(change)
         where (quantity_rows%field == 'x' .and. ieee_is_finite(summary%of%value)) shares = &
            shares/max(abs(summary%of%value), tiny(1.0_wp))
         return
      end if
      shares = report%fit%inlet_error*min(1.0_wp, summary%of(h_central)%value)
      where (quantity_rows%field == 'pressure') shares = report%fit%inlet_pressure_error
      where (quantity_rows%field == 'film_thickness' .or. quantity_rows%field == 'power' &
         .or. quantity_rows%field == 'friction_coefficient' &
         .or. quantity_rows%field == 'temperature_rise') shares = film_safety &
         *report%fit%inlet_error
      response = shear_safety
      if (.not. thins(fluid) .and. ieee_is_finite(summary%of(p_max)%value)) then
         call fluid_viscosity(fluid, [summary%of(p_max)%value], ln_mu)
         response = max(response, pressure_part*ln_mu(1))
      end if
      shares(sheared_rows) = shares(sheared_rows) + response*report%fit%inlet_pressure_error
      shares([asperity_share, boundary_friction]) = abs(summary%asperity_response) &
         *(film_safety*report%fit%inlet_error)
   end function inlet_shares

   !> Estimated errors of all quantities by the inlet: relative; of positions in units of b; of
   !> positions or forces that are not known 0 is the change.
   pure function change_by_inlet(self) result(errors)
      type(domain_change_t), intent(in) :: self
      real(wp) :: errors(quantity_count)
      real(wp) :: near, far
      integer :: i

      do i = 1, quantity_count
         near = compared_value(self, self%near, i)
         far = compared_value(self, self%far, i)
         if (quantity_rows(i)%field == 'x') then
            errors(i) = abs(near - far)
         else
            errors(i) = abs(1 - quotient(far, near))
         end if
         if (any(quantity_rows(i)%field == may_be_unknown)) errors(i) = merge(errors(i), 0.0_wp, &
            ieee_is_finite(errors(i)))
      end do
      errors = safety*errors + doubt*maxval(errors, quantity_rows%field == 'film_thickness')
      where (quantity_rows%field == 'pressure') errors = errors*(1 + doubt)
   end function change_by_inlet

   !> Share of the central film lost by starvation; 0 if the inlet thickens it.
   pure real(wp) function film_loss(self) result(loss)
      type(domain_change_t), intent(in) :: self

      loss = max(1 - quotient(value_between(self%near, h_central), value_between(self%far, &
         h_central)), 0.0_wp)
   end function film_loss

   !> The compared value of row `i` of a `summary`: that between nodes; of crests the one next to a
   !> spike, if both have one.
   pure real(wp) function compared_value(self, summary, i) result(value)
      type(domain_change_t), intent(in) :: self
      type(line_summary_t), intent(in) :: summary
      integer, intent(in) :: i

      value = value_between(summary, i)
      if (quantity_rows(i)%rule /= rule_crest) return
      if (all(ieee_is_finite([self%near%crests%spike, self%far%crests%spike, &
         self%near%crests%other, self%far%crests%other]))) value = summary%crests%other
   end function compared_value

end module inlet_errors
