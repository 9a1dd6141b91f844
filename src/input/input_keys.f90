!> The one table of what a namelist may contain: groups, keys, types, units, defaults, ranges,
!> words, meanings, and with what a key is used and needed.
!>
!> The reader, its checks and messages, `--template`, `--keys` and the page docs/input.md all use
!> it. Defaults of the solvers that stand in the code too are compared with it by a unit test.
module input_keys
   use key_row, only: dry, dry_area, dry_line, every, film, group_row_t, has_word, key_t, &
      lubricated, other_than_point, point
   use length_units, only: length_words => known_units
   implicit none (type, external)
   private

   public :: find_group, find_key

   type(group_row_t), parameter, public :: group_rows(*) = [ &
      group_row_t('case', 'what is computed and where the result goes', every, is_needed=.true.), &
      group_row_t('bodies', 'geometry, elasticity and speeds of the two bodies (not with &moes)', &
         every, is_needed=.true., yields_to_moes=.true.), &
      group_row_t('load', 'the load (not with &moes)', every, is_needed=.true., &
         yields_to_moes=.true.), &
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

   type(key_t), parameter :: case_rows(*) = [ &
      key_t('case', 'title', other_than_point, 'text', '', "''", '', &
         'free text, stored in the result', &
         example="'Case 1: smooth surfaces, steady' | 'Rough surface against a rigid plane'"), &
      key_t('case', 'title', point, 'text', '', "''", '', 'free text, stored in the result', &
         example="'Ball on a disc'"), &
      key_t('case', 'problem', every, 'word', '', 'required', every, 'ehl_line, ehl_point: '// &
         'lubricated line and point contact; dry_line, dry_area: dry contact of profiles and '// &
         'of areas'), &
      key_t('case', 'output', every, 'text', '', 'chosen', '', 'result file, relative to the '// &
         'namelist; chosen: name of the namelist + .h5, in the current folder', &
         example="! 'case1.h5' | ! 'rough.h5'"), &
      key_t('case', 'model', lubricated, 'word', '', "'full'", 'full auto', 'full: every '// &
         'ingredient of the model; auto: a passage as a steady contact where that suffices'), &
      key_t('case', 'model', dry, 'word', '', "'full'", 'full', &
         'full: every ingredient of the model'), &
      key_t('case', 'equations', lubricated, 'word', '', "'reynolds'", 'reynolds stokes', &
         'of the film: reynolds; stokes: full momentum, and Reynolds on the same grid')]

   type(key_t), parameter :: bodies_rows(*) = [ &
      key_t('bodies', 'radius_1', other_than_point, 'real', 'm', '-', '/= 0, >= -1e12, <= 1e12', &
         'radius of body 1, negative if concave; radius_1 and radius_2, or one and plane, or '// &
         'reduced_radius', typical=typical_radius, example='0.01 | ! 0.01'), &
      key_t('bodies', 'radius_2', other_than_point, 'real', 'm', '-', '/= 0, >= -1e12, <= 1e12', &
         'radius of body 2, negative if concave', typical=typical_radius, example='2.0 | ! 2.0'), &
      key_t('bodies', 'plane', other_than_point, 'logical', '', '.false.', '', &
         'the body whose radius is not given is a plane', example='! .true.'), &
      key_t('bodies', 'plane', point, 'logical', '', '.false.', '', &
         'the body whose radius_x is not given is a plane', example='.true.'), &
      key_t('bodies', 'reduced_radius', other_than_point, 'real', 'm', '-', '>= 1e-9, <= 1e9', &
         'R of 1/R = 1/R1 + 1/R2', typical=typical_radius, example='! 9.950e-3'), &
      [(key_t('bodies', 'radius_x_'//numbers(i), point, 'real', 'm', '-', &
         '/= 0, >= -1e12, <= 1e12', 'radius of body '//numbers(i)//' in the plane of x, '// &
         'negative if concave; those of both bodies, or one and plane, or reduced_radius_x', &
         typical=typical_radius, example=merge('12.7e-3', '! 0.05 ', i == 1)), i=1, 2)], &
      [(key_t('bodies', 'radius_y_'//numbers(i), point, 'real', 'm', 'chosen', &
         '/= 0, >= -1e12, <= 1e12', &
         'radius of body '//numbers(i)//' in the plane of y; chosen: that of x, a ball', &
         typical=typical_radius, used='radius_x_'//numbers(i), example='! 0.05'), i=1, 2)], &
      key_t('bodies', 'reduced_radius_x', point, 'real', 'm', '-', '>= 1e-9, <= 1e9', &
         'Rx of 1/Rx = 1/Rx1 + 1/Rx2', typical=typical_radius, example='! 6.35e-3'), &
      key_t('bodies', 'reduced_radius_y', point, 'real', 'm', 'chosen', '>= 1e-9, <= 1e9', &
         'Ry; chosen: Rx, a circle', typical=typical_radius, used='reduced_radius_x', &
         example='! 6.35e-3'), &
      key_t('bodies', 'youngs_modulus_1', every, 'real', 'Pa', '-', '>= 1e3, <= 1e15', &
         'of body 1; both moduli and Poisson ratios, or reduced_modulus', typical=typical_modulus, &
         example='206e9 | 210e9'), &
      key_t('bodies', 'youngs_modulus_2', every, 'real', 'Pa', '-', '>= 1e3, <= 1e15', &
         'of body 2', typical=typical_modulus, example='206e9 | ! 210e9'), &
      key_t('bodies', 'poisson_ratio_1', every, 'real', '-', '-', '>= 0, <= 0.5', 'of body 1', &
         example='0.3'), &
      key_t('bodies', 'poisson_ratio_2', every, 'real', '-', '-', '>= 0, <= 0.5', 'of body 2', &
         example='0.3 | ! 0.3'), &
      key_t('bodies', 'reduced_modulus', every, 'real', 'Pa', '-', '>= 1e3, <= 1e15', &
         "E' of 2/E' = (1-nu1^2)/E1 + (1-nu2^2)/E2", typical=typical_modulus, &
         example='! 226.4e9 | ! 230.8e9'), &
      key_t('bodies', 'speed_1', film, 'real', 'm/s', '-', '>= -1e4, <= 1e4', 'surface speed '// &
         'u1 of body 1; both speeds, or entrainment_speed; the oil flows towards +x: u1 + u2 '// &
         '> 0', typical=typical_speed, example='0.1'), &
      key_t('bodies', 'speed_2', film, 'real', 'm/s', '-', '>= -1e4, <= 1e4', &
         'surface speed u2 of body 2', typical=typical_speed, example='1.1'), &
      key_t('bodies', 'entrainment_speed', film, 'real', 'm/s', '-', '> 0, <= 1e4', &
         'mean speed U = (u1 + u2)/2, in place of the two speeds', typical=typical_speed, &
         example='! 0.6'), &
      key_t('bodies', 'slide_to_roll', film, 'real', '-', '0.0', '>= -1e3, <= 1e3', &
         '(u2 - u1)/U: positive where surface 2 is the faster one', used='entrainment_speed', &
         example='! 1.666667'), &
      key_t('bodies', 'entrainment_angle', point, 'real', 'deg', '0.0', '>= -90, <= 90', &
         'from the x of the radii to the x of the grid, along which the oil flows', example='!'), &
      key_t('bodies', 'hardness', dry, 'real', 'Pa', '-', '>= 1, <= 1e15', &
         'H, the largest pressure of an elastic-perfectly plastic contact; not given: elastic', &
         typical=typical_hardness, example='4e9'), &
      key_t('bodies', 'hardness', film, 'real', 'Pa', '-', '>= 1, <= 1e15', &
         'of the softer body: pressures above it, and above the shakedown limit, are reported', &
         typical=typical_hardness, example='! 7e9'), &
      [(key_t('bodies', 'roughness_'//numbers(i), film, 'real', 'm', '-', '> 0, <= 1e-3', &
         'rms height Rq of surface '//numbers(i)//', smooth in the film: for the lambda ratio '// &
         'only', typical='1e-9 to 1e-5', &
         used='surface_'//numbers(i)//'%shape = smooth feature: whose heights give it', &
         example='! 0.1e-6'), i=1, 2)], &
      key_t('bodies', 'contact_length', lubricated, 'real', 'm', '-', '>= 1e-9, <= 1e6', &
         'length of the contact across the flow, for load and an estimate of the flow to its '// &
         'sides', typical='1e-4 to 5', needed='load%load: with load', example='! 0.02'), &
      key_t('bodies', 'thermal_effusivity', film, 'real', 'W s^0.5/m2/K', '13000.0', &
         '>= 1, <= 1e6', 'sqrt(k rho c) of both bodies, for an estimate of temperatures; '// &
         'default: steel', typical='100 to 1e5')]

   type(key_t), parameter :: load_rows(*) = [ &
      key_t('load', 'load_per_length', 'ehl_line dry_line', 'real', 'N/m', '-', &
         '>= 1e-6, <= 1e12', 'load w per length of the line; this, load or hertz_pressure', &
         typical='50 to 2e7', example='1e5 | ! 100e3'), &
      key_t('load', 'hertz_pressure', film, 'real', 'Pa', '-', '>= 1, <= 1e13', 'greatest '// &
         'Hertzian pressure p_h of the same load', typical=typical_pressure, example='! 0.6e9'), &
      key_t('load', 'load', lubricated, 'real', 'N', '-', '> 0, <= 1e15', &
         'load of the whole contact_length', typical='1e-2 to 1e8', example='! 2000.0'), &
      key_t('load', 'load', point, 'real', 'N', '-', '> 0, <= 1e15', &
         'load of the contact; or hertz_pressure', typical='1e-3 to 1e6', example='30.0'), &
      key_t('load', 'mean_pressure', dry, 'reals', 'Pa', '-', '> 0, <= 1e15', 'load over '// &
         'nominal area; several values: a sweep; or load_per_length, load, hertz_pressure, '// &
         'separation', typical='1e4 to 1e10', example='50e6, 100e6, 250e6'), &
      key_t('load', 'load', dry_area, 'real', 'N', '-', '> 0, <= 1e15', 'load of an area', &
         typical='1e-5 to 1e6', example='! 10.0'), &
      key_t('load', 'hertz_pressure', dry, 'real', 'Pa', '-', '>= 1, <= 1e13', &
         'greatest Hertzian pressure of the same load', typical=typical_pressure, &
         used='surface%shape = parabola', example='! 1e9'), &
      key_t('load', 'separation', dry, 'reals', 'm', '-', '>= -1e3, <= 1e3', 'instead of a '// &
         'load: plane to mean of the undeformed surface; open areas: approach since first touch', &
         typical='1e-10 to 3e-4', example='! 1e-6'), &
      key_t('load', 'loading', dry, 'word', '', "'virgin'", 'virgin history', &
         'virgin: each load acts on the virgin surface; history: on what the load before left'), &
      key_t('moes', 'moes_m', film, 'real', '-', 'required', '>= 1e-3, <= 1e6', 'load number M', &
         example='! 20'), &
      key_t('moes', 'moes_l', film, 'real', '-', 'required', '>= 0, <= 1000', &
         'material number L; 0: constant viscosity', example='! 10'), &
      key_t('moes', 'velocity', film, 'word', '', 'required', 'mean sum', 'velocity in M and '// &
         'L: mean is (u1+u2)/2, sum is u1+u2 (Venner and Lubrecht)', example="! 'sum'"), &
      key_t('moes', 'radius_ratio', point, 'real', '-', '1.0', '>= 0.02, <= 50', &
         'D = Rx/Ry of the reduced radii, x along the entrainment at angle 0', example='!')]

   type(key_t), parameter :: lubricant_rows(*) = [ &
      key_t('lubricant', 'viscosity', film, 'real', 'Pa s', '-', '>= 1e-9, <= 1e6', &
         'viscosity mu_0 at ambient pressure; or viscosity_grade, or kinematic_viscosity', &
         typical='2e-4 to 5', used=no_moes, &
         needed='no &moes: or viscosity_grade or kinematic_viscosity', example='0.14'), &
      key_t('lubricant', 'viscosity_grade', film, 'integer', '-', '-', &
          'one of 2 3 5 7 10 15 22 32 46 68 100 150 220 320 460 680 1000 1500 2200 3200', &
         'ISO VG of a mineral oil: its viscosity class (ISO 3448)', used=no_moes, example='! 46'), &
      key_t('lubricant', 'viscosity_index', film, 'real', '-', '95.0', '>= 0, <= 400', &
         'of the data sheet (ASTM D2270); default: mineral oil', typical='20 to 250', &
         used='viscosity_grade', example='!'), &
      key_t('lubricant', 'kinematic_viscosity', film, 'reals', 'mm2/s', '-', '>= 1e-3, <= 2e7', &
         'at the temperature of the inlet; or two, at 40 and 100 degC; mu_0: this times density', &
         typical='0.5 to 5000', used=no_moes, example='! 46.0, 6.8'), &
      key_t('lubricant', 'temperature', film, 'real', 'degC', '-', '>= -70, <= 370', &
         'of the oil in the inlet, for viscosity_grade or two values of kinematic_viscosity', &
         typical='5 to 200', used=no_moes, example='! 60.0'), &
      key_t('lubricant', 'viscosity_law', film, 'word', '', "'roelands'", &
         'roelands barus constant', 'rise of viscosity with pressure'), &
      key_t('lubricant', 'pressure_viscosity', film, 'real', '1/Pa', '-', '>= 1e-12, <= 1e-6', &
         'alpha; Roelands needs alpha, or two of alpha, z, P0 (alpha alone: P0 = 1.96e8)', &
         typical='3e-10 to 1e-7', used='moes%moes_l /= 0, viscosity_law = roelands barus', &
         needed="no &moes, viscosity_law = barus: with viscosity_law = 'barus'", &
         moes_default='2.2e-8', example='! 2.3345e-8'), &
      key_t('lubricant', 'roelands_z', film, 'real', '-', '-', '>= 0.01, <= 2', &
         'exponent z of Roelands', typical='0.1 to 1.5', &
         used='moes%moes_l /= 0, viscosity_law = roelands', moes_default='0.668', example='0.6'), &
      key_t('lubricant', 'roelands_p0', film, 'real', 'Pa', '-', '>= 1e6, <= 1e11', &
         'reference pressure P0 of Roelands, about 1.96e8', typical='5e7 to 1e9', &
         used='moes%moes_l /= 0, viscosity_law = roelands', moes_default='1.96e8', &
         example='1.98e8'), &
      key_t('lubricant', 'density_law', film, 'word', '', "'dowson_higginson'", &
         'dowson_higginson constant', 'rise of density with pressure'), &
      key_t('lubricant', 'rheology', film, 'word', '', "'newtonian'", 'newtonian eyring', &
         'flow law of the oil', example="'eyring'"), &
      key_t('lubricant', 'eyring_stress', film, 'real', 'Pa', '-', '>= 1e3, <= 1e15', &
         'tau_0 of the Eyring law', typical='5e4 to 1e8', used='rheology = eyring', &
         needed="rheology = eyring: with rheology = 'eyring'", example='3.3e6'), &
      key_t('lubricant', 'shear_limit', film, 'word', '', "'none'", 'none cut bair_winer', &
         'limiting shear stress tau_L in the friction: cut, at most tau_L; bair_winer, tau_L '// &
         '(1 - exp(-tau/tau_L))', used=no_moes), &
      key_t('lubricant', 'limit_ratio', film, 'real', '-', '-', '>= 1e-3, <= 1', &
         'tau_L over the pressure', typical='0.03 to 0.12', used='shear_limit = cut bair_winer', &
         needed='shear_limit = cut bair_winer', example='! 0.05'), &
      key_t('lubricant', 'cavitation', lubricated, 'word', '', "'auto'", &
         'auto reynolds mass_conserving', 'reynolds: P >= 0 alone (thesis); mass_conserving: '// &
         'no oil is lost; auto: that with &supply, &asperities or &thermal'), &
      key_t('lubricant', 'density', film, 'real', 'kg/m3', '870.0', '>= 1, <= 1e5', 'at '// &
         'ambient pressure, for kinematic_viscosity, Reynolds number and &film inertia; '// &
         'default: mineral oil', typical='500 to 2500', used=in_metres), &
      key_t('lubricant', 'thermal_conductivity', film, 'real', 'W/m/K', '0.14', '>= 1e-3, <= 1e3', &
         'for temperatures; default: mineral oil', typical='0.05 to 2', used=in_metres), &
      key_t('lubricant', 'thermal_viscosity', film, 'real', '1/K', '0.04', '>= 0, <= 1', &
         '-d ln(viscosity)/dT, for what heat does; with temperature that of the oil', &
         typical='0.005 to 0.2', used=in_metres), &
      key_t('asperities', 'law', lubricated, 'word', '', 'required', &
         'exponential greenwood_tripp table', 'pressure of the asperities over the separation '// &
         'of the mean planes: exponential A exp(-h/l), greenwood_tripp, table', &
         example="! 'exponential'"), &
      key_t('asperities', 'rms_height', lubricated, 'real', 'm', 'required', '>= 1e-12, <= 1e-3', &
         'rms height sigma of both surfaces together', typical='1e-9 to 5e-5', example='! 2e-7'), &
      key_t('asperities', 'contact_pressure', lubricated, 'real', 'Pa', '-', '>= 1, <= 1e13', 'A', &
         typical='1e6 to 1e11', used='law = exponential', needed='law = exponential', &
         example='! 1.2e9'), &
      key_t('asperities', 'decay_length', lubricated, 'real', 'm', 'chosen', '>= 1e-12, <= 1e-3', &
         'l; chosen: 0.45 sigma', typical='1e-9 to 5e-5', used='law, law = exponential', &
         example='! 9e-8'), &
      key_t('asperities', 'density_radius_height', lubricated, 'real', '-', '-', '>= 1e-4, <= 1', &
         'asperities per area times their radius times sigma', typical='0.02 to 0.1', &
         used='law = greenwood_tripp', needed='law = greenwood_tripp', example='! 0.05'), &
      key_t('asperities', 'height_over_radius', lubricated, 'real', '-', '-', '>= 1e-7, <= 1', &
         'sigma over the radius of the asperities', typical='1e-5 to 0.1', &
         used='law = greenwood_tripp', needed='law = greenwood_tripp', example='! 1e-2'), &
      key_t('asperities', 'file', lubricated, 'text', '', '-', '', &
         'table of gap [m] and pressure [Pa], or the result of a dry sweep', used='law = table', &
         needed='law = table', example="! 'law.csv'"), &
      key_t('asperities', 'flow', lubricated, 'word', '', "'none'", 'none patir_cheng', &
         'flow past the asperities: patir_cheng, isotropic; none: that of the mean gap', &
         used='law', example='!'), &
      key_t('asperities', 'boundary_friction', lubricated, 'real', '-', '0.12', '>= 0, <= 1', &
         'friction coefficient of the asperities', typical='0.05 to 0.2', used='law', &
         example='!'), &
      key_t('supply', 'film', lubricated, 'real', 'm', 'required', '>= 1e-12, <= 1', &
         'thickness of the oil that both surfaces bring, at (u1+u2)/2; no effect beyond what '// &
         'the inlet holds', typical=typical_film, example='! 5e-7'), &
      key_t('thermal', 'temperature', lubricated, 'real', 'degC', 'required', '>= -70, <= 370', &
         'of the oil in the inlet, at which it has its viscosity and thermal_viscosity', &
         typical='5 to 200', example='! 60.0'), &
      key_t('thermal', 'inlet_heating', lubricated, 'logical', '', '.false.', '', &
         'the flow by pressure, mostly in the inlet, warms the oil too, which thins the film', &
         used='temperature', example='!')]

   type(key_t), parameter :: surface_1_rows(*) = [ &
      key_t('surface_1', 'shape', lubricated, 'words', '', "'smooth'", &
         'smooth feature sinusoid file synthetic', 'file, synthetic; or ridge or dent (5.4), '// &
         'sinusoid A cos(2 pi (x-xc)/Lambda), one word for each element'), &
      key_t('surface_1', 'amplitude', every, 'reals', 'm', '-', '>= -1, <= 1', &
         'height A of each element; a ridge is positive, a dent negative', typical='1e-9 to 1e-4', &
         used=of_features, needed=of_features, example='! 2e-7, -1e-7 | ! 1e-6'), &
      key_t('surface_1', 'wavelength', every, 'reals', 'm', '-', '>= 1e-12, <= 1e3', &
         'wavelength Lambda of each element', typical=typical_wave, used=of_features, &
         needed=of_features, example='! 1e-4, 5e-5 | ! 1e-4'), &
      key_t('surface_1', 'wavelength_y', point, 'reals', 'm', '0.0', '>= 0, <= 1e3', &
         'across the flow; 0: the element is the same at all y', typical=typical_wave, &
         used=of_features, example='! 1e-4, 0.0'), &
      key_t('surface_1', 'position', film, 'reals', 'half-widths', 'chosen', '>= -1e6, <= 1e6', &
         'centre xc of each element at time 0; chosen: 0, where it moves about to enter', &
         used=of_roughness, example='! -2.5, -3.0'), &
      key_t('surface_1', 'position_y', point, 'reals', 'half-widths', '0.0', '>= -1e6, <= 1e6', &
         'centre yc of each element', used=of_features, example='! 0.5, 0.0'), &
      key_t('surface_1', 'entry_length', film, 'real', 'half-widths', 'chosen', '>= 0, <= 1e4', &
         'everything rises over it behind a front that enters the domain; chosen: 1 for '// &
         'profiles, else 0', used=of_roughness//', '//in_time, example='! 1.0'), &
      key_t('surface_1', 'shape', point, 'words', '', "'smooth'", &
         'smooth feature sinusoid file synthetic', 'file, synthetic; or ridge, dent or bump, '// &
         'sinusoid A cos(2 pi x/Lambda) cos(2 pi y/Lambda_y), one for each element'), &
      key_t('surface_1', 'shape', dry, 'words', '', "'smooth'", &
         'smooth feature sinusoid file synthetic parabola', 'file, synthetic, parabola '// &
         '(radius of &bodies), or features and sinusoids, one for each element', &
         example="'synthetic'"), &
      key_t('surface_1', 'position', dry, 'reals', 'm', '0.0', '>= -1e3, <= 1e3', &
         'centre xc of each element, from x = 0 of the domain', used=of_features, example='!'), &
      key_t('surface_1', 'file', every, 'text', '', '-', '', &
         'file of heights: table of positions and heights, or HDF5', used='shape = file', &
         needed='shape = file', example="! 'profile.csv'"), &
      key_t('surface_1', 'dataset', every, 'text', '', '-', '', 'heights: name of the column '// &
         '(needed if there are more than two), or path in the HDF5 file', used='shape = file', &
         example="! 'z'"), &
      key_t('surface_1', 'positions', other_than_point, 'text', '', '-', '', &
         'name of the column of positions, needed if there are more than two', &
         used='shape = file', example="! 'x'"), &
      key_t('surface_1', 'x_unit', every, 'word', '', "'auto'", 'auto '//length_words, &
         'unit of the positions or spacings in the file; auto: what the file says, else m', &
         used='shape = file', example="! 'mm'"), &
      key_t('surface_1', 'z_unit', every, 'word', '', "'auto'", 'auto '//length_words, &
         'unit of the heights in the file; auto: what the file says, else m', used='shape = file', &
         example="! 'um'"), &
      key_t('surface_1', 'detrend', every, 'word', '', "'auto'", 'auto none mean line parabola', &
         'subtracted from the heights (line: plane of an area); auto: line, none where '// &
         'heights close that are repeated', used='shape = file', example="! 'line'"), &
      key_t('surface_1', 'cutoff_long', every, 'real', 'm', '-', '>= 1e-12, <= 1e3', &
         'cut-off lambda_c: longer waves are removed by the Gaussian filter of ISO 16610-21', &
         typical=typical_wave, used='shape = file', example='! 0.8e-3'), &
      key_t('surface_1', 'cutoff_short', every, 'real', 'm', '-', '>= 1e-12, <= 1e3', &
         'cut-off lambda_s: shorter waves are removed by the same filter', typical=typical_wave, &
         used='shape = file', example='! 2.5e-6'), &
      key_t('surface_1', 'harmonics', lubricated, 'integer', '-', '-', '>= 1, <= 16777216', &
         'keep the harmonics 1 to n of the periodic heights, drop the mean (4.1)', &
         used='shape = file', example='! 50'), &
      key_t('surface_1', 'harmonics', dry, 'integer', '-', '-', '>= 1, <= 16777216', &
         'keep the harmonics 1 to n of the periodic heights, drop the mean (4.1)', &
         used=of_roughness, example='! 50'), &
      key_t('surface_1', 'seed', every, 'integer', '-', '1', '>= 0, <= 2147483647', &
         'the same seed gives the same surface everywhere', used=of_synthesis, example='! | 1'), &
      key_t('surface_1', 'hurst', every, 'real', '-', '0.8', '>= 0, <= 1', &
         'Hurst exponent of the self-affine part', used=of_synthesis, example='! | 0.8'), &
      key_t('surface_1', 'rms_height', every, 'real', 'm', '-', '>= 1e-12, <= 1', 'rms height Rq', &
         typical='1e-9 to 5e-5', used=of_synthesis, needed=of_synthesis, &
         example='! 50e-9 | 1e-6'), &
      key_t('surface_1', 'wavelength_long', every, 'real', 'm', 'chosen', '>= 1e-12, <= 1e3', &
         'longest wave; chosen: the longest that fits', typical=typical_wave, used=of_synthesis, &
         example='! 4e-4'), &
      key_t('surface_1', 'wavelength_rolloff', every, 'real', 'm', 'chosen', '>= 1e-12, <= 1e3', &
         'below it the spectrum falls by the power law; chosen: wavelength_long', &
         typical=typical_wave, used=of_synthesis, example='! 1e-4 | 1e-4'), &
      key_t('surface_1', 'wavelength_short', film, 'real', 'm', '-', '>= 1e-12, <= 1e3', &
         'shortest wave', typical=typical_wave, used=of_synthesis, needed=of_synthesis, &
         example='! 2.5e-5'), &
      key_t('surface_1', 'wavelength_short', dry, 'real', 'm', 'chosen', '>= 1e-12, <= 1e3', &
         'shortest wave; chosen: two node spacings, with &accuracy target required', &
         typical=typical_wave, used=of_synthesis, example='1.25e-5'), &
      key_t('surface_1', 'skewness', every, 'real', '-', '0.0', '>= -3, <= 3', 'Rsk', &
         used=of_synthesis, example='! | 0.0'), &
      key_t('surface_1', 'kurtosis', every, 'real', '-', '3.0', '>= 1, <= 20', 'Rku', &
         used=of_synthesis, example='! | 3.0')]

   type(key_t), parameter :: domain_rows(*) = [ &
      key_t('domain', 'x_inlet', lubricated, 'real', 'half-widths', 'chosen', '>= -1000, < -1', &
         'start of the domain; the contact is -1 to 1', example='! -4.0'), &
      key_t('domain', 'x_outlet', lubricated, 'real', 'half-widths', 'chosen', '> 1, <= 1000', &
         'end of the domain', example='! 1.5'), &
      key_t('domain', 'grid', lubricated, 'word', '', "'auto'", 'auto even graded', 'graded: '// &
         'follows the film, in time its inlet; even: as in the thesis; auto: graded if '// &
         'nothing speaks against it'), &
      key_t('domain', 'intervals', lubricated, 'integer', '-', 'chosen', &
         '>= 8, <= 16777216, a power of two (times 3 or 5 or 7)', &
         'grid intervals, 2^k or 3, 5, 7 times that', used=no_target, example='! 1024'), &
      key_t('domain', 'length', dry_line, 'real', 'm', '-', '>= 1e-12, <= 1e6', &
         'length of the profile; from the file if the surface is one', typical='1e-6 to 0.2', &
         example='4e-4'), &
      key_t('domain', 'intervals', dry_line, 'integer', '-', '-', '>= 2, <= 16777216', &
         'number of nodes; default: those of the file, which others resample (Fourier series)', &
         used=no_target, example='512'), &
      [(key_t('domain', 'length_'//axes(i), dry_area, 'real', 'm', '-', '>= 1e-12, <= 1e6', &
         'length of the area in '//axes(i)//'; from the file if the surface is one', &
         typical='1e-6 to 0.2', example='4e-4'), i=1, 2)], &
      [(key_t('domain', 'intervals_'//axes(i), dry_area, 'integer', '-', '-', '>= 2, <= 65536', &
         'number of nodes in '//axes(i) //'; default: those of the file, which others '// &
         'resample (Fourier series)', used=no_target, example='256'), i=1, 2)], &
      key_t('domain', 'x_inlet', point, 'real', 'half-widths', 'chosen', '>= -1000, < -1', &
         'start of the domain, in the half-axis a of the radii of x', example='! -4.5'), &
      key_t('domain', 'x_outlet', point, 'real', 'half-widths', 'chosen', '> 1, <= 1000', &
         'end of the domain', example='! 1.5'), &
      key_t('domain', 'y_half_width', point, 'real', 'half-widths', 'chosen', '> 0.1, <= 1000', &
         'half of its width', example='! 3.0'), &
      key_t('domain', 'intervals_x', point, 'integer', '-', 'chosen', &
         '>= 32, <= 4096, a power of two (times 3 or 5 or 7)', &
         'grid intervals in x; chosen: for 1 % of h_central', used=no_target, example='! 256'), &
      key_t('domain', 'intervals_y', point, 'integer', '-', 'chosen', &
         '>= 32, <= 8192, a power of two (times 3 or 5 or 7)', 'in y; chosen: cells at most '// &
         '1.5 times as long as in x', used='intervals_x', example='! 256'), &
      key_t('domain', 'far_field', point, 'logical', '', '.true.', '', 'pressure of the far '// &
         'field on the border and the load beyond it; else both are 0', is_expert=.true.), &
      key_t('domain', 'periodic', dry, 'logical', '', 'chosen', '', 'periodic surface; or an '// &
         'open half-space, which the contact must not leave; chosen: .false. with a parabola', &
         example='.true.'), &
      key_t('domain', 'kernel', dry, 'word', '', "'band_limited'", 'band_limited element', &
         'periodic: transfer function sampled, or pressure constant over each element; open: '// &
         'element', is_expert=.true.), &
      key_t('time', 'transient', film, 'logical', '', '.false.', '', 'transient or steady'), &
      key_t('time', 'end_time', film, 'real', '-', 'chosen', '> 0, <= 1e6', 'end of the '// &
         'transient, T; chosen: all that is rough has passed, or repeats itself', used=in_time, &
         needed=in_time// ', no duration, surface%shape = synthetic: with a synthetic surface', &
         example='! 2.181818'), &
      key_t('time', 'duration', film, 'real', 's', '-', '> 0, <= 1e9', &
         'end of the transient in seconds, in place of end_time', &
         used=in_time//', no end_time, '//in_metres, example='! 1e-3'), &
      key_t('time', 'time_step', film, 'real', '-', 'chosen', '>= 1e-9, <= 1e3', &
         'time step in T, cut so that whole steps reach end_time; chosen: dX or less', &
         used=in_time//', '//no_target, example='! 2.7e-3'), &
      key_t('time', 'scheme', film, 'word', '', "'bdf2'", 'backward_euler bdf2 quasi_steady', &
         'time discretisation: second order, or first order (thesis); quasi_steady: no squeeze', &
         used=in_time, example='!', is_expert=.true.), &
      key_t('time', 'statistics_from', film, 'real', '-', 'chosen', '>= 0, <= 1e6', 'T from '// &
         'which extremes and film statistics count; chosen: when waves have entered and the '// &
         'start is forgotten', used=in_time, example='! 0.0'), &
      key_t('history', 'file', film, 'text', '', 'required', '', 'table: time [s] or angle '// &
         '[deg]; load_per_length [N/m] (points: load [N]), reduced_radius [m], speed_1, '// &
         'speed_2 [m/s]', used=in_time, example="! 'mesh.csv'"), &
      key_t('history', 'interpolation', film, 'word', '', "'linear'", 'linear cubic', &
         'between the rows: straight lines, or monotone cubics', used='file', example='!'), &
      key_t('history', 'periodic', film, 'logical', '', '.false.', '', 'repeats the table '// &
         'until its film repeats itself; quantities are those of the last cycle', used='file', &
         example='!'), &
      key_t('history', 'speed_rpm', film, 'real', '1/min', '-', '> 0, <= 1e6', 'speed of '// &
         'rotation, for a table over angles', typical='1 to 1e5', used='file', example='! 1500.0')]

   type(key_t), parameter :: film_rows(*) = [ &
      key_t('film', 'layers', lubricated, 'integer', '-', '20', '>= 4, <= 200', &
         'layers across the film', used='case%equations = stokes', example='!'), &
      key_t('film', 'inertia', lubricated, 'logical', '', '.false.', '', &
         'includes the convective terms (Navier-Stokes), which depend on density', &
         used='case%equations = stokes', example='!')]

   type(key_t), parameter :: solver_rows(*) = [ &
      key_t('solver', 'method', lubricated, 'word', '', "'auto'", &
         'auto fas_block_jacobi block_jacobi newton_krylov newton_dense', 'auto: '// &
         'Newton-Krylov, else other ways; newton_dense, the exact reference, and '// &
         'block_jacobi: up to 8192 intervals', is_expert=.true.), &
      key_t('solver', 'smoother', lubricated, 'word', '', "'auto'", &
         'auto block_jacobi gauss_seidel line hybrid', 'smoother of the multigrid cycle', &
         used=of_multigrid, is_expert=.true.), &
      key_t('solver', 'space_scheme', lubricated, 'word', '', "'auto'", 'auto upwind2 kappa', &
         'upwind2 (thesis), or kappa (Newton methods); auto: kappa with a target in time and '// &
         'where a history rests or reverses', is_expert=.true.), &
      key_t('solver', 'start', lubricated, 'word', '', "'fmg'", 'fmg hertz', 'first guess: '// &
         'full multigrid, or the Hertz pressure on the finest grid', is_expert=.true.), &
      key_t('solver', 'tolerance', film, 'real', '-', 'chosen', '>= 1e-15, <= 1e-2', &
         'bound on the dimensionless residuals and the load; chosen: 1e-8, in time steps 1e-6', &
         example='! 1e-8', is_expert=.true.), &
      key_t('solver', 'max_cycles', lubricated, 'integer', '-', 'chosen', '>= 1, <= 10000000', &
         'most cycles (Newton: iterations) for one solution; chosen: by the method', &
         example='! 100', is_expert=.true.), &
      key_t('solver', 'levels', lubricated, 'integer', '-', 'chosen', '>= 1, <= 22', &
         'grid levels, the finest counted', used=of_multigrid, example='! 5', is_expert=.true.), &
      key_t('solver', 'pre_sweeps', lubricated, 'integer', '-', 'chosen', '>= 1, <= 1000', &
         'smoothing sweeps before the coarse grid', used=of_multigrid, example='! 2', &
         is_expert=.true.), &
      key_t('solver', 'post_sweeps', lubricated, 'integer', '-', 'chosen', '>= 1, <= 1000', &
         'smoothing sweeps after the coarse grid', used=of_multigrid, example='! 2', &
         is_expert=.true.), &
      key_t('solver', 'coarse_sweeps', lubricated, 'integer', '-', 'chosen', '>= 1, <= 100000', &
         'sweeps on the coarsest grid, in place of its exact solution; with block_jacobi: '// &
         'sweeps a cycle', used=of_sweeps, example='! 100', is_expert=.true.), &
      key_t('solver', 'relaxation', lubricated, 'real', '-', 'chosen', '>= 1e-6, < 2', &
         'relaxation factor of the smoother', used=of_sweeps, example='! 0.8', is_expert=.true.), &
      key_t('solver', 'load_relaxation', lubricated, 'real', '-', 'chosen', '>= 1e-6, < 2', &
         'relaxation factor of the force balance', used=of_sweeps, example='! 0.5', &
         is_expert=.true.), &
      key_t('solver', 'film_floor', film, 'real', 'm', '-', '> 0, <= 1e-3', &
         'a film below it is a film breakdown, reported with place and time', &
         typical=typical_film, used=in_metres, example='! 5e-9'), &
      key_t('solver', 'on_film_breakdown', film, 'word', '', "'stop'", 'stop continue', 'at a '// &
         'film breakdown: end as not converged, or continue with a mark; a film that closes '// &
         'always ends', used='film_floor', example='!'), &
      key_t('solver', 'method', dry, 'word', '', "'auto'", &
         'auto conjugate_gradient steepest_descent', 'auto: conjugate_gradient; '// &
         'steepest_descent: the method of the thesis, a baseline', is_expert=.true.), &
      key_t('solver', 'tolerance', dry, 'real', '-', '1e-8', '>= 1e-15, <= 1e-1', &
         'bound on the violation of the contact conditions', is_expert=.true.), &
      key_t('solver', 'max_cycles', dry, 'integer', '-', '10000', '>= 1, <= 10000000', &
         'most iterations for one load', is_expert=.true.), &
      key_t('solver', 'max_cycles', point, 'integer', '-', '120', '>= 1, <= 1000', &
         'most Newton steps on a grid', is_expert=.true.)]

   type(key_t), parameter :: output_rows(*) = [ &
      key_t('output', 'profile_stride', lubricated, 'integer', '-', '1', '>= 1, <= 1000000000', &
         'every how many time steps profiles are stored', used=in_time, example='!'), &
      key_t('output', 'profile_stride', point, 'integer', '-', 'chosen', '>= 1, <= 1000000000', &
         'every how many time steps fields are stored; chosen: for about 50 of them', &
         used=in_time, example='! 10'), &
      key_t('output', 'fields', lubricated, 'words', '', "'pressure', 'film_thickness'", &
         'pressure film_thickness shear_stress_1 shear_stress_mean shear_stress_2', 'the '// &
         'profiles that are stored; shear stresses not with &moes', used=in_time, example='!'), &
      key_t('output', 'fields', point, 'words', '', "'pressure', 'film_thickness'", &
         'pressure film_thickness', 'the fields that are stored over time', used=in_time, &
         example='!'), &
      key_t('output', 'fields', dry, 'words', '', '-', &
         'pressure gap height_undeformed height_loaded height_unloaded plastic_deformation', &
         'the fields of the last load that are stored; not given: all', &
         example="! 'pressure', 'gap'"), &
      key_t('output', 'precision', dry, 'word', '', "'double'", 'double single', &
         'of the stored fields; single halves the file'), &
      key_t('output', 'checkpoint_interval', film, 'real', 's', '600.0', '>= 0, <= 1e9', &
         'wall time between checkpoints, from which asperity --resume continues', used=in_time, &
         example='!'), &
      key_t('output', 'film_thresholds', film, 'reals', 'm', '-', '> 0, <= 1', &
         'films for /statistics: how often and on how much of the contact the film is thinner', &
         typical=typical_film, used=in_time//', '//in_metres, example='! 50e-9, 100e-9'), &
      key_t('output', 'adequacy', every, 'logical', '', '.true.', 'full', 'measures the '// &
         'effect of each ingredient, for /adequacy: a tenth of the cost, points a fifth; '// &
         'full: everything'), &
      key_t('output', 'si_copies', film, 'logical', '', '.true.', '', &
         'stores the fields and series that are dimensionless in SI too, in /si'), &
      key_t('output', 'xdmf', every, 'logical', '', '.false.', '', &
         'writes NAME.xdmf next to NAME.h5, with which ParaView shows the fields'), &
      key_t('output', 'velocity_layers', lubricated, 'integer', '-', '0', '>= 0, <= 200', &
         'layers across the film at whose borders /velocity has the velocity of the oil; 0: none', &
         used='case%equations = reynolds, '//in_metres, is_expert=.true.), &
      key_t('accuracy', 'target', every, 'real', '-', '-', '>= 1e-7, <= 0.1', 'relative error '// &
         'for which grid and time step are chosen: of h_min (points: and h_central), graded: '// &
         'all, dry: area', example='! 1e-3 | ! 0.02'), &
      key_t('accuracy', 'error_bars', every, 'logical', '', '.true.', '', &
         'compares with fewer intervals, for error estimates')]

   !> The rows of &surface_1 once more.
   type(key_t), parameter :: surface_2_rows(*) = [(key_t('surface_2', surface_1_rows(i)%key, &
      surface_1_rows(i)%problems, surface_1_rows(i)%kind, surface_1_rows(i)%unit, &
      surface_1_rows(i)%default, surface_1_rows(i)%allowed, 'as in &surface_1', &
      surface_1_rows(i)%typical, surface_1_rows(i)%used, surface_1_rows(i)%needed, &
      example=surface_1_rows(i)%example), i=1, size(surface_1_rows))]

   !> Every key that is built, in the order of the manual.
   type(key_t), parameter, public :: key_rows(*) = [case_rows, bodies_rows, load_rows, &
      lubricant_rows, surface_1_rows, surface_2_rows, domain_rows, film_rows, solver_rows, &
      output_rows]

contains

   !> Row of a key in `key_rows` for a problem, or for any one ('', the last row); 0: it has no such
   !> key.
   pure integer function find_key(group, key, problem) result(row)
      character(*), intent(in) :: group, key, problem
      character(len=len(key_rows%group)) :: padded_group
      character(len=len(key_rows%key)) :: padded_key

      ! of equal lengths they are compared without a call
      padded_group = group
      padded_key = key
      do row = size(key_rows), 1, -1
         if (key_rows(row)%key /= padded_key) cycle
         if (key_rows(row)%group /= padded_group) cycle
         if (problem == '' .or. has_word(key_rows(row)%problems, problem)) return
      end do
   end function find_key

   !> Row of a group in `group_rows`; 0: not there.
   pure integer function find_group(group) result(row)
      character(*), intent(in) :: group

      row = findloc(group_rows%group, group, dim=1)
   end function find_group

end module input_keys
