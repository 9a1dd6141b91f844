"""&history: tables that are damaged, the same history in other words, resumed runs, what a result holds, a random family."""

import signal

import h5py
import numpy as np
import pytest
from cases import STEADY, contents, ended, write
from kill_and_resume import different, start, undisturbed, wait_for

LOAD, RADIUS, U1, U2 = "load_per_length [N/m]", "reduced_radius [m]", "speed_1 [m/s]", "speed_2 [m/s]"
CONSTANT = {LOAD: 1e5, RADIUS: 0.01, U1: 0.1, U2: 1.1}
CASE = (
    STEADY.replace("radius_1 = 0.01, radius_2 = 2.0", "reduced_radius = 0.01")
    .replace("-4.0, x_outlet = 1.5", "-3.0, x_outlet = 3.0")
    .replace("intervals = 256", "intervals = 128")
    + "&time transient = .true. /\n&accuracy error_bars = .false. /\n&output adequacy = .false. /\n&history file = 'h.csv' /\n"
)  # fmt: skip
OPEN = CASE.replace("&load load_per_length = 1e5 /\n", "").replace("reduced_radius = 0.01, ", "")
OPEN = OPEN.replace(", speed_1 = 0.1, speed_2 = 1.1", "")
ROWS = f"time [s],{LOAD}\n0,1e5\n1e-3,1.2e5\n"
NAMES = f", expected names with units: time [s] or angle [deg], then any of {LOAD}, {RADIUS}, {U1}, {U2}"
RADII = f", expected a number from 1.00000E-09 to 1.00000E+09 in {RADIUS}"
MOTION = "expected a history that begins in motion, or a periodic one without an end: at rest no film is known"
FORWARDS = "expected a sum > 0 in one of them: oil is drawn in at X < 0"
LOADS = f", expected a number from 1.00000E-06 to 1.00000E+12 in {LOAD}"


def table(folder, clock, name="time [s]", **columns):
    """Writes h.csv: a first column `name`, and those of CONSTANT that are given as `load`, `radius`, `u1` and `u2`."""
    keys = dict(zip(("load", "radius", "u1", "u2"), CONSTANT, strict=True))
    rows = np.column_stack([clock, *(np.broadcast_to(values, np.shape(clock)) for values in columns.values())])
    head = ",".join([name, *(keys[key] for key in columns)])
    write(folder, "h.csv", head + "\n" + "".join(",".join(f"{value:.17g}" for value in row) + "\n" for row in rows))


DAMAGED = {
    "unsorted": (ROWS + "5e-4,1e5\n", ":4: found 5.00000E-04 behind 0.00100000, expected rising time [s]"),
    "repeated time": (ROWS + "1e-3,1e5\n", ":4: found 0.00100000 behind 0.00100000, expected rising time [s]"),
    "gap": (ROWS.replace("1.2e5", ""), ":3: found nothing" + LOADS),
    "text": (ROWS.replace("1.2e5", "high"), ":3: found 'high'" + LOADS),
    "no units": (ROWS.replace(" [s]", ""), ":1: found 'time'" + NAMES),
    "no names": ("0,1e5\n1e-3,1e5\n", ":1: found '0'" + NAMES),
    "unknown column": (ROWS.replace(LOAD, "wind [m/s]"), ":1: found 'wind [m/s]'" + NAMES),
    "twice": (f"time [s],{U1},{U1}\n0,1,1\n1,1,1\n", f":1: found 'time [s],{U1},{U1}'" + NAMES),
    "time and angle": (f"time [s],angle [deg],{U1}\n0,0,1\n", f":1: found 'time [s],angle [deg],{U1}'" + NAMES),
    "a field too many": (ROWS + "2e-3,1e5,\n", ":4: found 3 fields, expected 2"),
    "one row": ("# units: SI\n" + ROWS[: ROWS.index("1e-3")], ":4: found 1 row, expected names with units and at least two rows"),
    "empty": ("", ":1: found 0 rows, expected names with units and at least two rows"),
    "NUL": (ROWS.replace("1.2e5", "1.2\0e5"), ":3: found '1.2?e5'" + LOADS),
    "binary": ("\x01\x02\x03\n" * 5, ":1: found '???'" + NAMES),
    "no load": (ROWS.replace("1.2e5", "0"), ":3: found '0'" + LOADS),
    "infinite": (ROWS.replace("1.2e5", "Inf"), ":3: found 'Inf'" + LOADS),
    "NaN": (ROWS.replace("1.2e5", "NaN"), ":3: found 'NaN'" + LOADS),
    "no radius": (f"time [s],{RADIUS}\n0,0\n1,1\n", ":2: found '0'" + RADII),
    "no span": (ROWS.replace("1e-3", "1e-300"), ": found a table over 1.00E-300 s, expected at least 1.E-12 s"),
    "angles": (ROWS.replace("time [s]", "angle [deg]"), ": found angles, expected &history speed_rpm with them"),
    "rest": (f"time [s],{U1},{U2}\n0,1,-1\n1,1,1\n", ": found speed_1 + speed_2 = 0 in the first row, " + MOTION),
    "backwards": (f"time [s],{U1},{U2}\n0,-1,-1\n1,0,0\n", ": found speed_1 + speed_2 <= 0 in every row, " + FORWARDS),
}


