"""Dry contacts with a wanted accuracy: which grid is chosen, that the surface stays the same, what is told."""

import contextlib

import h5py
import numpy as np
import pytest
from cases import called, ended, text, write
from dry_cases import HARD, HEIGHTS, case_text, profile, write_heights

MODULUS, LENGTH = 230e9, 1e-3
SYNTHETIC = "shape = 'synthetic', seed = 3, rms_height = 1e-6, wavelength_rolloff = 3e-4, wavelength_short = 1e-4"
PARABOLA = ", reduced_radius = 0.02"
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
    with run(asperity, tmp_path, "shape = 'parabola'", [peak], target, PARABOLA, key="hertz_pressure", **options) as (
        file,
        printed,
    ):
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
    bodies, body = (PARABOLA, "\n&surface_2 shape = 'parabola' /") if open_domain else ("", "")
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
                assert note.endswith(
                    " is estimated, 0.0010 is the target, and without a period the heights of a file stay on their own nodes"
                )
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
