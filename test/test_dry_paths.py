"""Dry areas under load, unload and reload: energy, running-in, hardness; the element kernel against direct sums."""

import os

import h5py
import numpy as np
import pytest
from cases import case_text, close, ended, solve, write

SURFACE = "shape = 'synthetic', rms_height = 0.5e-6, wavelength_rolloff = 1e-4, wavelength_short = 1.25e-5"
DOMAIN = "&domain length_x = 3e-4, length_y = 2.4e-4, intervals_x = 60, intervals_y = 48 /"
HARD = ", hardness = 4e9"
AREA = 3e-4 * 2.4e-4


def press(asperity, folder, loads, bodies=HARD, **options):
    """The sweep of the area, and its last pressure and heights."""
    with solve(asperity, folder, SURFACE, loads, bodies, DOMAIN, "dry_area", **options) as file:
        found = {name: item[()] for name, item in file["sweep"].items()}
        return found | {name: item[()] for name, item in file["solution"].items()}


def work(load, datum):
    """Integral of the load over the datum by the trapezoid."""
    return np.sum(np.diff(datum) * 0.5 * (load[1:] + load[:-1]))


def test_work_is_stored_and_dissipated(asperity, tmp_path):
    found = press(asperity, tmp_path, np.linspace(0.004, 1.0, 250) * 1e9)
    load = np.concatenate([[0.0], found["load"]])
    datum = np.concatenate([[-found["height_undeformed"].max()], found["datum"]])
    energy = found["elastic_energy"][-1] + found["dissipated_energy"][-1]
    assert found["dissipated_energy"][-1] > 0.1 * energy
    assert work(load, datum) == pytest.approx(energy, rel=3e-4, abs=0)
    np.testing.assert_allclose(found["dissipated_energy"], 4e9 * AREA * found["dp_mean"], rtol=1e-12)


def test_energy_of_a_cycle_is_what_was_dissipated(asperity, tmp_path):
    loads = np.concatenate([[1e9], np.linspace(1.0, 0.0, 200, endpoint=False) * 1e9])
    found = press(asperity, tmp_path, loads, loading=", loading = 'history'")
    # Unloading gives back what was stored, to the last contact; nothing more is dissipated.
    back = -work(np.append(found["load"], 0.0)[1:], np.append(found["datum"], -found["height_unloaded"].max())[1:])
    assert back == pytest.approx(found["elastic_energy"][0], rel=1e-3, abs=0)
    close(found["dissipated_energy"], np.full(201, found["dissipated_energy"][0]), 1e-9)


@pytest.mark.path
def test_running_in_of_an_area(asperity, tmp_path):
    # The published case: 0.6 of the earlier maximum yields nothing new; back at the maximum all is as it was.
    loads = [1e9, 0.2e9, 0.6e9, 1e9, 1.2e9]
    history = press(asperity, tmp_path, loads, loading=", loading = 'history'")
    virgin = press(asperity, tmp_path, loads)
    close(history["dp_mean"][1:4], np.full(3, virgin["dp_mean"][0]), 1e-9)
    assert list(history["plastic_area_fraction"][1:3]) == [0.0, 0.0]
    for name in ("datum", "mean_separation", "elastic_energy", "ra_loaded", "rq_unloaded"):
        close(history[name][3], history[name][0], 1e-8)
    # Beyond the maximum as if the load had come at once.
    for name in ("dp_mean", "datum", "contact_area_fraction", "dissipated_energy"):
        close(history[name][4], virgin[name][4], 1e-8)
    # On the way back there is more contact than on the virgin surface, and less roughness for good.
    assert history["contact_area_fraction"][1] > 1.5 * virgin["contact_area_fraction"][1]
    assert history["rq_unloaded"][1] < history["rq_undeformed"][1]


def test_hardness_above_the_elastic_peak_changes_nothing(asperity, tmp_path):
    elastic = press(asperity, tmp_path, [2e8, 1e9], "")
    peak = float(elastic["p_max"].max())
    # Just above the peak the iteration may touch the bound on its way: the areas are the same to the last bit.
    capped = press(asperity, tmp_path, [2e8, 1e9], f", hardness = {1.001 * peak!r}")
    assert list(elastic["contact_area_fraction"]) == list(capped["contact_area_fraction"])
    assert list(elastic["contact_area_fraction_corrected"]) == list(capped["contact_area_fraction_corrected"])
    assert list(capped["plastic_area_fraction"]) == [0.0, 0.0]
    assert np.array_equal(elastic["pressure"] > 0, capped["pressure"] > 0)
    np.testing.assert_allclose(capped["pressure"], elastic["pressure"], atol=1e-9 * peak)


def test_elastic_areas_give_everything_back(asperity, tmp_path):
    found = press(asperity, tmp_path, [1e9, 2e8], "", loading=", loading = 'history'")
    alone = press(asperity, tmp_path, [2e8], "")
    assert list(found["dissipated_energy"]) == [0.0, 0.0]
    assert found["contact_area_fraction"][1] == alone["contact_area_fraction"][0]
    np.testing.assert_allclose(found["pressure"], alone["pressure"], atol=1e-8 * alone["pressure"].max())