@pytest.mark.parametrize("damage", DAMAGED)
def test_a_damaged_table_is_one_finding(run_case, tmp_path, damage):
    """With its file and line, and nothing else is missing because of it."""
    content, words = DAMAGED[damage]
    write(tmp_path, "h.csv", content)
    for case in (CASE,) if damage in ("rest", "backwards") else (OPEN, CASE):
        done = run_case(case, "--check", status=1)
        assert done.stderr == f"case.nml:{len(case.splitlines())}: &history file: h.csv{words}\n"
    case = CASE.replace("'h.csv'", "'h.csv', periodic = .true.")
    if damage == "rest":
        assert MOTION in run_case(case.replace("= .true.", "= .true., duration = 1.0", 1), "--check", status=1).stderr
        run_case(case, "--check")


def test_a_steady_film_needs_motion(solved_case, run_case, tmp_path):
    """'quasi_steady' is refused where the contact reverses, and what squeeze changes is then not known."""
    table(tmp_path, [0, 1e-3], u1=[0.6, -0.6], u2=[0.6, -0.6])
    done = run_case(CASE.replace("transient = .true.", "transient = .true., scheme = 'quasi_steady'"), "--check", status=1)
    assert "&time scheme: found 'quasi_steady' with a history that stops or reverses, expected 'bdf2': at rest " in done.stderr
    bars = CASE.replace("&accuracy error_bars = .false. /\n&output adequacy = .false. /\n", "&solver film_floor = 1e-12 /\n")
    with solved_case(bars) as file:
        assert "stops or reverses" in str(dict(file["adequacy/squeeze"].attrs))


OTHERS = {
    "no file": ("'h.csv'", "'none.csv'", "file: none.csv: no such file"),
    "folder": ("'h.csv'", "'.'", "file: .: found a folder, expected a file"),
    "no name": ("'h.csv'", "''", "file: found an empty text, expected the name of a file"),
    "speed": ("'h.csv'", "'h.csv', speed_rpm = 60.0", "found times with &history speed_rpm, expected the column angle [deg]"),
    "empty": ("file = 'h.csv'", "", "file: missing, expected a quoted text"),
    "steady": ("transient = .true.", "", "file: not used with transient = .false.: remove it"),
    "stokes": ("'ehl_line'", "'ehl_line', equations = 'stokes'", "file: found with equations = 'stokes', expected 'reynolds'"),
    "model": (
        "'ehl_line'",
        "'ehl_line', model = 'auto'",
        "model: found 'auto' without &accuracy target, expected 'full', or a target",
    ),
    "layers": ("adequacy = .false.", "velocity_layers = 4", "velocity_layers: found with &history, expected 0"),
    "hertz": ("load_per_length", "hertz_pressure", f"found {LOAD} together with &load hertz_pressure, expected one of the two"),
    "ridge": (
        "&load",
        "&surface_2 shape = 'feature', amplitude = 1e-7, wavelength = 1e-4 /\n&load",
        "position: missing, expected real numbers >= -1e6, <= 1e6 [half-widths] with &history",
    ),
}


