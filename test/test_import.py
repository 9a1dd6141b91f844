"""Import of measured topographies: with SurfaceTopography where it is installed, and what is said where it is not."""

import importlib.util
import pathlib
import subprocess
import sys

import h5py
import numpy as np
import pytest
from dry_cases import solve

SCRIPT = pathlib.Path(__file__).resolve().parent.parent / "tools" / "import_topography.py"


def call(*arguments, cwd):
    """Runs the script."""
    return subprocess.run([sys.executable, str(SCRIPT), *arguments], cwd=cwd, capture_output=True, text=True, check=False)


@pytest.fixture
def library():
    """The module SurfaceTopography."""
    if importlib.util.find_spec("SurfaceTopography") is None:
        pytest.skip("not applicable: SurfaceTopography is not installed (.venv/bin/pip install SurfaceTopography)")
    return importlib.import_module("SurfaceTopography")


def measured(nx=24, ny=16):
    """Heights [µm] on a tilted plane, first index x."""
    x, y = np.arange(nx)[:, None] / nx, np.arange(ny)[None, :] / ny
    return np.cos(2 * np.pi * (2 * x + y)) + 0.5 * np.sin(2 * np.pi * 3 * y) + x


def test_without_the_library_it_is_said(tmp_path):
    # A module of that name that fails stands for one that is missing.
    (tmp_path / "SurfaceTopography.py").write_text("raise ImportError('No module named muFFT')\n", encoding="utf-8")
    command = (
        f"import sys, runpy; sys.path.insert(0, {str(tmp_path)!r}); sys.argv = ['x', 'a.x3p']; "
        f"runpy.run_path({str(SCRIPT)!r}, run_name='__main__')"
    )
    done = subprocess.run([sys.executable, "-c", command], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert done.stderr.startswith("import_topography.py: needs the library SurfaceTopography (No module named muFFT): install it")
    assert not (tmp_path / "heights.h5").exists()


@pytest.mark.parametrize("ending", ["nc", "x3p"])
def test_area_of_an_instrument(library, asperity, tmp_path, ending):
    z = measured()
    topography = library.Topography(z, (48.0, 64.0), unit="µm")
    {"nc": topography.to_netcdf, "x3p": topography.to_x3p}[ending](str(tmp_path / f"scan.{ending}"))
    done = call(f"scan.{ending}", "--output", "scan.h5", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert "24 x 16 nodes, 4.8e-05 m x 6.4e-05 m" in done.stdout
    with h5py.File(tmp_path / "scan.h5") as file:
        np.testing.assert_allclose(file["z"][()], z.T * 1e-6, rtol=0, atol=1e-14)
        assert file["z"].attrs["spacing_x"] == pytest.approx(2e-6)
        assert file["z"].attrs["spacing_y"] == pytest.approx(4e-6)
    with solve(
        asperity, tmp_path, "shape = 'file', file = 'scan.h5', dataset = 'z', detrend = 'none'", [1e8], problem="dry_area"
    ) as file:
        np.testing.assert_allclose(file["solution/height_undeformed"][()], z.T * 1e-6, rtol=0, atol=1e-14)
        assert file["solution/y"][-1] == pytest.approx(60e-6)


def test_tilt_is_taken_off(library, tmp_path):
    library.Topography(measured(), (48.0, 64.0), unit="µm").to_netcdf(str(tmp_path / "scan.nc"))
    assert call("scan.nc", "--detrend", "tilt", cwd=tmp_path).returncode == 0
    with h5py.File(tmp_path / "heights.h5") as file:
        z = file["z"][()]
    x, y = np.meshgrid(np.arange(24), np.arange(16))
    assert abs(np.corrcoef(x.ravel(), z.ravel())[0, 1]) < 0.05
    assert abs(z.mean()) < 1e-9
    assert y.shape == z.shape


def test_gaps_are_an_error_unless_filled(library, tmp_path):
    z = measured()
    holes = np.ma.masked_array(z, mask=np.zeros_like(z, dtype=bool))
    holes[5:7, 3] = np.ma.masked
    library.Topography(holes, (48.0, 64.0), unit="µm").to_netcdf(str(tmp_path / "scan.nc"))
    done = call("scan.nc", cwd=tmp_path)
    assert done.returncode == 1
    assert "2 points were not measured" in done.stderr
    assert not (tmp_path / "heights.h5").exists()
    assert call("scan.nc", "--fill", cwd=tmp_path).returncode == 0
    with h5py.File(tmp_path / "heights.h5") as file:
        filled = file["z"][()].T * 1e6
    np.testing.assert_allclose(filled[~holes.mask], z[~holes.mask], atol=1e-9)
    assert np.all(np.abs(filled - z) < 1)


def test_files_that_are_none(library, tmp_path):
    assert library is not None
    done = call("none.x3p", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (1, "import_topography.py: none.x3p: no such file\n")
    (tmp_path / "text.x3p").write_text("no topography\n", encoding="utf-8")
    done = call("text.x3p", cwd=tmp_path)
    assert done.returncode == 1
    assert "text.x3p: no format that SurfaceTopography reads" in done.stderr
    library.Topography(measured(), (48.0, 64.0), unit="µm").to_netcdf(str(tmp_path / "scan.nc"))
    assert call("scan.nc", "--list", cwd=tmp_path).stdout.startswith("0  Default  ")
    assert "found no channel 3, expected 0 to 0" in call("scan.nc", "--channel", "3", cwd=tmp_path).stderr


TABLES = {
    "commas": ("x,z\n" + "".join(f"{i * 0.5},{(i % 3) * 0.1}\n" for i in range(20)), ["--unit", "mm,um"], 5e-4, 1e-7),
    "decimal commas": (
        "".join(f"{i * 0.5};{(i % 3) * 0.1:.1f}\n".replace(".", ",") for i in range(20)),
        ["--unit", "um,nm"],
        5e-7,
        1e-10,
    ),
    "blanks": (
        "# by hand\n" + "".join(f" {i * 0.5}  7 {(i % 3) * 0.1}\n" for i in range(20)),
        ["--unit", "um", "--column", "3"],
        5e-7,
        1e-7,
    ),
    "no positions": ("".join(f"{(i % 3) * 0.1}\n" for i in range(20)), ["--unit", "um,nm", "--spacing", "0.5"], 5e-7, 1e-10),
}


@pytest.mark.parametrize("name", TABLES)
def test_plain_columns(asperity, tmp_path, name):
    """Without the library, and the program reads what was written."""
    table, options, spacing, step = TABLES[name]
    (tmp_path / "scan.txt").write_text(table, encoding="utf-8")
    done = call("scan.txt", *options, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("heights.h5: 20 nodes, ")
    expected = step * (np.arange(20) % 3)
    with h5py.File(tmp_path / "heights.h5") as file:
        np.testing.assert_allclose(file["z"][()], expected, rtol=1e-12, atol=1e-25)
        assert file["z"].attrs["spacing_x"] == pytest.approx(spacing, rel=1e-12)
    surface = "shape = 'file', file = 'heights.h5', dataset = 'z', detrend = 'none'"
    with solve(asperity, tmp_path, surface, [1e3], "") as file:
        np.testing.assert_allclose(file["solution/height_undeformed"][()], expected, rtol=1e-12, atol=1e-25)


def test_area_of_plain_columns(tmp_path):
    y, x = np.mgrid[0:6, 0:9]
    z = 3.0 + 0.2 * x - 0.1 * y
    np.savetxt(tmp_path / "area.txt", z)
    done = call("area.txt", "--unit", "um", "--spacing", "2", "--detrend", "tilt", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    with h5py.File(tmp_path / "heights.h5") as file:
        assert file["z"].shape == (6, 9)
        assert np.abs(file["z"][()]).max() < 1e-20
        assert file["z"].attrs["spacing_y"] == 2e-6


def test_falling_positions_are_mirrored(tmp_path):
    """As by the program, so that both read the same heights."""
    table = np.column_stack([0.5 * np.arange(20)[::-1] + 3, np.arange(20) ** 2])
    np.savetxt(tmp_path / "scan.txt", table)
    done = call("scan.txt", "--unit", "um,nm", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    with h5py.File(tmp_path / "heights.h5") as file:
        np.testing.assert_allclose(file["z"][()], 1e-9 * np.arange(20)[::-1] ** 2, rtol=1e-12)
        assert file["z"].attrs["spacing_x"] == pytest.approx(5e-7, rel=1e-12)


@pytest.mark.parametrize("positions", ["0 1 3", "3 1 0", "1 1 1", "0 1 0"])
def test_plain_columns_of_uneven_positions(tmp_path, positions):
    (tmp_path / "scan.txt").write_text("".join(f"{x} 1\n" for x in positions.split()), encoding="utf-8")
    assert "neither rise nor fall evenly" in call("scan.txt", "--unit", "mm", cwd=tmp_path).stderr
    assert not (tmp_path / "heights.h5").exists()


def test_plain_columns_that_are_none(tmp_path):
    (tmp_path / "scan.txt").write_text("0 1\n1 2\n2 4\n", encoding="utf-8")
    assert "--unit: found 'mm,furlong'" in call("scan.txt", "--unit", "mm,furlong", cwd=tmp_path).stderr
    (tmp_path / "scan.txt").write_text("0 1\n1 x\n", encoding="utf-8")
    assert "scan.txt:2: could not convert string to float: 'x'" in call("scan.txt", "--unit", "mm", cwd=tmp_path).stderr
    (tmp_path / "scan.txt").write_text("0,5\n1,5\n2,5\n", encoding="utf-8")
    assert "may be numbers with decimal commas" in call("scan.txt", "--unit", "um", "--spacing", "1", cwd=tmp_path).stderr
    assert "with --unit" in call("scan.txt", "--column", "2", cwd=tmp_path).stderr
    assert not (tmp_path / "heights.h5").exists()
