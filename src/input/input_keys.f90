!> The one table of what a namelist may contain: groups, keys, types, units, defaults, ranges,
!> words, meanings.
!>
!> It serves the reader, its messages, `--template`, `--keys` and the page docs/input.md; defaults
!> exist nowhere else.
module input_keys
   implicit none (type, external)
   private

   public :: find_key, find_group, later_meaning, expected_value, has_word, word_list

   !> Kinds of values.
   integer, parameter, public :: real_kind = 1, integer_kind = 2, logical_kind = 3, &
      word_kind = 4, text_kind = 5, &
      reals_kind = 6, words_kind = 7
   !> Defaults that are no value: must be given; chosen by the program; only with certain other
   !> keys.
   character(*), parameter, public :: is_required = 'required', is_chosen = 'chosen', &
      is_optional = '-'

   !> The problems: lubricated line; dry profiles and areas; all of them.
   character(*), parameter, public :: lubricated = 'ehl_line', dry_line = 'dry_line', &
      dry_area = 'dry_area', &
      dry = 'dry_line dry_area', every = 'ehl_line dry_line dry_area'

   !> One group.
   type, public :: group_row_t
      character(len=12) :: group
      !> 'yes', 'no' or 'later' (known, but not built yet).
      character(len=8) :: needed
      character(len=100) :: meaning
      !> Problems that know the group, separated by blanks.
      character(len=32) :: problems = lubricated
   end type group_row_t

   !> One key.
   type, public :: key_row_t
      character(len=12) :: group
      character(len=20) :: key
      !> One of the kinds above.
      integer :: kind
      !> SI unit; '-' for a pure number, 'half-widths' for X; empty for words and texts.
      character(len=12) :: unit
      !> Default as namelist text, or one of the three words above.
      character(len=32) :: default
      !> Range as a comma-separated list of comparisons, each of which must hold.
      character(len=56) :: range
      !> Words that are built, separated by blanks.
      character(len=80) :: words
      !> Words that are known but not built yet, separated by blanks.
      character(len=40) :: later_words
      character(len=120) :: meaning
      !> Problems that use the key, separated by blanks. A key may have a row for each of several
      !> problems.
      character(len=32) :: problems = lubricated
   end type key_row_t

   !> A key that is known but not built yet.
   type, public :: later_row_t
      character(len=12) :: group
      character(len=20) :: key
      character(len=40) :: meaning
   end type later_row_t

   !> A word of a key that has got another name.
   type, public :: renamed_word_t
      character(len=20) :: key
      character(len=16) :: old, new
   end type renamed_word_t

   type(group_row_t), parameter, public :: group_rows(*) = [ &
      group_row_t('case', 'yes', 'what is computed and where the result goes', every), &
      group_row_t('bodies', 'yes', &
         'geometry, elasticity and speeds of the two bodies (not with &moes)', every), &
      group_row_t('load', 'yes', 'the load (not with &moes)', every), &
      group_row_t('moes', 'no', &
         'dimensionless smooth Newtonian studies: replaces bodies, load and viscosity'), &
      group_row_t('lubricant', 'yes', 'the oil'), &
      group_row_t('surface_1', 'no', &
         'roughness of surface 1, moving at speed_1; heights count positive out of the material', &
         every), &
      group_row_t('surface_2', 'no', &
         'roughness of surface 2, moving at speed_2; heights count positive out of the material', &
         every), &
      group_row_t('domain', 'no', 'the computed stretch of the contact and its grid', every), &
      group_row_t('time', 'no', &
         'steady, or a transient from the smooth steady solution; T = t (u1+u2)/(2 half-width)'), &
      group_row_t('solver', 'no', 'method and accuracy of the numerical solution', every), &
      group_row_t('output', 'no', 'what is stored of a transient'), &
      group_row_t('accuracy', 'no', &
         'error bars, and an accuracy from which the program chooses grid and time step', every)]

   type(key_row_t), parameter :: case_rows(*) = [ &
      key_row_t('case', 'title', text_kind, '', "''", '', '', '', &
         'free text, stored in the result', every), &
      key_row_t('case', 'problem', word_kind, '', is_required, '', every, '', &
         'ehl_line: lubricated line contact; dry_line, dry_area: dry contact of profiles '// &
            'and of areas', &
         every), &
      key_row_t('case', 'output', text_kind, '', is_chosen, '', '', '', &
         'result file, relative to the namelist; chosen: name of the namelist + .h5, in the '// &
            'current folder', &
         every), &
      key_row_t('case', 'model', word_kind, '', "'full'", '', 'full', 'auto', &
         'full: every ingredient of the model', every)]

   type(key_row_t), parameter :: bodies_rows(*) = [ &
      key_row_t('bodies', 'radius_1', real_kind, 'm', is_optional, &
         '/= 0, >= -1e12, <= 1e12', '', '', &
         'radius of body 1, negative if concave; radius_1 and radius_2, or reduced_radius', &
            every), &
      key_row_t('bodies', 'radius_2', real_kind, 'm', is_optional, &
         '/= 0, >= -1e12, <= 1e12', '', '', 'radius of body 2, negative if concave', every), &
      key_row_t('bodies', 'reduced_radius', real_kind, 'm', is_optional, &
         '>= 1e-9, <= 1e9', '', '', 'R of 1/R = 1/R1 + 1/R2', every), &
      key_row_t('bodies', 'youngs_modulus_1', real_kind, 'Pa', is_optional, &
         '>= 1e3, <= 1e15', '', '', &
         'of body 1; both moduli and Poisson ratios, or reduced_modulus', every), &
      key_row_t('bodies', 'youngs_modulus_2', real_kind, 'Pa', is_optional, &
         '>= 1e3, <= 1e15', '', '', 'of body 2', every), &
      key_row_t('bodies', 'poisson_ratio_1', real_kind, '-', is_optional, '>= 0, <= 0.5', '', '', &
         'of body 1', every), &
      key_row_t('bodies', 'poisson_ratio_2', real_kind, '-', is_optional, '>= 0, <= 0.5', '', '', &
         'of body 2', every), &
      key_row_t('bodies', 'reduced_modulus', real_kind, 'Pa', is_optional, &
         '>= 1e3, <= 1e15', '', '', "E' of 2/E' = (1-nu1^2)/E1 + (1-nu2^2)/E2", every), &
      key_row_t('bodies', 'speed_1', real_kind, 'm/s', is_required, '>= -1e4, <= 1e4', '', '', &
         'surface speed u1 of body 1; the oil flows towards +x: u1 + u2 > 0'), &
      key_row_t('bodies', 'speed_2', real_kind, 'm/s', is_required, '>= -1e4, <= 1e4', '', '', &
         'surface speed u2 of body 2')]

   type(key_row_t), parameter :: load_rows(*) = [ &
      key_row_t('load', 'load_per_length', real_kind, 'N/m', is_optional, &
         '>= 1e-6, <= 1e12', '', '', 'load w per length of the line; this or hertz_pressure', &
         'ehl_line dry_line'), &
      key_row_t('load', 'hertz_pressure', real_kind, 'Pa', is_optional, '>= 1, <= 1e13', '', '', &
         'greatest Hertzian pressure p_h of the same load'), &
      key_row_t('moes', 'moes_m', real_kind, '-', is_required, '>= 1e-3, <= 1e6', '', '', &
         'load number M'), &
      key_row_t('moes', 'moes_l', real_kind, '-', is_required, '>= 0, <= 1000', '', '', &
         'material number L; 0: constant viscosity'), &
      key_row_t('moes', 'velocity', word_kind, '', is_required, '', 'mean sum', '', &
         'velocity in M and L: mean is (u1+u2)/2, sum is u1+u2 (Venner and Lubrecht)')]

   type(key_row_t), parameter :: lubricant_rows(*) = [ &
      key_row_t('lubricant', 'viscosity', real_kind, 'Pa s', is_optional, &
         '>= 1e-9, <= 1e6', '', '', 'viscosity mu_0 at ambient pressure; required without &moes'), &
      key_row_t('lubricant', 'viscosity_law', word_kind, '', "'roelands'", &
         '', 'roelands barus constant', '', 'rise of viscosity with pressure'), &
      key_row_t('lubricant', 'pressure_viscosity', real_kind, '1/Pa', is_optional, &
         '>= 1e-12, <= 1e-6', '', '', &
         'alpha; Barus needs it; Roelands needs two of alpha, z, P0; with &moes: 2.2e-8'), &
      key_row_t('lubricant', 'roelands_z', real_kind, '-', is_optional, '>= 0.01, <= 2', '', '', &
         'exponent z of Roelands; with &moes: 0.668'), &
      key_row_t('lubricant', 'roelands_p0', real_kind, 'Pa', is_optional, &
         '>= 1e6, <= 1e11', '', '', &
         'reference pressure P0 of Roelands, about 1.96e8; with &moes: 1.96e8'), &
      key_row_t('lubricant', 'density_law', word_kind, '', "'dowson_higginson'", &
         '', 'dowson_higginson constant', '', 'rise of density with pressure'), &
      key_row_t('lubricant', 'rheology', word_kind, '', "'newtonian'", '', 'newtonian eyring', '', &
         'flow law of the oil'), &
      key_row_t('lubricant', 'eyring_stress', real_kind, 'Pa', is_optional, &
         '>= 1e3, <= 1e15', '', '', "tau_0 of the Eyring law; required with rheology = 'eyring'")]

   type(key_row_t), parameter :: surface_rows(*) = [ &
      key_row_t('surface_1', 'shape', words_kind, '', "'smooth'", &
         '', 'smooth feature sinusoid file synthetic', 'parabola', &
         'file, synthetic; or ridge or dent (5.4), sinusoid A cos(2 pi (x-xc)/Lambda), one '// &
            'word for each element'), &
      key_row_t('surface_1', 'amplitude', reals_kind, 'm', is_optional, '>= -1, <= 1', '', '', &
         'height A of each element; a ridge is positive, a dent negative', every), &
      key_row_t('surface_1', 'wavelength', reals_kind, 'm', is_optional, &
         '>= 1e-12, <= 1e3', '', '', 'wavelength Lambda of each element', every), &
      key_row_t('surface_1', 'position', reals_kind, 'half-widths', '0.0', &
         '>= -1e6, <= 1e6', '', '', &
         'centre xc of each element at time 0; default of moving features and profiles: '// &
            'about to enter'), &
      key_row_t('surface_1', 'entry_length', real_kind, 'half-widths', is_chosen, &
         '>= 0, <= 1e4', '', '', &
         'everything rises over it behind a front that enters the domain; chosen: 1 for '// &
            'profiles, else 0'), &
      key_row_t('surface_2', 'shape', words_kind, '', "'smooth'", &
         '', 'smooth feature sinusoid file synthetic', 'parabola', 'as in &surface_1'), &
      key_row_t('surface_2', 'amplitude', reals_kind, 'm', is_optional, '>= -1, <= 1', '', '', &
         'as in &surface_1', every), &
      key_row_t('surface_2', 'wavelength', reals_kind, 'm', is_optional, &
         '>= 1e-12, <= 1e3', '', '', 'as in &surface_1', every), &
      key_row_t('surface_2', 'position', reals_kind, 'half-widths', '0.0', &
         '>= -1e6, <= 1e6', '', '', 'as in &surface_1'), &
      key_row_t('surface_2', 'entry_length', real_kind, 'half-widths', is_chosen, &
         '>= 0, <= 1e4', '', '', 'as in &surface_1')]

   type(key_row_t), parameter :: numeric_rows(*) = [ &
      key_row_t('domain', 'x_inlet', real_kind, 'half-widths', is_chosen, &
         '>= -1000, < -1', '', '', 'start of the domain; the contact is -1 to 1'), &
      key_row_t('domain', 'x_outlet', real_kind, 'half-widths', is_chosen, '> 1, <= 1000', '', '', &
         'end of the domain'), &
      key_row_t('domain', 'inlet', word_kind, '', "'auto'", '', 'auto zero tail', '', &
         'in front of x_inlet: no pressure, or the tail of a rigid inlet, steady only; '// &
            'auto: zero with x_inlet given'), &
      key_row_t('domain', 'intervals', integer_kind, '-', is_chosen, &
         '>= 8, <= 16777216, a power of two (times 3 or 5 or 7)', '', '', &
         'grid intervals, 2^k or 3, 5, 7 times that'), &
      key_row_t('time', 'transient', logical_kind, '', '.false.', '', '', '', &
         'transient or steady'), &
      key_row_t('time', 'end_time', real_kind, '-', is_optional, '> 0, <= 1e6', '', '', &
         'end of the transient, T; required with transient = .true.'), &
      key_row_t('time', 'time_step', real_kind, '-', is_chosen, '>= 1e-9, <= 1e3', '', '', &
         'time step in T, cut so that whole steps reach end_time; chosen: dX or less'), &
      key_row_t('time', 'scheme', word_kind, '', "'bdf2'", '', 'backward_euler bdf2', '', &
         'time discretisation: second order, or first order (thesis)'), &
      key_row_t('time', 'statistics_from', real_kind, '-', is_chosen, '>= 0, <= 1e6', '', '', &
         'T from which extremes and film statistics count; chosen: when waves have entered '// &
            'and the start is forgotten'), &
      key_row_t('solver', 'method', word_kind, '', "'auto'", &
         '', 'auto fas_block_jacobi block_jacobi newton_krylov newton_dense', '', &
         'auto: Newton-Krylov, else other ways; newton_dense, the exact reference, and '// &
            'block_jacobi: up to 8192 intervals'), &
      key_row_t('solver', 'smoother', word_kind, '', "'auto'", &
         '', 'auto block_jacobi gauss_seidel line hybrid', '', 'smoother of the multigrid cycle'), &
      key_row_t('solver', 'space_scheme', word_kind, '', "'auto'", '', 'auto upwind2 kappa', '', &
         'upwind2 (thesis), or kappa (Newton methods); auto: upwind2, of a transient with a '// &
            'target kappa'), &
      key_row_t('solver', 'start', word_kind, '', "'fmg'", '', 'fmg hertz', '', &
         'first guess: full multigrid, or the Hertz pressure on the finest grid'), &
      key_row_t('solver', 'tolerance', real_kind, '-', is_chosen, '>= 1e-15, <= 1e-2', '', '', &
         'bound on the dimensionless residuals and the load; chosen: 1e-8, in time steps 1e-6'), &
      key_row_t('solver', 'max_cycles', integer_kind, '-', is_chosen, '>= 1, <= 10000000', '', '', &
         'most cycles (Newton: iterations) for one solution; chosen: by the method'), &
      key_row_t('solver', 'levels', integer_kind, '-', is_chosen, '>= 1, <= 22', '', '', &
         'grid levels, the finest counted'), &
      key_row_t('solver', 'pre_sweeps', integer_kind, '-', is_chosen, '>= 1, <= 1000', '', '', &
         'smoothing sweeps before the coarse grid'), &
      key_row_t('solver', 'post_sweeps', integer_kind, '-', is_chosen, '>= 1, <= 1000', '', '', &
         'smoothing sweeps after the coarse grid'), &
      key_row_t('solver', 'coarse_sweeps', integer_kind, '-', is_chosen, &
         '>= 1, <= 100000', '', '', &
         'sweeps on the coarsest grid, in place of its exact solution; with block_jacobi: '// &
            'sweeps a cycle'), &
      key_row_t('solver', 'relaxation', real_kind, '-', is_chosen, '>= 1e-6, < 2', '', '', &
         'relaxation factor of the smoother'), &
      key_row_t('solver', 'load_relaxation', real_kind, '-', is_chosen, '>= 1e-6, < 2', '', '', &
         'relaxation factor of the force balance'), &
      key_row_t('solver', 'film_floor', real_kind, 'm', is_optional, '> 0, <= 1e-3', '', '', &
         'a film below it is a film breakdown, told with place and time'), &
      key_row_t('solver', 'on_film_breakdown', word_kind, '', "'stop'", '', 'stop continue', '', &
         'at a film breakdown: end as not converged, or go on with a mark; a film that '// &
            'closes always ends'), &
      key_row_t('output', 'profile_stride', integer_kind, '-', '1', '>= 1, <= 1000000000', '', '', &
         'every how many time steps profiles are stored (transient)'), &
      key_row_t('output', 'fields', words_kind, '', "'pressure', 'film_thickness'", &
         '', 'pressure film_thickness', '', 'the profiles that are stored (transient)'), &
      key_row_t('output', 'checkpoint_interval', real_kind, 's', '600.0', '>= 0, <= 1e9', '', '', &
         'wall time between checkpoints, from which asperity --resume goes on (transient)'), &
      key_row_t('output', 'film_thresholds', reals_kind, 'm', is_optional, '> 0, <= 1', '', '', &
         'films for /statistics: how often and on how much of the contact the film is '// &
            'thinner (transient)'), &
      key_row_t('accuracy', 'target', real_kind, '-', is_optional, '>= 1e-7, <= 0.1', '', '', &
         'relative error of h_min, in dry cases of the contact area, for which intervals '// &
            'and time step are chosen', &
         every), &
      key_row_t('accuracy', 'error_bars', logical_kind, '', '.true.', '', '', '', &
         'compares with fewer intervals, for error estimates', every)]

   type(key_row_t), parameter :: dry_surface_rows(*) = [ &
      key_row_t('surface_1', 'shape', words_kind, '', "'smooth'", &
         '', 'smooth feature sinusoid file synthetic parabola', '', &
         'file, synthetic, parabola (radius of &bodies), or features and sinusoids, one for '// &
            'each element', &
         dry), &
      key_row_t('surface_1', 'position', reals_kind, 'm', '0.0', '>= -1e3, <= 1e3', '', '', &
         'centre xc of each element, from x = 0 of the domain', dry), &
      key_row_t('surface_1', 'file', text_kind, '', is_optional, '', '', '', &
         'file of heights: CSV with a header line, x in the first column; or HDF5 (.h5, .hdf5)', &
         every), &
      key_row_t('surface_1', 'dataset', text_kind, '', is_optional, '', '', '', &
         'name of the column (default: the second), or path in the HDF5 file', every), &
      key_row_t('surface_1', 'harmonics', integer_kind, '-', is_optional, &
         '>= 1, <= 16777216', '', '', &
         'keep the harmonics 1 to n of the periodic heights, drop the mean (4.1)', every), &
      key_row_t('surface_1', 'seed', integer_kind, '-', '1', '>= 0, <= 2147483647', '', '', &
         'synthetic: the same seed gives the same surface everywhere', every), &
      key_row_t('surface_1', 'hurst', real_kind, '-', '0.8', '>= 0, <= 1', '', '', &
         'synthetic: Hurst exponent of the self-affine part', every), &
      key_row_t('surface_1', 'rms_height', real_kind, 'm', is_optional, '>= 1e-12, <= 1', '', '', &
         'synthetic: rms height Rq, required', every), &
      key_row_t('surface_1', 'wavelength_long', real_kind, 'm', is_chosen, &
         '>= 1e-12, <= 1e3', '', '', 'synthetic: longest wave; chosen: the longest that fits', &
         every), &
      key_row_t('surface_1', 'wavelength_rolloff', real_kind, 'm', is_chosen, &
         '>= 1e-12, <= 1e3', '', '', &
         'synthetic: below it the spectrum falls by the power law; chosen: wavelength_long', &
         every), &
      key_row_t('surface_1', 'wavelength_short', real_kind, 'm', is_chosen, &
         '>= 1e-12, <= 1e3', '', '', 'synthetic: shortest wave; chosen (dry): two node spacings', &
         every), &
      key_row_t('surface_1', 'skewness', real_kind, '-', '0.0', '>= -3, <= 3', '', '', &
         'synthetic: Rsk', every), &
      key_row_t('surface_1', 'kurtosis', real_kind, '-', '3.0', '>= 1, <= 20', '', '', &
         'synthetic: Rku', every), &
      key_row_t('surface_2', 'shape', words_kind, '', "'smooth'", &
         '', 'smooth feature sinusoid file synthetic parabola', '', 'as in &surface_1', dry), &
      key_row_t('surface_2', 'position', reals_kind, 'm', '0.0', '>= -1e3, <= 1e3', '', '', &
         'as in &surface_1', dry), &
      key_row_t('surface_2', 'file', text_kind, '', is_optional, '', '', '', &
         'as in &surface_1', every), &
      key_row_t('surface_2', 'dataset', text_kind, '', is_optional, '', '', '', &
         'as in &surface_1', every), &
      key_row_t('surface_2', 'harmonics', integer_kind, '-', is_optional, &
         '>= 1, <= 16777216', '', '', 'as in &surface_1', every), &
      key_row_t('surface_2', 'seed', integer_kind, '-', '1', '>= 0, <= 2147483647', '', '', &
         'as in &surface_1', every), &
      key_row_t('surface_2', 'hurst', real_kind, '-', '0.8', '>= 0, <= 1', '', '', &
         'as in &surface_1', every), &
      key_row_t('surface_2', 'rms_height', real_kind, 'm', is_optional, '>= 1e-12, <= 1', '', '', &
         'as in &surface_1', every), &
      key_row_t('surface_2', 'wavelength_long', real_kind, 'm', is_chosen, &
         '>= 1e-12, <= 1e3', '', '', 'as in &surface_1', every), &
      key_row_t('surface_2', 'wavelength_rolloff', real_kind, 'm', is_chosen, &
         '>= 1e-12, <= 1e3', '', '', 'as in &surface_1', every), &
      key_row_t('surface_2', 'wavelength_short', real_kind, 'm', is_chosen, &
         '>= 1e-12, <= 1e3', '', '', 'as in &surface_1', every), &
      key_row_t('surface_2', 'skewness', real_kind, '-', '0.0', '>= -3, <= 3', '', '', &
         'as in &surface_1', every), &
      key_row_t('surface_2', 'kurtosis', real_kind, '-', '3.0', '>= 1, <= 20', '', '', &
         'as in &surface_1', every)]

   type(key_row_t), parameter :: dry_rows(*) = [ &
      key_row_t('bodies', 'hardness', real_kind, 'Pa', is_optional, '>= 1, <= 1e15', '', '', &
         'H, the largest pressure of an elastic-perfectly plastic contact; not given: elastic', &
         dry), &
      key_row_t('load', 'mean_pressure', reals_kind, 'Pa', is_optional, '> 0, <= 1e15', '', '', &
         'load over nominal area; several values: a sweep; or load_per_length, load, '// &
            'hertz_pressure, separation', &
         dry), &
      key_row_t('load', 'load', real_kind, 'N', is_optional, '> 0, <= 1e15', '', '', &
         'load of an area', dry_area), &
      key_row_t('load', 'hertz_pressure', real_kind, 'Pa', is_optional, '>= 1, <= 1e13', '', '', &
         "greatest Hertzian pressure of the same load; with shape = 'parabola'", dry), &
      key_row_t('load', 'separation', reals_kind, 'm', is_optional, '>= -1e3, <= 1e3', '', '', &
         'instead of a load: plane to mean of the undeformed surface; open areas: approach '// &
            'since first touch', &
         dry), &
      key_row_t('load', 'loading', word_kind, '', "'virgin'", '', 'virgin history', '', &
         'virgin: each load acts on the virgin surface; history: on what the load before left', &
         dry), &
      key_row_t('domain', 'length', real_kind, 'm', is_optional, '>= 1e-12, <= 1e6', '', '', &
         'length of the profile; from the file if the surface is one', dry_line), &
      key_row_t('domain', 'intervals', integer_kind, '-', is_optional, &
         '>= 2, <= 16777216', '', '', &
         'number of nodes; default: those of the file, which others resample (Fourier series)', &
         dry_line), &
      key_row_t('domain', 'length_x', real_kind, 'm', is_optional, '>= 1e-12, <= 1e6', '', '', &
         'length of the area in x; from the file if the surface is one', dry_area), &
      key_row_t('domain', 'length_y', real_kind, 'm', is_optional, '>= 1e-12, <= 1e6', '', '', &
         'length of the area in y; from the file if the surface is one', dry_area), &
      key_row_t('domain', 'intervals_x', integer_kind, '-', is_optional, '>= 2, <= 65536', '', '', &
         'number of nodes in x; default: those of the file, which others resample (Fourier '// &
            'series)', &
         dry_area), &
      key_row_t('domain', 'intervals_y', integer_kind, '-', is_optional, '>= 2, <= 65536', '', '', &
         'number of nodes in y; default: those of the file, which others resample (Fourier '// &
            'series)', &
         dry_area), &
      key_row_t('domain', 'periodic', logical_kind, '', is_chosen, '', '', '', &
         'periodic surface; or an open half-space, which the contact must not leave; '// &
            'chosen: .false. with a parabola', &
         dry), &
      key_row_t('domain', 'kernel', word_kind, '', "'band_limited'", &
         '', 'band_limited element', '', &
         'periodic: transfer function sampled, or pressure constant over each element; '// &
            'open: element', &
         dry), &
      key_row_t('solver', 'method', word_kind, '', "'auto'", &
         '', 'auto conjugate_gradient steepest_descent', '', &
         'auto: conjugate_gradient; steepest_descent: the method of the thesis, a baseline', dry), &
      key_row_t('solver', 'tolerance', real_kind, '-', '1e-8', '>= 1e-15, <= 1e-1', '', '', &
         'bound on the violation of the contact conditions', dry), &
      key_row_t('solver', 'max_cycles', integer_kind, '-', '10000', '>= 1, <= 10000000', '', '', &
         'most iterations for one load', dry)]

   !> Every key that is built, in the order of the manual.
   type(key_row_t), parameter, public :: key_rows(*) = [case_rows, bodies_rows, load_rows, &
      lubricant_rows, surface_rows, &
      numeric_rows, dry_rows, dry_surface_rows]

   !> Keys that are known but not built yet; those of the surfaces hold for both.
   type(later_row_t), parameter, public :: later_rows(*) = [ &
      later_row_t('output', 'adequacy', 'lean models')]

   !> Words that were renamed; the old one is refused, and the message names the new one.
   type(renamed_word_t), parameter, public :: renamed_words(*) = [ &
      renamed_word_t('space_scheme', 'thesis', 'upwind2'), &
      renamed_word_t('space_scheme', 'sharp', 'kappa')]