@pytest.mark.parametrize(("old", "new", "words"), OTHERS.values(), ids=OTHERS)
def test_what_does_not_go_with_a_history(run_case, tmp_path, old, new, words):
    write(tmp_path, "h.csv", ROWS)
    (finding,) = run_case(CASE.replace(old, new), "--check", status=1).stderr.splitlines()
    assert finding.endswith(words)


def test_all_findings_are_told_at_once(run_case, tmp_path):
    """In the namelist and in the table; and each way to write a table that is read."""
    write(tmp_path, "h.csv", DAMAGED["gap"][0])
    case = CASE.replace("'h.csv'", "'h.csv', interpolation = 'spline'").replace("= 0.14", "= -1.0")
    lines = run_case(case, "--check", status=1).stderr.splitlines()
    expected = ["viscosity: found -1.0", "interpolation: found 'spline'", "file: h.csv:3: found nothing"]
    for line, words in zip(lines, expected, strict=True):
        assert words in line
    for content in (ROWS, ROWS.replace("\n", "\r\n"), "\ufeff" + ROWS, "# Öl\n\n" + ROWS.replace(",", " , ")):
        write(tmp_path, "h.csv", content)
        run_case(CASE, "--check")


CYCLE = 1e-3  # [s]; about 5 half-widths
PERIODIC = OPEN.replace("'h.csv'", "'h.csv', periodic = .true.")


def course(times):
    """A load that vibrates, a radius that swings, and a motion to and fro with sliding."""
    phase = 2 * np.pi * times / CYCLE
    speed = np.cos(phase)
    return {"load": 1e5 * (1 + 0.2 * np.sin(phase)), "radius": 0.01 + 0.002 * speed, "u1": 0.1 * speed, "u2": 1.1 * speed}


@pytest.mark.path
@pytest.mark.parametrize(("way", "times"), [("", 1800), ("&thermal temperature = 40 /\n", 300), ("auto", 300)])
def test_an_interrupted_history_goes_on_to_the_same_bits(program, asperity, tmp_path, way, times):
    """Motion to and fro, ended by SIGTERM in a cycle that was added, warm, or slow; a table that has changed is another case."""
    clock, case = np.linspace(0, CYCLE, 41), PERIODIC + way
    motion = course(clock) | ({"u1": 0.1, "u2": 1.1} if way else {})
    if way == "auto":
        clock, case = 1000 * clock, PERIODIC.replace("_line'", "_line', model = 'auto'").replace(", intervals = 128", "")
        case = case.replace("error_bars = .false.", "target = 0.01")
    table(tmp_path, clock, **motion)
    reference, _ = undisturbed(program, tmp_path, case)
    write(tmp_path, "case.nml", case.replace("adequacy", "checkpoint_interval = 0.0, adequacy"))
    with start(program, tmp_path) as running:
        wait_for(tmp_path / "case.h5.part", running, times=times)
        running.send_signal(signal.SIGTERM)
        message = running.stderr.read()
    assert running.returncode == 4, message
    table(tmp_path, clock, **(motion | {"u1": motion["u1"] * (1 + np.cos(np.linspace(0, 2 * np.pi, 41)) ** 2) / 2}))
    assert "another case: it has &history table_checksum = " in ended(asperity("case.nml", "--resume", "--quiet"), 1).stderr
    table(tmp_path, clock, **motion)
    ended(asperity("case.nml", "--resume", "--quiet"))
    assert different(reference, tmp_path / "case.h5") == []
    with h5py.File(reference) as file:
        assert (way == "auto") == (b"quasi_steady" in file["input/effective/time"].attrs["scheme"])


