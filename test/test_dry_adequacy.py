"""Dry models: verdicts of random surfaces beside runs that leave the ingredient out; grids for a wanted accuracy."""

import contextlib

import h5py
import numpy as np
import pytest
from cases import HARD, HEIGHTS, LEAN, called, case_text, contents, ended, profile, text, write, write_heights

BELOW = "matters below the accuracy"
QUANTITIES = ("contact_area_fraction", "mean_separation", "p_max")


def random_surface(rng, is_area):
    """A rough surface that yields at some of its asperities, as namelist with places for what is left out; its mean pressure."""
    nodes, in_wave = int(rng.choice([64, 96] if is_area else [256, 512])), int(rng.choice([4, 8]))
    short, rms = 1e-3 / nodes * in_wave, 10 ** rng.uniform(-7, -5.7)
    pressure = 10 ** rng.uniform(-2.5, -0.8) * 231e9 / 4 * rms / short
    domain = "length = 1e-3, intervals = {0}"
    if is_area:
        domain = "length_x = 1e-3, length_y = 1e-3, intervals_x = {0}, intervals_y = {0}"
    surface = f"shape = 'synthetic', rms_height = {rms:.6e}, wavelength_short = {short:.6e}, hurst = {rng.uniform(0.3, 0.95):.3f}"
    surface += f", seed = {rng.integers(10**6)}{{surface}}"
    more = f"&domain {domain.format(nodes)} /\n{{more}}"
    return case_text(surface, [pressure], "{bodies}", more, "dry_area" if is_area else "dry_line"), pressure


def values(path):
    with h5py.File(path) as file:
        return np.array([file["sweep"][name][0] for name in QUANTITIES])


def test_verdicts_of_random_surfaces(asperity, tmp_path):
    """Beside runs without the ingredient: of 72 verdicts on other seeds no "needed" was wrong, and one of the others."""
    rng = np.random.default_rng(7)
    wrong, known, misses, changes = [], 0, 0, 0
    for i in range(12):
        case, pressure = random_surface(rng, is_area=i % 2 == 0)
        yields = f", hardness = {pressure * 10 ** rng.uniform(0.5, 2.0):.6e}"
        write(tmp_path, "full.nml", case.format(bodies=yields, surface="", more=""))
        assert asperity("full.nml", "--quiet").returncode == 0
        with h5py.File(tmp_path / "full.h5") as file:
            accuracy, said = file["adequacy"].attrs["accuracy"], contents(tmp_path / "full.h5")
        for name in ("plasticity", "harmonics"):
            if f"adequacy/{name}@verdict" not in said:
                continue
            left = {"bodies": "", "surface": ""}
            if name == "harmonics":
                half = said[f"adequacy/{name}@instead"].decode().split()[4]
                left = {"bodies": yields, "surface": f", harmonics = {half}"}
            write(tmp_path, "lean.nml", case.format(**left, more=LEAN))
            assert asperity("lean.nml", "--quiet").returncode == 0
            truth = values(tmp_path / "lean.h5") / values(tmp_path / "full.h5") - 1
            largest, verdict = np.abs(truth).max(), said[f"adequacy/{name}@verdict"].decode()
            known += verdict != "not known"
            bounds = {"needed": largest > accuracy, BELOW: largest <= accuracy, "irrelevant": largest < 0.1 * accuracy}
            assert verdict != "needed" or bounds["needed"], (i, name, truth)
            if not bounds.get(verdict, True):
                wrong.append((i, name, verdict, largest, accuracy))
            for change, quantity in zip(truth[:2], QUANTITIES, strict=False):
                path = f"adequacy/{name}/{quantity}"
                if path in said:
                    changes += 1
                    misses += abs(said[path] - change) > said[f"{path}@error_estimate"] + 1e-9
    assert known >= 13, known
    assert len(wrong) <= 1, wrong
    assert misses <= 0.15 * changes


