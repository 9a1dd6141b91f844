"""Axes, units and names of every group of every kind of result, as xarray and netCDF4 see them, and the XDMF file beside it.

The rules of ParaView's reader (vtkXdmfReader of vtk 9): a dataset is not reached through a link, and a field has as many extents
as the topology of its grid; of one with fewer it reads the first numbers only, without a word.
"""

import warnings
from xml.etree import ElementTree

import h5py
import numpy as np
import pytest
from cases import MOES, POINT, STEADY, STOKES, TRANSIENT, ended, write

XDMF = "&output xdmf = .true. /\n"
LEAN = "&accuracy error_bars = .false. /\n&output adequacy = .false., xdmf = .true. /\n"
PASSAGE = TRANSIENT.replace("time_step = 0.05", "time_step = 0.05, scheme = 'bdf2'")
AUTO = PASSAGE.replace("problem = 'ehl_line'", "problem = 'ehl_line', model = 'auto'").replace(", intervals = 256", "")
RIDGE = """&surface_2 shape = 'feature', amplitude = 0.2e-6, wavelength = 1e-4, position = -2.1 /
&time transient = .true., end_time = 0.3, time_step = 0.05 /
"""
DENT = """&surface_1 shape = 'feature', amplitude = -5e-8, wavelength = 2e-4, wavelength_y = 2e-4 /
&time transient = .true., end_time = 0.6, time_step = 0.2 /
"""
DRY = """&case problem = 'dry_{kind}' /
&bodies youngs_modulus_1 = 210e9, poisson_ratio_1 = 0.3, hardness = 3e9 /
&load mean_pressure = 1e7, 3e7, 2e7 /
&surface_1 shape = 'synthetic', rms_height = 0.5e-6, hurst = 0.8, wavelength_long = 1e-4, wavelength_short = 2e-5, seed = 4 /
"""
LINE = DRY.format(kind="line") + "&domain length = 4e-4, intervals = 128 /"
AREA = DRY.format(kind="area") + "&domain length_x = 2e-4, length_y = 2e-4, intervals_x = 32, intervals_y = 24 /"
X, XY = {"x": 257}, {"x": 33, "y": 49}
FILM, SURFACES = {"pressure", "film_thickness"}, {"pressure", "gap", "height_undeformed", "height_unloaded", "plastic_deformation"}
# Namelist; sizes of axes; nodes of each grid of the XDMF file along x, y and z, and some of its fields.
KINDS = {
    "steady": (
        STEADY + XDMF.replace("xdmf", "velocity_layers = 4, xdmf"),
        {"/solution": X, "/si/solution": X, "/velocity": {"x": 257, "zeta": 5}},
        {"solution": ((257, 1, 1), FILM | {"shear_stress_1"}), "velocity": ((5, 257, 1), {"u"})},
    ),
    "dimensionless": (MOES + XDMF, {"/solution": X}, {"solution": ((257, 1, 1), FILM)}),
    "transient": (
        PASSAGE + LEAN.replace("xdmf", "profile_stride = 4, film_thresholds = 1e-7, 2e-7, xdmf"),
        {"/transient": {"time": 21, "profile_time": 6, **X}, "/si/transient": {"time": 21, "profile_time": 6, **X}},
        {"solution": ((257, 1, 1), FILM), "transient": ((257, 6, 1), FILM)},
    ),
    "momentum": (
        STOKES + "&film layers = 6 /" + LEAN,
        {"/momentum": {"zeta": 6, **X}},
        {"solution": ((257, 1, 1), FILM), "momentum": ((6, 257, 1), {"u", "w", "layer_pressure", "shear_stress", "viscosity"})},
    ),
    "momentum in time": (
        STOKES + "&film layers = 6 /" + RIDGE + LEAN.replace("xdmf", "profile_stride = 3, xdmf"),
        {"/momentum/transient": {"time": 7, "profile_time": 3, **X}, "/transient": {"time": 7, "profile_time": 3, **X}},
        {"solution": ((257, 1, 1), FILM), "momentum": ((6, 257, 1), {"u", "w"})}
        | dict.fromkeys(("transient", "momentum/transient"), ((257, 3, 1), FILM)),
    ),
    "auto": (
        AUTO.replace(", time_step = 0.05", "") + "&accuracy target = 0.05 /",
        {"/solution": {"x": 129}, "/adequacy/decision/roughness": {}},
        {},
    ),
    "line": (
        LINE + XDMF,
        {"/solution": {"x": 128}, "/si/solution": {"x": 128}, "/sweep": {"step": 3}},
        {"solution": ((128, 1, 1), SURFACES)},
    ),
    "area": (AREA + XDMF, {"/solution": {"x": 32, "y": 24}, "/sweep": {"step": 3}}, {"solution": ((32, 24, 1), SURFACES)}),
    "point": (
        POINT.replace("intervals_x = 64", "intervals_x = 32") + DENT + XDMF,
        {"/solution": XY, "/transient": {"time": 4, "profile_time": 4, **XY}},
        {"solution": ((33, 49, 1), {"roughness_1"}), "transient": ((33, 49, 4), FILM)},
    ),
}