def test_angles_and_constants_give_the_same_history(run_case, tmp_path):
    """As times: to round-off. As in the table, to the bit."""
    clock = np.linspace(0, CYCLE, 41)
    speeds = {"u1": 0.1, "u2": 1.1 + 0.2 * np.sin(2 * np.pi * clock / CYCLE)}
    table(tmp_path, clock, load=1e5, radius=0.01, **speeds)
    run_case(OPEN, "--quiet", name="all")
    table(tmp_path, clock, u2=speeds["u2"])
    run_case(CASE, "--quiet", name="constants")
    table(tmp_path, 30 + clock * 1200 * 6, "angle [deg]", u2=speeds["u2"])
    run_case(CASE.replace("'h.csv'", "'h.csv', speed_rpm = 1200.0"), "--quiet", name="angles")
    assert different(tmp_path / "all.h5", tmp_path / "constants.h5") == []
    first, other = (contents(tmp_path / f"{name}.h5") for name in ("constants", "angles"))
    for name in ("time", "h_min", "h_central", "p_max", "speed_2"):
        assert other[f"transient/{name}"] == pytest.approx(first[f"transient/{name}"], rel=1e-6)


def test_a_periodic_table_is_the_table_repeated(solved_cases, tmp_path):
    """Three cycles, the second time by hand; what counts is the last one, and the table is what the result says it is."""
    cycle = np.linspace(0, CYCLE, 21)
    clock = np.concatenate([cycle, cycle[1:] + CYCLE, cycle[1:] + 2 * CYCLE])
    time = f"transient = .true., duration = {3 * CYCLE}, time_step = 0.02"
    case = PERIODIC.replace("transient = .true.", time)
    table(tmp_path, cycle, **course(cycle))
    (repeated,) = solved_cases(repeated=case)
    table(tmp_path, clock, **course(clock))
    (whole,) = solved_cases(whole=case.replace(", periodic = .true.", ""))
    series, table_of = repeated["transient"], course(clock)
    seconds = series["time"][()] * series["time"].attrs["si_scale"]
    last = seconds >= 2 * CYCLE * (1 - 1e-9)
    assert seconds[-1] == pytest.approx(3 * CYCLE)
    names = {"load_per_length": "load", "reduced_radius": "radius", "speed_1": "u1", "speed_2": "u2"}
    for name, key in names.items():
        expected = np.interp(seconds, clock, table_of[key])
        assert series[name][()] * series[name].attrs["si_scale"] == pytest.approx(expected, rel=1e-9, abs=1e-9 * expected.max())
    for name, least in (("h_min", np.min), ("h_central", np.min), ("p_max", np.max)):
        found = series[name][()]
        assert whole[f"transient/{name}"][()] == pytest.approx(found, rel=1e-5)
        assert repeated[f"summary/{name}"].attrs["dimensionless"] == pytest.approx(least(found[last]), rel=1e-12)
    assert repeated["summary"].attrs["statistics_from"] == pytest.approx(series["time"][-1] * 2 / 3)


TO_AND_FRO = PERIODIC.replace("periodic", "interpolation = 'cubic', periodic").replace("&time ", "&time time_step = 0.05, ")


def test_a_history_is_repeated_until_its_film_repeats(solved_cases, tmp_path):
    """The last of all cycles counts; the same one whether it begins in motion or at rest."""
    clock, lows = np.linspace(0, CYCLE, 41), {}
    for name, shape in (("motion", np.cos), ("rest", np.sin)):
        speed = shape(2 * np.pi * clock / CYCLE)
        table(tmp_path, clock, load=1e5, radius=0.01, u1=0.1 * speed, u2=1.1 * speed)
        (file,) = solved_cases(**{name: TO_AND_FRO})
        series, film = file["transient"], file["summary/h_min"]
        cycles = round(series["time"][-1] * series["time"].attrs["si_scale"] / CYCLE)
        steps = (len(series["time"]) - 1) // cycles
        ends, pressure = series["film_thickness"][::steps], series["pressure"][::steps]
        changes = [np.abs(new / old - 1)[p > 0].max() for old, new, p in zip(ends[:-1], ends[1:], pressure[1:], strict=True)]
        assert len(changes) == cycles > 4
        assert min(changes[:-1]) > 1e-3 > changes[-1]
        lows[name] = [series["h_min"][i * steps : (i + 1) * steps + 1].min() for i in range(cycles)]
        assert film.attrs["dimensionless"] == pytest.approx(lows[name][-1], rel=1e-12)
        assert film.attrs["error_start"] / film[()] == pytest.approx(abs(1 - lows[name][-2] / lows[name][-1]))
    assert lows["rest"][-1] == pytest.approx(lows["motion"][-1], rel=1e-3)


