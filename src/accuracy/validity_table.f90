!> The limits of the model, in one table: what is compared with which threshold, and who says so.
!>
!> `estimate` in a source marks a threshold that is ours; docs/theory.md says where it comes from.
module validity_table
   use kinds, only: wp
   implicit none (type, external)
   private

   !> Rows of the table.
   integer, parameter, public :: starvation = 1, mixed_lubrication = 2, viscosity_data = 3, &
      limiting_stress = 4, hardness = 5, shakedown = 6, shear_heating = 7, inlet_heating = 8, &
      side_flow = 9, stokes_number = 10, surface_slope = 11, film_over_wave = 12, turbulence = 13

   !> Film over composite rms height below which asperities carry load.
   real(wp), parameter, public :: least_lambda_ratio = 1.0_wp

   !> One limit.
   type, public :: limit_row_t
      !> Name in /adequacy/validity.
      character(len=17) :: name
      !> Unit of value and threshold.
      character(len=2) :: units
      !> The model is left beyond it: below where `is_least`, else above.
      real(wp) :: threshold
      logical :: is_least
      !> What the value is.
      character(len=110) :: meaning
      !> Where the threshold comes from.
      character(len=130) :: source
   end type limit_row_t

   type(limit_row_t), parameter, public :: limit_rows(*) = [ &
      limit_row_t('starvation', '1', 5.0e-3_wp, .false., &
         'share by which the given inlet starves the film', &
         'rule of the inlet, 71 contacts against twice the domain, above 5 % measured; '// &
            'threshold: estimate'), &
      limit_row_t('mixed_lubrication', '1', 3.0_wp, .true., &
         'smallest film over composite rms height of both surfaces', &
         'full film above 3: Hamrock, Schmid and Jacobson, Fundamentals of Fluid Film '// &
            'Lubrication, 2004'), &
      limit_row_t('viscosity_data', 'Pa', 1.03e9_wp, .false., &
         'largest pressure; threshold: the pressures to which viscosities are measured', &
         'Roelands: data of the ASME Pressure-Viscosity Report, 1953; Barus, 0.3e9: estimate'), &
      limit_row_t('limiting_stress', '1', 0.1_wp, .false., &
         'largest mean shear stress over pressure, where p is above a tenth of its largest', &
         'stress at which oils give way: Bair and Winer, J. Lubr. Technol. 101, 1979, 251; '// &
            '0.1: estimate'), &
      limit_row_t('hardness', 'Pa', 0.0_wp, .false., &
         'largest pressure; threshold: the given hardness', 'definition of the hardness'), &
      limit_row_t('shakedown', 'Pa', 0.0_wp, .false., &
         'Hertzian pressure; threshold: 4 k, with k = hardness/6 the yield stress in shear', &
         'Johnson, Contact Mechanics, 1985, sections 9.2 (4 k, no friction) and 6.3 '// &
            '(hardness 3 Y = 6 k)'), &
      limit_row_t('shear_heating', 'K', 0.0_wp, .false., &
         'temperature rise of the film by sliding; threshold: a tenth of the viscosity', &
         'Jaeger 1942, Archard, Wear 2, 1959, 438, and conduction across the film; threshold: '// &
            'estimate'), &
      limit_row_t('inlet_heating', '1', 0.05_wp, .false., &
         'share by which heat of the flow in the inlet thins the film', &
         'formula: Gupta et al., Tribol. Trans. 35, 1992, 269; threshold: estimate'), &
      limit_row_t('side_flow', '1', 0.01_wp, .false., &
         'share of the smallest film that is lost to the sides', &
         'formula: Hamrock and Dowson, J. Lubr. Technol. 99, 1977, 264; threshold: estimate'), &
      limit_row_t('stokes_number', '1', 0.25_wp, .false., &
         'T_max, largest d tau/dp at a given shear rate, tau of the sliding', &
         'Bair, Khonsari and Winer, Tribol. Int. 31, 1998, 573 (below 1); 0.25, 1 % of the '// &
            'film: estimate'), &
      limit_row_t('surface_slope', '1', 0.2_wp, .false., &
         'largest slope dh/dx of the film where p is above a hundredth of its largest', &
         'Stokes flow in a rigid wavy channel, 1 % of the flow; threshold: estimate'), &
      limit_row_t('film_over_wave', '1', 0.1_wp, .false., &
         'central film over the finest wave of the surfaces', &
         'Stokes flow past a rigid wave, (2 pi h/Lambda)^2/30 of its pressure; threshold: '// &
            'estimate'), &
      limit_row_t('turbulence', '1', 1000.0_wp, .false., &
         'Reynolds number of the flow, ambient density and viscosity, central film', &
         'Harnoy, Bearing Design in Machinery, 2003, section 5.5 (1000 to 1600)')]

   integer, parameter, public :: limit_count = size(limit_rows)

end module validity_table
