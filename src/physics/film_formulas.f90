!> Films by handbook formulas for smooth, steady line contacts, to compare with the computed one,
!> and their known deviations.
!>
!> With U = mu_0 u/(E' R), mean speed u, G = alpha E' and W = w/(E' R) Moes' numbers of (2.53, 2.54)
!> are M = W U^(-1/2) and L = G U^(1/4), and h/R = U^(1/2) times a function of M and L alone: the
!> exponents of the formulas below obey that to the last digit.
module film_formulas
   use kinds, only: wp
   use lubricant, only: density_constant, fluid_density, fluid_t, viscosity_barus
   use moes, only: central_film, film_from_moes_units, moes_l_sum_from_mean, moes_m_sum_from_mean
   implicit none (type, external)
   private

   public :: film_by_formula, formula_row_t, formulas_hold, known_bias

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
   end type formula_row_t

   integer, parameter :: dowson_higginson = 1, dowson_toyoda = 2, moes_fit = 3

   type(formula_row_t), parameter, public :: formula_rows(*) = [ &
      formula_row_t('dowson_higginson', 'Dowson-Higginson', 'h_min', &
         'smallest film, h/R = 2.65 U^0.70 G^0.54 W^-0.13', &
         'D. Dowson, Proc. Instn. Mech. Engrs. 182 (3A), 1968, 151', &
         reshape([-0.10_wp, 0.13_wp, -0.07_wp, 0.12_wp, -0.13_wp, 0.0_wp, -0.10_wp, 0.01_wp], &
         [2, 4])), &
      formula_row_t('dowson_toyoda', 'Dowson-Toyoda', 'h_central', &
         'central film, h/R = 3.06 U^0.69 G^0.56 W^-0.10', &
         'D. Dowson and A. Toyoda, Proc. 5th Leeds-Lyon Symposium, 1979, 60', &
         reshape([-0.08_wp, 0.12_wp, -0.09_wp, 0.05_wp, -0.11_wp, 0.02_wp, -0.12_wp, -0.01_wp], &
         [2, 4])), &
      formula_row_t('moes', 'Moes', 'h_central', &
         'central film, four asymptotes joined smoothly', &
         'G. Nijenbanning, C. H. Venner and H. Moes, Wear 176, 1994, 217', &
         reshape([-0.04_wp, 0.11_wp, -0.05_wp, 0.04_wp, -0.07_wp, -0.01_wp, -0.09_wp, -0.03_wp], &
         [2, 4]))]

   !> Moes' numbers (mean speed) for which the formulas are compared: elastic bodies and an oil
   !> whose viscosity rises with pressure.
   real(wp), parameter :: m_range(2) = [3.0_wp, 500.0_wp], l_range(2) = [5.0_wp, 30.0_wp]

contains

   !> Whether the formulas are meant for a contact of Moes' numbers `m_mean` and `l_mean` (mean
   !> speed), and their bias is known: 3 <= M <= 500, 5 <= L <= 30.
   pure logical function formulas_hold(m_mean, l_mean) result(hold)
      real(wp), intent(in) :: m_mean, l_mean

      hold = m_mean >= m_range(1) .and. m_mean <= m_range(2) .and. l_mean >= l_range(1) &
         .and. l_mean <= l_range(2)
   end function formulas_hold

   !> Film in b^2/R [-] by row `i` of the formulas; M and L > 0 with the mean speed.
   pure real(wp) function film_by_formula(i, m_mean, l_mean) result(film)
      integer, intent(in) :: i
      real(wp), intent(in) :: m_mean, l_mean

      select case (i)
      case (dowson_higginson)
         film = film_from_moes_units(2.65_wp*m_mean**(-0.13_wp)*l_mean**0.54_wp, m_mean)
      case (dowson_toyoda)
         film = film_from_moes_units(3.06_wp*m_mean**(-0.10_wp)*l_mean**0.56_wp, m_mean)
      case (moes_fit)
         film = central_film(moes_m_sum_from_mean(m_mean), moes_l_sum_from_mean(l_mean))
      case default
         error stop 'film_by_formula: a formula without its case'
      end select
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

end module film_formulas
