#!/usr/bin/env python3
"""Dry elastic contact of rough areas: asperity beside the programs that are on PyPI, same surface, same load, equal error.

The error of every answer, ours too, is computed here from its pressure (docs/theory.md). Of each peer the cheapest run with an
error of at most 1e-6 counts, or its best if none reaches that. Seconds are CPU of the solution, on both sides without reading and
writing; planning of the transforms is counted against asperity. The peers live in an environment of their own, made by
python3 -m venv DIR && DIR/bin/pip install tamaas ContactMechanics aspher; peers that are missing are left out.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import tempfile
from pathlib import Path

import h5py
import numpy as np

ROOT = Path(__file__).resolve().parent.parent
PROGRAM = ROOT / "build" / "bin" / "asperity"
PEERS = {
    "aspher": (1e-6, 1e-7, 1e-8, 1e-10),
    "tamaas": (1e-6, 1e-8, 1e-10, 1e-12),
    "ContactMechanics": (1e-4, 1e-6, 1e-8),
}
WANTED = 1e-6
ONE_THREAD = os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
CASE = """&case problem = 'dry_area' /
&bodies reduced_modulus = 2e9 /
&load mean_pressure = {pressure!r} /
&surface_1 shape = 'file', file = 'z.h5', dataset = '/z' /
&solver tolerance = 1e-6 /
"""


def surface(nodes: int, seed: int = 1) -> np.ndarray:
    """A self-affine periodic surface on the unit square, Hurst exponent 0.8, roll-off at a quarter, rms slope 0.1."""
    waves = np.hypot(np.fft.fftfreq(nodes, 1 / nodes)[:, None], np.arange(nodes // 2 + 1)[None, :])
    amplitude = np.where((waves >= 1) & (waves <= nodes / 8), np.maximum(waves, 4.0) ** -1.8, 0.0)
    noise = np.random.default_rng(seed).standard_normal((nodes, nodes))
    spectrum = amplitude * np.fft.rfft2(noise)
    z = np.fft.irfft2(spectrum, s=(nodes, nodes))
    slope = np.fft.irfft2(2j * np.pi * np.fft.fftfreq(nodes, 1 / nodes)[:, None] * spectrum, s=(nodes, nodes)).std() * np.sqrt(2)
    return z * 0.1 / slope


def error_of(pressure: np.ndarray, z: np.ndarray, load: float) -> float:
    """The largest violation of the contact conditions; pressures over E*."""
    nodes = z.shape[0]
    waves = 2 * np.pi * np.hypot(np.fft.fftfreq(nodes, 1 / nodes)[:, None], np.arange(nodes // 2 + 1)[None, :])
    waves[0, 0] = 1.0
    response = 2.0 / waves
    response[0, 0] = 0.0
    v = np.fft.irfft2(response * np.fft.rfft2(pressure), s=z.shape) - z
    touching = pressure > 0
    v -= v[touching].mean()
    mean, rms = load * z.size / touching.sum(), z.std()
    return max(
        np.abs(pressure * v)[touching].max() / (mean * rms),
        -v.min() / rms,
        -pressure.min() / mean,
        abs(pressure.mean() - load) / load,
    )


def ours(z: np.ndarray, load: float, folder: Path) -> tuple[np.ndarray, float, float]:
    """Pressure over E*, seconds, FFT pairs."""
    with h5py.File(folder / "z.h5", "w") as file:
        data = file.create_dataset("z", data=z)
        data.attrs["spacing"] = 1.0 / z.shape[0]
    (folder / "case.nml").write_text(CASE.format(pressure=load * 1e9), encoding="utf-8")
    subprocess.run([str(PROGRAM), "case.nml", "--quiet"], cwd=folder, env=ONE_THREAD, check=True)
    with h5py.File(folder / "case.h5") as file:
        return file["solution/pressure"][:] / 1e9, float(file["report/cpu_seconds"][()]), float(file["sweep/fft_pairs"][0])


def theirs(peer: str, python: str, z: np.ndarray, load: float, folder: Path) -> tuple[float, float]:
    """Seconds and error of the cheapest run that is good enough, or of the best."""
    runs = []
    for tolerance in PEERS[peer]:
        np.savez(folder / "in.npz", z=z, load=load, tolerance=tolerance)
        command = [python, str(ROOT / "bench" / "dry_peer.py"), peer, "in.npz", "out.npz"]
        done = subprocess.run(command, cwd=folder, env=ONE_THREAD, check=False, capture_output=True, text=True)
        if done.returncode != 0:
            print(f"    {peer}: {done.stderr.strip().splitlines()[-1] if done.stderr.strip() else 'failed'}")
            break
        with np.load(folder / "out.npz") as data:
            runs.append((float(data["seconds"]), error_of(data["pressure"].reshape(z.shape), z, load)))
        if runs[-1][1] <= WANTED:
            return runs[-1]
    return min(runs, key=lambda run: run[1]) if runs else (float("nan"), float("nan"))


def main() -> None:
    """Prints a table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--peers", metavar="PYTHON", help="python of the environment of the peers")
    parser.add_argument("--only", choices=PEERS, help="one peer instead of all")
    parser.add_argument("--nodes", type=int, nargs="+", default=[512, 1024])
    options = parser.parse_args()
    for nodes in options.nodes:
        z = surface(nodes)
        for share in (0.01, 0.05, 0.15):
            load = share * 0.1 / 2.0
            with tempfile.TemporaryDirectory() as name:
                folder = Path(name)
                pressure, seconds, pairs = ours(z, load, folder)
                area = (pressure > 0).mean()
                print(
                    f"{nodes}^2, contact {100 * area:.1f} %: asperity {seconds:.2f} s, {pairs:.0f} pairs, "
                    f"error {error_of(pressure, z, load):.1e}",
                    flush=True,
                )
                for peer in ([options.only] if options.only else PEERS) if options.peers else ():
                    peer_seconds, error = theirs(peer, options.peers, z, load, folder)
                    print(f"    {peer}: {peer_seconds:.2f} s, error {error:.1e}, {peer_seconds / seconds:.1f} times", flush=True)


if __name__ == "__main__":
    main()
