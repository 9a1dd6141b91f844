"""The cases of golden.py: small namelists whose results, texts and statuses are stored in full.

Each case is a list of steps in an empty folder. A step is a line of shell, in which `asperity` is the program and `python` this
one, or `stop NAME.nml`: run it, and end it by SIGTERM after its first checkpoint. `files` are written before.
"""

import math
import pathlib
import random
import re
import sys
import tempfile

import test_bad_input
import test_good_input
import test_validity

sys.path.append(str(pathlib.Path(__file__).resolve().parent / "fuzz"))

import valid_cases

LUBRICANT = """&lubricant viscosity = 0.14, roelands_z = 0.6, roelands_p0 = 1.98e8, rheology = 'eyring', eyring_stress = 3.3e6 /
"""
CASE_1 = (
    """&case title = 'Öl', problem = 'ehl_line' /
&bodies radius_1 = 0.01, radius_2 = 2.0, youngs_modulus_1 = 206e9, youngs_modulus_2 = 206e9,
        poisson_ratio_1 = 0.3, poisson_ratio_2 = 0.3, speed_1 = 0.1, speed_2 = 1.1 /
&load load_per_length = 1e5 /
"""
    + LUBRICANT
)
DOMAIN = "&domain x_inlet = -4.0, x_outlet = 1.5, intervals = 128 /\n"
PLAIN = CASE_1 + DOMAIN
STOKES = PLAIN.replace("'ehl_line'", "'ehl_line', equations = 'stokes'").replace("128", "64")
MOES = """&case problem = 'ehl_line' /
&moes moes_m = {m}, moes_l = {l}, velocity = '{velocity}' /
&lubricant viscosity_law = 'barus', density_law = 'constant' /
"""
STEEL = """&case title = 'dry', problem = '{problem}' /
&bodies youngs_modulus_1 = 210e9, poisson_ratio_1 = 0.3, youngs_modulus_2 = 70e9, poisson_ratio_2 = 0.33{more} /
"""


def feature(surface, amplitude=2e-7, position=-1.6, more=""):
    return f"&surface_{surface} shape = 'feature', amplitude = {amplitude}, wavelength = 1e-4, position = {position}{more} /\n"


def wave(surface, amplitude=3e-8, wavelength=6e-5, position=0.1, more=""):
    return (
        f"&surface_{surface} shape = 'sinusoid', amplitude = {amplitude}, wavelength = {wavelength},"
        f" position = {position}{more} /\n"
    )


def time(end, step, more=""):
    """A passage; without a step the program chooses one."""
    chosen = f", time_step = {step}" if step else ""
    return f"&time transient = .true., end_time = {end}{chosen}{more} /\n"


def dry(problem, load, domain, surface, more="", bodies=""):
    return (
        STEEL.format(problem=problem, more=bodies) + f"&load {load} /\n&domain {domain} /\n&surface_1 shape = {surface} /\n" + more
    )


def tilted(seed, columns):
    """A table of heights on a slope, with waves; names and units in its header."""
    source = random.Random(seed)
    phases = [source.uniform(0, 2 * math.pi) for _ in range(6)]
    lines = ["position [um],height [nm]" + (",other [nm]" if columns == 3 else "")]
    for node in range(128):
        x = 2.0 * node
        z = 3.0 * x + sum(40 / (k + 1) * math.sin(2 * math.pi * (k + 1) * node / 128 + phases[k]) for k in range(6))
        lines.append(f"{x:.3f},{z:.6f}" + (f",{-z:.6f}" if columns == 3 else ""))
    return "\n".join(lines) + "\n"


