"""Dry contacts against exact solutions: observed orders, error bars, bounds of convergence, domains that hold the contact."""

import random

import h5py
import numpy as np
import pytest
from cases import HARD, HEIGHTS, case_text, ended, profile, solve, text, write, write_heights, write_profile

RADIUS, MODULUS, PEAK = 0.01, 230e9, 1e9
LINE = 4 * RADIUS * PEAK / MODULUS  # half-width of the Hertzian line
POINT = np.pi * PEAK * RADIUS / MODULUS  # radius of the Hertzian circle


def hertz(asperity, folder, nodes, length, problem="dry_line"):
    """Fields and figures of a parabola under the Hertzian pressure PEAK."""
    names = ("_x", "_y") if problem == "dry_area" else ("",)
    domain = "&domain " + ", ".join(f"length{name} = {float(length)!r}, intervals{name} = {nodes}" for name in names)
    options = {"key": "hertz_pressure", "modulus": MODULUS}
    bodies, domain = f", reduced_radius = {RADIUS}", domain + ", periodic = .false. /"
    return fields_of(solve(asperity, folder, "shape = 'parabola'", [PEAK], bodies, domain, problem, **options))


def fields_of(file):
    """The solution and the figures of the last load, in memory."""
    with file:
        fields = {name: item[()] for name, item in file["solution"].items()}
        return fields | {name: item[-1] for name, item in file["sweep"].items()}


def hertz_line(asperity, folder, nodes, _kernel):
    """Pressure, gap, their exact values, and the contact width in nodes with its exact value."""
    length = np.pi * LINE
    found = hertz(asperity, folder, nodes, length)
    x = np.abs(found["x"]) / LINE
    outside = np.sqrt(np.maximum(x**2 - 1, 0))
    gap = LINE**2 / (2 * RADIUS) * np.where(x > 1, x * outside - np.log(np.maximum(x + outside, 1)), 0)
    pressure = PEAK * np.sqrt(np.maximum(1 - x**2, 0))
    return found, pressure, gap, PEAK, 2 * LINE / length


def hertz_point(asperity, folder, nodes, _kernel):
    """The same of a ball on an open area."""
    length = np.e * POINT
    found = hertz(asperity, folder, nodes, length, "dry_area")
    r = np.hypot(found["x"][None, :], found["y"][:, None]) / POINT
    inside = np.arccos(1 / np.maximum(r, 1))
    gap = POINT**2 / (np.pi * RADIUS) * (np.sqrt(np.maximum(r**2 - 1, 0)) - (2 - r**2) * inside) * (r > 1)
    return found, PEAK * np.sqrt(np.maximum(1 - r**2, 0)), gap, PEAK, np.pi * POINT**2 / length**2


def westergaard(asperity, folder, nodes, kernel):
    """The same of a periodic sinusoid (H. M. Westergaard, J. Appl. Mech. 6, 1939, A49) at 0.3 of the full load."""
    length, height, share = 1e-3, 1e-6, 0.3
    full = np.pi * MODULUS / 2 * height / length
    domain = f"&domain length = {length}, intervals = {nodes}, kernel = '{kernel}' /"
    surface = f"shape = 'sinusoid', amplitude = {height}, wavelength = {length}"
    found = fields_of(solve(asperity, folder, surface, [share * full], "", domain, modulus=MODULUS))
    angle = np.pi * ((found["x"] / length + 0.5) % 1 - 0.5)
    edge = np.arcsin(np.sqrt(share))
    inside = np.sqrt(np.maximum(share - np.sin(angle) ** 2, 0))
    pressure = 2 * full * np.cos(angle) * inside
    s = np.abs(np.sin(angle)) / np.sqrt(share)
    outside = np.sqrt(np.maximum(s**2 - 1, 0))
    gap = height * 2 * share * np.where(np.abs(angle) > edge, s * outside - np.log(np.maximum(s + outside, 1)), 0)
    return found, pressure, gap, 2 * full * np.sqrt(share), 2 * edge / np.pi


CONTACTS = {
    "hertz_line": (hertz_line, "", range(24)),
    "hertz_point": (hertz_point, "", range(0, 13)),
    "westergaard": (westergaard, "band_limited", range(24)),
    "westergaard_element": (westergaard, "element", range(24)),
}


