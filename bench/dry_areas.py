#!/usr/bin/env python3
"""Measures the speed of dry contacts against other programs and against the bare transforms: results/bench/dry.csv.

Every program gets the same surface and load; one error measure, the largest violation of the contact conditions, judges every
answer. The peers run with the loosest of a ladder of tolerances that reaches 1e-6. Times are processor seconds of one core,
without reading and writing. Those of the peers cover their solving call with its planning and allocation; ours are given with and
without planning, and the ratios include it. `limit` is the sum over all transforms of FFTW's own time at their size and
precision, with plans measured beforehand. The peers have their own environment, made by python3 -m venv DIR && DIR/bin/pip
install tamaas ContactMechanics aspher (it needs libeigen3-dev); missing peers are left out. Parts may be run one by one: rows of
other parts stay in the table.
"""

from __future__ import annotations

import argparse
import functools
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np
import pandas as pd
from bench_program import ENVIRONMENT, ROOT, Answer, Row, Run, answer, new_parser, run_program, save, show_rows
from family_dry import PROBLEMS, height_file
from namelists import BARE, Groups, namelist

PEERS = {"aspher": (1e-6, 1e-7, 1e-8, 1e-10), "tamaas": (1e-6, 1e-8, 1e-10, 1e-12), "ContactMechanics": (1e-4, 1e-6, 1e-8)}
WANTED = 1e-6
ONE_THREAD = ENVIRONMENT | {"OMP_WAIT_POLICY": "passive"}
LOADS = (5, 10, 20, 30, 40, 50, 60, 70, 80, 90, 100, 125, 150)
# Asked for a whole process, by the nodes of a side.
WHOLE_PROCESS = {256: 5, 512: 5, 1024: 7, 2048: 10}


