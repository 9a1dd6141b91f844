!> The lubricated point contact, dimensionless: X along entrainment, lengths in the half-axis a that
!> belongs to Rx, pressure in p_h, film in a^2/Rx, time in 2 a/u_s. The ellipse turns under the
!> grid, not the grid under the oil.
!>
!>     div( e grad P ) - d(rho H)/dX - d(rho H)/dT = 0 ,  e = rho H^3 S/(lambda mu) ,  P >= 0
!>     H = H0 + q0 X^2/2 + q1 X Y + q2 Y^2/2 - Psi_1 - Psi_2 + C II P/R dA ,  II P dA = 2 pi kappa/3
!>
!> With the flow of small pressure gradients on sliding along X, an Eyring oil has the viscosities
!> mu/S along and across it: S_x = sqrt(1 + B^2), S_y = B/arsinh(B), B = mu |u2 - u1|/(tau_0 h).
module point_contact
   use contact_moment, only: least_speed, sample_count, set_sliding, thinned_central_film
   use duty, only: moment_t
   use hertz, only: ellipse_t, new_ellipse
   use kinds, only: pi, wp
   use line_contact, only: rough_contact_t, smoothen_both
   use lubricant, only: faster_fluid, fluid_t
   use moes, only: central_point_film, point_film_unit, point_lambda
   implicit none (type, external)
   private

   public :: dry_border, far_pressure, film_by_formulas, fit_duty, first_intervals, &
      hertz_pressure_at, intervals_for, new_point_contact, rows_for, set_point_moment, start_of

   !> Directions of the far field.
   integer, parameter :: directions = 360

   !> The contact.
   type, public, extends(rough_contact_t) :: point_contact_t
      type(ellipse_t) :: ellipse
      !> D = Rx/Ry, and the angle from the x axis of the ellipse to the entrainment [rad].
      real(wp) :: radius_ratio = 1.0_wp, angle = 0.0_wp
      !> Moes' M of the sum of the speeds [-].
      real(wp) :: moes_m = 1.0_wp
      !> II P dA [-], of the reference state; the moment of a duty, and its film to start from.
      real(wp) :: load = 0.0_wp, first_film = 0.0_wp
      type(moment_t) :: moment
      !> Whether the speeds of a duty become small.
      logical :: rests = .false.
      !> q0, q1, q2, and half-widths of the turned ellipse along X and Y [-].
      real(wp) :: curvature(3) = 0.0_wp, half_widths(2) = 1.0_wp
      !> The pressure around the domain is that of rigid bodies, not 0; its P r^3 in directions from
      !> that of the fastest growing gap on.
      logical :: has_far_field = .true.
      real(wp) :: far(0:directions) = 0.0_wp
   end type point_contact_t

   !> Cells are at most so many times as long in y as in x: longer ones cost iterations.
   real(wp), parameter :: longest_cell = 1.5_wp
   !> Fewest intervals in x of a grid that is solved.
   integer, parameter :: fewest = 32