TARGET = "&accuracy target = 0.02 /\n"
NO_BARS = "&accuracy error_bars = .false. /\n"
SAVING = "&output checkpoint_interval = 0.0 /\n"
DENTED = (
    CASE_1.replace("ehl_line", "ehl_point")
    .replace("radius_1 = 0.01, radius_2 = 2.0", "radius_x_1 = 0.01, radius_x_2 = 0.02")
    .replace("load_per_length = 1e5", "load = 20.0")
    + "&surface_1 shape = 'feature', amplitude = -6e-8, wavelength = 1e-4, wavelength_y = 2e-4, position_y = 0.2 /\n"
    + "&surface_2 shape = 'sinusoid', amplitude = 1e-8, wavelength = 2e-4, wavelength_y = 1e-4 /\n"
    + "&domain intervals_x = 32, intervals_y = 48 /\n"
)
# load and speed of a point, until the film repeats itself
VARYING = (
    DENTED[: DENTED.index("&surface_1")].replace("&load load = 20.0 /\n", "").replace(", speed_1 = 0.1, speed_2 = 1.1", "")
    + "&history file = 'h.csv', periodic = .true. /\n&time transient = .true., time_step = 0.2 /\n"
    + "&domain intervals_x = 32, intervals_y = 32 /\n"
    + SAVING
)
LOADS = "time [s],load [N],speed_1 [m/s],speed_2 [m/s]\n0,2,2,1.6\n6e-4,4,0.8,0.6\n1e-3,2,2,1.6\n"
POINT = DENTED[: DENTED.index("&surface_1")]
NO_ADEQUACY = "&output adequacy = .false. /\n"
GRADED = "&domain grid = 'graded' /\n" + NO_ADEQUACY
WAVES = "'synthetic', seed = 3, rms_height = 2e-7, wavelength_short = 2e-5"
LINE = "length = 2.56e-4, intervals = 128"
ROUND = "length_x = 3.6e-4, length_y = 3e-4, intervals_x = 32, intervals_y = 32"
SHORTER = PLAIN.replace("128", "64")
AREA = "length_x = 1.6e-4, length_y = 1.2e-4, intervals_x = 32, intervals_y = 48"
BUSY = (
    PLAIN.replace("128", "64")
    + wave(1)
    + wave(2, wavelength=4e-5, position=-0.2)
    + time(3.0, 0.01, ", statistics_from = 0.0")
    + "&solver film_floor = 3.2e-7, on_film_breakdown = 'continue' /\n"
    + "&output checkpoint_interval = 0.0, film_thresholds = 4e-7, 5e-7, profile_stride = 7,"
    + " fields = 'film_thickness', 'pressure', 'shear_stress_1', 'shear_stress_mean', 'shear_stress_2' /\n"
)
MOVING = STOKES.replace("x_outlet = 1.5", "x_outlet = 2.0") + feature(1, 5e-8, -1.4) + time(0.6, 0.05)