@pytest.fixture(scope="module", name="results")
def _results(solve_all):
    return solve_all({name: content for name, (content, *_) in KINDS.items()})


def groups_of(path):
    """The paths of all groups, links among them."""
    found = ["/"]

    def walk(group):
        for item in group.values():
            if isinstance(item, h5py.Group):
                found.append(item.name)
                walk(item)

    with h5py.File(path) as file:
        walk(file)
    return found


@pytest.mark.parametrize("kind", KINDS)
def test_xarray_opens_every_group_with_names_and_units(results, kind):
    xarray = pytest.importorskip("xarray")
    path, sizes = results / f"{kind}.h5", KINDS[kind][1]
    seen = {}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for group in groups_of(path):
            with xarray.open_dataset(path, group=group, engine="h5netcdf") as data:
                data.load()
                seen[group] = dict(data.sizes)
                for name, array in data.variables.items():
                    assert array.attrs["long_name"], (group, name)
                    assert array.ndim == 0 or array.dtype.kind in "SUO" or array.attrs["units"], (group, name)
                    assert set(array.dims) <= set(data.coords), (group, name)
    for group, expected in sizes.items():
        assert seen[group] == expected, group
    assert seen["/report"]["phase"] == 6


@pytest.mark.parametrize("kind", KINDS)
def test_netcdf_readers_see_the_same_axes(results, kind):
    netcdf, xarray = pytest.importorskip("netCDF4"), pytest.importorskip("xarray")
    path = results / f"{kind}.h5"
    with netcdf.Dataset(path) as data:
        for group in groups_of(path):
            with xarray.open_dataset(path, group=group, engine="h5netcdf") as same:
                for name, variable in (data if group == "/" else data[group]).variables.items():
                    assert variable.dimensions == same[name].dims
                    if variable.dimensions:
                        np.testing.assert_array_equal(variable[...], same[name])


@pytest.mark.parametrize("kind", ["steady", "transient", "line", "area"])
def test_a_pressure_in_si_means_one_thing(results, kind):
    """/si holds the stored numbers times their scale, with the unit that is said beside them."""
    with h5py.File(results / f"{kind}.h5") as file:
        assert file["si/solution/pressure"].attrs["units"] == b"Pa"
        assert 1e7 < file["si/solution/pressure"][()].max() < 5e9
        compared = 0
        for group in ("solution", "transient"):
            for name, item in file[f"si/{group}"].items() if group in file["si"] else ():
                stored = file[group][name]
                assert item.attrs["units"] == item.attrs["si_units"] == stored.attrs["si_units"]
                assert item.attrs["si_scale"] == 1
                np.testing.assert_array_equal(item[()], stored[()] * stored.attrs["si_scale"])
                compared += 1
        assert compared >= 6
        missing = [name for name, item in file["solution"].items() if item.attrs["si_scale"] != 1 and item.ndim]
        assert set(missing) <= set(file["si/solution"])


