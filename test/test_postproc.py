"""The figure scripts: each draws a small result, and refuses what is not one with a message."""

import contextlib
import importlib.util
import io
import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType, SimpleNamespace

import h5py
import numpy as np
import pytest
from cases import LEAN, ROOT, STEADY, STOKES, TRANSIENT, called, case_text, ended, seal

sys.path.append(str(ROOT / "postproc"))

import figure_style
from result_file import read_result

SCRIPTS = ("profile", "transient", "convergence", "compare", "film_statistics", "regime", "friction")


def load(script: str) -> ModuleType:
    """A script of postproc/ as a module; under its own name 'profile' would hide Python's."""
    spec = importlib.util.spec_from_file_location(f"figures_{script}", ROOT / "postproc" / f"{script}.py")
    sys.modules[spec.name] = module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def run(script: str, *arguments: object) -> subprocess.CompletedProcess:
    """Runs a script inside this process, which saves the second that its imports take."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            status = load(script).main([str(argument) for argument in arguments])
        except SystemExit as end:
            status = int(end.code or 0)
    return subprocess.CompletedProcess(script, status, out.getvalue(), err.getvalue())


def drawn(script: str, *arguments: object) -> str:
    """What a script prints that has drawn its figures and has nothing to say about them."""
    done = run(script, *arguments)
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout


def files_of(folder: Path) -> list[str]:
    """Names in a folder, sorted; none may be empty."""
    assert all(path.stat().st_size > 1000 for path in folder.iterdir())
    return sorted(path.name for path in folder.iterdir())


@pytest.fixture(scope="module")
def results(solve_all: Callable) -> Path:
    return solve_all({"smooth": STEADY + LEAN, "ridge": TRANSIENT + LEAN, "moes": MOES.format(10.0, 5.0, 0.05)})


@pytest.fixture(name="steady")
def _steady(results: Path, tmp_path: Path) -> Path:
    return Path(shutil.copy(results / "smooth.h5", tmp_path))


@pytest.fixture(name="moving")
def _moving(results: Path, tmp_path: Path) -> Path:
    return Path(shutil.copy(results / "ridge.h5", tmp_path))


@contextlib.contextmanager
def changed(path: Path) -> Iterator[h5py.File]:
    """A result, open for changes, which has a seal again afterwards."""
    with h5py.File(path, "r+") as file:
        yield file
    seal(path)


@pytest.mark.parametrize("si", [(), ("--si",)])
def test_profile_draws_png_and_pdf(steady: Path, tmp_path: Path, si: tuple[str, ...]) -> None:
    said = drawn("profile", steady, "--output", tmp_path / "out", *si)
    assert files_of(tmp_path / "out") == ["smooth_profile.pdf", "smooth_profile.png"]
    assert said.split() == [str(tmp_path / "out" / f"smooth_profile.{ending}") for ending in ("png", "pdf")]


def test_far_inlet_leaves_the_units(asperity: Callable, tmp_path: Path) -> None:
    (tmp_path / "smooth.nml").write_text((ROOT / "input" / "minimal.nml").read_text())
    asperity("smooth.nml", "--quiet")
    read = read_result(tmp_path / "smooth.h5", si=True)
    assert abs(read.x[0]) > 100  # half-widths of 0.1 mm, with a film of millimetres
    assert [read.solution[name].axis(True).unit for name in ("x", "film_thickness", "pressure")] == ["µm", "µm", "MPa"]


def test_profile_of_a_time_and_convergence(steady: Path, moving: Path, tmp_path: Path) -> None:
    target = tmp_path / "deep" / "middle.png"
    drawn("profile", moving, "--time", 0.7, "--output", target)
    assert files_of(target.parent) == ["middle.png"]
    drawn("convergence", steady, moving, "--output", tmp_path / "out", "--format", "png")
    assert files_of(tmp_path / "out") == ["ridge_convergence.png", "smooth_convergence.png"]


def test_compare_draws_and_prints_a_table(steady: Path, moving: Path, tmp_path: Path) -> None:
    said = drawn("compare", steady, moving, "--output", tmp_path / "out")
    assert files_of(tmp_path / "out") == ["smooth_compare.pdf", "smooth_compare.png"]
    head, first, second = said.splitlines()[:3]
    assert "h_min [-]" in head
    assert first.split()[:2] == ["smooth", "257"]
    assert "+0.000%" in first
    assert second.split()[0] == "ridge"
    assert "at least two" in ended(run("compare", steady), 1).stderr


@pytest.mark.parametrize("key", ["load_per_length = 1e5", "radius_1 = 0.01", "speed_2 = 1.1"])
def test_compare_is_in_si_where_scales_differ(solved_cases: Callable, tmp_path: Path, key: str) -> None:
    """The change of the film that is printed is that of the film in metres, whatever of the case changes."""
    name, value = key.split("=")
    other = STEADY.replace(key, f"{name}= {1.5 * float(value)!r}")
    films = [file["summary/h_min"][()] for file in solved_cases(one=STEADY, other=other)]
    said = drawn("compare", tmp_path / "one.h5", tmp_path / "other.h5", "--output", tmp_path / "out", "--format", "png")
    change = f"{100 * (films[1] / films[0] - 1):+8.3f}%".strip()
    assert change != "+0.000%"
    rows = {line.split()[0]: line.split() for line in said.splitlines() if line[:3] in ("one", "oth")}
    assert rows["other"][3] == change
    differ = "speed" not in key
    assert ("compared in SI" in said) is differ
    assert ("h_min [µm]" in said) is differ


def test_compare_warns_where_there_is_no_si(solved_cases: Callable, tmp_path: Path) -> None:
    points = {"m10": (10.0, 5.0, 0.01), "m20": (20.0, 5.0, 0.01), "coarse": (10.0, 5.0, 0.05)}
    solved_cases(**{name: MOES.format(*point) for name, point in points.items()})
    results = [tmp_path / f"{name}.h5" for name in points]
    done = ended(run("compare", *results[:2], "--output", tmp_path / "out", "--format", "png"))
    assert "the scales of the results differ, and " in done.stderr
    assert run("compare", results[0], results[2], "--output", tmp_path / "out", "--format", "png").stderr == ""


@pytest.mark.parametrize("si", [(), ("--si",)])
def test_transient_draws_map_strip_and_animation(moving: Path, tmp_path: Path, si: tuple[str, ...]) -> None:
    drawn("transient", moving, "--output", tmp_path / "out", *si)
    assert len(files_of(tmp_path / "out")) == 4
    drawn("transient", moving, "--parts", "passage", "--output", tmp_path / "out", "--frames", 4, *si)
    parts = ("film_strip.pdf", "film_strip.png", "passage.gif", "xt.pdf", "xt.png")
    assert files_of(tmp_path / "out") == [f"ridge_{part}" for part in parts]


@pytest.mark.parametrize(
    "features",
    [
        {"shape": "smooth"},
        {"shape": "sinusoid", "amplitude": 1e-7, "wavelength": 1e-4, "position": 0.0},
        {"shape": "'feature', 'sinusoid'", "amplitude": "2e-7, 1.0d-7", "wavelength": "2*1e-4", "position": "-2.5 0.0"},
    ],
)
def test_transient_with_other_surfaces(moving: Path, tmp_path: Path, features: dict[str, object]) -> None:
    with changed(moving) as file:
        file["input/effective/surface_2"].attrs.update(features)
    drawn("transient", moving, "--output", tmp_path / "out", "--parts", "xt", "film_strip", "--format", "png")
    assert len(files_of(tmp_path / "out")) == 2


@pytest.mark.parametrize("script", ["profile", "convergence", "transient"])
def test_not_converged_is_said(moving: Path, tmp_path: Path, script: str) -> None:
    with changed(moving) as file:
        file.attrs.update(converged=0, reason="cycle limit of 12 reached")
    extra = ("--parts", "xt") if script == "transient" else ()
    done = ended(run(script, moving, "--output", tmp_path / "out", *extra))
    assert "not converged: cycle limit of 12 reached" in done.stderr
    assert len(done.stderr.splitlines()) == 1


def test_figures_of_the_program(run_case, tmp_path: Path) -> None:
    """Numbers of every step, profiles of every 40th: the figures show the profiles at their times."""
    text = (ROOT / "input" / "case3_demo.nml").read_text(encoding="utf-8")
    run_case(text + "&output profile_stride = 40 /\n", "--quiet", name="demo")
    for script in ("profile", "convergence", "transient"):
        extra = ("--time", 1.0) if script == "profile" else ()
        drawn(script, tmp_path / "demo.h5", "--output", tmp_path / "out", "--format", "png", *extra)
    assert files_of(tmp_path / "out") == [f"demo_{kind}" for kind in ("convergence.png", "film_strip.png", "profile.png", "xt.png")]
    read = read_result(tmp_path / "demo.h5", with_transient=True)
    (ridge,) = read.features
    assert (ridge.word, ridge.surface, ridge.position) == ("ridge", 2, -2.5)
    assert ridge.speed == pytest.approx(11 / 6, rel=1e-12)
    times, film = read.transient["time"].values, read.transient["film_thickness"].values
    assert times.size == 407
    assert read.profile_time.values == pytest.approx(times[::40], abs=0)
    assert read.transient["pressure"].values.shape[0] == 11
    steps, followed = load("transient").strip_steps(read, [-1.0, 0.0, 1.0])
    places = followed.centre(read.profile_time.values[steps])
    assert places == pytest.approx([-1.0, 0.0, 1.0], abs=0.5 * ridge.speed * 40 * times[1] + 1e-12)
    # where the path says the ridge is, the film is thinner than at the start
    thinner = np.interp(places[1], read.x, film[steps[1]]) / np.interp(places[1], read.x, film[0])
    assert thinner < 0.8
    pressure, _, found = load("profile").fields(read, 1.0)
    assert found == pytest.approx(1.0, abs=20 * times[1])
    assert np.array_equal(pressure, read.transient["pressure"].values[np.flatnonzero(read.profile_time.values == found)[0]])


def test_a_periodic_history_has_its_last_cycle_and_paths_there_and_back(run_case, tmp_path: Path) -> None:
    rows = "".join(f"{1e-5 * i},{np.cos(np.pi * i / 10):.6f}\n" for i in range(21))
    (tmp_path / "to_and_fro.csv").write_text("time [s],speed_1 [m/s]\n" + rows, encoding="utf-8")
    history = "&history file = 'to_and_fro.csv', periodic = .true. /\n&time transient = .true., time_step = 0.02364 /\n"
    text = STEADY.replace("speed_1 = 0.1, speed_2 = 1.1", "speed_2 = 0.0").replace("x_outlet = 1.5", "x_outlet = 4.0") + history
    ridge = "&surface_1 shape = 'feature', amplitude = 1e-9, wavelength = 1e-4, position = -0.3 /\n"
    run_case(text + ridge + "&accuracy error_bars = .false. /\n", "--quiet", name="ring")
    drawn("transient", tmp_path / "ring.h5", "--si", "--output", tmp_path / "out", "--format", "png")
    assert files_of(tmp_path / "out") == [f"ring_{part}.png" for part in ("film_strip", "history", "xt")]
    read = read_result(tmp_path / "ring.h5", with_transient=True)
    (path,), time = read.features, read.transient["time"].values
    assert np.ptp(path.centre(time)) * read.solution["x"].si_scale == pytest.approx(2e-4 / np.pi, rel=0.02)
    load("transient").keep_last_cycle(read)
    assert np.ptp(read.transient["time"].values) == pytest.approx(2e-4 / read.transient["time"].si_scale, rel=0.01)


def test_results_of_older_versions_are_drawn(moving: Path, tmp_path: Path) -> None:
    """Without profile_time the times of the numbers are those of the profiles; in files of layout 2 inputs are datasets."""
    with changed(moving) as file:
        del file["transient/profile_time"]
    drawn("transient", moving, "--output", tmp_path / "out", "--parts", "xt", "film_strip", "--format", "png")
    read = read_result(moving, with_transient=True)
    assert read.profile_time.values.size == read.transient["pressure"].values.shape[0]
    assert len(read.features) == 1
    with changed(moving) as file:
        for group in file["input/effective"].values():
            for key, value in list(group.attrs.items()):
                group[key] = value
                del group.attrs[key]
    assert read_result(moving).features == read.features


MOES = """&case problem = 'ehl_line' /
&moes moes_m = {}, moes_l = {}, velocity = 'sum' /
&lubricant viscosity_law = 'barus', density_law = 'constant' /
&accuracy target = {} /
"""


def test_regime_of_several_results(solved_cases, tmp_path: Path) -> None:
    points = {"rubber": (200.0, 0.0), "roller": (100.0, 10.0), "ring": (0.2, 3.0), "light": (1.0, 38.0), "heavy": (2000.0, 5.0)}
    solved_cases(**{name: MOES.format(*point, 1e-2) for name, point in points.items()})
    printed = drawn("regime", *[tmp_path / f"{name}.h5" for name in points], "--output", tmp_path / "out", "--format", "png")
    assert files_of(tmp_path / "out") == ["rubber_regime.png"]
    said = dict(line.split(": ", 1) for line in printed.splitlines()[:-1])
    regimes = {name: words.split(": ")[1].split(";")[0] for name, words in said.items()}
    assert regimes == {
        "rubber": "elastic, isoviscous",
        "roller": "elastic, piezoviscous",
        "ring": "rigid, isoviscous",
        "light": "rigid, piezoviscous",
        "heavy": "elastic, piezoviscous",
    }
    # the same contact as in the table; 1 % is what was asked for, 1 % the interpolation
    for name in ("rubber", "roller", "ring", "light"):
        assert abs(float(re.search(r"\(([+-]\S+) %\)", said[name])[1])) < 2.0
    assert "outside the table" in said["heavy"]


FRICTION = """&case problem = 'ehl_line' /
&bodies reduced_radius = 0.01, reduced_modulus = 226e9, speed_1 = 0.5, speed_2 = 1.5 /
&load load_per_length = 1e5 /
&lubricant viscosity = 0.14, roelands_z = 0.6, roelands_p0 = 1.98e8, rheology = 'eyring', eyring_stress = 3.3e6 /
&domain x_inlet = -4.0, x_outlet = 1.5, intervals = 128 /
{}
"""


def test_friction_draws_with_and_without_velocity(run_case, tmp_path: Path) -> None:
    """Steady with the velocity across the film, and a passage without; the caption has both coefficients and the time."""
    passage = "&surface_2 shape = 'feature', amplitude = 1e-7, wavelength = 1e-4 /\n&time transient = .true., end_time = 0.5 /"
    for name, more in {"steady": "&output velocity_layers = 8 /", "passage": passage}.items():
        run_case(FRICTION.format(more), "--quiet", name=name)
        for options in ((), ("--si", "--window", -1, 1)):
            drawn("friction", tmp_path / f"{name}.h5", "--output", tmp_path / "out", "--format", "png", *options)
    assert files_of(tmp_path / "out") == ["passage_friction.png", "steady_friction.png"]
    friction = load("friction")
    result = read_result(tmp_path / "steady.h5")
    found = friction.read_friction(tmp_path / "steady.h5", result)
    assert found.velocity.values.shape == (129, 9)
    assert not friction.has_times(result)
    words = friction.caption(found, result)
    with h5py.File(tmp_path / "steady.h5") as file:
        for name in ("friction_coefficient", "rolling_friction_coefficient"):
            error = file[f"summary/{name}"].attrs["error_estimate"]
            shown = [float(number) for number in re.findall(r"\d\.\d+", words)]
            assert min(abs(number - file[f"summary/{name}"][()]) for number in shown) < 0.1 * error
            assert min(abs(number - error) for number in shown) < 0.1 * error
    assert "largest in time" not in words
    result = read_result(tmp_path / "passage.h5")
    words = friction.caption(friction.read_friction(tmp_path / "passage.h5", result), result)
    assert "largest in time; curves over $X$: $T$ = 0.500" in words


def test_friction_of_a_chosen_time(run_case, tmp_path: Path, steady: Path) -> None:
    # Stresses, pressure and film of the stored time nearest to the one asked for, friction and power of every step.
    fields = "'film_thickness', 'pressure', 'shear_stress_1', 'shear_stress_mean', 'shear_stress_2'"
    more = (
        "&surface_2 shape = 'feature', amplitude = 1e-7, wavelength = 1e-4 /\n"
        "&time transient = .true., end_time = 0.5, time_step = 0.05 /\n"
        f"&output profile_stride = 4, fields = {fields}, velocity_layers = 8 /"
    )
    path = tmp_path / "passage.h5"
    run_case(FRICTION.format(more), "--quiet", name="passage")
    for options in ((), ("--time", 0.25), ("--time", 0.25, "--si")):
        drawn("friction", path, "--output", tmp_path / "out", "--format", "png", *options)
    assert files_of(tmp_path / "out") == ["passage_friction.png"]
    friction, style = load("friction"), figure_style
    result = read_result(path)
    found = friction.read_friction(path, result, 0.25)
    with h5py.File(path) as file:
        for name, field in (found.stresses | found.contact).items():
            np.testing.assert_array_equal(field.values, file["transient"][name][1])
        assert found.time == file["transient/profile_time"][1] == pytest.approx(0.2)
        assert found.velocity is None  # that is of the last time
        assert friction.read_friction(path, result).velocity is not None
        figure, panels = style.new_figure(1, 50, nrows=2, ncols=2)
        friction.draw_times(panels, result, found, si=True)
        curves = [axes.lines[0].get_ydata() for axes in figure.axes]
        names = ("friction_coefficient", "rolling_friction_coefficient", "sliding_power", "rolling_power")
        for curve, name in zip(curves, names, strict=True):
            np.testing.assert_allclose(curve, file["si/transient"][name], rtol=1e-12)  # rounding
            assert curve.shape == (11,)
        style.plt.close(figure)
    # A steady result has no time, a passage without stored stresses only the last one, a contact by Moes' numbers no speeds: each
    # is said, as is a file without friction.
    passage = "&surface_2 shape = 'feature', amplitude = 1e-7, wavelength = 1e-4 /\n&time transient = .true., end_time = 0.2 /"
    for name, text, time, words in (
        ("steady", FRICTION.format(""), ("--time", 0.1), "has no /transient"),
        ("passage", FRICTION.format(passage), ("--time", 0.1), "&output fields = pressure"),
        ("moes", MOES.format(10.0, 5.0, 1e-2), (), "speeds of the surfaces are not known"),
    ):
        run_case(text, "--quiet", name=name)
        assert words in ended(run("friction", tmp_path / f"{name}.h5", *time), 1).stderr
    with changed(steady) as file:
        del file["summary/rolling_friction_coefficient"]
    assert "has no friction" in ended(run("friction", steady), 1).stderr


def test_regime_table_is_what_the_program_computes(solved_cases) -> None:
    table = load("regime").TABLE.read_text(encoding="utf-8").splitlines()
    rows = [dict(zip(table[2].split(","), map(float, line.split(",")), strict=True)) for line in table[3:]]
    assert len(rows) == 11 * 33
    chosen = rows[:: len(rows) // 11]
    results = solved_cases(**{f"{i}": MOES.format(row["moes_m"], row["moes_l"], 1e-3) for i, row in enumerate(chosen)})
    for row, file in zip(chosen, results, strict=True):
        film = file["summary/h_min_moes"]
        margin = row["h_min_error"] + film.attrs["error_estimate"] / np.sqrt(2)
        assert row["h_min"] == pytest.approx(film[()] / np.sqrt(2), abs=margin)


def test_regime_asymptotes() -> None:
    films = load("regime").read_films()
    # Martin's film, without a factor from the table, at the light end: 0.3 % and what L = 0 and M = 0.1 leave
    rigid = films.asymptotes(films.moes_m[:1], np.zeros(1))[0]
    assert films.h_min[0, 0] == pytest.approx(rigid[0], rel=5e-3)
    # the exponents of the others where they should hold: over the last decade of M, and over the largest L
    slope = np.diff(np.log(films.h_min[:, -9::8]), axis=1)[:, 0] / np.log(10)
    assert slope[0] == pytest.approx(-0.2, abs=0.01)
    assert slope[-1] == pytest.approx(-0.125, abs=0.01)
    ones = np.searchsorted(films.moes_m, 1.0)
    rise = np.log(films.h_min[-1] / films.h_min[-2]) / np.log(films.moes_l[-1] / films.moes_l[-2])
    assert rise[ones] == pytest.approx(2 / 3, abs=0.03)
    assert rise[-1] == pytest.approx(3 / 4, abs=0.03)


def test_film_statistics_of_the_program(run_case, tmp_path: Path) -> None:
    text = (ROOT / "input" / "rough_passage.nml").read_text(encoding="utf-8")
    for old, new in (("intervals = 512", "intervals = 128"), ("time_step = 0.01", "time_step = 0.04"), ("= 47.99609375", "= 12.0")):
        assert old in text
        text = text.replace(old, new)
    run_case(text, "--quiet", name="rough")
    drawn("film_statistics", tmp_path / "rough.h5", "--output", tmp_path / "out", "--format", "png")
    assert files_of(tmp_path / "out") == ["rough_film_statistics.png"]
    values = load("film_statistics").read_statistics(tmp_path / "rough.h5")
    for name in ("h_min", "p_max"):
        assert values[f"{name}_share"].sum() == pytest.approx(1.0, abs=1e-12)
        assert len(values[f"{name}_edges"]) == len(values[f"{name}_share"]) + 1
    # the distribution and the counted share of the time agree to a class
    film, below = values["film_threshold"][3], values["time_below"][3]
    up_to = np.searchsorted(values["h_min_edges"], film)
    assert values["h_min_share"][: up_to - 1].sum() <= below + 1e-12
    assert values["h_min_share"][:up_to].sum() >= below - 1e-12
    assert 0 < below < 1


def test_history_of_a_transient_is_cut_at_its_start() -> None:
    """Nine cycles of the start, three of each of two steps, and two behind the last one after a failure."""
    history = np.array([*np.geomspace(1e-2, 4e-9, 9), *[2e-3, 3e-5, 4e-7], *[2e-3, 3e-5, 5e-7], 2e-3, 3e-2])
    steps = {"residual": SimpleNamespace(values=history[[8, 11, 14]])}
    for converged, parts in ((True, [slice(0, 9)]), (False, [slice(0, 9), slice(15, None)])):
        result = SimpleNamespace(report={"residual_history": history}, transient=steps, converged=converged)
        assert [part for _, part in load("convergence").sections(result)] == parts


def refused(script: str, path: Path, tmp_path: Path) -> str:
    """Runs a script on a bad file; one line, status 1, nothing drawn; returns the message."""
    out = tmp_path / "refused"
    extra = (path,) if script == "compare" else ()
    done = ended(run(script, path, *extra, "--output", out), 1)
    assert done.stdout == ""
    assert "Traceback" not in done.stderr
    assert not out.exists()
    assert str(path) in done.stderr
    assert script == "compare" or len(done.stderr.splitlines()) == 1
    return done.stderr


def no_result(kind: str, steady: Path) -> Path:
    """A file that is none, or not one that a figure of films can be made of."""
    path = steady.with_name(f"{kind.split(maxsplit=1)[0]}.h5")
    if kind == "a folder":
        return steady.parent
    if kind == "no HDF5":
        path.write_text("&case title = 'no result' /\n")
    elif kind == "unfinished":
        path = steady.rename(steady.with_suffix(".h5.part"))
    elif kind == "foreign":
        with h5py.File(path, "w") as file:
            file["data"] = np.arange(3)
    elif kind == "dry":
        path = steady
        with changed(path) as file:
            file.attrs["problem"] = "dry_line"
    return path


NO_RESULTS = {
    **{"missing": "no such file", "a folder": "is a folder", "no HDF5": "not an HDF5 file", "unfinished": "unfinished"},
    **{"foreign": "no result of asperity", "dry": "problem is 'dry_line'"},
}


@pytest.mark.parametrize("script", SCRIPTS)
@pytest.mark.parametrize("kind", NO_RESULTS)
def test_no_result(script: str, kind: str, steady: Path, tmp_path: Path) -> None:
    if (script, kind) != ("regime", "dry"):  # it says that the result has no film: test_regime_of_any_result
        assert NO_RESULTS[kind] in refused(script, no_result(kind, steady), tmp_path)


def test_missing_groups_and_fields(steady: Path, moving: Path, tmp_path: Path) -> None:
    assert "has no /transient" in refused("transient", steady, tmp_path)
    assert "has no /statistics" in refused("film_statistics", moving, tmp_path)
    with changed(steady) as file:
        del file["solution/pressure"]
    assert "has no /solution/pressure" in refused("profile", steady, tmp_path)
    # one bad file, and none is drawn
    ended(run("profile", moving, tmp_path / "none.h5", "--output", tmp_path / "out"), 1)
    assert not (tmp_path / "out").exists()
    assert "cannot write" in ended(run("profile", moving, "--output", moving), 3).stderr


def test_si_of_a_dimensionless_study(results: Path, tmp_path: Path) -> None:
    assert "leave out --si" in ended(run("profile", results / "moes.h5", "--si", "--output", tmp_path / "out"), 1).stderr
    assert run("profile", results / "moes.h5", "--output", tmp_path / "out").returncode == 0


@pytest.mark.parametrize("script", SCRIPTS)
def test_help_has_an_example(script: str) -> None:
    command = [sys.executable, str(ROOT / "postproc" / f"{script}.py"), "--help"]
    done = called(command)
    assert (done.returncode, done.stderr) == (0, "")
    assert f"python postproc/{script}.py" in done.stdout


def test_values_that_are_not_finite(moving: Path, tmp_path: Path) -> None:
    with changed(moving) as file:
        file.attrs.update(converged=0, reason="cycle limit of 12 reached")
        for group, place in (("transient", -1), ("solution", ...)):
            pressure, film = (file[group][name][place] for name in ("pressure", "film_thickness"))
            pressure[40:50], film[9:] = np.inf, np.nan
            file[group]["pressure"][place], file[group]["film_thickness"][place] = pressure, film
    for script in ("profile", "convergence"):
        assert run(script, moving, "--output", tmp_path / "out", "--format", "png").returncode == 0
    ended(run("transient", moving, "--output", tmp_path / "out", "--frames", 3, "--format", "png"))


def test_regime_of_any_result(solved_cases, tmp_path: Path) -> None:
    """A contact by the full momentum equations has its place; of a dry one the command says that it has none."""
    body, domain = ", reduced_radius = 0.01", "&domain length = 1e-3, intervals = 128 /"
    dry = case_text("shape = 'parabola'", [0.5e9], body, domain, key="hertz_pressure", modulus=226e9)
    solved_cases(stokes=STOKES.replace("256", "128"), dry=dry)
    both = ended(run("regime", tmp_path / "stokes.h5", tmp_path / "dry.h5", "--output", tmp_path, "--format", "png"))
    assert "dry: dry, without a film" in both.stdout
    assert "stokes: M 5.1" in both.stdout
    assert (tmp_path / "stokes_regime.png").exists()
    alone = run("regime", tmp_path / "dry.h5", "--output", tmp_path / "none")
    assert (alone.returncode, alone.stdout.count("\n")) == (0, 1)
    assert not (tmp_path / "none").exists()