IMAGES = """&case problem = 'dry_area' /
&bodies youngs_modulus_1 = 210e9, poisson_ratio_1 = 0.3, reduced_radius = 0.01 /
&load load = 1.0 /
&surface_1 shape = 'parabola' /
&domain length_x = {0}, length_y = {0}, intervals_x = 64, intervals_y = 64, periodic = .true. /
"""


def test_images_of_a_parabola(run_case, tmp_path):
    """Images matter where the contact fills half of its period, and hardly where it is a fortieth of it."""
    verdicts = {}
    for length, rise in ((1e-4, 0.041), (1.5e-4, 0.012), (2e-3, None)):
        run_case(IMAGES.format(length), name="a")
        with h5py.File(tmp_path / "a.h5") as file:
            group = file["adequacy/periodicity"]
            verdicts[length] = group.attrs["verdict"].decode()
            assert group.attrs["instead"] == b"an open half-space"
            # beside the curvature that the images give the surface (theory of the note on them)
            if rise:
                peak = group["p_max"]
                assert 1 / (1 + peak[()]) - 1 == pytest.approx(rise, abs=peak.attrs["error_estimate"] + 0.1 * rise)
    assert verdicts[1e-4] == "needed"
    assert verdicts[2e-3] != "needed"


def test_a_grooved_area_is_a_line(run_case, tmp_path):
    """Waves along x alone: 16 profiles along x are the area, to the tolerance."""
    domain = "&domain length_x = 1e-4, length_y = 1e-4, intervals_x = 64, intervals_y = 16 /"
    case = case_text("shape = 'sinusoid', amplitude = 1e-6, wavelength = 1e-4", [1e8, 2e8], "", domain, "dry_area")
    assert "  model     irrelevant: area" in run_case(case, name="a").stdout
    with h5py.File(tmp_path / "a.h5") as file:
        group = file["adequacy"]
        assert group.attrs["mean_pressure"] == pytest.approx(2e8, rel=1e-12)
        assert group["area"].attrs["verdict"] == b"irrelevant"
        assert abs(group["area/mean_separation"][()]) < 1e-6
        assert set(group) == {"area", "grid"}
        grid = group["grid/contact_area_fraction"][()]
        area = file["sweep/contact_area_fraction"]
        assert grid == pytest.approx(area.attrs["error_estimate"][1] / area[1], rel=1e-12)


def test_profiles_that_all_yield_tell_nothing_of_others(solved_case):
    """The largest pressure of each of 16 profiles is the hardness: no spread, which is no error bar; the other changes have one."""
    case, pressure = random_surface(np.random.default_rng(3), is_area=True)
    with solved_case(case.format(bodies=f", hardness = {4 * pressure}", surface="", more="")) as file:
        assert file["sweep/p_max"][0] == pytest.approx(4 * pressure, rel=1e-6)
        row = file["adequacy/area"]
        assert "p_max" not in row
        assert row.attrs["not_known"].decode().startswith("p_max: all profiles have the same")
        assert row["contact_area_fraction"].attrs["error_estimate"] > 0


@pytest.mark.parametrize(("width", "kind"), [(1.2e-5, ".true."), (1.6e-5, ".false."), (2.6e-5, ".false.")])
def test_a_change_is_known_no_better_than_its_grid(solved_case, width, kind):
    """Of a contact of 4 to 8 nodes two coarser grids may give the same change by chance."""
    body, domain = ", reduced_radius = 0.01", f"&domain length = 2e-4, intervals = 64, periodic = {kind} /"
    load = {"key": "hertz_pressure", "modulus": 231e9}
    case = case_text("shape = 'parabola'", [width / 2 * 231e9 / 0.04], body, domain, **load)
    with solved_case(case) as file:
        for name in QUANTITIES:
            grid = file[f"adequacy/grid/{name}"][()]
            assert file[f"adequacy/periodicity/{name}"].attrs["error_estimate"] >= 0.05 * grid * (1 - 1e-12) > 0


SINUSOID = """&case problem = 'dry_line' /
&bodies youngs_modulus_1 = 210e9, poisson_ratio_1 = 0.3, hardness = {0} /
&load {1} /
&surface_1 shape = 'sinusoid', amplitude = 1e-6, wavelength = 1e-4 /
&domain length = 1e-4, intervals = 512 /
"""