def test_a_film_that_does_not_repeat_is_told(run_case, tmp_path):
    """Of a stroke so short that no oil reaches the middle."""
    clock = np.linspace(0, CYCLE, 41)
    speed = 0.1 * np.cos(2 * np.pi * clock / CYCLE)
    table(tmp_path, clock, load=1e5, radius=0.01, u1=speed, u2=speed)
    done = run_case(TO_AND_FRO, "--quiet", status=2)
    assert "the film does not repeat itself: the last of 20 cycles changed it by " in " ".join(done.stderr.split())


def test_times_are_told_in_seconds(run_case, tmp_path):
    table(tmp_path, [0, CYCLE / 2, CYCLE], u1=[0.1, 0.2, 0.1])
    lines = run_case(CASE).stdout.splitlines()
    (h_min,) = [line for line in lines if line.lstrip().startswith("h_min")]
    with h5py.File(tmp_path / "case.h5") as file:
        series = file["transient/h_min"][()]
        when = file["transient/time"][series.argmin()] * file["transient/time"].attrs["si_scale"]
    assert float(h_min.split(" at ")[1].removesuffix(" us")) == pytest.approx(when * 1e6, rel=1e-3)


@pytest.mark.parametrize(("seed", "motion"), [(1, "onwards"), (2, "to and fro"), (3, "with a stop"), (6, "onwards")])
def test_random_histories_converge(asperity, tmp_path, seed, motion):
    """Kinked loads, radii and speeds (1:5, 1:4 and with rest) on the grid that the program chooses; processor time is limited."""
    source = np.random.default_rng(seed)
    clock = np.append(0, np.cumsum(source.uniform(0.5, 1.5, 8))) * 10 ** source.uniform(-4, -3)
    load, radius, speed = (source.uniform(0, 1, len(clock)) for _ in range(3))
    speed = 2 * speed - 1 if motion == "to and fro" else 0.1 + 0.9 * speed
    speed[0] = 1
    if motion == "with a stop":
        speed[4:6] = 0
    table(tmp_path, clock, load=1e5 * 5**-load, radius=0.01 * 4**-radius, u1=speed, u2=3 * speed * source.uniform())
    law = ("'newtonian'", "'eyring', eyring_stress = 5e6")[seed % 2]
    case = OPEN.replace("x_inlet = -3.0, x_outlet = 3.0, intervals = 128", "").replace("'eyring', eyring_stress = 3.3e6", law)
    write(tmp_path, "case.nml", case.replace("viscosity = 0.14", f"viscosity = {10 ** source.uniform(-2, -0.5):.3f}"))
    ended(asperity("case.nml", "--quiet", seconds=60))
    with h5py.File(tmp_path / "case.h5") as file:
        assert file["transient/h_min"][()].min() > 0


def test_a_trapped_film_costs_no_more_on_a_fine_grid(solved_cases, tmp_path):
    """The oil of gear teeth whose load jumps leaves through the end of the pressure, which moves by many nodes in a step."""
    clock = np.array([0, 0.04, 0.043, 0.26]) * 1e-3
    table(tmp_path, clock, load=[1.77e5, 1.77e5, 2.66e5, 2.66e5], radius=[8.8e-3, 9e-3, 9e-3, 1e-2], u1=1.9, u2=2.3)
    case = OPEN.replace("x_inlet = -3.0, x_outlet = 3.0, ", "").replace("viscosity = 0.14", "viscosity = 0.017")
    case = case.replace("pressure_viscosity = 2.3e-8", "pressure_viscosity = 1.8e-8")
    files = solved_cases(**{f"n{n}": case.replace("128", str(n)) for n in (1024, 4096)})
    few, many = (file["report/cycles"][()] for file in files)
    assert many < 4 / 3 * few