def test_units_and_axes_by_the_library_of_hdf5(results):
    with h5py.File(results / "steady.h5") as file:
        assert file["solution/pressure"].attrs["units"] == b"1"
        assert file["solution/pressure"].attrs["si_units"] == b"Pa"
        assert file["summary/h_min"].attrs["units"] == b"m"
        assert file.attrs["layout"] == 3
    # Both ends of each link, as HDF5 itself follows them.
    with h5py.File(results / "momentum.h5") as file:
        field = file["momentum/u"]
        assert [dim.label for dim in field.dims] == ["", ""]
        assert field.dims[0][0] == file["momentum/x"] == file["solution/x"]
        assert field.dims[1][0] == file["momentum/zeta"]
        assert file["solution/x"].is_scale
        users = {file[user].name for user, _ in file["solution/x"].attrs["REFERENCE_LIST"]}
        assert {"/momentum/u", "/solution/pressure"} <= users
        axes = {int(axis) for user, axis in file["momentum/zeta"].attrs["REFERENCE_LIST"]}
        assert axes == {1}


def values(item, folder):
    """The numbers of a DataItem, in the shape that it says, which is that of the dataset but for ones in front."""
    shape = tuple(map(int, item.get("Dimensions").split()))
    if item.get("Format") == "XML":
        found = np.array(item.text.split(), dtype=float)
    else:
        name, path = item.text.strip().split(":")
        with h5py.File(folder / name) as file:
            found = file[path][()]
            assert isinstance(file.get(path, getlink=True), h5py.HardLink), path
        assert (item.get("NumberType"), item.get("Precision")) == ("Float", "8")
        assert found.dtype == np.float64
    assert (1,) * (len(shape) - found.ndim) + found.shape == shape, item.text
    return found.reshape(shape)


@pytest.mark.path
@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "auto"])
def test_names_what_is_in_the_result(results, kind):
    root = ElementTree.parse(results / f"{kind}.xdmf").getroot()
    assert root.tag == "Xdmf"
    grids = {grid.get("Name"): grid for grid in root.iter("Grid")}
    expected = KINDS[kind][2]
    assert grids.keys() == expected.keys()
    for name, (nodes, fields) in expected.items():
        grid = grids[name]
        assert tuple(map(int, grid.find("Topology").get("Dimensions").split())) == nodes[::-1]
        axes = [values(item, results) for item in grid.find("Geometry")]
        assert tuple(map(len, axes)) == nodes
        assert all((np.diff(axis) > 0).all() for axis in axes)
        found = {field.get("Name"): values(field.find("DataItem"), results) for field in grid.iter("Attribute")}
        assert fields <= found.keys()
        assert all(field.get("Center") == "Node" for field in grid.iter("Attribute"))
        assert all(field.shape == nodes[::-1] for field in found.values())


def test_takes_no_place_that_is_not_its_own(asperity, tmp_path):
    write(tmp_path, "a.nml", STEADY + XDMF)
    (tmp_path / "a.xdmf").write_text("<?xml version='1.0'?>\n<mine/>\n", encoding="utf-8")
    done = ended(asperity("a.nml"), 1)
    assert "a.nml: found a.xdmf as its XDMF file, which is there and no XDMF file of asperity, expected another" in done.stderr
    (tmp_path / "a.xdmf").unlink()
    assert asperity("a.nml", "--quiet").returncode == 0
    first = (tmp_path / "a.xdmf").read_bytes()
    assert asperity("a.nml", "--quiet").returncode == 0
    assert (tmp_path / "a.xdmf").read_bytes() == first
    write(tmp_path, "a.xdmf", STEADY)
    write(tmp_path, "b.nml", (STEADY + XDMF).replace("&case", "&case output = 'a.h5',"))
    assert "found the namelist a.xdmf as its XDMF file" in asperity("b.nml", "a.xdmf", "--check").stderr


def test_places_and_names_of_xdmf(run_case, tmp_path, asperity):
    run_case((STEADY + XDMF).replace("&case", "&case output = 'oil & <steel>.h5',"), "--quiet", name="a")
    items = list(ElementTree.parse(tmp_path / "oil & <steel>.xdmf").getroot().iter("DataItem"))
    assert any(item.text.strip() == "oil & <steel>.h5:/solution/pressure" for item in items)
    write(tmp_path, "a.nml", STEADY + XDMF)
    (tmp_path / "a.xdmf").mkdir()
    assert "a.xdmf" in ended(asperity("a.nml", "--quiet"), 3).stderr
    assert (tmp_path / "a.h5").is_file()
    assert not list(tmp_path.glob("*.part"))