@pytest.mark.path
def test_given_separation_is_told_as_its_load(solved_case, asperity, tmp_path):
    """A surface at a given separation, and under the load that was found there: the same contact, to the 1e-8 of the search."""
    with solved_case(SINUSOID.format("5e9", "separation = 3e-7, 5e-7"), name="gap") as file:
        pressure = file["sweep/mean_pressure"][0]
        assert pressure > file["sweep/mean_pressure"][1]
        assert file["sweep/p_max"][0] == 5e9
        gap = {name: row for name, row in contents(tmp_path / "gap.h5").items() if name.startswith("adequacy/plasticity")}
        assert file["adequacy"].attrs["mean_pressure"] == pressure
    write(tmp_path, "load.nml", SINUSOID.format("5e9", f"mean_pressure = {pressure:.17g}"))
    assert "needed at" in asperity("load.nml").stdout
    load = contents(tmp_path / "load.h5")
    assert sum(name.endswith(QUANTITIES) for name in gap) == len(QUANTITIES)
    for name, value in gap.items():
        if name.endswith(QUANTITIES):
            assert value == pytest.approx(load[name], rel=1e-4), name
    assert gap["adequacy/plasticity@verdict"] == load["adequacy/plasticity@verdict"] == b"needed"


def test_plasticity_follows_from_the_largest_pressure(solved_case):
    """Irrelevant exactly where it is below the hardness by more than its bar; within the bar the errors say how much may yield."""
    with solved_case(SINUSOID.format("1e12", "mean_pressure = 1e9")) as file:
        top = file["sweep/p_max"]
        peak, bar = top[0], top.attrs["error_estimate"][0]
    known = ((2 * peak, "irrelevant"), (peak + 2 * bar, "irrelevant"), (peak + 0.5 * bar, "within the bar"), (0.9 * peak, "needed"))
    for hardness, verdict in known:
        with solved_case(SINUSOID.format(f"{hardness:.17g}", "mean_pressure = 1e9")) as file:
            row = file["adequacy/plasticity"]
            changes = {q: (row[q][()], row[q].attrs["error_estimate"]) for q in QUANTITIES}
            if verdict == "within the bar":
                top = file["sweep/p_max"]
                excess = (top[0] + top.attrs["error_estimate"][0]) / hardness - 1
                assert excess > 0
                assert all(change == 0 and error == pytest.approx(excess, rel=1e-6) for change, error in changes.values())
            else:
                assert row.attrs["verdict"].decode() == verdict
            if verdict == "irrelevant":
                assert set(changes.values()) == {(0.0, 0.0)}


def test_nothing_is_measured(solved_case):
    with solved_case(IMAGES.format(1e-3) + "&output adequacy = .false. /\n") as file:
        assert "adequacy" not in file


MODULUS, LENGTH = 230e9, 1e-3
SYNTHETIC = "shape = 'synthetic', seed = 3, rms_height = 1e-6, wavelength_rolloff = 3e-4, wavelength_short = 1e-4"
ROUND = ", reduced_radius = 0.02"
LINE, AREA = f"&domain length = {LENGTH!r}", f"&domain length_x = {LENGTH!r}, length_y = {LENGTH!r}"


@contextlib.contextmanager
def run(asperity, folder, surface, loads, target, bodies="", domain=LINE, more="", **options):
    """A case with a target: its open result and what it prints."""
    content = case_text(surface, loads, bodies, f"{domain} /\n&accuracy target = {target!r} /{more}", modulus=MODULUS, **options)
    write(folder, "case.nml", content.replace("&solver tolerance = 1e-12 /", ""))
    done = ended(asperity("case.nml"))
    with h5py.File(folder / "case.h5") as file:
        yield file, done.stderr + done.stdout


def shares(file):
    """Estimated relative errors of the contact area of all loads."""
    area = file["sweep/contact_area_fraction"]
    return area.attrs["error_estimate"] / area[()]


