"""The Python package: the program called from Python, its results in SI; the wheel that carries both; a plain `fpm install`."""

import os
import re
import shutil
import subprocess
import sys
import tomllib
import zipfile

import asperity
import f90nml
import h5py
import numpy as np
import pytest
from cases import ROOT, called, ended
from PIL import Image

MINIMAL = ROOT / "input" / "minimal.nml"


pytestmark = pytest.mark.usefixtures("package")


@pytest.fixture
def minimal():
    return asperity.run(MINIMAL)


def test_a_path_a_text_and_a_mapping_are_the_same_case(minimal):
    groups = f90nml.read(MINIMAL)
    for case in (str(MINIMAL), MINIMAL.read_text(encoding="utf-8"), groups, groups.todict()):
        np.testing.assert_array_equal(asperity.run(case).pressure, minimal.pressure)
    assert asperity.run(groups).case.todict() == groups.todict()


def test_examples_and_the_version_of_the_program():
    assert asperity.example("minimal.nml") == MINIMAL
    with pytest.raises(asperity.AsperityError, match=r"case1\.nml"):
        asperity.example("none.nml")
    version = tomllib.loads((ROOT / "fpm.toml").read_text())["version"]
    assert re.fullmatch(r"asperity (\S+) \(commit \S+\)", asperity.version())[1] == version


def test_fields_and_summary_are_in_si(minimal, tmp_path):
    result = asperity.run(MINIMAL, folder=tmp_path / "new")
    assert result.path == tmp_path / "new" / "minimal.h5"
    with h5py.File(result.path) as file:
        scaling = file["scaling"].attrs
        np.testing.assert_allclose(result.x, file["solution/x"][()] * scaling["half_width"], rtol=1e-15)
        np.testing.assert_allclose(result.pressure, file["solution/pressure"][()] * scaling["hertz_pressure"], rtol=1e-15)
        np.testing.assert_allclose(result.film, file["solution/film_thickness"][()] * scaling["film_thickness"], rtol=1e-15)
        assert result.summary.h_min.attrs["error_estimate"] == file["summary/h_min"].attrs["error_estimate"]
    assert (result.x.attrs["units"], result.pressure.attrs["units"], result.film.attrs["units"]) == ("m", "Pa", "m")
    assert result.pressure.dims == result.film.dims == ("x",)
    # two definitions of the smallest film: a parabola through three nodes, and the nodes
    assert float(minimal.film.min()) == pytest.approx(float(minimal.summary.h_min), rel=2e-2)
    assert result.converged
    assert result.report["method"]
    assert re.search(r"h_min +\d+(\.\d+)?e-07 m \+- \d", repr(result))
    even = asperity.run(MINIMAL.read_text() + "&domain grid = 'even' /\n")
    assert re.search(r"p_central +5\.81e\+08 Pa \+- 0\.35 %", repr(even))
    assert "p_central" not in repr(asperity.run(ROOT / "input" / "case1.nml"))  # there is no spike


def test_a_passage_has_time_and_place_as_coordinates():
    case = f90nml.read(ROOT / "input" / "case3_demo.nml")
    case["output"] = {"profile_stride": 7}
    seen = []
    result = asperity.run(case, progress=seen.append)
    film = result.transient.film_thickness
    assert film.dims == ("profile_time", "x")
    assert result.transient.h_min.dims == ("time",)
    assert result.transient.sizes["time"] > 5 * result.transient.sizes["profile_time"]
    np.testing.assert_array_equal(film.isel(profile_time=-1), result.film)
    counts = [(state.done, state.total) for state in seen if state.total]
    assert counts == sorted(counts)
    assert counts[-1][0] == counts[-1][1] > 100


def test_areas_and_loads_of_a_dry_contact():
    result = asperity.run(ROOT / "input" / "dry_area.nml", threads=2)
    assert result.pressure.dims == ("y", "x")
    assert result.sweep.contact_area_fraction.size == 3
    assert float(result.film.min()) >= 0
    assert float(result.pressure.mean()) == pytest.approx(float(result.sweep.mean_pressure[-1]), rel=1e-6)


