"""Result files: layout, labels, units, reproduction, exit status, and that nothing half-written looks like a result."""

import os
import re
import resource
import signal
import subprocess
from functools import partial

import h5py
import numpy as np
import pytest
from cases import LONG, MOES, POINT, STEADY, TRANSIENT, called, contents, ended, same_bits, text, write
from kill_and_resume import wait_for

FRICTION = ["friction_coefficient", "rolling_friction_coefficient", "sliding_power", "rolling_power"]
SLIDING = {"friction_coefficient", "sliding_power"}
NUMBERS = ["time", "rigid_displacement", "h_min", "p_max", *FRICTION, "residual"]
SERIES = [*NUMBERS, "profile_time", "pressure", "film_thickness"]
FIGURES = ["h_min", "h_min_node", "h_central", "p_max", "x_cavitation"]
IN_TIME = "&time transient = .true., end_time = 1.0, time_step = 0.05 /\n"
RESULTS = ["steady", "transient", "moes", "moes_transient"]


@pytest.fixture(scope="module")
def results(solve_all):
    """Results of a steady and a transient case, and of both by Moes' numbers, each run once."""
    passage = TRANSIENT.replace("\n", "\r\n")  # kept as it is
    return solve_all({"steady": STEADY, "transient": passage, "moes": MOES, "moes_transient": MOES + IN_TIME})


@pytest.mark.path
@pytest.mark.parametrize("name", RESULTS)
def test_nothing_is_nan_without_a_reason(results, name):
    """No dataset holds a NaN, and where an attribute is one `no_estimate` stands beside it: what is not known is left out."""

    def visit(path, item):
        if isinstance(item, h5py.Dataset) and item.dtype.kind == "f":
            assert np.isfinite(item[()]).all(), path
        for key, value in item.attrs.items():
            if np.asarray(value).dtype.kind == "f" and not np.isfinite(value).all():
                assert text(item.attrs["no_estimate"]), f"{path}@{key}"

    with h5py.File(results / f"{name}.h5") as file:
        file.visititems(visit)
        expected = set(FRICTION) - (SLIDING if "moes" in name else set())
        for group in {"summary", "transient"} & set(file):
            assert set(FRICTION) & set(file[group]) == expected


SPIKE = "a pressure spike that this grid does not resolve may pass the largest pressure on finer grids, or grow without a limit"


@pytest.mark.path
@pytest.mark.parametrize(
    ("extra", "names", "reason"),
    [
        ("&accuracy error_bars = .false. /", FIGURES, "no coarser grids are compared"),
        ("&solver method = 'block_jacobi', max_cycles = 1 /", FIGURES, "no solution"),
        ("", ["p_max"], SPIKE),
    ],
)
def test_missing_estimate_has_a_reason(asperity, tmp_path, extra, names, reason):
    moes = "&moes moes_m = 50, moes_l = 20, velocity = 'sum' /\n&lubricant viscosity_law = 'barus', density_law = 'constant' /\n"
    write(tmp_path, "case.nml", f"&case problem = 'ehl_line' /\n{moes}&domain intervals = 512 /\n{extra}\n")
    asperity("case.nml", "--quiet")
    with h5py.File(tmp_path / "case.h5") as file:
        for name in FIGURES:
            figure = file["summary"][name]
            assert np.isnan(figure.attrs["error_estimate"]) == (name in names), name
            if name in names:
                assert text(figure.attrs["no_estimate"]) == reason


def test_figures_are_those_of_the_fields(results):
    with h5py.File(results / "steady.h5") as file:
        film, pressure, x = (file["solution"][name] for name in ("film_thickness", "pressure", "x"))
        summary = file["summary"]
        assert summary["h_min_node"][()] == film[()].min() * film.attrs["si_scale"]
        assert summary["p_max"][()] == pressure[()].max() * pressure.attrs["si_scale"]
        assert summary["h_min"].attrs["dimensionless"] <= film[()].min()
        assert summary["h_central"].attrs["dimensionless"] == pytest.approx(np.interp(0, x[()], film[()]), rel=1e-14)
        exit_node = x[()][pressure[()] > 0][-1]
        assert summary["x_cavitation"].attrs["dimensionless"] == exit_node
        between = summary["x_cavitation_extrapolated"].attrs["dimensionless"]
        assert exit_node < between < exit_node + 2 * (x[1] - x[0])
        # the exit of Case 1 on ever finer grids
        assert between == pytest.approx(1.22074, abs=0.05 * (x[1] - x[0]))


