!> Moes' parameters M, L of the smooth lubricated line contact, in both conventions, and the films
!> from them, also by other formulas of handbooks, with their known deviations.
!>
!> The thesis (2.53, 2.54) uses the mean speed (u1 + u2)/2: M_mean, L_mean. Venner and Lubrecht, and
!> Moes' film formulas here, use the sum of the speeds: M_sum = M_mean/sqrt(2), L_sum = L_mean
!> 2^(1/4). Names state the convention; the product L sqrt(M) is the same in both.
!>
!> With U = mu_0 u/(E' R), mean speed u, G = alpha E' and W = w/(E' R) they are M = W U^(-1/2) and
!> L = G U^(1/4), and h/R = U^(1/2) times a function of M and L alone: the exponents of the formulas
!> of handbooks obey that to the last digit.
!>
!> Of a point contact with D = Rx/Ry they are those of the sum of the speeds: M = w/(E' Rx^2)
!> (2U)^(-3/4), L = alpha E' (2U)^(1/4), film h/Rx (2U)^(-1/2), 2U = mu_0 (u1 + u2)/(E' Rx).
module moes
   use hertz, only: ellipse_t
   use kinds, only: pi, wp
   use lubricant, only: density_constant, fluid_density, fluid_t, viscosity_barus
   implicit none (type, external)
   private

   public :: alpha_bar_from_moes, central_film, central_point_film, film_by_formula, &
      film_from_moes_units, formula_row_t, formulas_hold, known_bias, lambda_from_moes_sum, &
      moes_l_from_alpha_bar, moes_m_sum_from_lambda, point_alpha_bar, point_film_unit, &
      point_lambda, rigid_film

   !> M of the mean speed over that of the sum of speeds, L of the sum over that of the mean [-].
   real(wp), parameter, public :: m_mean_per_sum = sqrt(2.0_wp), &
      l_sum_per_mean = sqrt(sqrt(2.0_wp))
   !> Film of the rigid isoviscous contact times M_sum, in Moes units [-]; H. M. Martin, Engineering
   !> 102, 1916, 119 (with the free cavitation boundary; the often quoted value 3 is 23 % high).
   real(wp), parameter, public :: martin_film = 2.4475_wp

   !> One formula.
   type :: formula_row_t
      !> Name in the result, and on screen.
      character(len=16) :: name, authors
      !> Quantity that it gives.
      character(len=9) :: quantity
      character(len=96) :: text, source
      !> Range of its deviation above the result of this program [-] for nine of ten of 240 contacts
      !> (`make formulas`): with Roelands' viscosity and constant density, with Dowson and
      !> Higginson's, with Barus' viscosity and either; of h_central without that density.
      real(wp) :: bias(2, 4)
      !> Film in Moes units: this times M and L to these powers; 0: by `central_film`.
      real(wp) :: factor, powers(2)
   end type formula_row_t

   type(formula_row_t), parameter, public :: formula_rows(*) = [ &
      formula_row_t('dowson_higginson', 'Dowson-Higginson', 'h_min', &
         'smallest film, h/R = 2.65 U^0.70 G^0.54 W^-0.13', &
         'D. Dowson, Proc. Instn. Mech. Engrs. 182 (3A), 1968, 151', &
         reshape([-0.10_wp, 0.13_wp, -0.07_wp, 0.12_wp, -0.13_wp, 0.0_wp, -0.10_wp, 0.01_wp], &
         [2, 4]), 2.65_wp, [-0.13_wp, 0.54_wp]), &
      formula_row_t('dowson_toyoda', 'Dowson-Toyoda', 'h_central', &
         'central film, h/R = 3.06 U^0.69 G^0.56 W^-0.10', &
         'D. Dowson and A. Toyoda, Proc. 5th Leeds-Lyon Symposium, 1979, 60', &
         reshape([-0.08_wp, 0.12_wp, -0.09_wp, 0.05_wp, -0.11_wp, 0.02_wp, -0.12_wp, -0.01_wp], &
         [2, 4]), 3.06_wp, [-0.10_wp, 0.56_wp]), &
      formula_row_t('moes', 'Moes', 'h_central', &
         'central film, four asymptotes joined smoothly', &
         'G. Nijenbanning, C. H. Venner and H. Moes, Wear 176, 1994, 217', &
         reshape([-0.04_wp, 0.11_wp, -0.05_wp, 0.04_wp, -0.07_wp, -0.01_wp, -0.09_wp, -0.03_wp], &
         [2, 4]), 0.0_wp, [0.0_wp, 0.0_wp])]

   !> Moes' numbers (mean speed) for which the formulas are compared: elastic bodies and an oil
   !> whose viscosity rises with pressure.
   real(wp), parameter :: m_range(2) = [3.0_wp, 500.0_wp], l_range(2) = [5.0_wp, 30.0_wp]

contains

   !> Speed parameter lambda [-] of (2.57):  lambda = 3 pi^2/(8 M_sum^2) = 3 pi^2/(4 M_mean^2);
   !> `m_sum` > 0.
   !>
   !> From (2.53) and (2.55), whose right-hand form lacks the factor 1/8 in print: lambda = 3 pi^2
   !> mu_0 u_s R E'/(8 w^2).
   pure elemental real(wp) function lambda_from_moes_sum(m_sum) result(lambda)
      real(wp), intent(in) :: m_sum

      lambda = 3.0_wp*pi**2/(8.0_wp*m_sum**2)
   end function lambda_from_moes_sum

   !> M_sum [-] from the speed parameter `lambda` > 0 [-], the inverse of `lambda_from_moes_sum`.
   pure elemental real(wp) function moes_m_sum_from_lambda(lambda) result(m_sum)
      real(wp), intent(in) :: lambda

      m_sum = pi*sqrt(3.0_wp/(8.0_wp*lambda))
   end function moes_m_sum_from_lambda

   !> alpha p_h [-] from M > 0 and L >= 0, both in either convention: L sqrt(M/(2 pi)), from (2.53,
   !> 2.54, 2.56).
   pure elemental real(wp) function alpha_bar_from_moes(m, l) result(alpha_bar)
      real(wp), intent(in) :: m, l

      alpha_bar = l*sqrt(m/(2.0_wp*pi))
   end function alpha_bar_from_moes

   !> L [-] from alpha p_h >= 0 and M > 0 [-], in the convention of the given M; inverse of
   !> `alpha_bar_from_moes`.
   pure elemental real(wp) function moes_l_from_alpha_bar(alpha_bar, m) result(l)
      real(wp), intent(in) :: alpha_bar, m

      l = alpha_bar*sqrt(2.0_wp*pi/m)
   end function moes_l_from_alpha_bar

   !> Film thickness in b^2/R [-] from Moes units, (h/R) sqrt(E' R/(mu_0 u_s)) with the sum of
   !> speeds:  pi/(8 M_sum).
   pure elemental real(wp) function film_from_moes_units(film_moes, m_sum) result(film)
      real(wp), intent(in) :: film_moes, m_sum

      film = film_moes*pi/(8.0_wp*m_sum)
   end function film_from_moes_units

   !> Central film thickness H_c in b^2/R [-] of the smooth incompressible Newtonian contact.
   !>
   !> Fit of G. Nijenbanning, C. H. Venner and H. Moes, Wear 176, 1994, 217, for line contacts (H.
   !> Moes): rigid or elastic, isoviscous or piezoviscous asymptotes joined smoothly. Within 5 % for
   !> M >= 5; about 20 % high near M = 1, L = 10. `m_sum` > 0; `l_sum` >= 0 (0 = isoviscous).
   !> `elasticity` (0 to 1): for bodies stiffer by its inverse, in the b^2/R of the given ones; M
   !> falls with the root of E', L rises with its power 3/4.
   pure elemental real(wp) function central_film(m_sum, l_sum, elasticity) result(film)
      real(wp), intent(in) :: m_sum, l_sum
      real(wp), intent(in), optional :: elasticity
      real(wp) :: rigid_iso, elastic_iso, rigid_piezo, elastic_piezo, power, isoviscous, lower, &
         piezoviscous

      rigid_iso = martin_film/m_sum
      elastic_iso = 2.621_wp*m_sum**(-0.2_wp)
      rigid_piezo = 1.287_wp*l_sum**(2.0_wp/3.0_wp)
      elastic_piezo = 1.311_wp*m_sum**(-0.125_wp)*l_sum**0.75_wp
      if (present(elasticity)) then
         elastic_iso = elastic_iso*elasticity**0.4_wp
         elastic_piezo = elastic_piezo*max(elasticity, tiny(1.0_wp))**(-0.125_wp)
      end if
      power = (7.0_wp + 8.0_wp*exp(-2.0_wp*min(elastic_iso/rigid_iso, 100.0_wp)))/5.0_wp
      isoviscous = (rigid_iso**(7.0_wp/3.0_wp) + elastic_iso**(7.0_wp/3.0_wp))**(3.0_wp/7.0_wp)
      ! (a^(-7/2) + b^(-7/2))^(-2/7) with the smaller one factored out, so that L = 0 is no special
      ! case
      lower = min(rigid_piezo, elastic_piezo)
      piezoviscous = lower/(1.0_wp + (lower/max(rigid_piezo, elastic_piezo, &
         tiny(1.0_wp)))**3.5_wp)**(2.0_wp/7.0_wp)
      film = film_from_moes_units((isoviscous**power + piezoviscous**power)**(1.0_wp/power), m_sum)
   end function central_film

   !> Film thickness in b^2/R [-] of rigid bodies and constant viscosity: 2.4475/M_sum in Moes units
   !> (`martin_film`).
   pure elemental real(wp) function rigid_film(m_sum) result(film)
      real(wp), intent(in) :: m_sum

      film = film_from_moes_units(martin_film/m_sum, m_sum)
   end function rigid_film

   !> Whether the formulas are meant for a contact of Moes' numbers `m_sum` and `l_sum`, and their
   !> bias is known: 3 <= M <= 500, 5 <= L <= 30 of the mean speed.
   pure logical function formulas_hold(m_sum, l_sum) result(hold)
      real(wp), intent(in) :: m_sum, l_sum

      associate (m => m_sum*m_mean_per_sum, l => l_sum/l_sum_per_mean)
         hold = m >= m_range(1) .and. m <= m_range(2) .and. l >= l_range(1) .and. l <= l_range(2)
      end associate
   end function formulas_hold

   !> Film in b^2/R [-] by row `i` of the formulas; M and L > 0 with the sum of speeds.
   pure real(wp) function film_by_formula(i, m_sum, l_sum) result(film)
      integer, intent(in) :: i
      real(wp), intent(in) :: m_sum, l_sum
      type(formula_row_t) :: row
      real(wp) :: l, m

      row = formula_rows(i)
      m = m_sum*m_mean_per_sum
      l = l_sum/l_sum_per_mean
      film = central_film(m/m_mean_per_sum, l*l_sum_per_mean)
      if (row%factor > 0.0_wp) film = film_from_moes_units(row%factor*m**row%powers(1) &
         *l**row%powers(2), m)
   end function film_by_formula

   !> Least and most by which row `i` usually lies above the computed film of a Newtonian oil [-].
   !> The formulas ignore density in the middle of the contact: there the same mass of oil takes
   !> less room by the density at the Hertzian pressure; at the exit, where h_min is, hardly any
   !> less.
   pure function known_bias(i, fluid) result(bias)
      integer, intent(in) :: i
      type(fluid_t), intent(in) :: fluid
      real(wp) :: bias(2), rho(1), slope(1)
      integer :: laws

      laws = merge(1, 2, fluid%density_law == density_constant)
      if (fluid%viscosity_law == viscosity_barus) laws = laws + 2
      bias = formula_rows(i)%bias(:, laws)
      if (formula_rows(i)%quantity /= 'h_central') return
      call fluid_density(fluid, [1.0_wp], rho, slope)
      bias = (1 + bias)*rho(1) - 1
   end function known_bias

   !> t of Moes' number M > 0, sum of speeds: films are in units of t^(2/3) a^2/Rx.
   pure elemental real(wp) function moes_scale(ellipse, moes_m) result(t)
      type(ellipse_t), intent(in) :: ellipse
      real(wp), intent(in) :: moes_m

      t = 3*moes_m/(pi**2*ellipse%compliance*ellipse%ratio)
   end function moes_scale

   !> lambda = 6 u_s mu_0 Rx^2/(a^3 p_h) [-] of M.
   pure elemental real(wp) function point_lambda(ellipse, moes_m) result(lambda)
      type(ellipse_t), intent(in) :: ellipse
      real(wp), intent(in) :: moes_m

      lambda = 12/(pi*ellipse%compliance)*moes_scale(ellipse, moes_m)**(-4.0_wp/3.0_wp)
   end function point_lambda

   !> alpha p_h [-] of M and L.
   pure elemental real(wp) function point_alpha_bar(ellipse, moes_m, moes_l) result(alpha_bar)
      type(ellipse_t), intent(in) :: ellipse
      real(wp), intent(in) :: moes_m, moes_l

      alpha_bar = 0.5_wp*pi*ellipse%compliance*moes_l*moes_scale(ellipse, moes_m)**(1.0_wp/3.0_wp)
   end function point_alpha_bar

   !> a^2/Rx, the unit of the film, in units of Moes.
   pure elemental real(wp) function point_film_unit(ellipse, moes_m) result(factor)
      type(ellipse_t), intent(in) :: ellipse
      real(wp), intent(in) :: moes_m

      factor = moes_scale(ellipse, moes_m)**(2.0_wp/3.0_wp)
   end function point_film_unit

   !> Central film in units of Moes of a smooth incompressible Newtonian contact with entrainment
   !> along x: fit of G. Nijenbanning, C. H. Venner and H. Moes, Wear 176, 1994, 217. M > 0, L >= 0,
   !> D > 0. Within 3 % for M >= 20 and 0.2 <= D <= 1; 20 % high at M = 1.
   pure elemental real(wp) function central_point_film(moes_m, moes_l, radius_ratio) result(film)
      real(wp), intent(in) :: moes_m, moes_l, radius_ratio
      real(wp) :: rigid_iso, elastic_iso, rigid_piezo, elastic_piezo, shape, power, isoviscous

      associate (d => radius_ratio)
         shape = 1 + 0.006_wp*log(d) + 0.63_wp*d**(4.0_wp/7.0_wp)
         rigid_iso = 145*(1 + 0.796_wp*d**(14.0_wp/15.0_wp))**(-15.0_wp/7.0_wp)/(d*moes_m**2)
         elastic_iso = 3.18_wp*shape**(-0.56_wp)*d**(-1.0_wp/15.0_wp)*moes_m**(-2.0_wp/15.0_wp)
         rigid_piezo = 1.29_wp*(1 + 0.691_wp*d)**(-2.0_wp/3.0_wp)*moes_l**(2.0_wp/3.0_wp)
         elastic_piezo = 1.48_wp*shape**(-0.35_wp)*d**(-1.0_wp/24.0_wp) &
            *moes_m**(-1.0_wp/12.0_wp)*moes_l**0.75_wp
         power = 1.5_wp*(1 + exp(-1.2_wp*elastic_iso/rigid_iso))
         isoviscous = (rigid_iso**(1.5_wp*power) + (elastic_iso**(-4) &
            + (1.8_wp/d)**(-4))**(-0.375_wp*power))**(2.0_wp/3.0_wp)
         ! both piezoviscous films are 0 for L = 0
         film = (isoviscous + (max(rigid_piezo, tiny(1.0_wp)**0.02_wp)**(-8) &
            + max(elastic_piezo, tiny(1.0_wp)**0.02_wp)**(-8))**(-power/8))**(1/power)
      end associate
   end function central_point_film

end module moes
