"""Small namelists for end-to-end tests, and helpers to read results."""

import csv
import os
import pathlib
import random
import resource
import subprocess
import sys

import h5py
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent
# Nothing takes so long [s of wall time], however busy the machine is: limits are processor time, wall time guards against hanging.
HANGING = 900


def members(by_day, by_night):
    """How many random members a test has: more with NIGHTLY=1, by .ci/nightly."""
    return by_night if os.environ.get("NIGHTLY") else by_day


STEADY = """&case title = 'Öl, smooth', problem = 'ehl_line' /
&bodies radius_1 = 0.01, radius_2 = 2.0, youngs_modulus_1 = 206e9, youngs_modulus_2 = 206e9,
        poisson_ratio_1 = 0.3, poisson_ratio_2 = 0.3, speed_1 = 0.1, speed_2 = 1.1 /
&load load_per_length = 1e5 /
&lubricant viscosity = 0.14, viscosity_law = 'roelands', roelands_z = 0.6, roelands_p0 = 1.98e8,
           density_law = 'dowson_higginson', rheology = 'eyring', eyring_stress = 3.3e6 /
&domain x_inlet = -4.0, x_outlet = 1.5, intervals = 256 /
"""

AT_REST = STEADY.replace("speed_1 = 0.1", "speed_1 = 0.0")
STOKES = STEADY.replace("problem = 'ehl_line'", "problem = 'ehl_line', equations = 'stokes'")

TRANSIENT = (
    STEADY
    + """&surface_2 shape = 'feature', amplitude = 0.2e-6, wavelength = 1e-4, position = -2.1 /
&time transient = .true., end_time = 1.0, time_step = 0.05 /
"""
)

# 200 000 steps: runs for minutes unless somebody ends it.
LONG = TRANSIENT.replace("end_time = 1.0, time_step = 0.05", "end_time = 1000.0, time_step = 0.005")

MOES = """&case problem = 'ehl_line' /
&moes moes_m = 10.0, moes_l = 5.0, velocity = 'mean' /
&lubricant viscosity_law = 'barus', density_law = 'constant' /
&domain x_inlet = -4.0, x_outlet = 1.5, intervals = 256 /
"""

# Four times as wide as long, turned by 30 degrees.
POINT = """&case problem = 'ehl_point' /
&bodies reduced_radius_x = 6e-3, reduced_radius_y = 40e-3, reduced_modulus = 226e9, entrainment_speed = 1.0,
   entrainment_angle = 30 /
&load hertz_pressure = 0.5e9 /
&lubricant viscosity = 0.05, viscosity_law = 'barus', pressure_viscosity = 2e-8 /
&domain intervals_x = 64 /
"""


def processor(seconds):
    """For `preexec_fn`: the process is killed (status -9) when it has taken so many seconds of processor time."""
    return lambda: resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))


def write(folder, name, text):
    path = folder / name
    path.write_bytes(text.encode("utf-8"))
    return path


def called(command, **options):
    """Calls a program: its returncode, stdout and stderr."""
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=HANGING, **options)


def ended(done, status=0):
    assert done.returncode == status, done.stderr
    return done


def text(value):
    return value.decode("utf-8") if isinstance(value, bytes) else str(value)


def rows(path):
    """The rows of a CSV file."""
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def named(file, value):
    """The value of an attribute; references as the names of what they lead to."""
    if isinstance(value, np.ndarray) and value.dtype.names == ("dataset", "dimension"):
        return " ".join(f"{file[user].name}:{dimension}" for user, dimension in value)
    if isinstance(value, np.ndarray) and value.dtype == object and len(value) and isinstance(value[0], np.ndarray):
        return " ".join(file[axis[0]].name for axis in value)
    return value


def contents(path):
    """All datasets {path: value} and attributes {path@name: value} of a file."""
    found = {}

    def visit(name, item):
        if isinstance(item, h5py.Dataset):
            found[name] = item[()]
        found.update({f"{name}@{key}": named(file, value) for key, value in item.attrs.items()})

    with h5py.File(path) as file:
        found.update({f"@{key}": value for key, value in file.attrs.items()})
        file.visititems(visit)
    return found


def same_bits(first, second):
    """Whether two values are equal to the last bit (NaN included)."""
    first, second = np.asarray(first), np.asarray(second)
    return first.dtype == second.dtype and first.shape == second.shape and first.tobytes() == second.tobytes()


SEAL_BYTES = 80


def seal(path):
    """Gives a file without a seal (src/system/file_bytes.f90) one that fits: it is another file then, not a damaged one."""
    content = path.read_bytes()
    words = np.frombuffer(content + bytes(-len(content) % 8), "<u4").astype(object)
    first, second = 0, 0
    for word in words:
        first = (first + word) % 4294967291
        second = (second + first) % 4294967291
    line = f"asperity checksum {second:08X}{first:08X} of the {len(content)} bytes before"
    path.write_bytes(content + f"{line:{SEAL_BYTES - 1}}\n".encode())


BATCH, STUDIES = ROOT / "batch", ROOT / "bench" / "studies"

# Four contacts on 256 intervals; the second one has room for one cycle of a slow method only and does not converge.
SMALL = """base = "base.nml"
together = ["load.hertz_pressure", "solver.max_cycles"]
[vary]
load.hertz_pressure = [0.4e9, 0.6e9, 0.5e9, 0.3e9]
solver.max_cycles = [100, 1, 100, 100]
[set]
domain.intervals = 256
solver.method = "fas_block_jacobi"
accuracy.error_bars = false
"""
BASE = (ROOT / "input" / "minimal.nml").read_text(encoding="utf-8")