def on_nodes(asperity, folder, nodes, area, surface=SYNTHETIC, more=""):
    """Heights of a surface on a given number of nodes."""
    names = ("intervals_x", "intervals_y") if area else ("intervals",)
    domain = (AREA if area else LINE) + "".join(f", {name} = {nodes}" for name in names)
    domain += f"{more} /\n&accuracy error_bars = .false. /"
    problem = "dry_area" if area else "dry_line"
    write(folder, "given.nml", case_text(surface, [1e6], "", domain, problem, modulus=MODULUS))
    assert asperity("given.nml", "--quiet").returncode == 0
    with h5py.File(folder / "given.h5") as file:
        return file["solution/height_undeformed"][()]


def series_at(z, points):
    """The Fourier series through the periodic heights z at points in each direction, in spacings of z."""
    for axis in range(z.ndim):
        n = z.shape[axis]
        number = np.fft.fftfreq(n, 1 / n)
        matrix = np.exp(2j * np.pi * np.outer(points, number) / n) / n
        z = np.moveaxis(np.tensordot(matrix, np.fft.fft(np.moveaxis(z, axis, 0), axis=0), 1), 0, axis).real
    return z


@pytest.mark.path
@pytest.mark.parametrize("area", [False, True])
@pytest.mark.parametrize("target", [0.02, 0.01])
def test_hertz_is_as_good_as_wanted(asperity, tmp_path, area, target):
    width = 0.4
    peak = width * LENGTH / 2 * MODULUS / ((np.pi if area else 4) * 0.02)
    exact = np.pi * width**2 / 4 if area else width
    options = {"problem": "dry_area", "domain": AREA} if area else {}
    with run(asperity, tmp_path, "shape = 'parabola'", [peak], target, ROUND, key="hertz_pressure", **options) as (file, printed):
        data = file["summary/contact_area_fraction"]
        assert abs(data[()] - exact) <= target * exact
        assert target / 1.5 < shares(file)[0] <= target
        nodes = file["solution/x"].size
        name = "intervals_x" if area else "intervals"
        assert file["input/effective/domain"].attrs[name] == nodes
        assert file["input/effective/accuracy"].attrs["target"] == target
        words = f"{nodes} x {nodes}" if area else f"{nodes}"
        assert f"case.nml: solved on {words} nodes for an error of {100 * target:.0f} % of the contact area\n" in printed
        assert "report/note" not in file


@pytest.mark.parametrize("area", [False, True])
@pytest.mark.parametrize("open_domain", [False, True])
def test_a_synthetic_surface_stays_the_same(asperity, tmp_path, area, open_domain):
    """On the chosen grid it has the Fourier series of the first one, on which it is made."""
    options = {"problem": "dry_area"} if area else {}
    more = ", periodic = .false." if open_domain else ""
    first, target = 80, 0.1 if area else 0.05
    z = on_nodes(asperity, tmp_path, first, area)
    load = [2e8 if area else 4e8] if not open_domain else [2e7]
    bodies, body = (ROUND, "\n&surface_2 shape = 'parabola' /") if open_domain else ("", "")
    with run(asperity, tmp_path, SYNTHETIC, load, target, bodies, (AREA if area else LINE) + more, body, **options) as (file, _):
        found = file["solution/height_undeformed"][()]
        nodes, shift = found.shape[0], 0.5 if open_domain else 0.0
        assert nodes > first
        assert shares(file)[0] <= target
        x = (np.arange(nodes) + shift) / nodes
        expected = series_at(z, x * first - shift)
        if open_domain:
            square = sum(g**2 for g in np.meshgrid(*[(x - 0.5) * LENGTH] * z.ndim))
            expected = expected - square / (2 * 0.02)
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-13)


def test_a_periodic_file_has_its_fourier_series(solved_case, asperity, tmp_path):
    surface = profile("C")
    with run(asperity, tmp_path, surface, [25e6, 250e6], 0.01, HARD, "&domain", loading=", loading = 'history'") as (file, _):
        nodes = file["solution/x"].size
        found, worst = file["solution/height_undeformed"][()], shares(file)
        assert 0.005 < worst.max() <= 0.01
    with solved_case(case_text(surface, [25e6], HARD, "&accuracy error_bars = .false. /")) as file:
        z = file["solution/height_undeformed"][()]
    assert nodes > z.size
    np.testing.assert_allclose(found, series_at(z, np.arange(nodes) * z.size / nodes), rtol=0, atol=1e-13)


