"""Heights in HDF5 files: positions in datasets x and y or dimension scales, which may fall; numbers that netCDF packs."""

import h5py
import numpy as np
import pytest
import xarray
from cases import LEAN, STEADY, case_text, write
from test_height_tables import FILE, SPACING, heights, read_back

NODES = 96
Z = heights(NODES)
X = SPACING * np.arange(NODES)


def store(path, z=Z, attributes=None, **positions):
    """Heights `z`, with attributes {name: {attribute: value}}, beside datasets of positions."""
    with h5py.File(path, "w") as file:
        for name, values in {"z": z, **positions}.items():
            file[name] = values
            file[name].attrs.update((attributes or {}).get(name, {}))


def profile(asperity, folder, keys="", refused=None):
    return read_back(asperity, folder, "z.h5", ", dataset = 'z', detrend = 'none'" + keys, refused)


def assert_profile(found, z=Z, spacing=SPACING):
    assert found[0] == pytest.approx(z, rel=1e-12, abs=1e-20)
    assert np.diff(found[1]) == pytest.approx(np.full(len(z) - 1, spacing), rel=1e-9, abs=0)


@pytest.mark.parametrize(("x", "z"), [(X, Z), (X + 1e-3, Z), (X - 5e-5, Z), (X[::-1] + 1e-4, Z[::-1])])
def test_positions_give_the_spacing(asperity, tmp_path, x, z):
    store(tmp_path / "z.h5", x=x)
    assert_profile(profile(asperity, tmp_path), z)


@pytest.mark.parametrize(
    ("attributes", "keys", "factors"),
    [
        ({"x": {"units": "mm"}, "z": {"units": "um"}}, "", (1e3, 1e6)),
        ({"x": {"unit": "\u00b5m"}, "z": {"si_scale": 1e-9}}, "", (1e6, 1e9)),
        ({"x": {"si_scale": 1e-2}, "z": {"unit": "nm"}}, "", (1e2, 1e9)),
        ({}, ", x_unit = 'mm', z_unit = 'nm'", (1e3, 1e9)),
        ({"z": {"units": "um"}}, ", x_unit = 'mm'", (1e3, 1e6)),
        ({"x": {"units": "m"}}, "", (1.0, 1.0)),
    ],
)
def test_units_of_positions(asperity, tmp_path, attributes, keys, factors):
    store(tmp_path / "z.h5", factors[1] * Z, attributes, x=factors[0] * X)
    assert_profile(profile(asperity, tmp_path, keys))


PLACE = np.arange(NODES)
BENT = 0.1 * SPACING * (PLACE == 40)  # one position is off by a tenth of a spacing
MM, UM = {"units": "mm"}, {"units": "um"}
# Positions, attributes, keys and the message.
REFUSED = [
    (X, {"x": MM}, "", "(x): found a unit of positions only, expected both, or the key z_unit"),
    (X, {"z": UM}, "", "(x): found a unit of heights only, expected both, or the key x_unit"),
    (X, {"x": {"units": "furlong"}, "z": UM}, "", "found the unit furlong in the attributes of x"),
    (X, {"x": MM, "z": UM}, ", x_unit = 'um'", "but x_unit = 'um', expected the same of both"),
    (X + BENT, {}, "", "(x): node 41: found uneven positions, expected a uniform grid"),
    (X[::-1] + BENT, {}, "", "(x): node 41: found uneven positions, expected a uniform grid"),
    (np.zeros(NODES), {}, "", "(x): found positions that neither rise nor fall, expected those of a uniform grid"),
    (np.concatenate([X[:-1], [0.0]]), {}, "", "found positions that neither rise nor fall"),
    (np.where(PLACE == 7, np.nan, X), {}, "", "(x): node 8: found a position of NaN m"),
    (np.where(PLACE == 7, np.inf, X), {}, "", "(x): node 8: found a position of Infinity m"),
    (np.full(NODES, b"1"), {}, "", "(x): found text, expected numbers"),
    (X, {"z": {"_Unsigned": "true"}}, "", "found _Unsigned = true"),
    (X, {"z": {"scale_factor": np.nan}}, "", "in scale_factor and add_offset, expected numbers"),
    (X, {"z": {"scale_factor": 0.0}}, "", "(scale_factor): found 0"),
    (X, {"z": {"add_offset": "none"}}, "", "(add_offset): found text, expected numbers"),
    (X, {"z": {"missing_value": [1.0, 2.0]}}, "", "(missing_value): found 2 values, expected 1"),
    (X, {}, ", positions = 'x'", "found the key positions, expected it for a table only"),
]