@pytest.mark.parametrize("parity", [0, 1], ids=["even", "odd"])
@pytest.mark.parametrize(("contact", "kernel", "sizes"), CONTACTS.values(), ids=CONTACTS)
def test_observed_orders(asperity, tmp_path, contact, kernel, sizes, parity):
    nodes = sorted({round(24 * 2 ** (k / 4)) // 2 * 2 + parity for k in sizes})
    errors = []
    for n in nodes:
        found, pressure, gap, peak, area = contact(asperity, tmp_path, n, kernel)
        difference = np.abs(found["pressure"] - pressure)
        gaps = np.abs(found["gap"] - gap).mean() / gap.max()
        errors.append([difference.sum() / pressure.sum(), gaps, abs(found["p_max"] / peak - 1), difference.max() / peak])
        if pressure.ndim == 1:
            assert abs(found["contact_area_fraction"] - area) <= 2 / n
        else:
            # Half a node all round.
            assert found["contact_area_fraction"] == pytest.approx(area, rel=np.e / n)
    mean_pressure, mean_gap, largest, edge = -np.polyfit(np.log(nodes), np.log(errors), 1)[0]
    # The pressure ends like a root: order 1.5 in the mean, 0.5 at the edge; the gap and the largest pressure do better.
    assert mean_pressure == pytest.approx(1.5, abs=0.15)
    assert 1.5 < mean_gap < 2.5
    assert largest == pytest.approx(2.0, abs=0.4)
    assert 0.1 < edge < 0.8


LENGTH = 1e-3
ESTIMATED = {"contact_area_fraction", "plastic_area_fraction", "plasticity_index", "mean_separation", "separation", "datum"}
ESTIMATED |= {"p_max", "dp_max", "dp_mean", "elastic_energy", "dissipated_energy"}
SUMMARY = {"p_max", "contact_area_fraction", "plastic_area_fraction", "mean_separation"}
OFF = "&accuracy error_bars = .false. /"


@pytest.mark.path
def test_every_figure_has_an_estimate(asperity, tmp_path):
    with solve(asperity, tmp_path, profile("C"), [25e6, 250e6]) as file:
        assert {name for name, data in file["sweep"].items() if "error_estimate" in data.attrs} == ESTIMATED
        assert set(file["summary"]) == SUMMARY
        for name in ESTIMATED:
            found = file["sweep"][name].attrs["error_estimate"]
            assert found.shape == (2,)
            assert np.all(np.isfinite(found) & (found >= 0)), name
        for name in SUMMARY:
            last = file["sweep"][name]
            assert file["summary"][name].attrs["error_estimate"] == last.attrs["error_estimate"][-1]
            assert file["summary"][name][()] == last[-1]
        phases = text(file["report/phase_seconds"].attrs["phases"]).split(", ")
        assert file["report/phase_seconds"][phases.index("error_bars")] > 0
    found = []
    for more in ("", OFF):
        with solve(asperity, tmp_path, profile("A"), [100e6], more=more) as file:
            found.append({name: data[()] for name, data in file["sweep"].items()})
            found[-1]["pressure"] = file["solution/pressure"][()]
            if more:
                assert np.isnan(file["summary/p_max"].attrs["error_estimate"])
                assert text(file["summary/p_max"].attrs["no_estimate"]) == "no other grids are compared"
    for name, values in found[0].items():
        assert np.array_equal(values, found[1][name]), name
    write(tmp_path, "case.nml", case_text(profile("C"), [250e6], HARD))
    lines = asperity("case.nml").stdout.splitlines()
    with h5py.File(tmp_path / "case.h5") as file:
        area = file["summary/contact_area_fraction"]
        share = 100 * area.attrs["error_estimate"] / area[()]
    bar = next(line for line in lines if line.strip().startswith("+-"))
    assert float(bar.split()[1]) == pytest.approx(share, rel=0.06)
    write(tmp_path, "case.nml", case_text(profile("C"), [250e6], HARD, OFF))
    assert "+-" not in asperity("case.nml").stdout


def test_no_estimate_without_a_solution(solved_case, tmp_path, asperity):
    content = case_text(profile("C"), [100e6]).replace("tolerance = 1e-12", "tolerance = 1e-12, max_cycles = 3")
    with solved_case(content, status=2) as file:
        for name in SUMMARY:
            assert np.isnan(file["summary"][name].attrs["error_estimate"]), name
    surface = "shape = 'sinusoid', amplitude = 1e-7, wavelength = 1e-3"
    for nodes, is_known in ((6, False), (9, True)):
        with solve(asperity, tmp_path, surface, [1e7], "", f"&domain length = 1e-3, intervals = {nodes} /") as file:
            for name in SUMMARY:
                assert np.isfinite(file["summary"][name].attrs["error_estimate"]) == is_known, name
            if not is_known:
                assert text(file["summary/p_max"].attrs["no_estimate"]) == "no solution, or too few other grids with one"


@pytest.mark.parametrize("nodes", [96, 131, 400])
@pytest.mark.parametrize("share", [0.1, 0.3, 0.8])
def test_westergaard_is_within_the_bars(asperity, tmp_path, nodes, share):
    height = 1e-6
    full = np.pi * MODULUS / 2 * height / LENGTH
    surface = f"shape = 'sinusoid', amplitude = {height}, wavelength = {LENGTH}"
    domain = f"&domain length = {LENGTH}, intervals = {nodes} /"
    with solve(asperity, tmp_path, surface, [share * full], "", domain, modulus=MODULUS) as file:
        for name, exact in {
            "contact_area_fraction": 2 / np.pi * np.arcsin(np.sqrt(share)),
            "mean_separation": height * (1 - share * (1 - np.log(share))),
            "p_max": 2 * full * np.sqrt(share),
        }.items():
            data = file["summary"][name]
            assert abs(data[()] - exact) <= data.attrs["error_estimate"] < 0.3 * exact, name


@pytest.mark.path
@pytest.mark.parametrize("nodes", [48, 144])  # finer and coarser grids
def test_a_given_separation_has_a_load_with_an_error(asperity, tmp_path, nodes):
    sizes = f"length_x = 2.4e-4, length_y = 2.4e-4, intervals_x = {nodes}, intervals_y = {nodes}"
    radius, half_width = 0.005, 70e-6
    surface, options = "shape = 'parabola'", {"problem": "dry_area", "key": "separation", "modulus": MODULUS}
    bodies, domain = f", reduced_radius = {radius}", f"&domain {sizes} /"
    with solve(asperity, tmp_path, surface, [half_width**2 / radius], bodies, domain, **options) as file:
        load = file["sweep/load"]
        exact = 2 / 3 * MODULUS * half_width**3 / radius
        assert abs(load[0] - exact) <= load.attrs["error_estimate"][0] < 0.05 * exact
        assert load[0] == pytest.approx(exact, rel=0.3 / nodes)
        assert file["sweep/separation"][0] == pytest.approx(half_width**2 / radius, rel=1e-10, abs=0)


def test_bars_of_many_nodes_are_sharp(asperity, tmp_path):
    # Six nodes in the shortest wave: much coarser grids lose waves, which is no error of this one.
    rng = np.random.default_rng(5)
    nodes, most = 144, 24
    wave = np.hypot(*np.meshgrid(*[np.fft.fftfreq(nodes, 1 / nodes)] * 2))
    kept = np.where((wave >= 1) & (wave <= most), np.maximum(wave, 1), np.inf)
    heights = np.fft.ifft2(np.fft.fft2(rng.standard_normal((nodes, nodes))) * kept**-1.8).real
    write_heights(tmp_path, 2e-7 * heights / heights.std(), 2.4e-4 / nodes)
    found = {}
    for n, more in ((nodes, ""), (2 * nodes, OFF)):
        domain = f"&domain length_x = 2.4e-4, length_y = 2.4e-4, intervals_x = {n}, intervals_y = {n} /"
        options = {"more": f"{more}\n{domain}", "problem": "dry_area", "modulus": MODULUS}
        with solve(asperity, tmp_path, HEIGHTS, [1e8], "", **options) as file:
            found[n] = {name: (file["summary"][name][()], file["summary"][name].attrs["error_estimate"]) for name in SUMMARY}
    for name, widest in {"mean_separation": 2e-3, "p_max": 0.15, "contact_area_fraction": 0.15}.items():
        value, bar = found[nodes][name]
        exact = found[2 * nodes][name][0]
        assert abs(value - exact) <= bar < widest * exact, name


def test_each_load_of_a_sweep_has_the_bars_that_it_has_alone(asperity, tmp_path):
    loads = [25e6, 250e6]
    with solve(asperity, tmp_path, profile("C"), loads, "") as file:
        together = {name: file["sweep"][name].attrs["error_estimate"] for name in ("mean_separation", "p_max")}
    for i, load in enumerate(loads):
        with solve(asperity, tmp_path, profile("C"), [load], "") as file:
            for name, bars in together.items():
                assert file["sweep"][name].attrs["error_estimate"][0] == pytest.approx(bars[i], rel=0.05), name


KINDS = ("full", "plastic", "flat", "partial", "separation")


def member(kind, source):
    """A small periodic contact that ends in a closed form, in an iteration or in a search for its load, and its bound."""
    wave, modulus = 10 ** source.uniform(-5, -3), 10 ** source.uniform(9, 12)
    amplitude = wave * 10 ** source.uniform(-6, -3)
    full = modulus * amplitude / wave  # about the least mean pressure of full contact, times pi/2
    bodies, load = f"reduced_modulus = {modulus!r}", f"mean_pressure = {full * source.uniform(0.01, 0.4)!r}"
    surface = f"shape = 'sinusoid', amplitude = {amplitude!r}, wavelength = {wave / source.randint(1, 4)!r}"
    tolerance = 10 ** source.uniform(-13, -6)
    if kind == "full":
        load = f"mean_pressure = {full * 10 ** source.uniform(1.5, 6)!r}"
    elif kind == "plastic":
        load = f"mean_pressure = {full!r}"
        bodies += f", hardness = {full!r}"
    elif kind == "flat":
        surface = "shape = 'file', file = 'two.csv', detrend = 'parabola'"
    elif kind == "separation":
        load = f"separation = {amplitude * source.uniform(0.2, 0.9)!r}"
        bodies += f", hardness = {full * source.uniform(0.05, 0.3)!r}"
    groups = f"&bodies {bodies} /\n&load {load} /\n&surface_1 {surface} /\n"
    domain = "" if kind == "flat" else f"&domain length = {wave!r}, intervals = {2 ** source.randint(4, 7)} /\n"
    return f"&case problem = 'dry_line' /\n{groups}{domain}&solver tolerance = {tolerance!r}, max_cycles = 3000 /\n", tolerance


@pytest.mark.path
@pytest.mark.parametrize("kind", KINDS)
def test_converged_means_below_the_bound(asperity, tmp_path, kind):
    source = random.Random(kind)
    heights = [source.uniform(-1e-8, 1e-8) for _ in range(2)]
    write(tmp_path, "two.csv", f"x_m,z_m\n0,{heights[0]!r}\n1e-6,{heights[1]!r}\n")
    bounds = {}
    for number in range(8):
        text, bounds[f"{number}"] = member(kind, source)
        write(tmp_path, f"{number}.nml", text)
    done = asperity(*(f"{name}.nml" for name in bounds), "--quiet")
    assert done.returncode in (0, 2), done.stderr
    for name, bound in bounds.items():
        with h5py.File(tmp_path / f"{name}.h5") as file:
            error = file["sweep/kkt"][-1]
            assert file["report/tolerance_effective"][()] == bound, name
            assert file["report/residual"][()] == error, name
            assert file.attrs["converged"] == (error <= bound), (name, error, bound)
            if kind in ("full", "flat", "plastic"):
                assert file.attrs["converged"] == 1, (name, error, bound, file.attrs["reason"])


ROUND = """&case problem = 'dry_line' /
&bodies reduced_radius = 0.01, reduced_modulus = 230e9 /
&load {load} /
&surface_1 shape = 'parabola' /
{more}
&domain length = {length}, intervals = 512{periodic} /
"""
HALF_WIDTH = 4 * 0.01 * 1e9 / 230e9  # of 1 GPa


def line(asperity, folder, *arguments, load="hertz_pressure = 1e9", more="", length=4 * HALF_WIDTH, periodic=""):
    write(folder, "case.nml", ROUND.format(load=load, more=more, length=length, periodic=periodic))
    return asperity("case.nml", *arguments)


def test_open_and_periodic_unless_it_is_said(asperity, tmp_path, run_case):
    assert line(asperity, tmp_path, "--quiet").returncode == 0
    with h5py.File(tmp_path / "case.h5") as file:
        assert file["summary/p_max"][()] == pytest.approx(1e9, rel=1e-4)
        assert file["input/effective/domain"].attrs["periodic"].decode() == ".false."
        assert file["input/effective/domain"].attrs["kernel"].decode() == "element"
        assert "note" not in file["report"]
    surface = "shape = 'sinusoid', amplitude = 1e-7, wavelength = 1e-4"
    with solve(asperity, tmp_path, surface, [1e7], "", "&domain length = 1e-4, intervals = 64 /") as file:
        assert file["input/effective/domain"].attrs["periodic"].decode() == ".true."
        assert file["solution/x"][0] == 0.0
    write_profile(tmp_path / "z.csv", [1e-9 * (i % 2) for i in range(64)], 1e-6)
    punch = (
        "&case problem = 'dry_line' /\n&bodies reduced_modulus = 230e9 /\n&load mean_pressure = 1e9 /\n"
        "&surface_1 shape = 'file', file = 'z.csv' /\n&domain periodic = .false. /\n"
    )
    told = run_case(punch, "--quiet", status=2).stderr
    assert f"{BEYOND}, towards which the surface does not fall: no length is enough" in told


@pytest.mark.parametrize("problem", ["dry_line", "dry_area"])
def test_what_images_of_a_parabola_do_is_told(asperity, tmp_path, problem):
    if problem == "dry_line":
        done = line(asperity, tmp_path, periodic=", periodic = .true.")
    else:
        sizes = "length_x = 4e-4, length_y = 4e-4, intervals_x = 128, intervals_y = 128"
        content = ROUND.format(load="hertz_pressure = 1e9", more="", length=1, periodic="").replace("dry_line", problem)
        write(tmp_path, "case.nml", content[: content.index("&domain")] + f"&domain {sizes}, periodic = .true. /\n")
        done = asperity("case.nml")
    assert done.returncode == 0
    with h5py.File(tmp_path / "case.h5") as file:
        rise = 100 * (file["summary/p_max"][()] / 1e9 - 1)
        note = file["report/note"][()].decode()
    assert note in " ".join(done.stdout.split())
    told = float(note.split("by about ")[1].split(" %")[0])
    assert rise > 1
    assert told == pytest.approx(rise, rel=0.1)


BEYOND = "the contact reaches the border of the open domain"


@pytest.mark.parametrize("load", ["load_per_length = 1e6", "mean_pressure = 1e9"])
def test_the_length_asked_for_is_enough(asperity, tmp_path, load):
    done = ended(line(asperity, tmp_path, "--check", load=load, length=2e-4), 1)
    wanted = float(done.stderr.split("expected about ")[1].split(" m")[0])
    assert line(asperity, tmp_path, "--quiet", load=load, length=wanted).returncode == 0
    with h5py.File(tmp_path / "case.h5") as file:
        assert file["sweep/contact_area_fraction"][0] == pytest.approx(1 / 1.2, rel=0.05)


@pytest.mark.path
def test_contact_that_reaches_the_border_is_no_solution(asperity, tmp_path):
    rough = "&surface_2 shape = 'synthetic', rms_height = 1e-8, wavelength_short = 5e-5 /"
    loads = "mean_pressure = 1e7, 2e9, 1e8"
    done = ended(line(asperity, tmp_path, load=loads, more=rough, length=4e-4), 2)
    assert f"{BEYOND}, which should be about " in done.stderr
    assert "at a mean pressure of 2.00000E+09 Pa" in done.stderr
    with h5py.File(tmp_path / "case.h5") as file:
        assert file.attrs["converged"] == 0
        reason = text(file.attrs["reason"])
        assert BEYOND in reason
        wanted = float(reason.split("should be about ")[1].split(" m")[0])
        load = file["sweep/load"][1]
    assert line(asperity, tmp_path, "--quiet", load=f"load_per_length = {load}", more=rough, length=wanted).returncode == 0


@pytest.mark.parametrize(("wave", "nodes"), [("", "2.0"), (", wavelength_short = 4e-6", "4.0"), (", wavelength_short = 8e-6", "")])
def test_few_nodes_a_wave_are_told(asperity, tmp_path, wave, nodes):
    surface = f"shape = 'synthetic', rms_height = 1e-7{wave}"
    with solve(asperity, tmp_path, surface, [1e7], "", "&domain length = 2.56e-4, intervals = 256 /") as file:
        if not nodes:
            assert "note" not in file["report"]
            return
        note = file["report/note"][()].decode()
    assert note == f"the finest waves of the surface have {nodes} nodes, of 8 that are needed for its contact area"
