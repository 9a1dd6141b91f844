!> Viscosity of an oil by its data sheet: the classes of ISO 3448, the viscosity index of ASTM D2270
!> and the temperature line of ASTM D341 (Ubbelohde and Walther), kinematic in the units of these
!> standards, mm2/s and degC; and the relation (2.27) of the parameters of Roelands' law with the
!> ambient viscosity, by which two of them give the third.
module oil_viscosity
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: complete_roelands, new_walther, roelands_alpha, viscosity_at_100, viscosity_at_40, &
      viscosity_of_class

   !> Range of the line of ASTM D341 with the constant 0.7 alone [mm2/s]; the viscosity index begins
   !> at the same least viscosity, at 100 degC.
   real(wp), parameter, public :: least_viscosity = 2.0_wp, largest_viscosity = 2.0e7_wp
   !> 0 degC [K].
   real(wp), parameter :: ice_point = 273.15_wp
   !> Viscosities at 100 degC where the pieces of L and H begin, and their coefficients:
   !> a Y**2 + b Y + c (3, piece); ASTM D2270-10, Table X2.1.
   real(wp), parameter :: begins(*) = [2.0_wp, 3.8_wp, 4.4_wp, 5.0_wp, 6.4_wp, 7.0_wp, 7.7_wp, &
      9.0_wp, 12.0_wp, 15.0_wp, 18.0_wp, 22.0_wp, 28.0_wp, 40.0_wp, 55.0_wp, 70.0_wp]
   real(wp), parameter :: l_coefficients(3, size(begins)) = reshape([ &
      1.14673_wp, 1.7576_wp, -0.109_wp, 3.38095_wp, -15.4952_wp, 33.196_wp, &
      2.5_wp, -7.2143_wp, 13.812_wp, 0.101_wp, 16.635_wp, -45.469_wp, &
      3.35714_wp, -23.5643_wp, 78.466_wp, 0.01191_wp, 21.475_wp, -72.87_wp, &
      0.41858_wp, 16.1558_wp, -56.04_wp, 0.88779_wp, 7.5527_wp, -16.6_wp, &
      0.7672_wp, 10.7972_wp, -38.18_wp, 0.97305_wp, 5.3135_wp, -2.2_wp, &
      0.97256_wp, 5.25_wp, -0.98_wp, 0.91413_wp, 7.4759_wp, -21.82_wp, &
      0.87031_wp, 9.7157_wp, -50.77_wp, 0.84703_wp, 12.6752_wp, -133.31_wp, &
      0.85921_wp, 11.1009_wp, -83.19_wp, 0.83531_wp, 14.6731_wp, -216.246_wp], [3, size(begins)])
   real(wp), parameter :: h_coefficients(3, size(begins)) = reshape([ &
      0.84155_wp, 1.5521_wp, -0.077_wp, 0.78571_wp, 1.7929_wp, -0.183_wp, &
      0.82143_wp, 1.5679_wp, 0.119_wp, 0.04985_wp, 9.1613_wp, -18.557_wp, &
      0.22619_wp, 7.7369_wp, -16.656_wp, 0.79762_wp, -0.7321_wp, 14.61_wp, &
      0.05794_wp, 10.5156_wp, -28.24_wp, 0.26665_wp, 6.7015_wp, -10.81_wp, &
      0.20073_wp, 8.4658_wp, -22.49_wp, 0.28889_wp, 5.9741_wp, -4.93_wp, &
      0.24504_wp, 7.416_wp, -16.73_wp, 0.20323_wp, 9.1267_wp, -34.23_wp, &
      0.18411_wp, 10.1015_wp, -46.75_wp, 0.17029_wp, 11.4866_wp, -80.62_wp, &
      0.1713_wp, 11.368_wp, -76.94_wp, 0.16841_wp, 11.8493_wp, -96.947_wp], [3, size(begins)])

   !> The line log10 log10(nu + 0.7) = a - b log10 T, T in K; ASTM D341.
   type, public :: walther_t
      real(wp) :: a, b
   contains
      procedure :: viscosity, thermal_slope
   end type walther_t

   !> Minus the logarithm of the viscosity [Pa s] to which every oil tends on Roelands' chart
   !> (6.31e-5 Pa s) [-]; (2.27), C. J. A. Roelands, thesis, Delft 1966.
   real(wp), parameter, public :: roelands_log_shift = 9.67_wp

   !> Largest relative disagreement of alpha, P0 and z when all three are given [-].
   real(wp), parameter :: roelands_agreement = 1.0e-3_wp