# Namelists that are run alone, with status and all they print.
ONE = {
    # steady
    "smooth": PLAIN,
    "mixed": PLAIN.replace("speed_2", "roughness_1 = 8e-7, speed_2"),
    "smooth_chosen": CASE_1,
    "moes_barus": MOES.format(m=10.0, l=5.0, velocity="mean") + DOMAIN,
    "moes_sum": MOES.format(m=30.0, l=8.0, velocity="sum"),
    "newtonian_constant": CASE_1.replace("rheology = 'eyring', eyring_stress = 3.3e6", "density_law = 'constant'")
    .replace("load_per_length = 1e5", "hertz_pressure = 0.4e9")
    .replace("speed_1 = 0.1, speed_2 = 1.1", "entrainment_speed = 0.7, slide_to_roll = -0.3, hardness = 1e9"),
    "kappa_adequacy": PLAIN + "&solver space_scheme = 'kappa' /\n",
    "target": CASE_1 + "&accuracy target = 0.003 /\n",
    "cycles_fail": CASE_1 + "&solver method = 'fas_block_jacobi', max_cycles = 5 /\n",
    "rest_features": PLAIN.replace("speed_1 = 0.1, speed_2 = 1.1", "speed_1 = 1.2, speed_2 = 0.0")
    + feature(2, "1e-7, -1e-7", "-0.3, 0.4").replace("'feature'", "'feature', 'feature'").replace("1e-4,", "1e-4, 8e-5,", 1),
    "velocity_layers": PLAIN + "&output velocity_layers = 5, xdmf = .true. /\n",
    "fas_hybrid": PLAIN + "&solver method = 'fas_block_jacobi', smoother = 'hybrid' /\n",
    "fas_gauss_seidel": PLAIN + "&solver method = 'fas_block_jacobi', smoother = 'gauss_seidel', levels = 4 /\n" + NO_ADEQUACY,
    "block_jacobi": PLAIN.replace("128", "64") + "&solver method = 'block_jacobi', max_cycles = 60 /\n" + NO_BARS,
    "dense": PLAIN + "&solver method = 'newton_dense', start = 'hertz' /\n" + NO_BARS,
    # graded grids
    "graded_sliding": CASE_1.replace("rheology = 'eyring', eyring_stress = 3.3e6", "").replace("1e5", "2e4") + NO_ADEQUACY,
    "graded_rolling": CASE_1.replace("speed_1 = 0.1", "speed_1 = 1.1") + NO_ADEQUACY,
    "graded_endless": MOES.format(m=50.0, l=10.0, velocity="sum") + NO_ADEQUACY,
    "graded_feature": CASE_1.replace("speed_2 = 1.1", "speed_2 = 0.0") + feature(2, position=0.1) + GRADED,
    "graded_cut": MOES.format(m=0.3, l=5.0, velocity="sum") + "&domain x_inlet = -9.0, x_outlet = 1.2 /\n",
    "graded_target": MOES.format(m=5.0, l=5.0, velocity="mean") + "&accuracy target = 1e-3 /\n",
    # in time
    "ridge_slow": PLAIN + feature(1) + time(0.6, 0.05),
    "ridge_fast": PLAIN + feature(2) + time(0.6, 0.05, ", scheme = 'backward_euler'"),
    "one_step": PLAIN + feature(2) + time(0.05, 0.05) + NO_ADEQUACY,
    "odd_steps": PLAIN.replace("128", "160") + feature(2) + time(0.35, 0.05, ", statistics_from = 0.1"),
    "periodic": PLAIN + wave(1) + wave(2, wavelength=4e-5, position=-0.2) + time(1.0, 0.04),
    "periods": PLAIN.replace("128", "64") + wave(2, 2e-8) + time(6.0, 0.05) + NO_ADEQUACY,
    "outlet_cut": CASE_1 + "&domain x_inlet = -3.0, x_outlet = 1.02, intervals = 96 /\n" + feature(2) + time(0.4, 0.05),
    "node_at_one": CASE_1 + "&domain x_inlet = -3.0, x_outlet = 2.0, intervals = 160 /\n" + feature(2) + time(0.3, 0.05),
    "breakdown_recovers": PLAIN.replace("x_outlet = 1.5", "x_outlet = 3.0")
    + feature(2, 6e-7, -2.0)
    + time(3.2, 0.04, ", scheme = 'backward_euler'")
    + "&solver film_floor = 250e-9, on_film_breakdown = 'continue' /\n&output film_thresholds = 1e-7, 3e-7 /\n",
    "floor_between_grids": PLAIN + feature(2, 4e-7) + time(0.8, 0.02) + "&solver film_floor = 3.0e-7 /\n",
    "auto_lean": CASE_1.replace("'ehl_line'", "'ehl_line', model = 'auto'") + feature(2, 2e-10, -2.5) + time(2.2, None) + TARGET,
    "auto_rest": CASE_1.replace("'ehl_line'", "'ehl_line', model = 'auto'").replace(
        "speed_1 = 0.1, speed_2 = 1.1", "speed_1 = 1.2, speed_2 = 0.0"
    )
    + feature(2, 2e-7, 0.2)
    + time(8.0, None)
    + TARGET,
    "target_in_time": CASE_1 + feature(2, 5e-8) + time(0.3, None) + TARGET,
    "strides": PLAIN
    + feature(2)
    + time(0.6, 0.05)
    + "&output profile_stride = 5, film_thresholds = 3e-7, 5e-7, fields = 'film_thickness', 'pressure', 'shear_stress_1',"
    + " 'shear_stress_mean', 'shear_stress_2', xdmf = .true. /\n",
    # full momentum
    "stokes": STOKES,
    "inertia": STOKES + "&film layers = 6, inertia = .true. /\n",
    "moving_lower": MOVING + "&film layers = 6 /\n",
    "moving_upper": STOKES + wave(2, 2e-8) + time(0.3, 0.05) + "&film layers = 5 /\n" + NO_ADEQUACY,
    # dry
    "line": dry("dry_line", "mean_pressure = 5e7, 3e8, 1e8", LINE, WAVES, bodies=", hardness = 4e9"),
    "line_elastic": dry("dry_line", "load_per_length = 2e4", LINE, WAVES + ", skewness = -0.5, kurtosis = 4.0"),
    "line_target": dry("dry_line", "mean_pressure = 1e8", "length = 2.56e-4", WAVES, "&accuracy target = 0.005 /\n"),
    "full_contact": dry(
        "dry_line",
        "mean_pressure = 2e7, 2e9, 5e7, loading = 'history'",
        LINE,
        "'sinusoid', amplitude = 1e-7, wavelength = 1.28e-4",
        bodies=", hardness = 3e9",
    ),
    "yields_thrice": dry(
        "dry_line", "mean_pressure = 2e8, 4e8, 3e8, loading = 'history'", LINE, WAVES, NO_ADEQUACY, ", hardness = 1.2e9"
    ),
    "steepest": dry("dry_line", "mean_pressure = 1e8", LINE, WAVES, "&solver method = 'steepest_descent' /\n" + NO_ADEQUACY),
    "area": dry("dry_area", "mean_pressure = 5e7, 2e8", AREA, WAVES + ", hurst = 0.6"),
    "area_plastic": dry(
        "dry_area",
        "mean_pressure = 1e8, 3e8, 2e8, loading = 'history'",
        AREA + ", kernel = 'element'",
        WAVES,
        "&output fields = 'pressure', 'gap', 'plastic_deformation', precision = 'single', xdmf = .true. /\n",
        ", hardness = 2e9",
    ),
    "area_separation": dry("dry_area", "separation = 4e-7, 2e-7", AREA, WAVES),
    "sphere": dry(
        "dry_area",
        "hertz_pressure = 1e9",
        "length_x = 3.6e-4, length_y = 3.6e-4, intervals_x = 48, intervals_y = 40, periodic = .false.",
        "'parabola'",
        bodies=", reduced_radius = 0.005",
    ),
    "cylinder": dry(
        "dry_line", "load_per_length = 1e5", "length = 6e-4, intervals = 160", "'parabola'", bodies=", reduced_radius = 0.01"
    ),
    "tilted_files": dry(
        "dry_line",
        "mean_pressure = 2e8",
        "periodic = .true.",
        "'file', file = 'a.csv', cutoff_long = 1.28e-4, cutoff_short = 1e-5",
        "&surface_2 shape = 'file', file = 'b.csv', dataset = 'other', positions = 'position', detrend = 'line', harmonics = 9 /\n",
    ),
    "file_in_oil": PLAIN.replace("128", "64")
    + "&surface_2 shape = 'file', file = 'a.csv', cutoff_short = 2e-5 /\n"
    + time(0.2, 0.05)
    + NO_ADEQUACY,
    # points
    "point": POINT + "&domain intervals_x = 32 /\n",
    "point_target": POINT + TARGET.replace("0.02", "0.05"),
    "point_ellipse": POINT.replace("radius_x_1 = 0.01", "radius_x_1 = 0.01, radius_y_1 = 0.02, radius_y_2 = -0.1")
    + "&domain intervals_x = 32, y_half_width = 5.0 /\n",
    "point_passage": DENTED + time(0.1, 0.05),
    # keys of few cases
    "full": PLAIN + feature(2) + time(0.05, 0.05) + "&output adequacy = 'full' /\n",
    "no_end": PLAIN.replace("128", "64") + feature(1, position=-1.2) + "&time transient = .true. /\n" + NO_ADEQUACY,
    "auto_thresholds": CASE_1.replace("'ehl_line'", "'ehl_line', model = 'auto'")
    + feature(2, 2e-10, -2.5)
    + "&time transient = .true., duration = 1e-4 /\n&output film_thresholds = 1e-7 /\n"
    + TARGET,
    "no_copies": MOVING + "&film layers = 5 /\n&output si_copies = .false. /\n",
    "oil_sheet": CASE_1.replace("viscosity = 0.14", "viscosity_grade = 46, viscosity_index = 150, temperature = 60")
    + "&asperities law = 'exponential', rms_height = 2e-7, contact_pressure = 1e9, decay_length = 5e-8, boundary_friction=0.1 /\n",
    "oil_points": PLAIN.replace("viscosity = 0.14", "kinematic_viscosity = 404, 28, temperature = 60, cavitation = 'reynolds'")
    + "&solver method = 'fas_block_jacobi', pre_sweeps = 2, post_sweeps = 3, coarse_sweeps = 20 /\n",
    "line_kurtosis": dry("dry_line", "mean_pressure = 1e8", LINE, WAVES + ", kurtosis = 4.0", NO_ADEQUACY),
    "line_skewness": dry("dry_line", "mean_pressure = 1e8", LINE, WAVES + ", skewness = 0.3", NO_ADEQUACY),
    "file_arrives": PLAIN.replace("128", "64")
    + "&surface_2 shape = 'file', file = 'a.csv', entry_length = 0.5, cutoff_short = 2e-5, x_unit = 'um' /\n"
    + time(0.4, 0.05)
    + NO_ADEQUACY,
    "warm": PLAIN + "&thermal temperature = 40, inlet_heating = .true. /\n",
    "warm_barus": SHORTER.replace("roelands_z = 0.6, roelands_p0 = 1.98e8", "viscosity_law = 'barus', pressure_viscosity = 1.8e-8")
    + "&thermal temperature = 40 /\n&supply film = 2e-7 /\n&asperities law = 'greenwood_tripp', rms_height = 2e-7,"
    + " density_radius_height = 0.05, height_over_radius = 1e-3, flow = 'patir_cheng' /\n",
    "line_smoother": SHORTER + "&solver method = 'fas_block_jacobi', smoother = 'line' /\n" + NO_BARS,
    "coarse": PLAIN.replace("128", "16").replace("1e5", "4e5"),
    "stokes_hard": STOKES.replace("1e5", "4e5") + NO_BARS + NO_ADEQUACY,
    "random_forever": SHORTER
    + "&surface_2 shape = 'synthetic', seed = 3, rms_height = 2e-8, wavelength_long = 8e-6, wavelength_short = 2e-6, skewness=0.3 /"
    + time(900.0, 450.0)
    + NO_ADEQUACY,
    "series_in_oil": SHORTER + "&surface_2 shape = 'file', file = 'a.csv', harmonics = 5 /\n" + time(0.2, 0.1) + NO_ADEQUACY,
    "all_plastic": dry("dry_line", "mean_pressure = 1e9", LINE, WAVES, bodies=", hardness = 1e9"),
    "near_plastic": dry("dry_area", "separation = 2e-7, 1e-8, 1e-10", AREA, WAVES, NO_ADEQUACY, ", hardness = 5e8"),
    "images": dry("dry_area", "mean_pressure = 1e8", ROUND, "'parabola'", bodies=", reduced_radius = 0.005"),
    "no_room": dry("dry_area", "load = 300.0", ROUND + ", periodic = .false.", "'parabola'", bodies=", reduced_radius = 0.005"),
    "open_waves": dry("dry_line", "mean_pressure = 3e8", LINE + ", periodic = .false.", WAVES),
    "point_moes": MOES.format(m=20.0, l=5.0, velocity="sum").replace("line", "point") + "&domain intervals_x = 32 /\n",
    "point_passages": DENTED[: DENTED.index("&domain")] + time(0.2, None) + TARGET.replace("0.02", "0.1"),
    # refused
    "refused": PLAIN.replace("load_per_length = 1e5", "load_per_length = -1e5, lod = 3").replace("128", "100")
    + feature(2).replace("'feature'", "'ridge'")
    + time(0.5, 0.8)
    + "&solver smoother = 'line', method = 'newton_dense' /\n&output fields = 'film' /\n",
    "refused_dry": dry("dry_area", "mean_pressure = 1e8, load = 3.0", "length_x = 1e-4", "'file', file = 'none.csv'"),
}