def test_an_open_file_keeps_its_nodes(asperity, tmp_path):
    """Its heights are known at its nodes only: a target is judged and told."""
    x = (np.arange(96) + 0.5) / 96 - 0.5
    write_heights(tmp_path, 1e-7 * np.cos(60 * x) - (x * LENGTH) ** 2 / 0.04, LENGTH / 96)
    for target in (0.1, 1e-3):
        with run(asperity, tmp_path, HEIGHTS, [1e8], target, domain="&domain periodic = .false.") as (file, printed):
            assert (file.attrs["converged"], file["solution/x"].size) == (1, 96)
            assert ("report/note" in file) == (target < shares(file)[0])
            if target == 1e-3:
                note = text(file["report/note"][()])
                assert note.startswith("the target accuracy is not met: of the contact area a relative error of ")
                assert note.endswith(", 0.0010 is the target, and without a period the heights of a file stay on their own nodes")
                assert " is estimated, 0.0010" in note
                assert note in " ".join(printed.split())


def test_a_target_beyond_the_memory_is_told(program, tmp_path):
    domain = f"{LINE} /\n&accuracy target = 1e-7 /"
    surface = f"shape = 'sinusoid', amplitude = 1e-6, wavelength = {LENGTH!r}"
    write(tmp_path, "case.nml", case_text(surface, [1e8], "", domain, modulus=MODULUS).replace("1e-12", "1e-8"))
    command = f"ulimit -v 300000; OPENBLAS_NUM_THREADS=1 '{program}' case.nml"
    ended(called(["bash", "-c", command], cwd=tmp_path))
    with h5py.File(tmp_path / "case.h5") as file:
        note, nodes = text(file["report/note"][()]), file["solution/x"].size
        assert "is the target, and grids of more than " in note
        assert note.endswith(" nodes are not chosen with this memory")
        most = int(note.split("more than ")[1].split()[0])
        assert most / 1.26 < nodes <= most < 2**22


def test_waves_are_seen_from_the_start(asperity, tmp_path):
    """A feature that a coarse grid would miss has its nodes, and there is no note about them."""
    surface = "shape = 'sinusoid', 'feature', amplitude = 1e-6, 5e-7, wavelength = 1e-3, 1e-5, position = 0.0, 3.3e-4"
    with run(asperity, tmp_path, surface, [1e7], 0.1) as (file, _):
        assert file["solution/x"].size >= 800
        assert "report/note" not in file


@pytest.mark.path
def test_no_solution_is_no_accuracy(solved_case):
    content = case_text(SYNTHETIC, [1e8], "", f"{LINE} /\n&accuracy target = 0.05 /", modulus=MODULUS)
    with solved_case(content.replace("tolerance = 1e-12", "tolerance = 1e-12, max_cycles = 2"), status=2) as file:
        assert file.attrs["converged"] == 0
        assert np.isnan(file["summary/contact_area_fraction"].attrs["error_estimate"])


def test_a_separation_that_the_first_grid_misses(asperity, tmp_path):
    """Only the very top of the wave touches."""
    surface = f"shape = 'sinusoid', amplitude = 1e-6, wavelength = {LENGTH!r}, position = 4e-6"
    with run(asperity, tmp_path, surface, [0.9995e-6], 0.02, key="separation") as (file, _):
        area = file["summary/contact_area_fraction"]
        share = area[()]
        assert area.attrs["error_estimate"] <= 0.02 * share
        # H. M. Westergaard, J. Appl. Mech. 6, 1939, A49: half-width a with load share sin^2(pi a / wavelength).
        load = np.sin(np.pi * share / 2) ** 2
        assert load * (1 - np.log(load)) == pytest.approx(1 - 0.9995, rel=0.1)