@pytest.mark.path
def test_transient_result_has_every_step(results):
    with h5py.File(results / "transient.h5") as file:
        assert file["input/namelist"][()] == (results / "transient.nml").read_bytes()
        series = file["transient"]
        assert set(SERIES) <= set(series)
        nt, nx = 21, 257
        assert series["time"][()] == pytest.approx(np.linspace(0, 1, nt), abs=1e-14)
        assert series["pressure"].shape == series["film_thickness"].shape == (nt, nx)
        assert all(series[name].shape == (nt,) for name in ("rigid_displacement", "h_min", "p_max"))
        assert same_bits(series["pressure"][-1], file["solution/pressure"][()])
        assert same_bits(series["film_thickness"][-1], file["solution/film_thickness"][()])
        summary = file["summary"]
        step = int(np.argmin(series["h_min"]))
        assert summary["h_min"].attrs["dimensionless"] == series["h_min"][step]
        assert summary["h_min_time"].attrs["dimensionless"] == series["time"][step]
        assert text(summary["h_min_time"].attrs["units"]) == "s"
        assert summary["p_max"].attrs["dimensionless"] == series["pressure"][()].max()
        assert summary["p_max_time"].attrs["dimensionless"] == series["time"][int(np.argmax(series["p_max"]))]
        # At every step sliding power is friction times load times speed difference; the largest are those of /summary, to the bit.
        load, difference, si = 1e5, 1.1 - 0.1, file["si/transient"]
        for name in FRICTION:
            assert series[name].shape == (21,)
            assert np.ptp(series[name]) > 0
            assert summary[name].attrs["dimensionless"] == series[name][()].max()
            assert summary[f"{name}_time"].attrs["dimensionless"] == series["time"][int(np.argmax(series[name]))]
            assert text(si[name].attrs["units"]) == text(summary[name].attrs["units"])
        power = si["friction_coefficient"][()] * load * difference
        np.testing.assert_allclose(si["sliding_power"][()], power, rtol=1e-12)  # rounding
        assert text(si["rolling_power"].attrs["units"]) == "W/m"


@pytest.mark.path
def test_inlet_that_the_program_chooses(solved_cases):
    case = "&case problem = 'ehl_line' / &moes moes_m = 1.0, moes_l = 5.0, velocity = 'sum' /\n"
    case += "&lubricant viscosity_law = 'barus', density_law = 'constant' /\n"
    far, near = solved_cases(far=case, near=case + "&domain grid = 'even', intervals = 2048 /\n")
    assert text(far["input/effective/domain"].attrs["grid"]) == "graded"
    assert text(near["input/effective/domain"].attrs["grid"]) == "even"
    assert far["input/effective/domain"].attrs["x_inlet"] < 3 * near["input/effective/domain"].attrs["x_inlet"] < 0
    assert np.ptp(np.diff(far["solution/x"][()])) > 1
    assert np.ptp(np.diff(near["solution/x"][()])) < 1e-9
    assert far["input/effective/domain"].attrs["intervals"] == far["solution/x"].size - 1
    films = [file["summary/h_min"].attrs["dimensionless"] for file in (far, near)]
    errors = [file["summary/h_min"].attrs["error_estimate"] / film for file, film in zip((far, near), films, strict=True)]
    # each within its own estimate of the truth
    assert abs(films[0] - films[1]) < (errors[0] + errors[1]) * films[1] < 0.02 * films[1]


@pytest.mark.path
def test_shear_stresses_at_the_times_of_the_profiles(solved_cases):
    """By their definition from the stored film and pressure, at every stored time; those of the last one are in /solution."""
    fields = "'pressure', 'film_thickness', 'shear_stress_1', 'shear_stress_mean', 'shear_stress_2'"
    file, plain = solved_cases(a=TRANSIENT + f"&output profile_stride = 5, fields = {fields} /\n", b=TRANSIENT)
    series = file["transient"]
    x, p, h = (series[name][()] for name in ("x", "pressure", "film_thickness"))
    first, mean, second = (series[f"shear_stress_{which}"][()] for which in (1, "mean", 2))
    assert first.shape == mean.shape == second.shape == (5, 257)
    wet = p > 0
    wet[:, [0, -1]] = False  # one-sided slopes there
    drive = h * np.gradient(p, x, axis=1)
    rounding = 1e-12 * np.abs(drive).max()
    np.testing.assert_allclose((second - first)[wet], drive[wet], rtol=1e-10, atol=rounding)
    np.testing.assert_allclose((second + first)[wet], 2 * mean[wet], rtol=1e-10, atol=rounding)
    assert not mean[:, 1:][p[:, 1:] == 0].any()
    # The sum of the result has the oil in front of the domain too, and half of the last interval: 0.18 % here.
    load = (x[1] - x[0]) * mean.sum(axis=1) * 2 / np.pi
    np.testing.assert_allclose(load, series["friction_coefficient"][::5], rtol=0.003)
    for name in ("shear_stress_1", "shear_stress_mean", "shear_stress_2"):
        np.testing.assert_array_equal(series[name][-1], plain["solution"][name])
        assert text(file[f"si/transient/{name}"].attrs["units"]) == "Pa"
        assert name not in plain["transient"]