HEIGHTS = {"a.csv": tilted(1, 2), "b.csv": tilted(2, 3)}

# Namelists together, other commands, and what is interrupted and goes on.
MORE = {
    "several": (
        {"a.nml": PLAIN + NO_ADEQUACY, "b.nml": ONE["refused"], "c.nml": ONE["line_elastic"], "d.nml": ONE["cycles_fail"]},
        [
            "asperity a.nml c.nml --set load.load_per_length=1.5e5 --output out --outcomes",
            "asperity a.nml b.nml --keep-going --quiet",
            "asperity d.nml a.nml --keep-going --outcomes --output more",
            "asperity --check a.nml b.nml c.nml",
            "asperity table out/a.h5 out/c.h5",
            "asperity table a.h5 out/a.h5 out/c.h5 --format csv",
            "asperity table out/a.h5 --format json",
        ],
    ),
    "texts": (
        {},
        [f"asperity --{words}" for words in ("help", "keys", "template ehl_line", "template dry_line", "template dry_area")]
        + ["asperity", "asperity none.nml --nothing"],
    ),
    "stopped_not": ({"a.nml": BUSY}, ["asperity a.nml --quiet --threads 2"]),
    "stopped_point_not": ({"a.nml": DENTED + time(3.0, 0.05) + SAVING}, ["asperity a.nml --quiet"]),
    "point_history": ({"a.nml": VARYING, "h.csv": LOADS}, ["asperity a.nml --quiet"]),
}
LEAVING = SHORTER + feature(2, position=0.95) + time(2.0, 0.01, ", statistics_from = 0.0") + NO_BARS + SAVING
STOPPED = {
    "": BUSY,
    "_point": DENTED + time(3.0, 0.05) + SAVING,
    "_point_history": VARYING,
    "_leaving": LEAVING,
    "_target": ONE["target_in_time"].replace("time = 0.3", "time = 1.5") + SAVING.replace(" /", ", adequacy = .false. /"),
    "_momentum": MOVING.replace("0.05", "0.005") + "&film layers = 5 /\n" + SAVING + NO_BARS,
}
MORE |= {
    f"stopped{name}": ({"a.nml": text, "h.csv": LOADS}, ["stop a.nml", "asperity a.nml --resume --quiet"])
    for name, text in STOPPED.items()
}