def test_extremes_between_steps_count(solved_cases, tmp_path):
    """The smallest film of a quick reversal lasts shorter than a step of the table: many given steps find the same one."""
    table(tmp_path, [0, 0.5, 0.502, 1], u1=[1, 1, -1, -1], u2=[1, 1, -1, -1])
    case = CASE.replace("intervals = 128", "intervals = 64")
    (divided, fine) = solved_cases(divided=case, fine=case.replace("transient = .true.", "transient = .true., time_step = 0.2"))
    film, at_steps = (divided[name] for name in ("summary/h_min", "transient/h_min"))
    assert film[()] < 0.97 * at_steps[()].min() * at_steps.attrs["si_scale"]
    assert film[()] == pytest.approx(fine["summary/h_min"][()], rel=0.01)


AUTO = CASE.replace("'ehl_line'", "'ehl_line', model = 'auto'").replace("x_inlet = -3.0, x_outlet = 3.0, intervals = 128", "")
AUTO = AUTO.replace("&accuracy error_bars = .false. /\n&output adequacy = .false. /\n", "&accuracy target = 0.03 /\n")


@pytest.mark.path
def test_squeeze_is_left_out_of_a_slow_history_alone(solved_cases, tmp_path):
    """model = 'auto': what that changes is in the bar; each bar is within the target, and the truth within the bar."""
    full = AUTO.replace("'auto'", "'full'")
    for name, end, scheme in (("slow", 1.0, b"quasi_steady"), ("fast", 2e-4, b"bdf2")):
        table(tmp_path, [0, end], load=[5e4, 1e5], u1=[0.5, 1], u2=[0.6, 1])
        cases = {name: AUTO, name + "_full": full, name + "_fine": full.replace("0.03", "0.003")}
        lean, whole, fine = solved_cases(**cases)
        assert dict(lean["input/effective/time"].attrs)["scheme"].strip(b"'") == scheme
        assert lean["adequacy/decision/squeeze"].attrs["decision"] == (b"left out" if name == "slow" else b"kept")
        film, bar = lean["summary/h_min"], lean["summary/h_min"].attrs["error_estimate"]
        assert (film.attrs["error_model"] > 0) == (name == "slow")
        assert (film[()] == whole["summary/h_min"][()]) == (name == "fast")
        assert abs(film[()] - fine["summary/h_min"][()]) < bar < 0.03 * film[()]
        assert fine["summary/h_min"].attrs["error_estimate"] < 0.003 * film[()]
        assert len(fine["solution/x"]) > len(whole["solution/x"])


def test_bars_of_a_quasi_steady_history_are_its_own(solved_cases, tmp_path):
    """Coarse runs leave the squeeze term out too, which here changes the films much."""
    table(tmp_path, [0, 1e-5, 2e-5], load=[1e5, 2e5, 1e5], u1=1, u2=1)
    case = CASE.replace("transient = .true.", "transient = .true., scheme = 'quasi_steady'").replace("error_bars = .false.", "")
    files = solved_cases(**{f"n{n}": case.replace("intervals = 128", f"intervals = {n}") for n in (256, 1024)})
    for name in ("h_min", "h_central"):
        (few, bar), (many, _) = ((file[f"summary/{name}"][()], file[f"summary/{name}"].attrs["error_grid"]) for file in files)
        assert abs(few - many) < bar < 0.02 * few