def element_response(nodes, length, modulus, images):
    """Transfer function of pressures constant over each element, at the nodes: the waves that the grid cannot tell apart."""
    wave = 2 * np.pi / length * np.arange(1, nodes // 2 + 1)
    alias = wave[:, None] + 2 * np.pi * nodes / length * np.arange(-images, images + 1)
    half = 0.5 * length / nodes
    return np.concatenate([[0.0], (4 / (modulus * np.abs(alias)) * np.sin(alias * half) / (alias * half)).sum(axis=1)])


@pytest.mark.parametrize("nodes", [64, 81])
def test_element_kernel_of_a_line(asperity, tmp_path, nodes):
    length, modulus, hardness = 4e-4, 230e9, 0.7e9
    surface = "shape = 'synthetic', rms_height = 0.2e-6, wavelength_short = 2.5e-5"
    domain = f"&domain length = {length}, intervals = {nodes}, kernel = 'element' /"
    with solve(asperity, tmp_path, surface, [4e8], f", hardness = {hardness}", domain, modulus=modulus) as file:
        pressure, z = file["solution/pressure"][()], file["solution/height_undeformed"][()]
        datum, plastic = file["sweep/datum"][0], file["solution/plastic_deformation"][()]
        gap = file["solution/gap"][()]
    response = element_response(nodes, length, modulus, 4000)
    deflection = np.fft.irfft(response[: nodes // 2 + 1] * np.fft.rfft(pressure), nodes)
    assert pressure.max() == hardness
    assert 0 < np.count_nonzero(pressure) < nodes
    np.testing.assert_allclose(deflection + plastic - z - datum, gap, atol=2e-6 * z.std())
    assert np.all((gap == 0) | (pressure == 0))
    with solve(asperity, tmp_path, surface, [4e8], f", hardness = {hardness}", domain.replace("element", "band_limited")) as file:
        assert not np.array_equal(file["solution/pressure"][()], pressure)


def test_element_kernel_of_an_area_in_full_contact(asperity, tmp_path):
    # Waves along x: what the elements do not resolve across them averages out, and the response is that of a line.
    length, nodes, height = 3e-4, 48, 1e-6
    amplitude = height / element_response(nodes, length, 230e9, 4000)[3]
    domain = f"length_x = {length}, length_y = {0.5 * length}, intervals_x = {nodes}, intervals_y = 20"
    waves = f"shape = 'sinusoid', amplitude = {height}, wavelength = {length / 3}"
    options = {"problem": "dry_area", "modulus": 230e9}
    with solve(asperity, tmp_path, waves, [6e9], "", f"&domain {domain}, kernel = 'element' /", **options) as file:
        assert file["sweep/contact_area_fraction"][0] == 1.0
        assert file["sweep/p_max"][0] - 6e9 == pytest.approx(amplitude, rel=1e-6)
    with solve(asperity, tmp_path, waves, [6e9], "", f"&domain {domain} /", **options) as file:
        assert file["sweep/p_max"][0] - 6e9 == pytest.approx(np.pi * 115e9 * height / (length / 3), rel=1e-10)


BAD_HDF5 = {
    "no_dataset": (np.zeros((4, 4)), "/other", "other"),
    "profile": (np.zeros(8), "z", "found a profile, expected an area"),
    "no_spacing": (np.ones((4, 4)), "z", "length_x"),
}


@pytest.mark.parametrize(("heights", "path", "message"), BAD_HDF5.values(), ids=BAD_HDF5)
def test_bad_hdf5_file(run_case, tmp_path, heights, path, message):
    with h5py.File(tmp_path / "bad.h5", "w") as file:
        file["z"] = heights
    text = case_text(f"shape = 'file', file = 'bad.h5', dataset = '{path}'", [1e6], "", problem="dry_area")
    done = run_case(text, status=1)
    assert message in done.stderr
    assert "Backtrace" not in done.stderr
    assert not (tmp_path / "case.h5").exists()


BAD_ATTRIBUTES = {
    "array": ("spacing", np.full(3000, 1e-6), "(spacing): found 3000 values, expected 1"),
    "array_of_x": ("spacing_x", np.full(3, 1e-6), "(spacing_x): found 3 values, expected 1"),
    "array_of_scale": ("si_scale", np.full(7000, 1.0), "(si_scale): found 7000 values, expected 1"),
    "empty": ("spacing", h5py.Empty("f8"), "(spacing): found 0 values, expected 1"),
    "word": ("spacing", "1e-6", "(spacing): found text, expected numbers"),
    "zero": ("spacing", 0.0, "(spacing): found a spacing of 0.000E+00 m, expected 1.0E-15 to 1000000 m"),
    "subnormal": ("spacing", 1e-320, "found a spacing of"),
    "not_a_number": ("spacing", np.nan, "found a spacing of NaN m"),
    "infinite": ("si_scale", np.inf, "(si_scale): found Infinity, expected"),
}


def refused_heights(asperity, tmp_path):
    """The message about the dataset z of bad.h5."""
    write(tmp_path, "case.nml", case_text("shape = 'file', file = 'bad.h5', dataset = 'z'", [1e6], ""))
    done = ended(asperity("case.nml"), 1)
    assert done.stderr.startswith("case.nml:4: &surface_1 file: ")
    assert "bad.h5" in done.stderr
    assert not (tmp_path / "case.h5").exists()
    return done.stderr


@pytest.mark.path
@pytest.mark.parametrize(("attribute", "value", "message"), BAD_ATTRIBUTES.values(), ids=BAD_ATTRIBUTES)
def test_bad_attribute(asperity, tmp_path, attribute, value, message):
    with h5py.File(tmp_path / "bad.h5", "w") as file:
        attributes = file.create_dataset("z", data=np.linspace(0, 1e-6, 64)).attrs
        attributes["spacing"] = 1e-6
        attributes[attribute] = value
    assert message in refused_heights(asperity, tmp_path)


ODD_ATTRIBUTES = [
    *(np.full(number, 1e-6) for number in (2, 3, 64, 1000)),
    *(np.zeros(0), 1e-300, 1e300, np.inf, -np.inf, np.bytes_("1e-6"), np.array([b"1e-6"] * 3), True, 1e-6 + 1e-6j),
    np.array((1, 2.0), dtype=[("a", "i4"), ("b", "f8")]),
]
TYPES = ["S4", "c16", "?", "V8", h5py.string_dtype(), h5py.ref_dtype, [("a", "f8"), ("b", "S3")]]
SHAPES = [(), (0,), (1,), (0, 4), (4, 0), (2, 2, 2), (1,) * 32]
VALUES = [1e308, -1e308, np.inf, -np.inf, np.nan, 1e300, 5e3]
ODD_DATASETS = {
    "type": [lambda file, kind=kind: file.create_dataset("z", (64,), dtype=kind) for kind in TYPES],
    "shape": [lambda file, shape=shape: file.update(z=np.zeros(shape)) for shape in SHAPES],
    "one height": [lambda file, value=value: file.update(z=np.where(np.arange(64) == 7, value, 1e-7)) for value in VALUES],
    "all heights": [lambda file, value=value: file.update(z=np.full(64, value)) for value in VALUES],
    "nothing": [lambda file: file.update(z=h5py.Empty("f8")), lambda file: file.create_group("z")],
    "loop": [lambda file: file.update(z=h5py.SoftLink("/z"))],
}


@pytest.mark.parametrize("name", ["spacing", "spacing_x", "si_scale"])
def test_no_odd_attribute_is_taken(asperity, tmp_path, name):
    for value in [*ODD_ATTRIBUTES, *([-1e-6] if name != "si_scale" else [])]:  # as a scale it turns heights into depths
        with h5py.File(tmp_path / "bad.h5", "w") as file:
            attributes = file.create_dataset("z", data=np.linspace(0, 1e-6, 64)).attrs
            attributes["spacing"] = 1e-6
            attributes[name] = value
        refused_heights(asperity, tmp_path)


@pytest.mark.parametrize("kind", ODD_DATASETS)
def test_no_odd_dataset_is_taken(asperity, tmp_path, kind):
    for make in ODD_DATASETS[kind]:
        with h5py.File(tmp_path / "bad.h5", "w") as file:
            make(file)
            if isinstance(file.get("z", getlink=True), h5py.HardLink):
                file["z"].attrs["spacing"] = 1e-6
        refused_heights(asperity, tmp_path)


def test_heights_of_other_files_are_not_read(asperity, tmp_path):
    os.mkfifo(tmp_path / "pipe.h5")
    sources = {
        "found external storage": lambda file: file.create_dataset("z", (32,), "f8", external=[("/etc/passwd", 0, 256)]),
        "found a virtual dataset": lambda file: file.create_virtual_dataset("z", virtual("bad.h5")),
        "traversal": lambda file: file.update({"z": h5py.ExternalLink("pipe.h5", "z")}),
    }
    for message, make in sources.items():
        with h5py.File(tmp_path / "bad.h5", "w") as file:
            make(file)
        found = refused_heights(asperity, tmp_path)
        assert message in found or "link" in found


def virtual(source):
    """A virtual dataset over z of a file."""
    layout = h5py.VirtualLayout((64,), "f8")
    layout[...] = h5py.VirtualSource(source, "z", shape=(64,))
    return layout


def test_heights_without_end(asperity, tmp_path):
    with h5py.File(tmp_path / "bad.h5", "w") as file:
        file.create_dataset("z", (2**45,), "f8", chunks=True).attrs["spacing"] = 1e-6
    assert "of which the file stores 0, expected all of them" in refused_heights(asperity, tmp_path)
    with h5py.File(tmp_path / "bad.h5", "w") as file:
        file.create_dataset("z", (2**29,), "f8", chunks=(2**28,)).attrs["spacing"] = 1e-6
    assert "found chunks of 2147483648 bytes" in refused_heights(asperity, tmp_path)
    (tmp_path / "bad.h5").unlink()
    os.mkfifo(tmp_path / "bad.h5")
    assert "found a pipe, a device or a socket, expected a file" in refused_heights(asperity, tmp_path)