@pytest.mark.path
def test_missing_folder_is_status_3(asperity, tmp_path):
    """As is a folder in the place of the result, and one that takes no files."""
    write(tmp_path, "a.nml", STEADY)
    assert "cannot write /proc/a.h5" in ended(asperity("a.nml", "--output", "/proc"), 3).stderr
    write(tmp_path, "b.nml", STEADY.replace("problem", "output = 'missing/a.h5', problem"))
    write(tmp_path, "file", "")
    for arguments in (("b.nml",), ("a.nml", "--output", "file/missing")):
        done = ended(asperity(*arguments), 3)
        assert "missing/a.h5" in done.stderr
        assert "there is no folder " in done.stderr
        assert not (tmp_path / "missing").exists()
    (tmp_path / "a.h5").mkdir()
    assert "a.h5: it is a folder" in ended(asperity("a.nml", "--quiet"), 3).stderr
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.h5", "a.nml", "b.nml", "file"]


def test_read_only_folder_is_status_3(program, tmp_path):
    if os.geteuid() == 0:
        pytest.skip("not applicable: root writes to read-only folders")
    write(tmp_path, "a.nml", STEADY)
    folder = tmp_path / "locked"
    folder.mkdir(mode=0o555)
    assert "Permission denied" in ended(called([program, "a.nml", "--output", "locked"], cwd=tmp_path), 3).stderr


def test_full_disk_is_status_3_and_keeps_the_older_result(program, tmp_path):
    """A limit on the file size stands for the full disk: both show up in a write, the first late in the run."""
    write(tmp_path, "a.nml", STEADY)
    subprocess.run([program, "a.nml", "--quiet"], cwd=tmp_path, check=True)
    older = (tmp_path / "a.h5").read_bytes()
    write(tmp_path, "a.nml", TRANSIENT.replace("time_step = 0.05", "time_step = 0.01"))
    for limit in (0, 3000, 60_000, 200_000):
        limited = partial(resource.setrlimit, resource.RLIMIT_FSIZE, (limit, limit))
        done = ended(called([program, "a.nml", "--quiet"], cwd=tmp_path, preexec_fn=limited), 3)
        assert "cannot write a.h5." in done.stderr
        assert "limit on the size of files is reached" in done.stderr
        assert (tmp_path / "a.h5").read_bytes() == older
        assert sorted(path.name for path in tmp_path.iterdir()) == ["a.h5", "a.nml"]


# Time steps, and trial runs before them.
TRIALS = POINT.replace("&domain intervals_x = 64 /", "&time transient = .true., end_time = 50.0 /\n&accuracy target = 1e-3 /")


@pytest.mark.parametrize(("case", "least"), [(LONG, 1), (TRIALS, 0)])
def test_two_runs_do_not_write_one_file(program, asperity, tmp_path, case, least):
    write(tmp_path, "a.nml", case)
    with subprocess.Popen([program, "a.nml", "--quiet"], cwd=tmp_path) as running:
        wait_for(tmp_path / "a.h5.part", running, size=least)
        second = asperity("a.nml", "--quiet")
        size = (tmp_path / "a.h5.part").stat().st_size
        running.send_signal(signal.SIGKILL)
    assert second.returncode == 3
    assert second.stderr == "asperity: cannot write a.h5: another run is writing a.h5.part\n"
    assert size >= least


def test_who_reads_a_part_does_not_stop_the_run(asperity, tmp_path):
    """HDF5 locks what it reads, here a file that a killed run has left."""
    write(tmp_path, "a.nml", TRANSIENT)
    with h5py.File(tmp_path / "a.h5.part", "w") as part:
        part.attrs["program"] = np.bytes_("asperity")
    with h5py.File(tmp_path / "a.h5.part") as part:
        done = asperity("a.nml", "--quiet")
        assert part.id.valid
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "a.h5").exists()