SMALL = PLAIN.replace("128", "64") + NO_BARS + NO_ADEQUACY
FILES = {"a.nml": SMALL, "b.nml": SMALL.replace("1e5", "2e5"), "dry.nml": ONE["line_elastic"], "bad.nml": ONE["refused"]}
MORE |= {
    "usage": (
        FILES,
        [f"asperity {words} a.nml" for words in ("--nothing", "--template b.nml", "--threads 0", "--set a=1", "--check --keys")]
        + [f"asperity {words}" for words in ("table a.h5 --format xml", "a.nml --profiles", "a.nml --summary a.h5 --output b")],
    ),
    "lost": (
        FILES,
        [
            "asperity a.nml dry.nml --quiet",
            "for i in text csv json; do asperity table a.h5 dry.h5 --format $i >/dev/full || echo $?; done",
            "for i in a dry none; do asperity table $i.h5 --profiles > /dev/full || asperity table $i.h5 --profiles; done",
            "for i in '--check a.nml dry' '--outcomes --keep-going bad.nml a'; do asperity $i.nml > /dev/full; done",
            "asperity --keys > /dev/full; rm *.h5",
        ],
    ),
    "no_room": (
        FILES | {"c.nml": BUSY, "d.nml": ONE["area"]},
        [
            "mkdir a.h5; asperity a.nml b.nml",
            "rmdir a.h5; mkdir a.h5.part; asperity a.nml b.nml",
            "rmdir a.h5.part; echo > a.h5; asperity a.nml dry.nml",
            "rm a.h5; for i in 4 20 40; do (ulimit -f $i; asperity b.nml dry.nml c.nml d.nml a.nml --quiet 2>&1 | sort -u); done",
            "ulimit -f 100; asperity d.nml --quiet",
            "mkdir c.h5.ckpt.tmp; asperity c.nml --quiet",
            "ulimit -v 200000; asperity d.nml a.nml --set domain.intervals=8192",
            "asperity a.nml --output dry.nml; rm -r *.h5*",
        ],
    ),
    "not_resumed": (
        {"a.nml": BUSY, "b.nml": BUSY},
        [
            "stop a.nml",
            "asperity a.nml --resume --set lubricant.viscosity=0.2",
            "for i in h5.part h5.ckpt; do cp a.$i b.$i; done; echo >> b.h5.ckpt; asperity b.nml --resume",
            "cp a.h5.ckpt b.h5.ckpt; echo 1 > b.h5.part; asperity b.nml --resume",
            "rm b.h5.part; asperity table a.h5 a.h5.part | sed 's/: [0-9].*: /: /'; asperity b.nml --resume",
            "rm b.h5.ckpt; asperity b.nml --resume --set time.end_time=0.5",
            "asperity a.nml --resume --quiet; asperity a.nml --resume",
            "asperity a.nml --resume --set time.end_time=0.5; rm *.h5*",
        ],
    ),
    "with_heights": (
        {"a.nml": ONE["file_in_oil"], "b.nml": ONE["tilted_files"]},
        [
            "asperity a.nml b.nml --quiet; asperity a.nml b.nml --resume",
            "sed -i 's/^2.000,.*/2.000,1.0/' a.csv; asperity a.nml b.nml --resume",
            "sed -i 's/^4.000,/3.000,/' a.csv; sed -i 's/^9.*/x,y/' b.csv; asperity a.nml b.nml",
            "rm a.csv; mkdir a.csv; asperity a.nml b.nml; rmdir a.csv",
            "mv a.h5 a.csv; asperity a.nml; printf %99999d 1 > a.csv; asperity a.nml; rm *.h5",
        ],
    ),
    "summary": (
        FILES,
        [
            "asperity a.nml b.nml --summary s.csv --quiet",
            "asperity a.nml b.nml --summary s.csv --resume",
            "asperity a.nml dry.nml --summary s.csv",
            "truncate -s -3 s.csv; asperity a.nml b.nml --summary s.csv --resume",
            "sed -i '1s/case/cases/' s.csv; asperity a.nml --summary s.csv",
            "mkdir t.csv; asperity a.nml --summary t.csv; rm s.csv",
        ],
    ),
    "bad_input": (
        {f"{name.replace(':', '_')}.nml": "\n".join(lines) + "\n" for name, (lines, _) in test_bad_input.CORPUS.items()},
        ["ulimit -v 6000000; asperity --check *.nml"],
    ),
    "good_input": (
        {f"{name}.nml": text for name, text in (test_good_input.FORMS | ONE).items()},
        [f"asperity --check *.nml --keep-going --set {entry}" for entry in ("time.time_step=1e-5", "lubricant.viscosity=1e3")],
    ),
    "beyond": (
        {f"{name}.nml": scenes[0] for name, scenes in test_validity.SCENES.items()},
        ["asperity *.nml --verbose --keep-going --set domain.intervals=64; rm *.h5"],
    ),
}