contains

   !> Viscosity at 40 degC [mm2/s] in the middle of a class of ISO 3448, ISO VG 2 to 3200.
   pure real(wp) function viscosity_of_class(class) result(nu)
      integer, intent(in) :: class
      integer, parameter :: thin(4) = [2, 3, 5, 7]
      real(wp), parameter :: middles(4) = [2.2_wp, 3.2_wp, 4.6_wp, 6.8_wp]

      nu = class
      if (any(class == thin)) nu = middles(findloc(thin, class, dim=1))
   end function viscosity_of_class

   !> Viscosity at 40 degC [mm2/s] of an oil of `nu_100` >= 2 mm2/s at 100 degC and a viscosity
   !> `index` >= 0: ASTM D2270, procedure A up to 100, B above.
   pure real(wp) function viscosity_at_40(nu_100, index) result(nu_40)
      real(wp), intent(in) :: nu_100, index
      real(wp) :: h, l
      integer :: piece

      piece = max(count(begins <= nu_100), 1)
      l = dot_product(l_coefficients(:, piece), [nu_100**2, nu_100, 1.0_wp])
      h = dot_product(h_coefficients(:, piece), [nu_100**2, nu_100, 1.0_wp])
      if (index <= 100.0_wp) then
         nu_40 = l - 0.01_wp*index*(l - h)
      else
         nu_40 = h/nu_100**log10(1.0_wp + 0.00715_wp*(index - 100.0_wp))
      end if
   end function viscosity_at_40

   !> Viscosity at 100 degC [mm2/s] of an oil of `nu_40` mm2/s at 40 degC and a viscosity `index`,
   !> by bisection; 0: it is below 2 mm2/s, where the index is not defined.
   pure real(wp) function viscosity_at_100(nu_40, index) result(nu_100)
      real(wp), intent(in) :: nu_40, index
      real(wp) :: above, below
      integer :: i

      nu_100 = 0.0_wp
      if (nu_40 < viscosity_at_40(least_viscosity, index)) return
      below = least_viscosity
      above = max(nu_40, below)
      do i = 1, digits(nu_40)
         nu_100 = 0.5_wp*(below + above)
         if (viscosity_at_40(nu_100, index) > nu_40) then
            above = nu_100
         else
            below = nu_100
         end if
      end do
   end function viscosity_at_100

   !> The line through two viscosities `nu` [mm2/s] at two temperatures `t` [degC].
   pure type(walther_t) function new_walther(nu, t) result(line)
      real(wp), intent(in) :: nu(2), t(2)
      real(wp) :: heights(2), places(2)

      heights = log10(log10(nu + 0.7_wp))
      places = log10(t + ice_point)
      line%b = (heights(1) - heights(2))/(places(2) - places(1))
      line%a = heights(1) + line%b*places(1)
   end function new_walther

   !> Viscosity [mm2/s] at a temperature `t` [degC]; valid from 2 to 2e7 mm2/s.
   pure real(wp) function viscosity(self, t) result(nu)
      class(walther_t), intent(in) :: self
      real(wp), intent(in) :: t

      nu = 10.0_wp**min(10.0_wp**(self%a - self%b*log10(t + ice_point)), 100.0_wp) - 0.7_wp
   end function viscosity

   !> -d ln(nu)/dT [1/K] at a temperature `t` [degC].
   pure real(wp) function thermal_slope(self, t) result(slope)
      class(walther_t), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp) :: nu

      nu = self%viscosity(t)
      slope = self%b/(t + ice_point)*log(nu + 0.7_wp)*(nu + 0.7_wp)/nu
   end function thermal_slope

   !> Pressure-viscosity coefficient alpha [1/Pa] from (2.27): alpha = z (ln mu_0 + 9.67)/P0.
   !>
   !> `mu_0` [Pa s] > 6.4e-5; `p0` [Pa] > 0; `z` [-] > 0.
   pure elemental real(wp) function roelands_alpha(mu_0, p0, z) result(alpha)
      real(wp), intent(in) :: mu_0, p0, z

      alpha = z*(log(mu_0) + roelands_log_shift)/p0
   end function roelands_alpha

   !> Completes alpha [1/Pa], P0 [Pa] and z [-] by (2.27) from any two of them; a value <= 0 means
   !> "not given".
   !>
   !> `mu_0` [Pa s] is the ambient viscosity. `is_sound` is false if fewer than two are given, three
   !> are given that disagree by more than `roelands_agreement`, or mu_0 is so small that (2.27)
   !> gives no positive value. The thesis's Table 6.1 gives alpha and P0 (so z = 0.5397), its Table
   !> 5.1 z = 0.6 alone (with the usual P0 = 1.98e8 Pa alpha = 2.3345e-8).
   pure subroutine complete_roelands(mu_0, alpha, p0, z, is_sound)
      real(wp), intent(in) :: mu_0
      real(wp), intent(inout) :: alpha, p0, z
      logical, intent(out) :: is_sound
      real(wp) :: expected

      is_sound = count([alpha, p0, z] > 0.0_wp) >= 2 .and. mu_0 > exp(-roelands_log_shift)
      if (.not. is_sound) return
      if (alpha <= 0.0_wp) then
         alpha = roelands_alpha(mu_0, p0, z)
      else if (p0 <= 0.0_wp) then
         p0 = z*(log(mu_0) + roelands_log_shift)/alpha
      else if (z <= 0.0_wp) then
         z = alpha*p0/(log(mu_0) + roelands_log_shift)
      else
         expected = roelands_alpha(mu_0, p0, z)
         is_sound = abs(alpha - expected) <= roelands_agreement*expected
      end if
   end subroutine complete_roelands

end module oil_viscosity