def test_heat_over_time_is_that_of_each_moment(solved_cases, run_case, tmp_path):
    """At the end of a slow rise of the load that of the steady contact; refused where a surface comes to rest."""
    warm = CASE.replace("viscosity = 0.14", "viscosity = 0.04") + "&thermal temperature = 40 /\n"
    warm = warm.replace("speed_1 = 0.1, speed_2 = 1.1", "speed_1 = 2.0, speed_2 = 3.0")
    steady = warm.replace("&history file = 'h.csv' /\n", "").replace("transient = .true.", "transient = .false.")
    table(tmp_path, [0, 0.2, 0.3], load=[5e4, 1e5, 1e5])
    in_time, at_rest = solved_cases(in_time=warm, at_rest=steady)
    for name in ("temperature_rise", "temperature_rise_1", "temperature_rise_2", "film_thickness"):
        expected = at_rest[f"solution/{name}"][()]
        np.testing.assert_allclose(in_time[f"solution/{name}"][()], expected, rtol=2e-4, atol=2e-4 * expected.max())
    assert expected.min() > 0 and at_rest["solution/temperature_rise"][()].max() > 5
    table(tmp_path, [0, 1e-3], u1=[1.0, 0.0], u2=1.0)
    done = run_case(warm, "--check", status=1)
    assert "history file: found with &thermal a surface that rests or moves against the other, expected speed_1 and" in done.stderr


def test_a_stop_ends_on_any_grid(run_case, solved_cases, tmp_path):
    """The oil at rest leaves through constrictions narrower than two intervals; upwind2 closes them, in bounded time."""
    table(tmp_path, [0, 0.05, 0.5], u1=[0.5, 0, 0], u2=[0.5, 0, 0])
    case = CASE.replace("load_per_length = 1e5", "hertz_pressure = 0.8e9").replace("x_inlet = -3.0, x_outlet = 3.0, ", "")
    case = case.replace("viscosity = 0.14", "viscosity = 0.05").replace("intervals = 128", "intervals = 256")
    fine, coarse = solved_cases(fine=case.replace("= 256", "= 1024"), coarse=case)
    assert coarse["report/cycles"][()] < 1000
    assert coarse["transient/h_min"][-1] == pytest.approx(fine["transient/h_min"][-1], rel=0.4)
    assert coarse["transient/h_central"][-1] == pytest.approx(fine["transient/h_central"][-1], rel=0.02)
    done = run_case(case + "&solver space_scheme = 'upwind2' /\n", "--quiet", status=2)
    assert "it closes between two nodes: it takes more &domain intervals" in " ".join(done.stderr.split())


def test_a_history_starts_where_kappa_has_no_steady_film(solved_case, run_case, tmp_path):
    """Its first moment is then that of upwind2. (Found among random histories that rest.)"""
    clock = np.array([0, 0.79, 1.38, 2.08, 2.69, 3.04, 3.45, 3.83, 4.16]) * 1e-3
    load = [50494.458, 26033.046, 45459.466, 55501.0, 23848.226, 33704.133, 52338.766, 78026.512, 30802.05]
    radius = 1e-3 * np.array([7.426925, 9.5823305, 5.2359379, 3.2515197, 7.859683, 2.664598, 7.8469832, 8.3820254, 6.529826])
    u1 = np.array([1, 0.56750186, 0.37105659, 0.73437089, 0, 0, 0.94599433, 0.2885986, 0.6640286])
    table(tmp_path, clock, load=load, radius=radius, u1=u1, u2=2.8742443 * u1)
    case = OPEN.replace("x_inlet = -3.0, x_outlet = 3.0, intervals = 128", "intervals = 3584").replace("0.14", "0.031")
    case = case.replace("rheology = 'eyring', eyring_stress = 3.3e6", "rheology = 'newtonian'")
    run_case(case.replace("transient = .true.", "transient = .true., duration = 1e-5"), "--quiet")
    given = case.replace("transient = .true.", "transient = .true., duration = 1e-5") + "&solver space_scheme = 'upwind2' /\n"
    with h5py.File(tmp_path / "case.h5") as file:
        kappa, scheme = file["summary/h_central"][()], file["input/effective/solver"].attrs["space_scheme"]
    with solved_case(given) as file:
        assert b"kappa" in scheme
        assert kappa == pytest.approx(file["summary/h_central"][()], rel=5e-3)