# Heights in HDF5: spacings, positions, units and scales of all forms, and what is refused.
MAKE = """import h5py, numpy as np
x = 2e-6 * np.arange(64)
z = sum(2e-7 / k * np.cos(2 * np.pi * k * np.arange(64) / 64 + k**2) for k in (1, 3, 5))
f = h5py.File("h.h5", "w")
def put(name, values, **attributes):
    f.create_dataset(name, data=values).attrs.update(attributes)
def both(name, x, of_x, z, of_z):
    put(f"{name}/x", x, **of_x)
    put(f"{name}/z", z, **of_z)
put("a", z, spacing=2e-6)
put("b", 1e9 * z, spacing_x=2.0, spacing_units="um", unit="nm")
put("c", (1e9 * z).astype("i4"), si_scale=1e-9, spacing=2e-6)
both("d", -1e3 * x, {"units": "mm"}, 1e6 * z, {"units": "um"})
put("e", 1e6 * z, units="um")
put("scale", 1e6 * x, units="um")
f["scale"].make_scale("x")
f["e"].dims[0].attach_scale(f["scale"])
area = z + z[::2, None]
put("f", area, spacing_x=2e-6, spacing_y=4e-6, units="m")
put("g/y", 4e-6 * np.arange(32)[::-1], units="m")
both("g", x[::-1], {"units": "m"}, area, {"units": "m"})
both("h", x**2, {"units": "m"}, z, {"units": "m"})
put("j", "text")
put("k", z.reshape(4, 4, 4))
put("l", np.where(x > 1e-5, np.nan, z), spacing=1e-6)
put("m", 1e9 * z, si_scale=1e-3, units="um", spacing=1e-6)
put("o", z, spacing="two")
f.create_dataset("r", 10**9, "f4", chunks=(10**6,))
f.create_dataset("s", 64, "f8", external=[("a.csv", 0, 512)])
both("t", x * np.nan, {"units": "m"}, z, {"units": "m"})
"""
OF = "--set surface_1.dataset=\"'/$i'\""
MORE["hdf5_heights"] = (
    {
        "line.nml": dry("dry_line", "mean_pressure = 1e8", "periodic = .true.", "'file', file = 'h.h5'", NO_ADEQUACY),
        "area.nml": dry("dry_area", "mean_pressure = 1e8", "periodic = .true.", "'file', file = 'h.h5'", NO_ADEQUACY),
        "make.py": MAKE,
    },
    [
        f"python -W ignore make.py; for i in b c d/z e; do asperity line.nml {OF}; mv line.h5 ${{i%/z}}.h5; done",
        f"for i in f g/z; do asperity area.nml {OF} --quiet; mv area.h5 ${{i%/z}}.h5; done",
        f"for i in a f h/z j k l m o r s t/z u; do asperity --check line.nml {OF} 2>&1; done",
        f"for i in a b e; do asperity --check line.nml {OF} --set surface_1.z_unit=\"'um'\" 2>&1; done; rm h.h5",
    ],
)