def test_findings_have_line_group_and_key():
    text = MINIMAL.read_text(encoding="utf-8").replace("0.14", "-1").replace("speed_1", "sped_1")
    findings = asperity.check(text)
    lines = text.splitlines()
    assert {(found.group, found.key) for found in findings} == {
        ("bodies", "sped_1"), ("bodies", "speed_1"), ("lubricant", "viscosity")
    }  # fmt: skip
    for found in findings:
        if found.key in ("sped_1", "viscosity"):
            assert found.key in lines[found.line - 1]
    with pytest.raises(asperity.InputError) as caught:
        asperity.run(text)
    assert caught.value.findings == findings
    assert all(str(found) in str(caught.value) for found in findings)
    assert asperity.check(MINIMAL) == []


def test_what_does_not_converge_is_a_result_with_a_warning():
    case = f90nml.read(MINIMAL)
    case["solver"] = {"max_cycles": 1, "method": "fas_block_jacobi"}
    with pytest.warns(asperity.NotConvergedWarning, match="1 cycle left"):
        result = asperity.run(case)
    assert not result.converged
    assert "NOT CONVERGED" in repr(result)
    assert result.reason
    assert result.outcome == "not converged"
    with pytest.warns(asperity.NotConvergedWarning, match="outside the model: mixed lubrication"):
        result = asperity.run(MINIMAL.read_text(encoding="utf-8").replace("speed_2", "roughness_1 = 1e-6\nspeed_2"))
    assert (result.converged, result.outcome) == (True, "outside the model: mixed")
    assert f"<asperity.Result ehl_line, {result.reason}>" in repr(result)
    assert "  lambda_ratio          0.4914 +- 0.018" in repr(result)


def test_files_of_heights_are_found_from_the_current_folder(tmp_path):
    x = np.linspace(0, 1e-3, 257)
    rows = "\n".join(f"{a:.17g},{b:.17g}" for a, b in zip(x, 1e-7 * np.cos(2 * np.pi * x / 1e-3), strict=True))
    (tmp_path / "heights.csv").write_text(f"x,z\n{rows}\n", encoding="utf-8")
    case = f90nml.read(ROOT / "input" / "dry_profile.nml").todict()
    case["surface_1"] = {"shape": "file", "file": "heights.csv"}
    case["load"] = {"mean_pressure": 1e6}
    case.pop("domain", None)
    assert asperity.check(case) == []
    assert asperity.check(case | {"surface_1": {"shape": "file", "file": "other.csv"}})[0].group == "surface_1"


@pytest.mark.parametrize("content", [b"", b"no HDF5", b"part"])
def test_what_is_no_result(tmp_path, content):
    path = tmp_path / ("a.h5.part" if content == b"part" else "a.h5")
    path.write_bytes(content)
    for read in (asperity.read, asperity.read_part):
        with pytest.raises(asperity.AsperityError, match=re.escape(str(path))):
            read(path)
    with pytest.raises(FileNotFoundError):
        asperity.read(tmp_path / "b.h5")


def command(name, *arguments):
    code = f"import sys; from asperity.commands import {name}; sys.argv[0] = {name!r}; {name}()"
    environment = os.environ | {"MPLBACKEND": "agg"}
    return called([sys.executable, "-c", code, *map(str, arguments)], env=environment)


def test_commands(tmp_path):
    assert command("asperity", MINIMAL, "--quiet").returncode == 0
    assert command("plot", "profile", "minimal.h5", "--format", "png").returncode == 0
    assert np.ptp(np.asarray(Image.open(next(tmp_path.glob("minimal*.png"))))) > 0
    assert "profile" in ended(command("plot", "nothing"), 1).stderr
    assert "sweep" in command("batch", "--help").stdout
    assert command("batch", "gather", "--help").returncode == 0