@pytest.mark.parametrize(("x", "attributes", "keys", "message"), REFUSED)
def test_positions_and_attributes_that_are_none(asperity, tmp_path, x, attributes, keys, message):
    store(tmp_path / "z.h5", Z, attributes, x=x)
    assert message in profile(asperity, tmp_path, keys, refused=True)


def assert_area(run_case, folder, dataset, z, tolerance):
    """The area of a dataset of z.h5 is `z` on spacings of 2 and 3 um, and nothing is said."""
    surface = FILE.format("z.h5") + f", dataset = '{dataset}', detrend = 'none'"
    assert run_case(case_text(surface, [1e6], "", LEAN, problem="dry_area"), "--quiet").stderr == ""
    with h5py.File(folder / "case.h5") as file:
        np.testing.assert_allclose(file["solution/height_undeformed"][()], z, rtol=tolerance, atol=1e-20)
        for axis, spacing in (("x", 2e-6), ("y", 3e-6)):
            assert np.diff(file[f"solution/{axis}"][()]) == pytest.approx(spacing, rel=1e-9, abs=0)


@pytest.mark.path
@pytest.mark.parametrize("falls", [(False, False), (True, False), (False, True), (True, True)])
def test_positions_of_an_area(run_case, tmp_path, falls):
    ny, nx = 24, 36
    z = 1e-7 * np.random.default_rng(5).standard_normal((ny, nx))
    x, y = 2e-6 * np.arange(nx), 3e-6 * np.arange(ny)
    steps = [-1 if fall else 1 for fall in falls]
    store(tmp_path / "z.h5", z, x=x[:: steps[0]], y=y[:: steps[1]])
    assert_area(run_case, tmp_path, "z", z[:: steps[1], :: steps[0]], 1e-12)


def test_an_attribute_goes_before_positions(asperity, tmp_path):
    store(tmp_path / "z.h5", Z, {"z": {"spacing": 2 * SPACING}}, x=X)
    assert_profile(profile(asperity, tmp_path), spacing=2 * SPACING)


def test_what_is_no_position_of_the_nodes_is_left_alone(asperity, tmp_path):
    for x in (X[:-1], np.zeros((NODES, 2)), 3.0):
        store(tmp_path / "z.h5", x=x)
        assert "spacing" in profile(asperity, tmp_path, refused=True)
    with h5py.File(tmp_path / "z.h5", "w") as file:
        file["z"] = Z
        file["x"] = np.zeros(NODES)
        file["x"].make_scale("This is a netCDF dimension but not a netCDF variable.        96")
    assert "spacing" in profile(asperity, tmp_path, refused=True)


def test_a_file_of_xarray(asperity, tmp_path):
    xarray = pytest.importorskip("xarray", reason="not applicable: xarray is not installed")
    data = xarray.DataArray(1e9 * Z, dims="x", coords={"x": ("x", 1e6 * X, {"units": "um"})}, attrs={"units": "nm"})
    data.to_dataset(name="z").to_netcdf(tmp_path / "z.h5", engine="h5netcdf")
    assert_profile(profile(asperity, tmp_path))


def test_heights_of_a_result_need_nothing_more(asperity, tmp_path):
    store(tmp_path / "z.h5", x=X)
    first = profile(asperity, tmp_path)
    (tmp_path / "case.h5").rename(tmp_path / "before.h5")
    again = read_back(asperity, tmp_path, "before.h5", ", dataset = 'solution/height_undeformed', detrend = 'none'")
    assert_profile(again, first[0])


def test_a_long_profile_that_falls(solved_case, tmp_path):
    """In pieces, in oil: the same film as of the profile the other way round."""
    nodes = 200_000
    x = 1e-6 * np.arange(nodes)
    z = 1e-9 * np.sin(2 * np.pi * x / 97e-6) * (1 + x / x[-1])
    films = []
    for way in (1, -1):
        store(tmp_path / "z.h5", z[::way], x=x[::way])
        surface = "&surface_2 shape = 'file', file = 'z.h5', dataset = 'z' /\n"
        time = "&time transient = .true., end_time = 2.0, time_step = 0.05 /\n&accuracy error_bars = .false. /\n"
        with solved_case(STEADY + surface + time + "&output adequacy = .false. /\n") as file:
            films.append(file["transient/h_min"][()])
            assert np.ptp(films[-1]) > 0
    assert np.array_equal(*films)