# What changes in time: an oil that flows back, with heat, and a law of asperities from a table.
TURNING = SHORTER[: SHORTER.index("&load")].replace(", speed_1 = 0.1, speed_2 = 1.1", "") + LUBRICANT
TURNING += "&domain intervals = 64 /\n&history file = 'h.csv' /\n&time transient = .true. /\n"
UNITS = "time [s],load_per_length [N/m],speed_1 [m/s],speed_2 [m/s]\n"
MORE["line_histories"] = (
    {
        "a.nml": TURNING + "&asperities rms_height = 2e-7, law = 'table', file = 'law.csv' /\n&supply film = 6e-7 /\n",
        "b.nml": TURNING.replace("h.csv", "i.csv") + "&thermal temperature = 40 /\n",
        "h.csv": f"{UNITS}0,1e5,0.5,0.8\n2e-4,8e4,0.1,0.2\n4e-4,1e5,-0.6,-0.9\n",
        "i.csv": f"{UNITS}0,1e5,0.5,0.8\n2e-4,8e4,0.6,1.2\n",
        "law.csv": "gap [m],pressure [Pa]\n0,2e8\n1e-7,5e7\n4e-7,1e6\n1e-6,1e3\n",
    },
    ["asperity a.nml b.nml", "sed -i 's/^4e-7,1e6/4e-7,1e8/' law.csv; asperity --check a.nml"],
)

# FAILS: which array of FFTW gets no memory; STOPS: with which one SIGTERM comes; LOST: which operation on files fails.
FAILS = """#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
static int number;
static int fails(const char *name, int is_counted) {
   return getenv(name) && is_counted && ++number == atoi(getenv(name));
}
void *memalign(size_t alignment, size_t size) {
   int is_counted = size % 512 == 0 || size % 1152 == 0;
   if (fails("STOPS", is_counted)) raise(SIGTERM);
   else if (getenv("STOPS") && is_counted && number > atoi(getenv("STOPS"))) dprintf(2, "array %d\\n", number);
   return fails("FAILS", is_counted) ? NULL : aligned_alloc(alignment, size);
}
int setitimer(int which, const void *next, void *last) { return 0; }
#define OF(type, name, given, passed, is_lost) type name given { \\
   if (is_lost) return errno = EIO, -1; \\
   return ((type (*) given)dlsym(RTLD_NEXT, #name)) passed; }
OF(int, open, (const char *p, int how, int mode), (p, how, mode), getenv("LOST") && !strncmp(p, "/proc", 5) || fails("LOST", 1))
OF(long, read, (int f, void *b, size_t n), (f, b, n), fails("LOST", 1))
OF(long, write, (int f, const void *b, size_t n), (f, b, n), fails("LOST", f > 2))
OF(long, pread, (int f, void *b, size_t n, long o), (f, b, n, o), fails("LOST", 1))
OF(long, pwrite, (int f, const void *b, size_t n, long o), (f, b, n, o), fails("LOST", 1))
OF(int, fsync, (int f), (f), fails("LOST", 1))
OF(int, rename, (const char *a, const char *b), (a, b), fails("LOST", 1))
"""
ONCE = "asperity a.nml --quiet 2>&1 | grep -a '^a' || echo none; rm -f *.h5*"
GCC = "gcc -w -shared -fPIC fails.c -o fails.so"
STARVED = """smooth 1 2 18 ridge_slow 1 2 50 full 1 2 52 auto_lean 1 2 40 auto_rest 1 2 22 target_in_time 1 2 36 stokes 1 2 26
moving_lower 1 2 38 outlet_cut 1 2 14 graded_cut 1 2 20 area_plastic 1 2 76 sphere 1 2 60 random_forever 1 2 60 point 11 16
point_passage 5 10 point_target 11 9 164 point_passages 15 40 235 line 1 6 38 tilted_files 7 5 40 area_separation 1 3 88"""
MORE |= {
    f"starved_{name}": (
        {"a.nml": ONE[name], "fails.c": FAILS},
        [
            f"{GCC}; export LD_PRELOAD=./fails.so FAILS STOPS; for FAILS in $(seq {numbers}); do {ONCE}; done; "
            f"unset FAILS; for STOPS in $(seq {numbers}); do {ONCE}; done; rm fails.so"
        ],
    )
    for name, numbers in re.findall(r"([a-z_]+) ([ 0-9]+)", STARVED)
}


