!> Errors by the length of the inlet.
module inlet_errors
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use inlet_change, only: change_by_inlet, inlet_change_t
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_summary, only: line_summary_t
   use lubricant, only: fluid_t, fluid_viscosity
   use quantities, only: h_central, p_max, quantity_count, quantity_rows, sliding_rows
   use rheology, only: thins
   implicit none (type, external)
   private

   public :: domain_error, inlet_shares

   !> Films err by up to twice the share lost by starvation, and the exit by that share where the
   !> film is thick (M 0.5-500, L 0-30, against four times the domain).
   real(wp), parameter :: film_safety = 2.0_wp
   !> Forces err as films do, sliding by up to this many times the share of the pressures in
   !> addition; with a Newtonian oil as its viscosity does, where the largest pressure changes by a
   !> third of that share (M 2-70, L 3-9, against a domain twice as long).
   real(wp), parameter :: shear_safety = 1.5_wp, pressure_part = 1.0_wp/3.0_wp

contains

   !> Bound on the relative error of a film by the length of the domain, from the `inlet_error` of
   !> its inlet.
   pure real(wp) function domain_error(inlet_error) result(error)
      real(wp), intent(in) :: inlet_error

      error = film_safety*inlet_error
   end function domain_error

   !> Relative errors of all quantities by the inlet: from the coarse runs of its `change`, else by
   !> the rules in the report.
   pure function inlet_shares(change, fluid, report, summary) result(shares)
      type(inlet_change_t), intent(in) :: change
      type(fluid_t), intent(in) :: fluid
      type(report_t), intent(in) :: report
      type(line_summary_t), intent(in) :: summary
      real(wp) :: shares(quantity_count)

      if (change%is_known) then
         shares = change_by_inlet(change)
         where (quantity_rows%field == 'x') shares = shares/max(abs(summary%of%value), tiny(1.0_wp))
         return
      end if
      shares = report%fit%inlet_error*min(1.0_wp, summary%of(h_central)%value)
      where (quantity_rows%field == 'pressure') shares = report%fit%inlet_pressure_error
      where (quantity_rows%field == 'film_thickness') shares = domain_error(report%fit%inlet_error)
      where (quantity_rows%field == 'friction_coefficient' .or. quantity_rows%field == 'power') &
         shares = domain_error(report%fit%inlet_error)
      shares(sliding_rows) = shares(sliding_rows) + shear_response(fluid, &
         summary%of(p_max)%value)*report%fit%inlet_pressure_error
   end function inlet_shares

   !> Relative error of sliding over the share of pressures lost at the inlet.
   pure function shear_response(fluid, pressure) result(response)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: pressure
      real(wp) :: response, ln_mu(1)

      response = shear_safety
      if (thins(fluid) .or. .not. ieee_is_finite(pressure)) return
      call fluid_viscosity(fluid, [pressure], ln_mu)
      response = max(response, pressure_part*ln_mu(1))
   end function shear_response

end module inlet_errors