def call(script, *arguments, folder, program, **options):
    environment = {**os.environ, "ASPERITY": str(program), "PYTHONDONTWRITEBYTECODE": "1", "MPLBACKEND": "agg"}
    command = [sys.executable, "-W", "error", str(BATCH / script), *map(str, arguments)]
    return called(command, cwd=folder, env=environment, **options)


def write_sweep(folder, text=SMALL, base=BASE, name="small.toml"):
    (folder / "base.nml").write_text(base, encoding="utf-8")
    (folder / name).write_text(text, encoding="utf-8")
    return folder / name


def swept(folder, program, text=SMALL, base=BASE):
    """The folder of a sweep, written by batch/sweep.py."""
    write_sweep(folder, text, base)
    ended(call("sweep.py", "small.toml", folder=folder, program=program))
    return folder / "small"


def run_quick(name, program, folder):
    """Calls a study with --quick; it checks its own references and must end with status 0. Returns standard output."""
    command = [sys.executable, str(STUDIES / name), "--quick", "--output", str(folder), "--jobs", "2", "--program", str(program)]
    done = ended(called(command))
    return done.stdout


def damaged(content: bytes, source: random.Random) -> bytes:
    """`content` with bytes flipped, zeroed, cut off or swapped, in one to four places; never the same as before."""
    while True:
        result = bytearray(content)
        for _ in range(source.choice([1, 1, 2, 4])):
            change_once(result, source)
        if result != content:
            return bytes(result)


def change_once(content: bytearray, source: random.Random) -> None:
    """One change, anywhere or among the first bytes, where the structure of an HDF5 file is."""
    if not content:
        return
    length = min(source.choice([1, 8, 64, 512, 4096]), len(content))
    place = source.randrange(source.choice([len(content), min(len(content), 2048)]))
    piece = content[place : place + length]
    kind = source.choice(["bit", "byte", "zero", "ones", "cut", "swap"])
    if kind == "bit":
        content[place] ^= 1 << source.randrange(8)
    elif kind == "byte":
        content[place] = source.randrange(256)
    elif kind in ("zero", "ones"):
        content[place : place + len(piece)] = (b"\0" if kind == "zero" else b"\xff") * len(piece)
    elif kind == "cut":
        del content[source.choice([place, len(content) - min(length, len(content))]) :]
    else:
        other = source.randrange(len(content) - len(piece) + 1)
        content[place : place + len(piece)] = content[other : other + len(piece)]
        if abs(other - place) >= len(piece):
            content[other : other + len(piece)] = piece


# Dry contacts: namelists, reference profiles.
DRY_CASE = """&case problem = '{problem}' /
&bodies {elastic}{bodies} /
&load {key} = {loads}{loading} /
&surface_1 {surface} /
{more}
&solver tolerance = 1e-12 /
"""
STEEL = ", youngs_modulus_2 = 210e9, poisson_ratio_2 = 0.3"
HARD = ", hardness = 4e9"
HEIGHTS = "shape = 'file', file = 'z.h5', dataset = 'z'"
LEAN = "&output adequacy = .false. /\n&accuracy error_bars = .false. /"


def profile(name, harmonics=None):
    more = f", harmonics = {harmonics}" if harmonics else ""
    return f"shape = 'file', file = '{ROOT / 'input'}/profiles_ABCD.csv', positions = 'x_m', dataset = 'z{name}_m'{more}"


def write_heights(folder, z, spacing):
    """Heights in z.h5 of a folder, HEIGHTS for a namelist; `spacing` a number, or two along x and y [m]."""
    with h5py.File(folder / "z.h5", "w") as file:
        data = file.create_dataset("z", data=z)
        data.attrs["spacing_x"], data.attrs["spacing_y"] = np.broadcast_to(spacing, 2)


def write_profile(path, z, spacing):
    """Positions and heights of a profile [m] as a table."""
    path.write_text("x,z\n" + "".join(f"{i * spacing!r},{float(h)!r}\n" for i, h in enumerate(z)), encoding="utf-8")


def case_text(surface, loads, bodies=HARD, more="", problem="dry_line", loading="", key="mean_pressure", modulus=None):
    """The namelist of a case; `modulus` replaces steel against a rigid plane."""
    elastic = f"reduced_modulus = {modulus!r}" if modulus else "youngs_modulus_1 = 210e9, poisson_ratio_1 = 0.3"
    load = {"key": key, "loads": ", ".join(repr(float(load)) for load in loads), "loading": loading}
    return DRY_CASE.format(problem=problem, elastic=elastic, bodies=bodies, surface=surface, more=more, **load)


def solve(asperity, folder, surface, loads, bodies=HARD, more="", problem="dry_line", **options):
    write(folder, "case.nml", case_text(surface, loads, bodies, more, problem, **options))
    assert ended(asperity("case.nml", "--quiet")).stderr == ""
    return h5py.File(folder / "case.h5")


def close(found, expected, tolerance=1e-6):
    """Whether two lists agree relative to the largest of the expected values."""
    found, expected = np.asarray(found), np.asarray(expected, dtype=float)
    np.testing.assert_allclose(found, expected, rtol=tolerance, atol=tolerance * np.abs(expected).max() * 1e-3)