def test_part_of_a_killed_run_is_replaced(run_case, asperity, tmp_path):
    """Also one of a run that was killed before it wrote anything, or while it began."""
    run_case(STEADY, "--quiet", name="a")
    head = (tmp_path / "a.h5").read_bytes()
    for left in (b"", head[:96], head[:96] + bytes(744) + head[840:872], head[:5000]):
        (tmp_path / "a.h5.part").write_bytes(left)
        ended(asperity("a.nml", "--quiet"))
        assert sorted(path.name for path in tmp_path.iterdir()) == ["a.h5", "a.nml"]


OUTPUT_KEYS = (
    "profile_stride = 3, si_copies = .false.",
    "profile_stride = 1000, xdmf = .true.",
    "fields = 'pressure', velocity_layers = 4",
    "fields = 'shear_stress_2', 'shear_stress_1', 'shear_stress_mean'",
    "fields = 'film_thickness', 'pressure', profile_stride = 7",
    "checkpoint_interval = 0.0, adequacy = .false.",
    "checkpoint_interval = 0.0, profile_stride = 50, film_thresholds = 3e-7",
)


@pytest.mark.parametrize("others", ["", "&accuracy target = 1e-2 /\n"])
def test_no_output_key_changes_a_number(asperity, tmp_path, others):
    """Every step counts, whatever is stored: figures, their estimates and all series of single numbers, to the bit."""
    ridge = "&surface_2 shape = 'feature', amplitude = 2e-7, wavelength = 1e-4, position = -2.0 /\n"
    time_step, case = ("", STEADY.replace("intervals = 256", "")) if others else (", time_step = 0.02", STEADY)
    passage = case + ridge + f"&time transient = .true., end_time = 1.6{time_step} /\n" + others
    write(tmp_path, "plain.nml", passage)
    for i, keys in enumerate(OUTPUT_KEYS):
        write(tmp_path, f"keys{i}.nml", passage + f"&output {keys} /\n")
    files = [f"keys{i}" for i in range(len(OUTPUT_KEYS))]
    assert asperity("plain.nml", *(f"{name}.nml" for name in files), "--quiet").returncode == 0
    expected = contents(tmp_path / "plain.h5")
    numbers = [path for path in expected if path.startswith("summary") or path in {f"transient/{name}" for name in NUMBERS}]
    assert len(numbers) > 40
    for name in files:
        found = contents(tmp_path / f"{name}.h5")
        assert {path for path in found if path.startswith("summary")} == {path for path in numbers if path.startswith("summary")}
        assert [path for path in numbers if not same_bits(found[path], expected[path])] == [], name
    with h5py.File(tmp_path / "plain.h5") as file, h5py.File(tmp_path / "keys1.h5") as strided:
        assert strided["summary/h_min"].attrs["dimensionless"] == file["transient/h_min"][()].min()
        assert strided["transient/pressure"].shape[0] == len(strided["transient/profile_time"]) == 1
        assert 0 < strided["summary/h_min"].attrs["error_grid"] < 0.2 * strided["summary/h_min"][()]


def test_a_target_out_of_reach_is_told(run_case, tmp_path):
    """Trial runs end at a bound of their work; the run is then done as well as they know, and says what it shows."""
    case = TRANSIENT.replace(", time_step = 0.05", "").replace("end_time = 1.0", "end_time = 0.1")
    case = "\n".join(line for line in case.splitlines() if not line.startswith("&domain"))
    done = run_case(case + "\n&domain x_inlet = -4.0, x_outlet = 1.5 /\n&accuracy target = 1e-7 /\n", "--verbose")
    with h5py.File(tmp_path / "case.h5") as file:
        note, h_min = text(file["report/note"][()]), file["summary/h_min"]
        found = h_min.attrs["error_grid"] / h_min[()]
        assert file.attrs["converged"] == 1
    passage, note = note.split("; the target")
    assert f"case.nml: the target{note}\n" in done.stderr
    assert passage.startswith("a feature is still in the contact")
    assert passage in " ".join(done.stdout.split())
    told = re.fullmatch(r" accuracy is not shown: a relative error of h_min of (\S+) is estimated, 1\.0E-07 is the target", note)
    assert 1e-7 < float(told[1]) == pytest.approx(found, rel=0.05)
