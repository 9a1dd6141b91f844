"""`&output xdmf`: a file beside the result in which ParaView finds its fields. What it names is in the result, with these axes.

The rules of ParaView's reader (vtkXdmfReader of vtk 9): a dataset is not reached through a link, and a field has as many extents
as the topology of its grid; of one with fewer it reads the first numbers only, without a word.
"""

from xml.etree import ElementTree

import h5py
import numpy as np
import pytest
from cases import MOES, POINT, STEADY, STOKES, TRANSIENT, ended, write
from dry_cases import case_text

LEAN = "&accuracy error_bars = .false. /\n&output xdmf = .true., adequacy = .false. /\n"
COARSE = STOKES.replace("256", "64") + "&film layers = 6 /\n"
SYNTHETIC = "shape = 'synthetic', seed = 1, rms_height = 1e-6, wavelength_short = 2e-4"
SIZE = "&domain length_x = 1e-3, length_y = 0.75e-3, intervals_x = 32, intervals_y = 24 /"
LINE = "&domain length = 1e-3, intervals = 64 /"
# Namelist; nodes of each grid along x, y and z; some of its fields.
STILL, IN_TIME = ((257, 1, 1), {"pressure", "film_thickness"}), ((257, 21, 1), {"pressure", "film_thickness"})
RIDGE = "&surface_2 shape = 'feature', amplitude = 0.2e-6, wavelength = 1e-4, position = -2.1 /\n"
DENT = """&surface_1 shape = 'feature', amplitude = -5e-8, wavelength = 2e-4, wavelength_y = 2e-4 /
&time transient = .true., end_time = 0.6, time_step = 0.2 /
"""
LAYERS = {"solution": ((65, 1, 1), {"pressure"})}
AREAS = {"pressure", "gap", "height_loaded", "height_unloaded", "plastic_deformation"}
KINDS = {
    "point": (POINT + LEAN.replace(", adequacy = .false.", ""), {"solution": ((65, 97, 1), {"pressure", "film_thickness"})}),
    "point in time": (
        POINT.replace("intervals_x = 64", "intervals_x = 32") + DENT + LEAN.replace(", adequacy = .false.", ""),
        {"solution": ((33, 49, 1), {"roughness_1"}), "transient": ((33, 49, 4), {"pressure", "film_thickness"})},
    ),
    "steady": (STEADY + LEAN, {"solution": ((257, 1, 1), {"pressure", "film_thickness", "shear_stress_1"})}),
    "passage": (TRANSIENT + LEAN, {"solution": ((257, 1, 1), {"pressure"}), "transient": IN_TIME}),
    "moes": (MOES + LEAN, {"solution": STILL}),
    "velocity": (STEADY + LEAN.replace("xdmf", "velocity_layers = 4, xdmf"), {"solution": STILL, "velocity": ((5, 257, 1), {"u"})}),
    "momentum": (COARSE + LEAN, LAYERS | {"momentum": ((6, 65, 1), {"u", "w", "layer_pressure", "shear_stress", "viscosity"})}),
    "momentum in time": (
        COARSE + RIDGE + "&time transient = .true., end_time = 0.3, time_step = 0.05 /\n" + LEAN,
        LAYERS
        | {"transient": ((65, 7, 1), {"pressure"}), "momentum": ((6, 65, 1), {"u", "w"})}
        | {"momentum/transient": ((65, 7, 1), {"pressure", "film_thickness"})},
    ),
    "line": (case_text(SYNTHETIC, [1e8], more=LINE + LEAN), {"solution": ((64, 1, 1), {"pressure", "gap", "height_undeformed"})}),
    "area": (case_text(SYNTHETIC, [1e8], more=SIZE + LEAN, problem="dry_area"), {"solution": ((32, 24, 1), AREAS)}),
}


@pytest.fixture(scope="module", name="results")
def _results(solve_all):
    return solve_all({name: content for name, (content, _) in KINDS.items()})


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
@pytest.mark.parametrize("kind", KINDS)
def test_names_what_is_in_the_result(results, kind):
    root = ElementTree.parse(results / f"{kind}.xdmf").getroot()
    assert root.tag == "Xdmf"
    grids = {grid.get("Name"): grid for grid in root.iter("Grid")}
    expected = KINDS[kind][1]
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
    write(tmp_path, "a.nml", STEADY + LEAN)
    (tmp_path / "a.xdmf").write_text("<?xml version='1.0'?>\n<mine/>\n", encoding="utf-8")
    done = ended(asperity("a.nml"), 1)
    assert "a.nml: found a.xdmf as its XDMF file, which is there and no XDMF file of asperity, expected another" in done.stderr
    (tmp_path / "a.xdmf").unlink()
    assert asperity("a.nml", "--quiet").returncode == 0
    first = (tmp_path / "a.xdmf").read_bytes()
    assert asperity("a.nml", "--quiet").returncode == 0
    assert (tmp_path / "a.xdmf").read_bytes() == first
    write(tmp_path, "a.xdmf", STEADY)
    write(tmp_path, "b.nml", (STEADY + LEAN).replace("&case", "&case output = 'a.h5',"))
    assert "found the namelist a.xdmf as its XDMF file" in asperity("b.nml", "a.xdmf", "--check").stderr


def test_places_and_names_of_xdmf(run_case, tmp_path, asperity):
    run_case((STEADY + LEAN).replace("&case", "&case output = 'oil & <steel>.h5',"), "--quiet", name="a")
    items = list(ElementTree.parse(tmp_path / "oil & <steel>.xdmf").getroot().iter("DataItem"))
    assert any(item.text.strip() == "oil & <steel>.h5:/solution/pressure" for item in items)
    write(tmp_path, "a.nml", STEADY + LEAN)
    (tmp_path / "a.xdmf").mkdir()
    assert "a.xdmf" in ended(asperity("a.nml", "--quiet"), 3).stderr
    assert (tmp_path / "a.h5").is_file()
    assert not list(tmp_path.glob("*.part"))