def losing(numbers, words, before=":", after=":"):
    """A case over and over, without its operation on a file of another number each time."""
    one = f"(export LOST=$i LD_PRELOAD=./fails.so; asperity {words} 2>&1); echo $? *.h5* *.xdmf; {after}; rm -f *.h5* *.xdmf"
    return f"for i in $(seq {numbers}); do {before}; {one}; done"


SHORT = BUSY.replace("3.0, time_step", "0.03, time_step").replace("interval = 0.0", "interval = 0.0, adequacy=.false., xdmf=.true.")
READS = {
    "a.nml": ONE["file_in_oil"].replace("'a.csv'", "'line.h5', dataset = '/solution/height_undeformed'")
    + "&asperities rms_height = 2e-7, law = 'table', file = 'row.h5' /\n",
    "line.nml": ONE["line"],
    "c.nml": ONE["tilted_files"],
    "row.nml": ONE["line"].replace("5e7, 3e8, 1e8", "3e8, 1e8, 5e7"),
    "b.nml": VARYING,
    "h.csv": LOADS,
    "fails.c": FAILS,
}
LONG = SHORTER + "&surface_2 shape = 'file', file = 'long.csv', x_unit = 'm', z_unit = 'm' /\n" + time(0.2, 0.05) + NO_BARS
ROWS = 'awk \'BEGIN { print "x,z"; for (i = 0; i < 70000; i++) printf "%.7f,%.4e\\n", 2e-6*i, 1e-8*sin(0.3*i) }\' > long.csv'
MORE |= {
    "long_table": (
        {"a.nml": LONG + NO_ADEQUACY, "fails.c": FAILS},
        [f"{GCC}; {ROWS}; asperity a.nml --quiet", losing("12 4 60", "a.nml --quiet") + "; rm fails.so long.csv"],
    ),
    "lost_steps": (
        {"a.nml": SHORT, "fails.c": FAILS},
        [
            GCC,
            losing("1 8 452", "a.nml --quiet", after="asperity a.nml --resume --quiet 2>&1"),
            "(export LOST=300 LD_PRELOAD=./fails.so; asperity a.nml --quiet 2>&1); mkdir b; mv a.h5* b",
            losing("1 4 332", "a.nml --resume --quiet", before="cp b/* ."),
            "rm -r b fails.so",
        ],
    ),
    "lost_files": (
        READS,
        [
            f"{GCC}; asperity line.nml row.nml --quiet; mkdir b; mv *.h5 b",
            losing("4 4 324", "a.nml --quiet", before="cp b/* ."),
            losing("1 2 70", "table line.h5 --profiles", before="cp b/line.h5 ."),
            losing("8", "--check b.nml"),
            losing("24", "--check c.nml"),
            "rm -r b fails.so",
        ],
    ),
}


def drawn(kind, count):
    """Random cases, valid or not, of a kind of valid_cases.py."""
    for number in range(count):
        with tempfile.TemporaryDirectory() as place:
            folder, name = pathlib.Path(place), f"{kind.__name__}_{number}"
            files = {f"{name}.nml": kind(random.Random(f"golden {kind.__name__} {number}"), folder)}
            files |= {path.name: path.read_text(encoding="utf-8") for path in folder.iterdir()}
        yield name, (files, [f"asperity {name}.nml --verbose"])


MORE |= drawn(valid_cases.lubricated, 90)
MORE |= drawn(valid_cases.point, 50)
MORE |= drawn(valid_cases.dry, 20)

# Cases whose instructions are counted: a steady contact, a climb, passages, momentum, lines and areas.
COUNTED = ("smooth", "target", "ridge_slow", "auto_lean", "moving_upper", "line", "area", "sphere")