contains

   !> The contact of D = `radius_ratio` > 0, Moes' M > 0 and L >= 0 of the sum of the speeds, the
   !> `angle` [rad] and the `fluid` in the scales of this contact. Its domain is the usual one.
   pure function new_point_contact(radius_ratio, moes_m, moes_l, angle, fluid) result(contact)
      real(wp), intent(in) :: radius_ratio, moes_m, moes_l, angle
      type(fluid_t), intent(in) :: fluid
      type(point_contact_t) :: contact
      real(wp) :: width

      allocate (contact%surface_1%features(0), contact%surface_2%features(0))
      contact%surface_1%speed = 1.0_wp
      contact%surface_2%speed = 1.0_wp
      contact%radius_ratio = radius_ratio
      contact%moes_m = moes_m
      contact%moes_l_sum = moes_l
      contact%angle = angle
      contact%fluid = fluid
      contact%ellipse = new_ellipse(radius_ratio)
      contact%lambda = point_lambda(contact%ellipse, moes_m)
      associate (c => cos(angle), s => sin(angle), kappa => contact%ellipse%ratio, &
         d => radius_ratio, q => contact%curvature, b => contact%half_widths)
         contact%load = 2*pi*kappa/3
         q = [c**2 + d*s**2, (d - 1)*c*s, s**2 + d*c**2]
         b = [hypot(c, kappa*s), hypot(s, kappa*c)]
         contact%half_length = b(1)
         contact%expected_film = film_by_formulas(contact, 1.0_wp)
         contact%far = far_shape(q, contact%lambda)
         contact%first_film = contact%expected_film
         width = max(1.0_wp, sqrt(2*contact%expected_film))
         contact%domain%x_inlet = -b(1) - 3.5_wp*width
         contact%domain%x_outlet = b(1) + 0.5_wp*width
         contact%domain%y_half_width = b(2) + 2*sqrt(b(2))*width
      end associate
   end function new_point_contact

   !> Central film of a contact with `factor` > 0 times its viscosity: M ~ mu_0^(-3/4), L ~
   !> mu_0^(1/4) at the same alpha; lambda and Eyring's B ~ mu_0.
   pure real(wp) function film_by_formulas(contact, factor) result(film)
      type(point_contact_t), intent(in) :: contact
      real(wp), intent(in) :: factor
      real(wp) :: m

      m = contact%moes_m/factor**0.75_wp
      associate (along => contact%curvature(1), across => contact%curvature(3))
         film = thinned_central_film(faster_fluid(contact%fluid, factor), factor*contact%lambda, &
            central_point_film(m*along**1.25_wp, contact%moes_l_sum*(factor*along)**0.25_wp, &
            across/along)/sqrt(along)/point_film_unit(contact%ellipse, m))
      end associate
   end function film_by_formulas

   !> Fits domain and expected film to all moments of the duty: the largest domain, and the film of
   !> the moment that needs the finest first grid. In units of its own, a W^(1/3) and p_h W^(1/3), a
   !> moment is a contact of constant load.
   pure subroutine fit_duty(contact)
      type(point_contact_t), intent(inout) :: contact
      type(point_contact_t) :: own
      type(fluid_t) :: fluid
      real(wp) :: ends(2), film, speed, width
      integer :: i

      contact%rests = .not. contact%duty%always_moves(least_speed)
      associate (times => contact%duty%samples(sample_count), domain => contact%domain)
         do i = 1, size(times)
            associate (moment => contact%duty%at(times(i)))
               width = moment%load**(1.0_wp/3)
               speed = max(abs(sum(moment%speeds)), least_speed)
               fluid = contact%fluid
               fluid%alpha_bar = fluid%alpha_bar*width
               fluid%p0 = fluid%p0/width
               fluid%c1 = fluid%c1/width
               call set_sliding(fluid, contact%lambda, moment)
               if (allocated(fluid%rheology)) then
                  fluid%rheology%sigma_scale = fluid%rheology%sigma_scale*width**2
                  fluid%rheology%ln_b_scale = fluid%rheology%ln_b_scale - 2*log(width)
               end if
               own = new_point_contact(contact%radius_ratio, contact%moes_m*moment%load &
                  /speed**0.75_wp, contact%moes_l_sum*speed**0.25_wp, contact%angle, fluid)
               ends = width*[own%domain%x_inlet, own%domain%x_outlet]
               if (sum(moment%speeds) < 0.0_wp) ends = -ends([2, 1])
            end associate
            film = width**2*own%expected_film
            if (i == 1) contact%first_film = film
            contact%expected_film = min(contact%expected_film, film*(max(contact%moes_m, 1.0_wp) &
               /max(own%moes_m, 1.0_wp))**0.4_wp)
            domain%x_inlet = min(domain%x_inlet, ends(1))
            domain%x_outlet = max(domain%x_outlet, ends(2))
            domain%y_half_width = max(domain%y_half_width, width*own%domain%y_half_width)
         end do
      end associate
   end subroutine fit_duty

   !> Sets load and speeds of the duty, if any, at a `time`.
   pure subroutine set_point_moment(contact, time)
      type(point_contact_t), intent(inout) :: contact
      real(wp), intent(in) :: time

      if (.not. allocated(contact%duty)) return
      contact%moment = contact%duty%at(time)
      contact%slide_to_roll = 2*(contact%moment%speeds(2) - contact%moment%speeds(1))
      call set_sliding(contact%fluid, contact%lambda, contact%moment)
   end subroutine set_point_moment

   !> The smooth contact of T = 0, from whose steady state a passage starts: of one at rest, as if
   !> it moved. Its grids need to hold its own film only.
   pure function start_of(contact) result(start)
      type(point_contact_t), intent(in) :: contact
      type(point_contact_t) :: start

      start = contact
      start%expected_film = start%first_film
      call smoothen_both(start)
      call set_point_moment(start, 0.0_wp)
      associate (speeds => start%moment%speeds)
         if (.not. abs(sum(speeds)) > 0.0_wp) speeds = 0.5_wp*least_speed
      end associate
   end function start_of

   !> P r^3 of rigid bodies and an oil of constant viscosity far from the contact, where H = q r^2/2
   !> with q = e.Q e in the direction e(theta), and where it does not cavitate
   !>
   !>     (q^3 f')' - 9 q^3 f = 8 lambda (q0 cos theta + q1 sin theta) ,  f >= 0
   !>
   !> (without f >= 0 that of P. L. Kapitza, Zh. Tekh. Fiz. 25, 1955, 747: -4 g.e/q^2). By central
   !> differences; the directions with oil are found by repetition.
   pure function far_shape(q, lambda) result(f)
      real(wp), intent(in) :: q(3), lambda
      real(wp) :: cube(0:2*directions), f(0:directions), share(0:directions), turn(0:2*directions)
      real(wp) :: between(directions)
      real(wp), dimension(directions - 1) :: diagonal, source
      logical :: flows(directions - 1), had(directions - 1)
      integer :: k

      turn = [(atan2(q(2), q(1)) + pi*k/directions, k=0, 2*directions)]
      cube = (q(1)*cos(turn)**2 + q(2)*sin(2*turn) + q(3)*sin(turn)**2)**3
      between = cube(1::2)*(directions/(2*pi))**2
      source = 8*lambda*norm2(q(:2))*cos([(2*pi*k/directions, k=1, directions - 1)])
      diagonal = between(:directions - 1) + between(2:) + 9*cube(2:2*directions - 2:2)
      f = 0.0_wp
      share = 0.0_wp
      flows = source < 0.0_wp
      had = .not. flows
      do while (any(flows .neqv. had))
         do k = 1, directions - 1
            share(k) = merge(1/(diagonal(k) - between(k)*share(k - 1)), 0.0_wp, flows(k))
            f(k) = share(k)*(between(k)*f(k - 1) - source(k))
            share(k) = share(k)*between(k + 1)
         end do
         do k = directions - 1, 1, -1
            f(k) = f(k) + share(k)*f(k + 1)
         end do
         had = flows
         flows = between(:directions - 1)*f(:directions - 2) + between(2:)*f(2:) > source
      end do
   end function far_shape

   !> That pressure at (x, y), x with the flow, where the film is `h`: far from the contact P r^3,
   !> closer (q r^2/(2 H))^2 of it, as Kapitza's.
   pure elemental real(wp) function far_pressure(contact, x, y, h) result(p)
      type(point_contact_t), intent(in) :: contact
      real(wp), intent(in) :: x, y, h
      real(wp) :: place
      integer :: k

      p = 0.0_wp
      if (.not. contact%has_far_field) return
      associate (q => contact%curvature, f => contact%far)
         place = modulo(atan2(y, x) - atan2(q(2), q(1)), 2*pi)*directions/(2*pi)
         k = min(int(place), directions - 1)
         p = (f(k) + (place - k)*(f(k + 1) - f(k)))*abs(sum(contact%moment%speeds))*(q(1)*x**2 &
            + 2*q(2)*x*y + q(3)*y**2)**2/(hypot(x, y)**3*(2*h)**2)
      end associate
   end function far_pressure

   !> Pressure of the dry contact of the moment at (x, y).
   pure elemental real(wp) function hertz_pressure_at(contact, x, y) result(p)
      type(point_contact_t), intent(in) :: contact
      real(wp), intent(in) :: x, y

      associate (c => cos(contact%angle), s => sin(contact%angle), &
         width => contact%moment%load**(1.0_wp/3))
         p = sqrt(max(width**2 - (c*x - s*y)**2 - ((s*x + c*y)/contact%ellipse%ratio)**2, 0.0_wp))
      end associate
   end function hertz_pressure_at

   !> q1, q2, q3 of the border q1 X^2 + 2 q2 X Y + q3 Y^2 = 1 of the dry contact.
   pure function dry_border(contact) result(q)
      type(point_contact_t), intent(in) :: contact
      real(wp) :: q(3)

      associate (c => cos(contact%angle), s => sin(contact%angle), k => contact%ellipse%ratio)
         q = [c**2 + (s/k)**2, c*s*(1/k**2 - 1), s**2 + (c/k)**2]
      end associate
   end function dry_border

   !> Fewest intervals in x, a power of two, for a relative error of H_c: on cells hx long 0.5
   !> M^0.24 hx^2/H_c is to be expected, measured.
   pure integer function intervals_for(contact, error) result(nx)
      type(point_contact_t), intent(in) :: contact
      real(wp), intent(in) :: error

      nx = 2*fewest
      do while (0.5_wp*max(contact%moes_m, 1.0_wp)**0.24_wp*(length(contact)/nx)**2 &
         /contact%expected_film > error .and. nx < 2**20)
         nx = 2*nx
      end do
   end function intervals_for

   !> Intervals in x of the first grid, `nx` halved as often as it holds the film: hx at most
   !> sqrt(1.15 H_c/M^0.4).
   pure integer function first_intervals(contact, nx) result(first)
      type(point_contact_t), intent(in) :: contact
      integer, intent(in) :: nx
      real(wp) :: most

      most = sqrt(1.15_wp*contact%expected_film/max(contact%moes_m, 1.0_wp)**0.4_wp)
      first = nx
      do while (first > fewest .and. mod(first, 2) == 0 .and. 2*length(contact)/first <= most)
         first = first/2
      end do
   end function first_intervals

   !> Intervals in y to `nx` in x: that, times 3/2 or 4/2 and so on until cells are short enough.
   pure integer function rows_for(contact, nx) result(ny)
      type(point_contact_t), intent(in) :: contact
      integer, intent(in) :: nx

      ny = nx
      do while (2*contact%domain%y_half_width/ny > longest_cell*length(contact)/nx)
         ny = merge(3*(ny/2), 4*(ny/3), iand(ny, ny - 1) == 0)
      end do
   end function rows_for

   !> Length of the domain along X.
   pure real(wp) function length(contact)
      type(point_contact_t), intent(in) :: contact

      length = contact%domain%x_outlet - contact%domain%x_inlet
   end function length

end module point_contact