@pytest.fixture(scope="module")
def wheel(program, tmp_path_factory):
    if program.name != "asperity":
        pytest.skip("not applicable: wheels carry the optimised program")
    folder = tmp_path_factory.mktemp("wheel")
    pip = [sys.executable, "-m", "pip", "wheel", "-q", "--disable-pip-version-check", "--no-build-isolation", "--no-deps"]
    environment = os.environ | {"ASPERITY": str(program), "PATH": f"{sys.prefix}/bin:{os.environ['PATH']}"}
    subprocess.run([*pip, "--wheel-dir", folder / "raw", ROOT], check=True, env=environment)
    raw = next((folder / "raw").glob("*.whl"))
    subprocess.run([sys.executable, "-m", "auditwheel", "repair", "-w", folder, raw], check=True, env=environment)
    return next(folder.glob("*.whl"))


@pytest.mark.nightly
def test_the_wheel_carries_program_and_scripts(wheel):
    assert re.fullmatch(r"asperity-[\d.]+-py3-none-manylinux_2_\d+_\w+(\.manylinux\w+)*\.whl", wheel.name)
    names = zipfile.ZipFile(wheel).namelist()
    carried = {"bin/asperity", "postproc/profile.py", "batch/sweep.py", "py.typed", "input/minimal.nml"}
    assert {f"asperity/{name}" for name in carried} <= set(names)
    assert any(re.match(r"asperity\.libs/libgomp-.*\.so", name) for name in names)  # of others what is not in the program


@pytest.mark.nightly
def test_the_wheel_runs_where_there_is_only_python(wheel):
    if os.geteuid() != 0:
        pytest.skip("not applicable: a new root folder needs root")
    done = called([ROOT / "python" / "packaging" / "try_wheel.sh", wheel], cwd=ROOT)  # fmt: skip
    if "mount: " in done.stderr:
        pytest.skip("not applicable: no mounts here: " + done.stderr.splitlines()[-1])
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == "OK"
    assert "libhdf5" not in done.stdout


def git(*words):
    """What git prints of this checkout; a tarball is none, and a machine may have no git."""
    if not shutil.which("git") or not (ROOT / ".git").exists():
        pytest.skip("not applicable: no checkout of git")
    return subprocess.run(["git", *words], cwd=ROOT, capture_output=True, check=True).stdout


@pytest.mark.nightly
def test_a_plain_fpm_install_from_a_tarball(program, tmp_path):
    """Without make, with the flags that fpm has for itself: all shipped cases pass the checks, one of each kind runs."""
    if program.name != "asperity":
        pytest.skip("not applicable: once is enough")
    for name in git("ls-files", "app", "src", "tools/*.inc", "tools/*.f03", "fpm.toml", "input", "test/data").decode().split():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    environment = {**os.environ, "PATH": f"{sys.prefix}/bin:{os.environ['PATH']}"}
    if (ROOT / ".pc").is_dir():  # of two HDF5 libraries, the serial one
        environment["PKG_CONFIG_PATH"] = str(ROOT / ".pc")
    command = ["fpm", "install", "--prefix", tmp_path / "there"]
    subprocess.run(command, cwd=tmp_path, env=environment, check=True, capture_output=True)
    plain = tmp_path / "there" / "bin" / "asperity"
    assert "commit unknown" in subprocess.run([plain, "--version"], capture_output=True, text=True, check=True).stdout
    cases = sorted((tmp_path / "input").rglob("*.nml"))
    subprocess.run([plain, "--check", *cases], check=True, capture_output=True)
    for name in ("minimal", "dry_profile", "scenes/10_run_in"):
        ended(called([plain, tmp_path / "input" / f"{name}.nml"], cwd=tmp_path))


def test_a_tarball_names_its_commit(tmp_path):
    (tmp_path / "a.tar").write_bytes(git("archive", "HEAD", "tools/git_commit.inc"))
    subprocess.run(["tar", "xf", "a.tar"], cwd=tmp_path, check=True)
    found = re.fullmatch(r"commit = '([0-9a-f]+)'\n", (tmp_path / "tools" / "git_commit.inc").read_text())
    assert git("rev-parse", "HEAD").decode().startswith(found[1])
