!> A contact whose load, radius and speeds change in time, at one of its moments: as a steady smooth
!> contact in units of its own, b sqrt(W r), p_h sqrt(W/r) and b^2/R W, with W = w/w_ref and r =
!> R/R_ref.
module contact_moment
   use duty, only: moment_t
   use eyring, only: ln_b_of_no_sliding
   use film_state, only: film_state_t
   use kinds, only: wp
   use line_contact, only: line_contact_t, smoothen_both
   use lubricant, only: fluid_t
   use moes, only: moes_l_from_alpha_bar, moes_l_sum_from_mean, moes_m_mean_from_sum, &
      moes_m_sum_from_lambda
   implicit none (type, external)
   private

   public :: at_moment, moments_of, own_contact, set_sliding, width_of

   !> Moments of a table that choose domain and grid, at most.
   integer, parameter, public :: sample_count = 200
   !> Contacts draw in oil with at least this share of the reference speed when domain, grid and a
   !> start at rest are chosen: at standstill a film lasts that a faster contact has made.
   real(wp), parameter, public :: least_speed = 0.1_wp

contains

   !> Half-width over that of the reference state.
   pure real(wp) function width_of(moment) result(width)
      type(moment_t), intent(in) :: moment

      width = sqrt(moment%load*moment%radius)
   end function width_of

   !> The contact at some moments of its duty, as if it moved at each.
   pure function moments_of(contact) result(moments)
      type(line_contact_t), intent(in) :: contact
      type(line_contact_t), allocatable :: moments(:)
      integer :: i

      associate (times => contact%duty%samples(sample_count))
         allocate (moments(size(times)))
         do i = 1, size(times)
            moments(i) = own_contact(contact, times(i), least_speed)
         end do
      end associate
   end function moments_of

   !> The smooth steady contact at `time` in its own units, with X in the direction of the flow;
   !> as if it moved at `least` so fast [u_ref].
   pure function own_contact(contact, time, least) result(own)
      type(line_contact_t), intent(in) :: contact
      real(wp), intent(in) :: time, least
      type(line_contact_t) :: own
      type(moment_t) :: moment
      real(wp) :: pressure, speed

      moment = contact%duty%at(time)
      call smoothen_both(own)   ! without a copy of the duty
      own%surface_1%speed = 1.0_wp
      own%surface_2%speed = 1.0_wp
      own%fluid = contact%fluid
      own%elasticity = contact%elasticity
      pressure = sqrt(moment%load/moment%radius)
      speed = max(abs(sum(moment%speeds)), least)
      own%lambda = contact%lambda*speed*moment%radius/moment%load**2
      own%slide_to_roll = sign(2/speed, sum(moment%speeds))*(moment%speeds(2) &
         - moment%speeds(1))
      own%slope = contact%slope*pressure
      associate (fluid => own%fluid)
         fluid%alpha_bar = fluid%alpha_bar*pressure
         fluid%p0 = fluid%p0/pressure
         fluid%c1 = fluid%c1/pressure
         call set_sliding(fluid, contact%lambda, moment)
         if (allocated(fluid%rheology)) then
            fluid%rheology%sigma_scale = fluid%rheology%sigma_scale*moment%load/moment%radius
            fluid%rheology%ln_b_scale = fluid%rheology%ln_b_scale - log(moment%load)
         end if
         own%moes_m_sum = moes_m_sum_from_lambda(own%lambda)
         own%moes_l_sum = moes_l_sum_from_mean(moes_l_from_alpha_bar(fluid%alpha_bar, &
            moes_m_mean_from_sum(own%moes_m_sum)))
      end associate
      own%domain = contact%domain
      associate (domain => own%domain, ends => [contact%domain%x_inlet, contact%domain%x_outlet] &
         /width_of(moment))
         domain%x_inlet = ends(1)
         domain%x_outlet = ends(2)
         if (sum(moment%speeds) < 0.0_wp) then
            domain%x_inlet = -ends(2)
            domain%x_outlet = -ends(1)
         end if
      end associate
   end function own_contact

   !> Sets what the sliding of a moment does to the slip factor of a fluid in reference units: B H
   !> over mu/mu_0 is lambda |u2 - u1|/u_ref (Sigma over H dP/dX)/3.
   pure subroutine set_sliding(fluid, lambda, moment)
      type(fluid_t), intent(inout) :: fluid
      real(wp), intent(in) :: lambda
      type(moment_t), intent(in) :: moment
      real(wp) :: sliding

      if (.not. allocated(fluid%rheology)) return
      sliding = abs(moment%speeds(2) - moment%speeds(1))*lambda*fluid%rheology%sigma_scale/3
      fluid%rheology%ln_b_scale = ln_b_of_no_sliding
      if (sliding > 0.0_wp) fluid%rheology%ln_b_scale = log(sliding)
   end subroutine set_sliding

   !> The contact with the sliding at `time`, in reference units.
   pure function at_moment(contact, time) result(now)
      type(line_contact_t), intent(in) :: contact
      real(wp), intent(in) :: time
      type(line_contact_t) :: now
      type(moment_t) :: moment

      now = contact
      if (.not. allocated(contact%duty)) return
      moment = contact%duty%at(time)
      now%slide_to_roll = 2*(moment%speeds(2) - moment%speeds(1))
      call set_sliding(now%fluid, contact%lambda, moment)
   end function at_moment

end module contact_moment