def store_with_scales(path, library, z, axes, units=("mm", "um"), group="", extra=()):
    """Heights `z` with coordinates {name: values}, the slowest first, attached as netCDF-4 has them."""
    if library == "xarray":
        data = xarray.Dataset(
            {"relief": (list(axes), z, {"units": units[1]})},
            coords={name: (name, values, {"units": units[0]}) for name, values in axes.items()},
        )
        data.to_netcdf(path, engine="netcdf4", group=group or None)
        return
    with h5py.File(path, "w") as file:
        parent = file.require_group(group) if group else file
        relief = parent.create_dataset("relief", data=z)
        if units[1]:
            relief.attrs["units"] = units[1]
        for i, (name, values) in enumerate(axes.items()):
            parent[name] = values
            if units[0]:
                parent[name].attrs["units"] = units[0]
            parent[name].make_scale(name)
            relief.dims[i].attach_scale(parent[name])
        for name, values in extra:
            parent[name] = values


def relief(asperity, folder, dataset="relief", keys="", refused=None):
    return read_back(asperity, folder, "z.h5", f", dataset = '{dataset}', detrend = 'none'" + keys, refused)


@pytest.mark.parametrize("library", ["xarray", "h5py"])
@pytest.mark.parametrize("seed", range(6))
def test_positions_are_dimension_scales(asperity, tmp_path, library, seed):
    """Whatever their names, units, group, start and direction."""
    rng = np.random.default_rng([23, seed])
    factors = {"m": 1.0, "mm": 1e3, "um": 1e6, "nm": 1e9}
    units = rng.choice(list(factors), 2)
    group, name = rng.choice(["", "scan", "scan/first"]), rng.choice(["distance", "lateral", "X"])
    step = rng.choice([-1, 1])
    x = (X + rng.uniform(-1e-3, 1e-3))[::step] * factors[units[0]]
    store_with_scales(tmp_path / "z.h5", library, Z * factors[units[1]], {str(name): x}, tuple(map(str, units)), str(group))
    assert_profile(relief(asperity, tmp_path, f"{group}/relief".lstrip("/")), Z[::step])


@pytest.mark.parametrize("library", ["xarray", "h5py"])
def test_dimension_scales_of_an_area(run_case, tmp_path, library):
    ny, nx = 24, 36
    z = 1e-7 * np.random.default_rng(29).standard_normal((ny, nx))
    axes = {"across": 3e-3 * np.arange(ny)[::-1], "along": 2e-3 * np.arange(nx)}
    store_with_scales(tmp_path / "z.h5", library, 1e6 * z, axes)
    assert_area(run_case, tmp_path, "relief", z[::-1], 1e-10)


def test_a_scale_without_unit_needs_the_key(asperity, tmp_path):
    """It may count pixels; x beside the heights goes before it. A unit that is none, or of one of the two, is refused."""
    pixels = {"pixel": np.arange(NODES)}
    store_with_scales(tmp_path / "z.h5", "h5py", Z, pixels, ("", ""))
    assert "spacing" in relief(asperity, tmp_path, refused=True)
    store_with_scales(tmp_path / "z.h5", "h5py", Z, pixels, ("", ""), extra=[("x", X)])
    assert_profile(relief(asperity, tmp_path))
    store_with_scales(tmp_path / "z.h5", "h5py", 1e6 * Z, {"distance": 1e3 * X}, ("", ""))
    assert_profile(relief(asperity, tmp_path, keys=", x_unit = 'mm', z_unit = 'um'"))
    for units, message in (
        (("mm", ""), "(/distance): found a unit of positions only, expected both, or the key z_unit"),
        (("pixel", "um"), "found the unit pixel in the attributes of /distance"),
    ):
        store_with_scales(tmp_path / "z.h5", "h5py", Z, {"distance": X}, units)
        assert message in relief(asperity, tmp_path, refused=True)