contains

   !> Row of a key in `key_rows` for a problem (default: ehl_line); 0: the problem has no such key.
   pure function find_key(group, key, problem) result(row)
      character(*), intent(in) :: group, key
      character(*), intent(in), optional :: problem
      integer :: row
      character(len=16) :: wanted

      wanted = lubricated
      if (present(problem)) wanted = problem
      do row = size(key_rows), 1, -1
         if (key_rows(row)%group /= group .or. key_rows(row)%key /= key) cycle
         if (has_word(key_rows(row)%problems, trim(wanted))) return
      end do
   end function find_key

   !> Row of a group in `group_rows`; 0: not there.
   pure function find_group(group) result(row)
      character(*), intent(in) :: group
      integer :: row

      do row = size(group_rows), 1, -1
         if (group_rows(row)%group == group) return
      end do
   end function find_group

   !> What a key that is not built yet belongs to; empty: not such a key.
   pure function later_meaning(group, key) result(meaning)
      character(*), intent(in) :: group, key
      character(:), allocatable :: meaning
      integer :: row

      meaning = ''
      do row = 1, size(later_rows)
         if (later_rows(row)%key /= key) cycle
         if (later_rows(row)%group == group .or. (later_rows(row)%group == 'surface_1' &
            .and. group == 'surface_2')) then
            meaning = trim(later_rows(row)%meaning)
         end if
      end do
   end function later_meaning

   !> What a key expects, for messages and tables: "a real number > 0 [m]".
   pure function expected_value(row) result(expected)
      type(key_row_t), intent(in) :: row
      character(:), allocatable :: expected

      select case (row%kind)
      case (real_kind)
         expected = 'a real number'
      case (integer_kind)
         expected = 'an integer'
      case (logical_kind)
         expected = '.true. or .false.'
      case (reals_kind)
         expected = 'real numbers'
      case (text_kind)
         expected = 'a quoted text'
      case default
         expected = word_list(row%words)
         if (row%kind == words_kind) expected = 'a list of ' // expected
      end select
      if (len_trim(row%range) > 0) expected = expected // ' ' // trim(row%range)
      if (len_trim(row%unit) > 0) expected = expected // ' [' // trim(row%unit) // ']'
   end function expected_value

   !> Blank-separated words as 'a', 'b' or 'c'.
   pure function word_list(words) result(list)
      character(*), intent(in) :: words
      character(:), allocatable :: list
      character(:), allocatable :: rest
      integer :: blank

      list = ''
      rest = trim(words)
      do while (len(rest) > 0)
         blank = index(rest // ' ', ' ')
         if (len(list) > 0 .and. blank > len(rest)) then
            list = list // ' or '
         else if (len(list) > 0) then
            list = list // ', '
         end if
         list = list // "'" // rest(:blank - 1) // "'"
         rest = rest(min(blank + 1, len(rest) + 1):)
      end do
   end function word_list

   !> True if `word` is one of the blank-separated `words`.
   pure function has_word(words, word)
      character(*), intent(in) :: words, word
      logical :: has_word

      has_word = len(word) > 0 .and. index(word, ' ') == 0 .and. index(' ' // words // ' ', &
         ' ' // word // ' ') > 0
   end function has_word

end module input_keys
