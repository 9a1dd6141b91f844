!> The one table of what a namelist may contain: groups, keys, types, units, defaults, ranges,
!> words, meanings, and with what a key is used and needed.
!>
!> The reader, its checks and messages, `--template`, `--keys` and the page docs/input.md all use
!> it. Defaults of the solvers that stand in the code too are compared with it by a unit test.
module input_keys
   use key_row, only: dry, dry_area, dry_line, every, film, group_row_t, has_word, integer_kind, &
      is_chosen, is_optional, is_required, key_row_t, logical_kind, lubricated, other_than_point, &
      point, real_kind, reals_kind, text_kind, word_kind, words_kind
   use length_units, only: length_words => known_units
   implicit none (type, external)
   private

   public :: find_group, find_key

   type(group_row_t), parameter, public :: group_rows(*) = [ &
      group_row_t('case', 'what is computed and where the result goes', every, is_needed=.true.), &
      group_row_t('bodies', &
         'geometry, elasticity and speeds of the two bodies (not with &moes)', every, &
         is_needed=.true., yields_to_moes=.true.), &
      group_row_t('load', 'the load (not with &moes)', every, &
         is_needed=.true., yields_to_moes=.true.), &
      group_row_t('moes', &
         'dimensionless smooth Newtonian studies: replaces bodies, load and viscosity', film), &
      group_row_t('lubricant', 'the oil', film, is_needed=.true.), &
      group_row_t('asperities', 'contact of the rough surfaces through the film', &
         yields_to_moes=.true.), &
      group_row_t('supply', 'oil that arrives, where it does not fill the inlet', &
         yields_to_moes=.true.), &
      group_row_t('thermal', 'film and surfaces that sliding warms, steady or with &history', &
         yields_to_moes=.true.), &
      group_row_t('surface_1', &
         'roughness of surface 1, moving at speed_1; heights count positive out of the material', &
         every, yields_to_moes=.true.), &
      group_row_t('surface_2', &
         'roughness of surface 2, moving at speed_2; heights count positive out of the material', &
         every, yields_to_moes=.true.), &
      group_row_t('domain', 'the computed stretch of the contact and its grid', every), &
      group_row_t('time', &
         'steady, or a transient from the smooth steady solution; T = t (u1+u2)/(2 half-width)', &
         film), &
      group_row_t('history', &
         'load, radius and speeds over time; scales: widest contact, largest u1 + u2', film, &
         yields_to_moes=.true.), &
      group_row_t('solver', 'method and accuracy of the numerical solution', every), &
      group_row_t('film', "the layers of equations = 'stokes'"), &
      group_row_t('output', 'what is measured and stored besides the solution', every), &
      group_row_t('accuracy', &
         'error bars, and an accuracy from which the program chooses grid and time step', every)]

   !> Rules that several keys share.
   character(*), parameter :: &
      of_features = 'shape = feature sinusoid', &
      of_roughness = 'shape = feature sinusoid file synthetic', &
      of_synthesis = 'shape = synthetic', &
      of_multigrid = 'method = auto fas_block_jacobi', &
      of_sweeps = 'method = auto fas_block_jacobi block_jacobi', &
      in_time = 'time%transient = .true.', &
      no_moes = 'no &moes: which stands for it', &
      in_metres = 'no &moes: which has no SI units', &
      no_target = 'no accuracy%target: which chooses it'

   !> Typical magnitudes. Radii: balls of miniature bearings to slewing rings [m]. Moduli: soft
   !> silicone to diamond [Pa]. Speeds: slow tests to aircraft turbines [m/s]. Hardness: soft
   !> polymers to diamond [Pa]. Hertzian pressures: soft seals to indentation [Pa]. Wavelengths:
   !> optical resolution to waviness [m]. Films: a molecule to a journal bearing [m].
   character(*), parameter :: typical_radius = '1e-4 to 5', typical_modulus = '5e5 to 1.2e12', &
      typical_speed = '1e-3 to 200', typical_hardness = '1e7 to 1e11', &
      typical_pressure = '5e4 to 1e10', typical_wave = '5e-8 to 0.02', &
      typical_film = '1e-10 to 5e-5'

   character(len=1), parameter :: axes(2) = ['x', 'y'], numbers(2) = ['1', '2']
   !> Counter of the implied loops below; it never has a value.
   integer :: i

   type(key_row_t), parameter :: case_rows(*) = [ &
      key_row_t('case', 'title', text_kind, '', "''", 'free text, stored in the result', &
         problems=other_than_point, example="'Case 1: smooth surfaces, steady' | "// &
         "'Rough surface against a rigid plane'"), &
      key_row_t('case', 'title', text_kind, '', "''", 'free text, stored in the result', &
         problems=point, example="'Ball on a disc'"), &
      key_row_t('case', 'problem', word_kind, '', is_required, &
         'ehl_line, ehl_point: lubricated line and point contact; dry_line, dry_area: dry ' &
         //'contact of profiles and of areas', words=every, problems=every), &
      key_row_t('case', 'output', text_kind, '', is_chosen, &
         'result file, relative to the namelist; chosen: name of the namelist + .h5, in the ' &
         //'current folder', problems=every, example="! 'case1.h5' | ! 'rough.h5'"), &
      key_row_t('case', 'model', word_kind, '', "'full'", &
         'full: every ingredient of the model; auto: a passage as a steady contact where ' &
         //'that suffices', words='full auto'), &
      key_row_t('case', 'model', word_kind, '', "'full'", 'full: every ingredient of the model', &
         words='full', problems=dry), &
      key_row_t('case', 'equations', word_kind, '', "'reynolds'", &
         'of the film: reynolds; stokes: full momentum, and Reynolds on the same grid', &
         words='reynolds stokes')]

   type(key_row_t), parameter :: bodies_rows(*) = [ &
      key_row_t('bodies', 'radius_1', real_kind, 'm', is_optional, &
         'radius of body 1, negative if concave; radius_1 and radius_2, or one and plane, ' &
         //'or reduced_radius', range='/= 0, >= -1e12, <= 1e12', problems=other_than_point, &
         typical=typical_radius, example='0.01 | ! 0.01'), &
      key_row_t('bodies', 'radius_2', real_kind, 'm', is_optional, &
         'radius of body 2, negative if concave', range='/= 0, >= -1e12, <= 1e12', &
         problems=other_than_point, typical=typical_radius, example='2.0 | ! 2.0'), &
      key_row_t('bodies', 'plane', logical_kind, '', '.false.', &
         'the body whose radius is not given is a plane', problems=other_than_point, &
         example='! .true.'), &
      key_row_t('bodies', 'plane', logical_kind, '', '.false.', &
         'the body whose radius_x is not given is a plane', problems=point, example='.true.'), &
      key_row_t('bodies', 'reduced_radius', real_kind, 'm', is_optional, 'R of 1/R = 1/R1 + 1/R2', &
         range='>= 1e-9, <= 1e9', problems=other_than_point, typical=typical_radius, &
         example='! 9.950e-3'), &
      [(key_row_t('bodies', 'radius_x_'//numbers(i), real_kind, 'm', is_optional, &
         'radius of body '//numbers(i)//' in the plane of x, negative if concave; those of '// &
         'both bodies, or one and plane, or reduced_radius_x', range='/= 0, >= -1e12, <= 1e12', &
         problems=point, typical=typical_radius, example=merge('12.7e-3', '! 0.05 ', i == 1)), &
         i=1, 2)], &
      [(key_row_t('bodies', 'radius_y_'//numbers(i), real_kind, 'm', is_chosen, &
         'radius of body '//numbers(i)//' in the plane of y; chosen: that of x, a ball', &
         range='/= 0, >= -1e12, <= 1e12', used='radius_x_'//numbers(i), problems=point, &
         typical=typical_radius, example='! 0.05'), i=1, 2)], &
      key_row_t('bodies', 'reduced_radius_x', real_kind, 'm', is_optional, &
         'Rx of 1/Rx = 1/Rx1 + 1/Rx2', range='>= 1e-9, <= 1e9', problems=point, &
         typical=typical_radius, example='! 6.35e-3'), &
      key_row_t('bodies', 'reduced_radius_y', real_kind, 'm', is_chosen, &
         'Ry; chosen: Rx, a circle', range='>= 1e-9, <= 1e9', used='reduced_radius_x', &
         problems=point, typical=typical_radius, example='! 6.35e-3'), &
      key_row_t('bodies', 'youngs_modulus_1', real_kind, 'Pa', is_optional, &
         'of body 1; both moduli and Poisson ratios, or reduced_modulus', range='>= 1e3, <= 1e15', &
         problems=every, typical=typical_modulus, example='206e9 | 210e9'), &
      key_row_t('bodies', 'youngs_modulus_2', real_kind, 'Pa', is_optional, 'of body 2', &
         range='>= 1e3, <= 1e15', problems=every, typical=typical_modulus, &
         example='206e9 | ! 210e9'), &
      key_row_t('bodies', 'poisson_ratio_1', real_kind, '-', is_optional, 'of body 1', &
         range='>= 0, <= 0.5', problems=every, example='0.3'), &
      key_row_t('bodies', 'poisson_ratio_2', real_kind, '-', is_optional, 'of body 2', &
         range='>= 0, <= 0.5', problems=every, example='0.3 | ! 0.3'), &
      key_row_t('bodies', 'reduced_modulus', real_kind, 'Pa', is_optional, &
         "E' of 2/E' = (1-nu1^2)/E1 + (1-nu2^2)/E2", range='>= 1e3, <= 1e15', problems=every, &
         typical=typical_modulus, example='! 226.4e9 | ! 230.8e9'), &
      key_row_t('bodies', 'speed_1', real_kind, 'm/s', is_optional, &
         'surface speed u1 of body 1; both speeds, or entrainment_speed; the oil flows ' &
         //'towards +x: u1 + u2 > 0', range='>= -1e4, <= 1e4', typical=typical_speed, &
         example='0.1', problems=film), &
      key_row_t('bodies', 'speed_2', real_kind, 'm/s', is_optional, 'surface speed u2 of body 2', &
         range='>= -1e4, <= 1e4', typical=typical_speed, example='1.1', problems=film), &
      key_row_t('bodies', 'entrainment_speed', real_kind, 'm/s', is_optional, &
         'mean speed U = (u1 + u2)/2, in place of the two speeds', range='> 0, <= 1e4', &
         typical=typical_speed, example='! 0.6', problems=film), &
      key_row_t('bodies', 'slide_to_roll', real_kind, '-', '0.0', &
         '(u2 - u1)/U: positive where surface 2 is the faster one', range='>= -1e3, <= 1e3', &
         used='entrainment_speed', example='! 1.666667', problems=film), &
      key_row_t('bodies', 'entrainment_angle', real_kind, 'deg', '0.0', &
         'from the x of the radii to the x of the grid, along which the oil flows', &
         range='>= -90, <= 90', problems=point, example='!'), &
      key_row_t('bodies', 'hardness', real_kind, 'Pa', is_optional, &
         'H, the largest pressure of an elastic-perfectly plastic contact; not given: elastic', &
         range='>= 1, <= 1e15', problems=dry, typical=typical_hardness, example='4e9'), &
      key_row_t('bodies', 'hardness', real_kind, 'Pa', is_optional, &
         'of the softer body: pressures above it, and above the shakedown limit, are reported', &
         range='>= 1, <= 1e15', problems=film, typical=typical_hardness, example='! 7e9'), &
      [(key_row_t('bodies', 'roughness_'//numbers(i), real_kind, 'm', is_optional, &
         'rms height Rq of surface '//numbers(i)//', smooth in the film: for the lambda ratio '// &
         'only', range='> 0, <= 1e-3', used='surface_'//numbers(i)//'%shape = smooth feature: '// &
         'whose heights give it', typical='1e-9 to 1e-5', example='! 0.1e-6', &
         problems=film), i=1, 2)], &
      key_row_t('bodies', 'contact_length', real_kind, 'm', is_optional, &
         'length of the contact across the flow, for load and an estimate of the flow to its '// &
         'sides', range='>= 1e-9, <= 1e6', needed='load%load: with load', typical='1e-4 to 5', &
         example='! 0.02'), &
      key_row_t('bodies', 'thermal_effusivity', real_kind, 'W s^0.5/m2/K', '13000.0', &
         'sqrt(k rho c) of both bodies, for an estimate of temperatures; default: steel', &
         range='>= 1, <= 1e6', typical='100 to 1e5', problems=film)]

   type(key_row_t), parameter :: load_rows(*) = [ &
      key_row_t('load', 'load_per_length', real_kind, 'N/m', is_optional, &
         'load w per length of the line; this, load or hertz_pressure', range='>= 1e-6, <= 1e12', &
         problems='ehl_line dry_line', typical='50 to 2e7', example='1e5 | ! 100e3'), &
      key_row_t('load', 'hertz_pressure', real_kind, 'Pa', is_optional, &
         'greatest Hertzian pressure p_h of the same load', range='>= 1, <= 1e13', &
         typical=typical_pressure, example='! 0.6e9', problems=film), &
      key_row_t('load', 'load', real_kind, 'N', is_optional, 'load of the whole contact_length', &
         range='> 0, <= 1e15', typical='1e-2 to 1e8', example='! 2000.0'), &
      key_row_t('load', 'load', real_kind, 'N', is_optional, &
         'load of the contact; or hertz_pressure', range='> 0, <= 1e15', problems=point, &
         typical='1e-3 to 1e6', example='30.0'), &
      key_row_t('load', 'mean_pressure', reals_kind, 'Pa', is_optional, &
         'load over nominal area; several values: a sweep; or load_per_length, load, ' &
         //'hertz_pressure, separation', range='> 0, <= 1e15', problems=dry, &
         typical='1e4 to 1e10', example='50e6, 100e6, 250e6'), &
      key_row_t('load', 'load', real_kind, 'N', is_optional, 'load of an area', &
         range='> 0, <= 1e15', problems=dry_area, typical='1e-5 to 1e6', example='! 10.0'), &
      key_row_t('load', 'hertz_pressure', real_kind, 'Pa', is_optional, &
         'greatest Hertzian pressure of the same load', range='>= 1, <= 1e13', &
         used='surface%shape = parabola', problems=dry, typical=typical_pressure, &
         example='! 1e9'), &
      key_row_t('load', 'separation', reals_kind, 'm', is_optional, &
         'instead of a load: plane to mean of the undeformed surface; open areas: approach ' &
         //'since first touch', range='>= -1e3, <= 1e3', problems=dry, typical='1e-10 to 3e-4', &
         example='! 1e-6'), &
      key_row_t('load', 'loading', word_kind, '', "'virgin'", &
         'virgin: each load acts on the virgin surface; history: on what the load before left', &
         words='virgin history', problems=dry), &
      key_row_t('moes', 'moes_m', real_kind, '-', is_required, 'load number M', &
         range='>= 1e-3, <= 1e6', example='! 20', problems=film), &
      key_row_t('moes', 'moes_l', real_kind, '-', is_required, &
         'material number L; 0: constant viscosity', range='>= 0, <= 1000', example='! 10', &
         problems=film), &
      key_row_t('moes', 'velocity', word_kind, '', is_required, &
         'velocity in M and L: mean is (u1+u2)/2, sum is u1+u2 (Venner and Lubrecht)', &
         words='mean sum', example="! 'sum'", problems=film), &
      key_row_t('moes', 'radius_ratio', real_kind, '-', '1.0', &
         'D = Rx/Ry of the reduced radii, x along the entrainment at angle 0', &
         range='>= 0.02, <= 50', problems=point, example='!')]

   type(key_row_t), parameter :: lubricant_rows(*) = [ &
      key_row_t('lubricant', 'viscosity', real_kind, 'Pa s', is_optional, &
         'viscosity mu_0 at ambient pressure; or viscosity_grade, or kinematic_viscosity', &
         range='>= 1e-9, <= 1e6', used=no_moes, &
         needed='no &moes: or viscosity_grade or kinematic_viscosity', typical='2e-4 to 5', &
         example='0.14', problems=film), &
      key_row_t('lubricant', 'viscosity_grade', integer_kind, '-', is_optional, &
         'ISO VG of a mineral oil: its viscosity class (ISO 3448)', range= &
         'one of 2 3 5 7 10 15 22 32 46 68 100 150 220 320 460 680 1000 1500 2200 3200', &
         used=no_moes, example='! 46', problems=film), &
      key_row_t('lubricant', 'viscosity_index', real_kind, '-', '95.0', &
         'of the data sheet (ASTM D2270); default: mineral oil', range='>= 0, <= 400', &
         used='viscosity_grade', typical='20 to 250', example='!', problems=film), &
      key_row_t('lubricant', 'kinematic_viscosity', reals_kind, 'mm2/s', is_optional, &
         'at the temperature of the inlet; or two, at 40 and 100 degC; mu_0: this times density', &
         range='>= 1e-3, <= 2e7', used=no_moes, typical='0.5 to 5000', example='! 46.0, 6.8', &
         problems=film), &
      key_row_t('lubricant', 'temperature', real_kind, 'degC', is_optional, &
         'of the oil in the inlet, for viscosity_grade or two values of kinematic_viscosity', &
         range='>= -70, <= 370', used=no_moes, typical='5 to 200', example='! 60.0', &
         problems=film), &
      key_row_t('lubricant', 'viscosity_law', word_kind, '', "'roelands'", &
         'rise of viscosity with pressure', words='roelands barus constant', problems=film), &
      key_row_t('lubricant', 'pressure_viscosity', real_kind, '1/Pa', is_optional, &
         'alpha; Roelands needs alpha, or two of alpha, z, P0 (alpha alone: P0 = 1.96e8)', &
         moes_default='2.2e-8', range='>= 1e-12, <= 1e-6', &
         used='moes%moes_l /= 0, viscosity_law = roelands barus', &
         needed="no &moes, viscosity_law = barus: with viscosity_law = 'barus'", &
         typical='3e-10 to 1e-7', example='! 2.3345e-8', problems=film), &
      key_row_t('lubricant', 'roelands_z', real_kind, '-', is_optional, 'exponent z of Roelands', &
         moes_default='0.668', range='>= 0.01, <= 2', &
         used='moes%moes_l /= 0, viscosity_law = roelands', typical='0.1 to 1.5', example='0.6', &
         problems=film), &
      key_row_t('lubricant', 'roelands_p0', real_kind, 'Pa', is_optional, &
         'reference pressure P0 of Roelands, about 1.96e8', moes_default='1.96e8', &
         range='>= 1e6, <= 1e11', used='moes%moes_l /= 0, viscosity_law = roelands', &
         typical='5e7 to 1e9', example='1.98e8', problems=film), &
      key_row_t('lubricant', 'density_law', word_kind, '', "'dowson_higginson'", &
         'rise of density with pressure', words='dowson_higginson constant', problems=film), &
      key_row_t('lubricant', 'rheology', word_kind, '', "'newtonian'", 'flow law of the oil', &
         words='newtonian eyring', example="'eyring'", problems=film), &
      key_row_t('lubricant', 'eyring_stress', real_kind, 'Pa', is_optional, &
         'tau_0 of the Eyring law', range='>= 1e3, <= 1e15', used='rheology = eyring', &
         needed="rheology = eyring: with rheology = 'eyring'", typical='5e4 to 1e8', &
         example='3.3e6', problems=film), &
      key_row_t('lubricant', 'shear_limit', word_kind, '', "'none'", &
         'limiting shear stress tau_L in the friction: cut, at most tau_L; bair_winer, tau_L '// &
         '(1 - exp(-tau/tau_L))', words='none cut bair_winer', used=no_moes, problems=film), &
      key_row_t('lubricant', 'limit_ratio', real_kind, '-', is_optional, &
         'tau_L over the pressure', range='>= 1e-3, <= 1', used='shear_limit = cut bair_winer', &
         needed='shear_limit = cut bair_winer', typical='0.03 to 0.12', example='! 0.05', &
         problems=film), &
      key_row_t('lubricant', 'cavitation', word_kind, '', "'auto'", &
         'reynolds: P >= 0 alone (thesis); mass_conserving: no oil is lost; auto: that with '// &
         '&supply, &asperities or &thermal', words='auto reynolds mass_conserving'), &
      key_row_t('lubricant', 'density', real_kind, 'kg/m3', '870.0', &
         'at ambient pressure, for kinematic_viscosity, Reynolds number and &film inertia; '// &
         'default: mineral oil', &
         range='>= 1, <= 1e5', used=in_metres, typical='500 to 2500', problems=film), &
      key_row_t('lubricant', 'thermal_conductivity', real_kind, 'W/m/K', '0.14', &
         'for temperatures; default: mineral oil', range='>= 1e-3, <= 1e3', &
         used=in_metres, typical='0.05 to 2', problems=film), &
      key_row_t('lubricant', 'thermal_viscosity', real_kind, '1/K', '0.04', &
         '-d ln(viscosity)/dT, for what heat does; with temperature that of the oil', &
         range='>= 0, <= 1', used=in_metres, typical='0.005 to 0.2', problems=film), &
      key_row_t('asperities', 'law', word_kind, '', is_required, &
         'pressure of the asperities over the separation of the mean planes: exponential '// &
         'A exp(-h/l), greenwood_tripp, table', words='exponential greenwood_tripp table', &
         example="! 'exponential'"), &
      key_row_t('asperities', 'rms_height', real_kind, 'm', is_required, &
         'rms height sigma of both surfaces together', range='>= 1e-12, <= 1e-3', &
         typical='1e-9 to 5e-5', example='! 2e-7'), &
      key_row_t('asperities', 'contact_pressure', real_kind, 'Pa', is_optional, 'A', &
         range='>= 1, <= 1e13', used='law = exponential', needed='law = exponential', &
         typical='1e6 to 1e11', example='! 1.2e9'), &
      key_row_t('asperities', 'decay_length', real_kind, 'm', is_chosen, &
         'l; chosen: 0.45 sigma', range='>= 1e-12, <= 1e-3', used='law, law = exponential', &
         typical='1e-9 to 5e-5', example='! 9e-8'), &
      key_row_t('asperities', 'density_radius_height', real_kind, '-', is_optional, &
         'asperities per area times their radius times sigma', range='>= 1e-4, <= 1', &
         used='law = greenwood_tripp', needed='law = greenwood_tripp', typical='0.02 to 0.1', &
         example='! 0.05'), &
      key_row_t('asperities', 'height_over_radius', real_kind, '-', is_optional, &
         'sigma over the radius of the asperities', range='>= 1e-7, <= 1', &
         used='law = greenwood_tripp', needed='law = greenwood_tripp', typical='1e-5 to 0.1', &
         example='! 1e-2'), &
      key_row_t('asperities', 'file', text_kind, '', is_optional, &
         'table of gap [m] and pressure [Pa], or the result of a dry sweep', used='law = table', &
         needed='law = table', example="! 'law.csv'"), &
      key_row_t('asperities', 'flow', word_kind, '', "'none'", &
         'flow past the asperities: patir_cheng, isotropic; none: that of the mean gap', &
         words='none patir_cheng', used='law', example='!'), &
      key_row_t('asperities', 'boundary_friction', real_kind, '-', '0.12', &
         'friction coefficient of the asperities', range='>= 0, <= 1', used='law', &
         typical='0.05 to 0.2', example='!'), &
      key_row_t('supply', 'film', real_kind, 'm', is_required, &
         'thickness of the oil that both surfaces bring, at (u1+u2)/2; no effect beyond what '// &
         'the inlet holds', range='>= 1e-12, <= 1', typical=typical_film, example='! 5e-7'), &
      key_row_t('thermal', 'temperature', real_kind, 'degC', is_required, &
         'of the oil in the inlet, at which it has its viscosity and thermal_viscosity', &
         range='>= -70, <= 370', typical='5 to 200', example='! 60.0'), &
      key_row_t('thermal', 'inlet_heating', logical_kind, '', '.false.', &
         'the flow by pressure, mostly in the inlet, warms the oil too, which thins the film', &
         used='temperature', example='!')]

   type(key_row_t), parameter :: surface_1_rows(*) = [ &
      key_row_t('surface_1', 'shape', words_kind, '', "'smooth'", &
         'file, synthetic; or ridge or dent (5.4), sinusoid A cos(2 pi (x-xc)/Lambda), one ' &
         //'word for each element', words='smooth feature sinusoid file synthetic'), &
      key_row_t('surface_1', 'amplitude', reals_kind, 'm', is_optional, &
         'height A of each element; a ridge is positive, a dent negative', range='>= -1, <= 1', &
         used=of_features, needed=of_features, problems=every, typical='1e-9 to 1e-4', &
         example='! 2e-7, -1e-7 | ! 1e-6'), &
      key_row_t('surface_1', 'wavelength', reals_kind, 'm', is_optional, &
         'wavelength Lambda of each element', range='>= 1e-12, <= 1e3', used=of_features, &
         needed=of_features, problems=every, typical=typical_wave, &
         example='! 1e-4, 5e-5 | ! 1e-4'), &
      key_row_t('surface_1', 'wavelength_y', reals_kind, 'm', '0.0', &
         'across the flow; 0: the element is the same at all y', range='>= 0, <= 1e3', &
         used=of_features, problems=point, typical=typical_wave, example='! 1e-4, 0.0'), &
      key_row_t('surface_1', 'position', reals_kind, 'half-widths', is_chosen, &
         'centre xc of each element at time 0; chosen: 0, where it moves about to enter', &
         range='>= -1e6, <= 1e6', used=of_roughness, problems=film, example='! -2.5, -3.0'), &
      key_row_t('surface_1', 'position_y', reals_kind, 'half-widths', '0.0', &
         'centre yc of each element', range='>= -1e6, <= 1e6', used=of_features, &
         problems=point, example='! 0.5, 0.0'), &
      key_row_t('surface_1', 'entry_length', real_kind, 'half-widths', is_chosen, &
         'everything rises over it behind a front that enters the domain; chosen: 1 for ' &
         //'profiles, else 0', range='>= 0, <= 1e4', used=of_roughness//', '//in_time, &
         problems=film, example='! 1.0'), &
      key_row_t('surface_1', 'shape', words_kind, '', "'smooth'", &
         'file, synthetic; or ridge, dent or bump, sinusoid A cos(2 pi x/Lambda) cos(2 pi '// &
         'y/Lambda_y), one for each element', words='smooth feature sinusoid file synthetic', &
         problems=point), &
      key_row_t('surface_1', 'shape', words_kind, '', "'smooth'", &
         'file, synthetic, parabola (radius of &bodies), or features and sinusoids, one for ' &
         //'each element', words='smooth feature sinusoid file synthetic parabola', problems=dry, &
         example="'synthetic'"), &
      key_row_t('surface_1', 'position', reals_kind, 'm', '0.0', &
         'centre xc of each element, from x = 0 of the domain', range='>= -1e3, <= 1e3', &
         used=of_features, problems=dry, example='!'), &
      key_row_t('surface_1', 'file', text_kind, '', is_optional, &
         'file of heights: table of positions and heights, or HDF5', used='shape = file', &
         needed='shape = file', problems=every, example="! 'profile.csv'"), &
      key_row_t('surface_1', 'dataset', text_kind, '', is_optional, &
         'heights: name of the column (needed if there are more than two), or path in the ' &
         //'HDF5 file', used='shape = file', problems=every, example="! 'z'"), &
      key_row_t('surface_1', 'positions', text_kind, '', is_optional, &
         'name of the column of positions, needed if there are more than two', &
         used='shape = file', problems=other_than_point, example="! 'x'"), &
      key_row_t('surface_1', 'x_unit', word_kind, '', "'auto'", &
         'unit of the positions or spacings in the file; auto: what the file says, else m', &
         words='auto '//length_words, used='shape = file', problems=every, example="! 'mm'"), &
      key_row_t('surface_1', 'z_unit', word_kind, '', "'auto'", &
         'unit of the heights in the file; auto: what the file says, else m', &
         words='auto '//length_words, used='shape = file', problems=every, example="! 'um'"), &
      key_row_t('surface_1', 'detrend', word_kind, '', "'auto'", &
         'subtracted from the heights (line: plane of an area); auto: line, none where heights ' &
         //'close that are repeated', words='auto none mean line parabola', used='shape = file', &
         problems=every, example="! 'line'"), &
      key_row_t('surface_1', 'cutoff_long', real_kind, 'm', is_optional, &
         'cut-off lambda_c: longer waves are removed by the Gaussian filter of ISO 16610-21', &
         range='>= 1e-12, <= 1e3', used='shape = file', problems=every, typical=typical_wave, &
         example='! 0.8e-3'), &
      key_row_t('surface_1', 'cutoff_short', real_kind, 'm', is_optional, &
         'cut-off lambda_s: shorter waves are removed by the same filter', &
         range='>= 1e-12, <= 1e3', used='shape = file', problems=every, typical=typical_wave, &
         example='! 2.5e-6'), &
      key_row_t('surface_1', 'harmonics', integer_kind, '-', is_optional, &
         'keep the harmonics 1 to n of the periodic heights, drop the mean (4.1)', &
         range='>= 1, <= 16777216', used='shape = file', example='! 50'), &
      key_row_t('surface_1', 'harmonics', integer_kind, '-', is_optional, &
         'keep the harmonics 1 to n of the periodic heights, drop the mean (4.1)', &
         range='>= 1, <= 16777216', used=of_roughness, problems=dry, example='! 50'), &
      key_row_t('surface_1', 'seed', integer_kind, '-', '1', &
         'the same seed gives the same surface everywhere', range='>= 0, <= 2147483647', &
         used=of_synthesis, problems=every, example='! | 1'), &
      key_row_t('surface_1', 'hurst', real_kind, '-', '0.8', &
         'Hurst exponent of the self-affine part', range='>= 0, <= 1', used=of_synthesis, &
         problems=every, example='! | 0.8'), &
      key_row_t('surface_1', 'rms_height', real_kind, 'm', is_optional, 'rms height Rq', &
         range='>= 1e-12, <= 1', used=of_synthesis, needed=of_synthesis, problems=every, &
         typical='1e-9 to 5e-5', example='! 50e-9 | 1e-6'), &
      key_row_t('surface_1', 'wavelength_long', real_kind, 'm', is_chosen, &
         'longest wave; chosen: the longest that fits', range='>= 1e-12, <= 1e3', &
         used=of_synthesis, problems=every, typical=typical_wave, example='! 4e-4'), &
      key_row_t('surface_1', 'wavelength_rolloff', real_kind, 'm', is_chosen, &
         'below it the spectrum falls by the power law; chosen: wavelength_long', &
         range='>= 1e-12, <= 1e3', used=of_synthesis, problems=every, typical=typical_wave, &
         example='! 1e-4 | 1e-4'), &
      key_row_t('surface_1', 'wavelength_short', real_kind, 'm', is_optional, 'shortest wave', &
         range='>= 1e-12, <= 1e3', used=of_synthesis, needed=of_synthesis, problems=film, &
         typical=typical_wave, example='! 2.5e-5'), &
      key_row_t('surface_1', 'wavelength_short', real_kind, 'm', is_chosen, &
         'shortest wave; chosen: two node spacings, with &accuracy target required', &
         range='>= 1e-12, <= 1e3', used=of_synthesis, problems=dry, typical=typical_wave, &
         example='1.25e-5'), &
      key_row_t('surface_1', 'skewness', real_kind, '-', '0.0', 'Rsk', range='>= -3, <= 3', &
         used=of_synthesis, problems=every, example='! | 0.0'), &
      key_row_t('surface_1', 'kurtosis', real_kind, '-', '3.0', 'Rku', range='>= 1, <= 20', &
         used=of_synthesis, problems=every, example='! | 3.0')]

   type(key_row_t), parameter :: domain_rows(*) = [ &
      key_row_t('domain', 'x_inlet', real_kind, 'half-widths', is_chosen, &
         'start of the domain; the contact is -1 to 1', range='>= -1000, < -1', example='! -4.0'), &
      key_row_t('domain', 'x_outlet', real_kind, 'half-widths', is_chosen, 'end of the domain', &
         range='> 1, <= 1000', example='! 1.5'), &
      key_row_t('domain', 'grid', word_kind, '', "'auto'", &
         'graded: follows the film, in time its inlet; even: as in the thesis; auto: graded if ' &
         //'nothing speaks against it', words='auto even graded'), &
      key_row_t('domain', 'intervals', integer_kind, '-', is_chosen, &
         'grid intervals, 2^k or 3, 5, 7 times that', &
         range='>= 8, <= 16777216, a power of two (times 3 or 5 or 7)', used=no_target, &
         example='! 1024'), &
      key_row_t('domain', 'length', real_kind, 'm', is_optional, &
         'length of the profile; from the file if the surface is one', range='>= 1e-12, <= 1e6', &
         problems=dry_line, typical='1e-6 to 0.2', example='4e-4'), &
      key_row_t('domain', 'intervals', integer_kind, '-', is_optional, &
         'number of nodes; default: those of the file, which others resample (Fourier series)', &
         range='>= 2, <= 16777216', used=no_target, problems=dry_line, example='512'), &
      [(key_row_t('domain', 'length_'//axes(i), real_kind, 'm', is_optional, &
         'length of the area in '//axes(i)//'; from the file if the surface is one', &
         range='>= 1e-12, <= 1e6', problems=dry_area, typical='1e-6 to 0.2', example='4e-4'), i=1, &
         2)], &
      [(key_row_t('domain', 'intervals_'//axes(i), integer_kind, '-', is_optional, &
         'number of nodes in '//axes(i) &
         //'; default: those of the file, which others resample (Fourier series)', &
         range='>= 2, <= 65536', used=no_target, problems=dry_area, example='256'), i=1, 2)], &
      key_row_t('domain', 'x_inlet', real_kind, 'half-widths', is_chosen, &
         'start of the domain, in the half-axis a of the radii of x', range='>= -1000, < -1', &
         problems=point, example='! -4.5'), &
      key_row_t('domain', 'x_outlet', real_kind, 'half-widths', is_chosen, 'end of the domain', &
         range='> 1, <= 1000', problems=point, example='! 1.5'), &
      key_row_t('domain', 'y_half_width', real_kind, 'half-widths', is_chosen, &
         'half of its width', range='> 0.1, <= 1000', problems=point, example='! 3.0'), &
      key_row_t('domain', 'intervals_x', integer_kind, '-', is_chosen, &
         'grid intervals in x; chosen: for 1 % of h_central', &
         range='>= 32, <= 4096, a power of two (times 3 or 5 or 7)', used=no_target, &
         problems=point, example='! 256'), &
      key_row_t('domain', 'intervals_y', integer_kind, '-', is_chosen, &
         'in y; chosen: cells at most 1.5 times as long as in x', &
         range='>= 32, <= 8192, a power of two (times 3 or 5 or 7)', used='intervals_x', &
         problems=point, example='! 256'), &
      key_row_t('domain', 'far_field', logical_kind, '', '.true.', &
         'pressure of the far field on the border and the load beyond it; else both are 0', &
         problems=point, is_expert=.true.), &
      key_row_t('domain', 'periodic', logical_kind, '', is_chosen, &
         'periodic surface; or an open half-space, which the contact must not leave; ' &
         //'chosen: .false. with a parabola', problems=dry, example='.true.'), &
      key_row_t('domain', 'kernel', word_kind, '', "'band_limited'", &
         'periodic: transfer function sampled, or pressure constant over each element; ' &
         //'open: element', words='band_limited element', problems=dry, is_expert=.true.), &
      key_row_t('time', 'transient', logical_kind, '', '.false.', 'transient or steady', &
         problems=film), &
      key_row_t('time', 'end_time', real_kind, '-', is_chosen, &
         'end of the transient, T; chosen: all that is rough has passed, or repeats itself', &
         range='> 0, <= 1e6', used=in_time, needed=in_time// &
         ', no duration, surface%shape = synthetic: with a synthetic surface', problems=film, &
         example='! 2.181818'), &
      key_row_t('time', 'duration', real_kind, 's', is_optional, &
         'end of the transient in seconds, in place of end_time', range='> 0, <= 1e9', &
         used=in_time//', no end_time, '//in_metres, problems=film, example='! 1e-3'), &
      key_row_t('time', 'time_step', real_kind, '-', is_chosen, &
         'time step in T, cut so that whole steps reach end_time; chosen: dX or less', &
         range='>= 1e-9, <= 1e3', used=in_time//', '//no_target, problems=film, &
         example='! 2.7e-3'), &
      key_row_t('time', 'scheme', word_kind, '', "'bdf2'", &
         'time discretisation: second order, or first order (thesis); quasi_steady: no squeeze', &
         words='backward_euler bdf2 quasi_steady', used=in_time, problems=film, example='!', &
         is_expert=.true.), &
      key_row_t('time', 'statistics_from', real_kind, '-', is_chosen, &
         'T from which extremes and film statistics count; chosen: when waves have entered ' &
         //'and the start is forgotten', range='>= 0, <= 1e6', used=in_time, problems=film, &
         example='! 0.0'), &
      key_row_t('history', 'file', text_kind, '', is_required, &
         'table: time [s] or angle [deg]; load_per_length [N/m] (points: load [N]), ' &
         //'reduced_radius [m], speed_1, speed_2 [m/s]', used=in_time, problems=film, &
         example="! 'mesh.csv'"), &
      key_row_t('history', 'interpolation', word_kind, '', "'linear'", &
         'between the rows: straight lines, or monotone cubics', words='linear cubic', &
         used='file', problems=film, example='!'), &
      key_row_t('history', 'periodic', logical_kind, '', '.false.', &
         'repeats the table until its film repeats itself; quantities are those of the last ' &
         //'cycle', used='file', problems=film, example='!'), &
      key_row_t('history', 'speed_rpm', real_kind, '1/min', is_optional, &
         'speed of rotation, for a table over angles', range='> 0, <= 1e6', used='file', &
         typical='1 to 1e5', problems=film, example='! 1500.0')]

   type(key_row_t), parameter :: film_rows(*) = [ &
      key_row_t('film', 'layers', integer_kind, '-', '20', 'layers across the film', &
         range='>= 4, <= 200', used='case%equations = stokes', example='!'), &
      key_row_t('film', 'inertia', logical_kind, '', '.false.', &
         'includes the convective terms (Navier-Stokes), which depend on density', &
         used='case%equations = stokes', example='!')]

   type(key_row_t), parameter :: solver_rows(*) = [ &
      key_row_t('solver', 'method', word_kind, '', "'auto'", &
         'auto: Newton-Krylov, else other ways; newton_dense, the exact reference, and ' &
         //'block_jacobi: up to 8192 intervals', &
         words='auto fas_block_jacobi block_jacobi newton_krylov newton_dense', is_expert=.true.), &
      key_row_t('solver', 'smoother', word_kind, '', "'auto'", 'smoother of the multigrid cycle', &
         words='auto block_jacobi gauss_seidel line hybrid', used=of_multigrid, is_expert=.true.), &
      key_row_t('solver', 'space_scheme', word_kind, '', "'auto'", &
         'upwind2 (thesis), or kappa (Newton methods); auto: kappa with a target in time and '// &
         'where a history rests or reverses', words='auto upwind2 kappa', is_expert=.true.), &
      key_row_t('solver', 'start', word_kind, '', "'fmg'", &
         'first guess: full multigrid, or the Hertz pressure on the finest grid', &
         words='fmg hertz', is_expert=.true.), &
      key_row_t('solver', 'tolerance', real_kind, '-', is_chosen, &
         'bound on the dimensionless residuals and the load; chosen: 1e-8, in time steps 1e-6', &
         range='>= 1e-15, <= 1e-2', problems=film, example='! 1e-8', is_expert=.true.), &
      key_row_t('solver', 'max_cycles', integer_kind, '-', is_chosen, &
         'most cycles (Newton: iterations) for one solution; chosen: by the method', &
         range='>= 1, <= 10000000', example='! 100', is_expert=.true.), &
      key_row_t('solver', 'levels', integer_kind, '-', is_chosen, &
         'grid levels, the finest counted', range='>= 1, <= 22', used=of_multigrid, &
         example='! 5', is_expert=.true.), &
      key_row_t('solver', 'pre_sweeps', integer_kind, '-', is_chosen, &
         'smoothing sweeps before the coarse grid', range='>= 1, <= 1000', used=of_multigrid, &
         example='! 2', is_expert=.true.), &
      key_row_t('solver', 'post_sweeps', integer_kind, '-', is_chosen, &
         'smoothing sweeps after the coarse grid', range='>= 1, <= 1000', used=of_multigrid, &
         example='! 2', is_expert=.true.), &
      key_row_t('solver', 'coarse_sweeps', integer_kind, '-', is_chosen, &
         'sweeps on the coarsest grid, in place of its exact solution; with block_jacobi: ' &
         //'sweeps a cycle', range='>= 1, <= 100000', used=of_sweeps, example='! 100', &
         is_expert=.true.), &
      key_row_t('solver', 'relaxation', real_kind, '-', is_chosen, &
         'relaxation factor of the smoother', range='>= 1e-6, < 2', used=of_sweeps, &
         example='! 0.8', is_expert=.true.), &
      key_row_t('solver', 'load_relaxation', real_kind, '-', is_chosen, &
         'relaxation factor of the force balance', range='>= 1e-6, < 2', used=of_sweeps, &
         example='! 0.5', is_expert=.true.), &
      key_row_t('solver', 'film_floor', real_kind, 'm', is_optional, &
         'a film below it is a film breakdown, reported with place and time', &
         range='> 0, <= 1e-3', used=in_metres, problems=film, typical=typical_film, &
         example='! 5e-9'), &
      key_row_t('solver', 'on_film_breakdown', word_kind, '', "'stop'", &
         'at a film breakdown: end as not converged, or continue with a mark; a film that ' &
         //'closes always ends', words='stop continue', used='film_floor', problems=film, &
         example='!'), &
      key_row_t('solver', 'method', word_kind, '', "'auto'", &
         'auto: conjugate_gradient; steepest_descent: the method of the thesis, a baseline', &
         words='auto conjugate_gradient steepest_descent', problems=dry, is_expert=.true.), &
      key_row_t('solver', 'tolerance', real_kind, '-', '1e-8', &
         'bound on the violation of the contact conditions', range='>= 1e-15, <= 1e-1', &
         problems=dry, is_expert=.true.), &
      key_row_t('solver', 'max_cycles', integer_kind, '-', '10000', &
         'most iterations for one load', range='>= 1, <= 10000000', &
         problems=dry, is_expert=.true.), &
      key_row_t('solver', 'max_cycles', integer_kind, '-', '120', 'most Newton steps on a grid', &
         range='>= 1, <= 1000', problems=point, is_expert=.true.)]

   type(key_row_t), parameter :: output_rows(*) = [ &
      key_row_t('output', 'profile_stride', integer_kind, '-', '1', &
         'every how many time steps profiles are stored', range='>= 1, <= 1000000000', &
         used=in_time, example='!'), &
      key_row_t('output', 'profile_stride', integer_kind, '-', is_chosen, &
         'every how many time steps fields are stored; chosen: for about 50 of them', &
         range='>= 1, <= 1000000000', used=in_time, problems=point, example='! 10'), &
      key_row_t('output', 'fields', words_kind, '', "'pressure', 'film_thickness'", &
         'the profiles that are stored; shear stresses not with &moes', &
         words='pressure film_thickness shear_stress_1 shear_stress_mean shear_stress_2', &
         used=in_time, example='!'), &
      key_row_t('output', 'fields', words_kind, '', "'pressure', 'film_thickness'", &
         'the fields that are stored over time', words='pressure film_thickness', &
         used=in_time, problems=point, example='!'), &
      key_row_t('output', 'fields', words_kind, '', is_optional, &
         'the fields of the last load that are stored; not given: all', &
         words='pressure gap height_undeformed height_loaded height_unloaded plastic_deformation', &
         problems=dry, example="! 'pressure', 'gap'"), &
      key_row_t('output', 'precision', word_kind, '', "'double'", &
         'of the stored fields; single halves the file', words='double single', problems=dry), &
      key_row_t('output', 'checkpoint_interval', real_kind, 's', '600.0', &
         'wall time between checkpoints, from which asperity --resume continues', &
         range='>= 0, <= 1e9', used=in_time, problems=film, example='!'), &
      key_row_t('output', 'film_thresholds', reals_kind, 'm', is_optional, &
         'films for /statistics: how often and on how much of the contact the film is thinner', &
         range='> 0, <= 1', used=in_time//', '//in_metres, problems=film, &
         typical=typical_film, example='! 50e-9, 100e-9'), &
      key_row_t('output', 'adequacy', logical_kind, '', '.true.', &
         'measures the effect of each ingredient, for /adequacy: a tenth of the cost, points '// &
            'a fifth; full: everything', words='full', problems=every), &
      key_row_t('output', 'si_copies', logical_kind, '', '.true.', &
         'stores the fields and series that are dimensionless in SI too, in /si', problems=film), &
      key_row_t('output', 'xdmf', logical_kind, '', '.false.', &
         'writes NAME.xdmf next to NAME.h5, with which ParaView shows the fields', &
         problems=every), &
      key_row_t('output', 'velocity_layers', integer_kind, '-', '0', &
         'layers across the film at whose borders /velocity has the velocity of the oil; 0: none', &
         range='>= 0, <= 200', used='case%equations = reynolds, '//in_metres, is_expert=.true.), &
      key_row_t('accuracy', 'target', real_kind, '-', is_optional, &
         'relative error for which grid and time step are chosen: of h_min (points: and ' &
         //'h_central), graded: all, dry: area', range='>= 1e-7, <= 0.1', &
         problems=every, example='! 1e-3 | ! 0.02'), &
      key_row_t('accuracy', 'error_bars', logical_kind, '', '.true.', &
         'compares with fewer intervals, for error estimates', problems=every)]

   !> The rows of &surface_1 once more.
   type(key_row_t), parameter :: surface_2_rows(*) = [(key_row_t('surface_2', &
      surface_1_rows(i)%key, surface_1_rows(i)%kind, surface_1_rows(i)%unit, &
      surface_1_rows(i)%default, 'as in &surface_1', surface_1_rows(i)%range, &
      surface_1_rows(i)%words, surface_1_rows(i)%used, &
      surface_1_rows(i)%needed, problems=surface_1_rows(i)%problems, &
      typical=surface_1_rows(i)%typical, example=surface_1_rows(i)%example), i=1, &
      size(surface_1_rows))]

   !> Every key that is built, in the order of the manual.
   type(key_row_t), parameter, public :: key_rows(*) = [case_rows, bodies_rows, load_rows, &
      lubricant_rows, surface_1_rows, surface_2_rows, domain_rows, film_rows, solver_rows, &
      output_rows]

contains

   !> Row of a key in `key_rows` for a problem (default: ehl_line); 0: the problem has no such key.
   pure integer function find_key(group, key, problem) result(row)
      character(*), intent(in) :: group, key
      character(*), intent(in), optional :: problem
      character(len=16) :: wanted
      character(len=len(key_rows%group)) :: padded_group
      character(len=len(key_rows%key)) :: padded_key

      wanted = lubricated
      if (present(problem)) wanted = problem
      ! of equal lengths they are compared without a call
      padded_group = group
      padded_key = key
      do row = size(key_rows), 1, -1
         if (key_rows(row)%key /= padded_key) cycle
         if (key_rows(row)%group /= padded_group) cycle
         if (has_word(key_rows(row)%problems, wanted)) return
      end do
   end function find_key

   !> Row of a group in `group_rows`; 0: not there.
   pure integer function find_group(group) result(row)
      character(*), intent(in) :: group
      character(len=len(group_rows%group)) :: padded

      padded = group   ! as in `find_key`
      do row = size(group_rows), 1, -1
         if (group_rows(row)%group == padded) return
      end do
   end function find_group

end module input_keys