@dataclass
class Contact:
    """Heights on a unit square (N, N) or line (N), mean pressure and hardness over E*."""

    z: np.ndarray
    load: float
    hardness: float = 0.0
    is_open: bool = False

    def deflection(self, pressure: np.ndarray) -> np.ndarray:
        """Elastic deflection: transfer function of the periodic half-space, or rectangles under uniform pressure (Love 1929)."""
        nodes = self.z.shape[0]
        if self.is_open:
            spectrum = np.fft.rfft2(love_kernel(nodes)) * np.fft.rfft2(pressure, s=(2 * nodes, 2 * nodes))
            return np.fft.irfft2(spectrum, s=(2 * nodes, 2 * nodes))[:nodes, :nodes]
        waves = np.arange(nodes // 2 + 1) * 2 * np.pi
        if self.z.ndim == 2:
            waves = np.hypot(2 * np.pi * np.fft.fftfreq(nodes, 1 / nodes)[:, None], waves[None, :])
        response = np.divide(2.0, waves, out=np.zeros_like(waves), where=waves > 0)
        return np.fft.irfftn(response * np.fft.rfftn(pressure), s=self.z.shape, axes=range(self.z.ndim))

    def error(self, pressure: np.ndarray) -> float:
        """The largest violation of the contact conditions."""
        cap = self.hardness or np.inf
        v = self.deflection(pressure) - self.z
        on, full = pressure > 0, pressure >= cap * (1 - 1e-12)
        free = on & ~full
        v -= v[free].mean() if free.any() else 0.5 * (v[full].max() + v[~on].min())
        mean, rms = self.load * self.z.size / on.sum(), self.z.std()
        return max(
            np.abs(pressure * v)[free].max(initial=0.0) / (mean * rms),
            -v[~full].min(initial=0.0) / rms,
            v[full].max(initial=0.0) / rms,
            -pressure.min() / mean,
            max(pressure.max() - cap, 0.0) / mean,
            abs(pressure.mean() - self.load) / self.load,
        )

    def separation(self, pressure: np.ndarray) -> float:
        """Mean gap of an elastic contact."""
        v = self.deflection(pressure) - self.z
        return float(v.mean() - v[pressure > 0].mean())


def love_kernel(nodes: int) -> np.ndarray:
    """Deflection of a half-space, E* = 1, under unit pressure on one element, on the doubled periodic grid."""
    half = 0.5 / nodes
    at = np.fft.fftfreq(2 * nodes, 1 / (2 * nodes)) / nodes
    x, y = at[:, None], at[None, :]
    total = np.zeros((2 * nodes, 2 * nodes))
    for sign, a, b in ((1, half, half), (-1, half, -half), (-1, -half, half), (1, -half, -half)):
        u, w = x + a, y + b
        r = np.hypot(u, w)
        total += sign * (u * np.log(np.maximum(w + r, 1e-300)) + w * np.log(np.maximum(u + r, 1e-300)))
    return total / np.pi


def rough(numbers: np.ndarray, waves: np.ndarray, power: float, noise: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
    """A self-affine periodic surface from a roll-off at a quarter on, at least 8 nodes in each wave, rms slope 0.1."""
    amplitude = np.where((waves >= 1) & (waves <= shape[0] / 8), np.maximum(waves, 4.0) ** power, 0.0)
    spectrum = amplitude * noise
    slope = np.fft.irfftn(2j * np.pi * numbers * spectrum, s=shape, axes=range(len(shape))).std() * np.sqrt(len(shape))
    return np.fft.irfftn(spectrum, s=shape, axes=range(len(shape))) * 0.1 / slope


def area(nodes: int, seed: int = 1) -> np.ndarray:
    """On the unit square, Hurst exponent 0.8."""
    numbers = np.fft.fftfreq(nodes, 1 / nodes)[:, None]
    waves = np.hypot(numbers, np.arange(nodes // 2 + 1)[None, :])
    noise = np.fft.rfft2(np.random.default_rng(seed).standard_normal((nodes, nodes)))
    return rough(numbers, waves, -1.8, noise, (nodes, nodes))


def profile(nodes: int, seed: int = 1) -> np.ndarray:
    """The same in one dimension."""
    rng, waves = np.random.default_rng(seed), np.arange(nodes // 2 + 1)
    noise = rng.standard_normal(nodes // 2 + 1) + 1j * rng.standard_normal(nodes // 2 + 1)
    return rough(waves, waves, -1.3, noise, (nodes,))


# Prints the least processor seconds of a pair of transforms by FFTW itself, plans measured: prefix, nodes along x and y.
PAIR = """
import ctypes, ctypes.util, sys, time
prefix, nx, ny = sys.argv[1], *map(int, sys.argv[2:])
f = ctypes.CDLL(ctypes.util.find_library({"fftw": "fftw3", "fftwf": "fftw3f"}[prefix]))
for routine in ("plan_dft_r2c", "plan_dft_c2r", "malloc"):
    getattr(f, prefix + "_" + routine).restype = ctypes.c_void_p
call = lambda routine, *args: getattr(f, prefix + "_" + routine)(*args)
count = (8 if prefix == "fftw" else 4) * (2 * (nx // 2 + 1)) * ny
x, y = (ctypes.c_void_p(call("malloc", ctypes.c_size_t(count))) for _ in range(2))
sizes = (ctypes.c_int * 2)(ny, nx) if ny > 1 else (ctypes.c_int * 1)(nx)
there = ctypes.c_void_p(call("plan_dft_r2c", len(sizes), sizes, x, y, ctypes.c_uint(0)))
back = ctypes.c_void_p(call("plan_dft_c2r", len(sizes), sizes, y, x, ctypes.c_uint(0)))
ctypes.memset(x, 0, count)
least, begun, repeat = 1e9, time.perf_counter(), max(1, 300000 // (nx * ny))
while time.perf_counter() - begun < 0.2 or least == 1e9:
    start = time.process_time()
    for _ in range(repeat):
        call("execute", there), call("execute", back)
    least = min(least, (time.process_time() - start) / repeat)
print(least)
"""


@functools.cache
def pair_seconds(prefix: str, nx: int, ny: int) -> float:
    """Processor time of a pair of transforms by FFTW itself."""
    command = [sys.executable, "-c", PAIR, prefix, str(nx), str(ny)]
    return float(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def limit_of(done: np.ndarray) -> float:
    """FFTW's own time of the transforms in the rows (nx, ny, pairs in double, pairs in single precision)."""
    sizes = [(nx, ny, *both) for nx, ny, *both in done.astype(int).tolist()]
    double = sum(count * pair_seconds("fftw", nx, ny) for nx, ny, count, _ in sizes if count)
    return double + sum(count * pair_seconds("fftwf", nx, ny) for nx, ny, _, count in sizes if count)


def ours(contact: Contact, runs: int = 2, threads: int = 1) -> Run:
    """The fastest of some runs."""
    groups = {
        "case": {"problem": PROBLEMS[contact.z.ndim - 1]},
        "bodies": {"reduced_modulus": 2e9, "hardness": contact.hardness * 1e9 if contact.hardness else None},
        "load": {"mean_pressure": contact.load * 1e9},
        "surface_1": {"shape": "file", "file": "z.h5", "dataset": "/z"},
        "domain": {"periodic": not contact.is_open},
        "solver": {"tolerance": 1e-6},
    }

    def read(file: h5py.File) -> Answer:
        transforms = np.reshape(file["report/transforms"][:], (-1, 4))
        return Answer(answer(file) | {"pressure": file["solution/pressure"][:] / 1e9, "transforms": transforms})

    files = {"z.h5": height_file(contact.z, [1.0 / contact.z.shape[0]] * contact.z.ndim)}
    words = namelist(groups | BARE), read, files, ("--threads", threads)
    done = [run_program(*words, environment=ONE_THREAD) for _ in range(runs)]
    if any(run.status for run in done):
        sys.exit(f"dry_areas.py: {done[0].words}")
    return min(done, key=lambda run: run.found["cpu_seconds"])


@dataclass
class PeerRun:
    """A run of another program: processor seconds, violation of the contact conditions, mean separation over the side."""

    seconds: float
    error: float
    separation: float


def peer_run(peer: str, python: str, contact: Contact, tolerance: float) -> list[PeerRun]:
    """One run; none if it fails."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        np.savez(folder / "in.npz", tolerance=tolerance, **vars(contact))
        command = [python, str(ROOT / "bench" / "dry_peer.py"), peer, "in.npz", "out.npz"]
        done = subprocess.run(command, cwd=folder, env=ONE_THREAD, check=False, capture_output=True, text=True)
        if done.returncode != 0:
            print(f"    {peer}: {(done.stderr.strip().splitlines() or ['failed'])[-1]}")
            return []
        with np.load(folder / "out.npz") as data:
            pressure = data["pressure"].reshape(contact.z.shape)
            return [PeerRun(float(data["seconds"]), contact.error(pressure), contact.separation(pressure))]


def peer_runs(peer: str, python: str, contact: Contact) -> list[PeerRun]:
    """Runs from the loosest tolerance to the first that is good enough, that one twice if it is fast; until it fails."""
    runs = []
    for tolerance in PEERS[peer]:
        found = peer_run(peer, python, contact, tolerance)
        runs += found
        if not found:
            break
        if found[0].error <= WANTED:
            return runs + (peer_run(peer, python, contact, tolerance) if found[0].seconds <= 3.0 else [])
    return runs


def beside_peers(options: argparse.Namespace, work: str, contact: Contact, asked: float) -> Iterator[Row]:
    """A row with the ratio to the fastest peer that is good enough, and one with the ratio to the transforms."""
    run = ours(contact)
    found, on = run.found, run.found["pressure"] > 0
    note = f"{100 * on.mean():.1f} % contact, {found['cpu_seconds']:.3f} s, {found['fft_pairs']:.0f} pairs"
    note += f", error {contact.error(found['pressure']):.0e}"
    if contact.hardness:
        note += f", {100 * (found['pressure'] >= contact.hardness).sum() / on.sum():.0f} % of the contact plastic"
    best = np.inf
    for peer in ([options.only] if options.only else PEERS) if options.peers else ():
        runs = peer_runs(peer, options.peers, contact)
        # the cheapest one that is good enough, or the best one
        for other in sorted(runs, key=lambda run: (run.error > WANTED, run.seconds if run.error <= WANTED else run.error))[:1]:
            note += f"; {peer} {other.seconds:.2f} s, {other.error:.0e}"
            best = min(best, other.seconds) if other.error <= 2 * WANTED else best
    if best < np.inf:
        yield Row(work, asked, best / found["cpu_seconds"], "times", note)
        note = f"the same solutions over {run.processor:.3f} s for reading, solving and writing"
        yield Row(f"{work}: whole process", WHOLE_PROCESS[len(contact.z)], best / run.processor, "times", note)
    limit, solve = limit_of(found["transforms"]), found["cpu_seconds"] - found["cpu_prepare_seconds"]
    note = f"solve {solve:.3f} s, planning {found['cpu_prepare_seconds']:.3f} s, transforms alone {limit:.3f} s"
    yield Row(f"{work}: over transforms", 1.5, solve / limit, "x", note)


def areas(options: argparse.Namespace) -> Iterator[Row]:
    """Elastic areas."""
    for nodes in options.nodes or ([256] if options.quick else [512, 1024, 2048]):
        z = area(nodes)
        for share in (1, 5, 15):  # of contact [%]
            yield from beside_peers(options, f"elastic {nodes}^2, {share} %", Contact(z, share / 100 * 0.05), 5)


def capped(options: argparse.Namespace) -> Iterator[Row]:
    """Areas with a hardness that makes about a fifth of the contact plastic."""
    for nodes in options.nodes or ([256] if options.quick else [256, 1024]):
        yield from beside_peers(options, f"capped {nodes}^2, 5 %", Contact(area(nodes), 0.0025, hardness=0.075), 15)


def open_sphere(options: argparse.Namespace) -> Iterator[Row]:
    """Hertz's sphere on an open half-space, contact radius a fifth of the side: a paraboloid at the centre of the unit square."""
    nodes = 256 if options.quick else 1024
    x = (np.arange(nodes) + 0.5) / nodes - 0.5
    contact = Contact(-(x[:, None] ** 2 + x[None, :] ** 2) / 2, 4 / 3 * 0.2**3, is_open=True)
    yield from beside_peers(options, f"open sphere {nodes}^2", contact, 5)


def growth(options: argparse.Namespace) -> Iterator[Row]:
    """Iterations at fixed contact area over the number of nodes."""
    sizes = (128, 256, 512) if options.quick else (256, 512, 1024, 2048, 4096)
    counts = [ours(Contact(area(nodes), 0.0025), runs=1).found["cycles"] for nodes in sizes]
    power = np.log(counts[-1] / counts[0]) / np.log((sizes[-1] / sizes[0]) ** 2)
    note = f"iterations {', '.join(map(str, counts))}"
    yield Row(f"growth of iterations, {sizes[0]}^2 to {sizes[-1]}^2", 0.25, power, "power", note)


def long_profile(options: argparse.Namespace) -> Iterator[Row]:
    """A long profile at 12 % contact."""
    nodes = 2**14 if options.quick else 2**20
    contact = Contact(profile(nodes), 0.0058)
    found = ours(contact, runs=1).found
    share = 100 * (found["pressure"] > 0).mean()
    note = f"{share:.1f} % contact, error {contact.error(found['pressure']):.0e}, {found['cycles']} iterations"
    yield Row(f"profile of {nodes} nodes", 10, found["cpu_seconds"], "s", note)
    yield Row(f"profile of {nodes} nodes: pairs", 900, found["fft_pairs"], "pairs")


def memory(options: argparse.Namespace) -> Iterator[Row]:
    """Largest area: memory, and two threads."""
    nodes = 1024 if options.quick else 4096
    contact = Contact(area(nodes), 0.0025)
    first, second = (ours(contact, runs=1, threads=threads) for threads in (1, 2))
    error, walls = contact.error(first.found["pressure"]), [run.found["wall_solve_seconds"] for run in (first, second)]
    note = f"{first.found['cpu_seconds']:.1f} s, error {error:.0e}; reading and writing included"
    yield Row(f"memory of {nodes}^2", 2.5, first.memory / 1024, "GB", note)
    note = f"wall {walls[0]:.2f} s and {walls[1]:.2f} s"
    yield Row(f"{nodes}^2 by two threads", 1, walls[0] / walls[1], "times", note)


def profile_case(name: str, load: float | list[float], hardness: float | None = None, harmonics: int | None = None) -> Groups:
    """A reference profile under mean pressures [Pa]."""
    surface = {"shape": "file", "file": str(ROOT / "input/profiles_ABCD.csv"), "positions": "x_m", "dataset": f"z{name}_m"}
    return {
        "case": {"problem": "dry_line"},
        "bodies": {"youngs_modulus_1": 210e9, "poisson_ratio_1": 0.3, "hardness": hardness},
        "load": {"mean_pressure": load},
        "surface_1": surface | {"harmonics": harmonics},
    }


def sweep(_: argparse.Namespace) -> Iterator[Row]:
    """Thirteen loads of four profiles of 512 nodes, beyond start-up, reading and writing."""
    texts = [namelist(profile_case(name, [load / 0.4 * 1e6 for load in LOADS], 4e9)) for name in "ABCD"]
    read = lambda file: (file["report/cpu_seconds"][()], file["sweep/kkt"][:].max())  # noqa: E731
    runs = np.array([run_program(texts, read, environment=ONE_THREAD).results for _ in range(3)])
    seconds, note = runs[:, :, 0].sum(axis=1).min(), f"largest error {runs[:, :, 1].max():.0e}"
    yield Row("sweep of 13 loads, 4 profiles of 512 nodes", 0.1, seconds, "s", note)


PARTS = {
    **{"areas": areas, "capped": capped, "sphere": open_sphere, "growth": growth},
    **{"profile": long_profile, "memory": memory, "sweep": sweep},
}


def main() -> None:
    """Runs the parts."""
    parser = new_parser(__doc__, "small grids", "results/bench")
    parser.add_argument("--peers", metavar="PYTHON", help="python of the environment of the peers")
    parser.add_argument("--only", choices=PEERS, help="one peer instead of all")
    parser.add_argument("--parts", nargs="+", choices=PARTS, default=[*PARTS])
    parser.add_argument("--nodes", type=int, nargs="+", help="nodes a side of the areas")
    options = parser.parse_args()
    path = options.output / "dry.csv"
    table = pd.read_csv(path) if path.exists() else pd.DataFrame()
    for part in options.parts:
        for row in PARTS[part](options):
            show_rows(part, [row])
            table = pd.concat([table, pd.DataFrame([row])]).drop_duplicates("work", keep="last")
            save(path, table)


if __name__ == "__main__":
    main()