@pytest.mark.parametrize("kind", ["text", "numbers", "gone", "none attached"])
def test_lists_of_scales_that_are_none(asperity, tmp_path, kind):
    """Then there are no positions, and nothing else is said."""
    store_with_scales(tmp_path / "z.h5", "h5py", Z, {"distance": X})
    with h5py.File(tmp_path / "z.h5", "a") as file:
        if kind == "gone":
            del file["distance"]
        elif kind == "none attached":
            file["relief"].dims[0].detach_scale(file["distance"])
        else:
            del file["relief"].attrs["DIMENSION_LIST"]
            file["relief"].attrs["DIMENSION_LIST"] = "distance" if kind == "text" else np.arange(3)
    assert "spacing" in relief(asperity, tmp_path, refused=True)


def packed(rng, kind):
    """Heights as numbers of a kind with the attributes that unpack them, and what they are [um]."""
    factor, shift = float(10 ** rng.uniform(-5, -3)), float(rng.uniform(-1, 1))
    counts = np.rint(1e9 * Z * rng.uniform(0.05, 0.2) + (100 if kind == "u1" else 0))
    z = counts.astype(kind)
    attributes = {"units": "um", "scale_factor": factor, "add_offset": shift}
    for name in rng.permutation(list(attributes))[: rng.integers(2)]:
        attributes.pop(str(name))
    values = z.astype(float) * attributes.get("scale_factor", 1.0) + attributes.get("add_offset", 0.0)
    return z, attributes, values / (1e6 if "units" in attributes else 1.0)


@pytest.mark.parametrize("kind", ["i2", "i4", "u1", "f4", "f8", ">i2"])
@pytest.mark.parametrize("mark", [None, "_FillValue", "missing_value", "valid_min", "valid_max"])
def test_packed_heights(asperity, tmp_path, kind, mark):
    """scale_factor, add_offset and marks as netCDF has them; a missing point is refused with its place."""
    rng = np.random.default_rng([53, len(kind), sum(map(ord, f"{kind}{mark}"))])
    z, attributes, expected = packed(rng, kind)
    values = {"_FillValue": 255, "missing_value": 255, "valid_min": 3, "valid_max": 250} if kind == "u1" else {}
    marks = {"_FillValue": -32000, "missing_value": 32000, "valid_min": -30000, "valid_max": 30000} | values
    if kind.startswith("f"):
        marks["_FillValue"] = 1e20
    if mark:
        attributes[mark] = np.array(marks[mark], dtype=kind)
    # Scaled positions: half a micrometre a count, in mm.
    scale = {"units": "mm", "scale_factor": SPACING * 1e3 / 4, "add_offset": 7.0}
    store(tmp_path / "z.h5", z, {"z": attributes | {"si_scale": 1e-6}, "x": scale}, x=4 * np.arange(NODES, dtype="i4"))
    keys = ", x_unit = 'mm', z_unit = 'um'"
    found, x = profile(asperity, tmp_path, keys)
    np.testing.assert_allclose(found, expected if "units" in attributes else expected * 1e-6, rtol=1e-12, atol=1e-20)
    np.testing.assert_allclose(np.diff(x), SPACING, rtol=1e-9)
    if not mark:
        return
    place = int(rng.integers(NODES))
    beyond = {"valid_min": -1, "valid_max": 1}.get(mark, 0)
    z[place] = marks[mark] + beyond
    store(tmp_path / "z.h5", z, {"z": attributes, "x": scale}, x=4 * np.arange(NODES, dtype="i4"))
    message = profile(asperity, tmp_path, keys, refused=True)
    assert f"z.h5 (z): node {place + 1}: found " in message
    assert "the mark of a missing point" in message


@pytest.mark.parametrize(
    ("value", "message"), [(9999.0, "found 0.00999900, far from"), (np.nan, "found a height that is no number")]
)
def test_a_missing_point_of_an_area(asperity, tmp_path, value, message):
    z = 1e-7 * np.random.default_rng(5).standard_normal((12, 16))
    z[7, 4] = value * 1e-6
    store(tmp_path / "z.h5", z, {"z": {"spacing": SPACING}})
    write(tmp_path, "case.nml", case_text(FILE.format("z.h5") + ", dataset = 'z'", [1e6], "", problem="dry_area"))
    found = asperity("case.nml", "--quiet").stderr
    assert f"z.h5: node 117: {message}" in found
    assert found.endswith("expected heights without gaps (node 5 in x, 8 in y)\n")
