"""Axes, units and names of every group of every kind of result, as xarray and netCDF4 see them."""

import warnings

import cases
import h5py
import numpy as np
import pytest

LEAN = "&accuracy error_bars = .false. /&output adequacy = .false. /"
PASSAGE = cases.TRANSIENT.replace("time_step = 0.05", "time_step = 0.05, scheme = 'bdf2'")
AUTO = (
    PASSAGE.replace("problem = 'ehl_line'", "problem = 'ehl_line', model = 'auto'")
    .replace(", intervals = 256", "")
    .replace(", time_step = 0.05", "")
    + "&accuracy target = 0.05 /"
)
DRY = """&case problem = 'dry_{kind}' /
&bodies youngs_modulus_1 = 210e9, poisson_ratio_1 = 0.3, hardness = 3e9 /
&load mean_pressure = 1e7, 3e7, 2e7 /
&surface_1 shape = 'synthetic', rms_height = 0.5e-6, hurst = 0.8, wavelength_long = 1e-4, wavelength_short = 2e-5, seed = 4 /
"""
LINE = DRY.format(kind="line") + "&domain length = 4e-4, intervals = 128 /"
AREA = DRY.format(kind="area") + "&domain length_x = 2e-4, length_y = 2e-4, intervals_x = 32, intervals_y = 24 /"
X = {"x": 257}
KINDS = {
    "steady": (
        cases.STEADY + "&output velocity_layers = 4 /",
        {"/solution": X, "/si/solution": X, "/velocity": {"x": 257, "zeta": 5}},
    ),
    "dimensionless": (cases.MOES, {"/solution": X}),
    "transient": (
        PASSAGE + "&accuracy error_bars = .false. /&output profile_stride = 4, film_thresholds = 1e-7, 2e-7, adequacy = .false. /",
        {"/transient": {"time": 21, "profile_time": 6, **X}, "/si/transient": {"time": 21, "profile_time": 6, **X}},
    ),
    "momentum": (cases.STOKES + "&film layers = 6 /" + LEAN, {"/momentum": {"zeta": 6, **X}}),
    "momentum in time": (
        cases.STOKES
        + "&surface_2 shape = 'feature', amplitude = 0.2e-6, wavelength = 1e-4, position = -2.1 /&film layers = 6 /"
        + "&time transient = .true., end_time = 0.3, time_step = 0.05 /&accuracy error_bars = .false. /"
        + "&output profile_stride = 3, adequacy = .false. /",
        {"/momentum/transient": {"time": 7, "profile_time": 3, **X}, "/transient": {"time": 7, "profile_time": 3, **X}},
    ),
    "auto": (AUTO, {"/solution": {"x": 129}, "/adequacy/decision/roughness": {}}),
    "line": (LINE, {"/solution": {"x": 128}, "/si/solution": {"x": 128}, "/sweep": {"step": 3}}),
    "area": (AREA, {"/solution": {"x": 32, "y": 24}, "/sweep": {"step": 3}}),
}


@pytest.fixture(scope="module", name="results")
def _results(solve_all):
    return solve_all({name: text for name, (text, _) in KINDS.items()})


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
