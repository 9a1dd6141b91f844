#!/usr/bin/env python3
"""How rough areas grow: what a process takes today, and what one shared among the ranks of a cluster would.

The first table is measured: the program on areas with 2 to 4 % of contact, always eight nodes in the finest wave. The second too,
if `mpifort`, `mpirun` and FFTW for MPI are there (libfftw3-mpi-dev, openmpi-bin): pairs of transforms in one rank and in two. The
third is paper: it takes the nodes a second of the transforms, the bytes a node and the pairs of a solution from the first two, and
counts what the ranks exchange.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import numpy as np
from dry import MEASURED, ONE_THREAD

ROOT = Path(__file__).resolve().parent.parent
PROGRAM = ROOT / "build" / "bin" / "asperity"
CASE = """&case problem = 'dry_area' /
&bodies youngs_modulus_1 = 210e9, poisson_ratio_1 = 0.3 /
&load mean_pressure = 3e8 /
&surface_1 shape = 'synthetic', seed = 7, hurst = 0.8, rms_height = 0.5e-6, wavelength_rolloff = 1e-4, wavelength_short = {wave} /
&domain length_x = 4e-4, length_y = 4e-4, intervals_x = {nodes}, intervals_y = {nodes} /
&accuracy error_bars = .false. /
&output adequacy = .false. /
"""
MPI = ["mpirun", "--oversubscribe", "--mca", "btl_vader_single_copy_mechanism", "none"]
AS_ROOT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
# Bytes a second that a rank can send, where 32 ranks share a link of 25 GB/s.
LINK = 25e9 / 32
SINGLE = 4


def measure_process(nodes: int, folder: Path) -> tuple[float, float, float]:
    """One area: bytes a node, pairs of full transforms, solution in seconds; a line of the table."""
    (folder / "case.nml").write_text(CASE.format(nodes=nodes, wave=4e-4 * 8 / nodes), encoding="utf-8")
    command = [sys.executable, "-c", MEASURED, str(PROGRAM), "case.nml", "--quiet", "--threads", "1"]
    done = subprocess.run(command, cwd=folder, env=ONE_THREAD, check=True, capture_output=True, text=True)
    memory = float(done.stdout.split()[0]) * 1024
    with h5py.File(folder / "case.h5") as file:
        pairs, seconds = float(file["sweep/fft_pairs"][0]), float(file["report/wall_solve_seconds"][()])
        contact = float(np.ravel(file["sweep/contact_area_fraction"][()])[0])
    size = (folder / "case.h5").stat().st_size
    print(
        f"{nodes:>6}^2  {100 * contact:5.1f} %  {pairs:5.1f} pairs  {seconds:8.2f} s  "
        f"{memory / 1e9:6.2f} GB  {memory / nodes**2:5.0f} B a node  file {size / 1e9:5.2f} GB"
    )
    return memory / nodes**2, pairs, seconds


def measure_transforms(sizes: list[int], folder: Path) -> float:
    """Pairs of transforms over ranks; nodes a second of one rank on the largest grid."""
    source = ROOT / "bench" / "mpi_transforms.f90"
    flags = ["-O3", "-I/usr/include", "-lfftw3f_mpi", "-lfftw3f"]
    subprocess.run(["mpifort", str(source), *flags, "-o", "transforms"], cwd=folder, check=True)
    rate = 0.0
    for nodes in sizes:
        seconds = []
        for ranks in (1, 2):
            command = [*MPI, "-n", str(ranks), "./transforms", str(nodes)]
            done = subprocess.run(command, cwd=folder, env=os.environ | AS_ROOT, check=True, capture_output=True, text=True)
            seconds.append(float(done.stdout.split()[2]))
        rate = nodes**2 / seconds[0]
        print(f"{nodes:>6}^2  {seconds[0]:7.3f} s by one rank, {seconds[1]:7.3f} s by two: {seconds[0] / seconds[1]:.2f} times")
    return rate


def estimate(bytes_a_node: float, pairs: float, over_transforms: float, rate: float, measured: int) -> None:
    """The third table."""
    for nodes in (16384, 32768, 65536):
        for ranks in (64, 1024):
            count = nodes**2
            slower = np.log2(nodes) / np.log2(measured)
            compute = pairs * count * slower / rate / ranks * over_transforms
            # a pair sends the spectrum (half as many complex numbers) there and back, all but the rank's own part
            sent = 2 * count * SINGLE * (1 - 1 / ranks) / ranks
            print(
                f"{nodes:>6}^2  {ranks:>5} ranks  {bytes_a_node * count / ranks / 1e9:6.2f} GB a rank  "
                f"computing {compute:8.2f} s  exchange {pairs * sent / LINK:7.2f} s ({pairs * sent / 1e9:6.2f} GB sent by each)"
            )


def main() -> None:
    """Prints the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="areas to 1024^2 instead of 8192^2 (6 GB)")
    sizes = [512, 1024] if parser.parse_args().quick else [1024, 2048, 4096, 8192]
    print(f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f} at the start")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        print("\nOne process, one thread, 8 nodes in the finest wave")
        bytes_a_node, pairs, seconds = [measure_process(nodes, folder) for nodes in sizes][-1]
        if not (shutil.which("mpifort") and shutil.which("mpirun")):
            print("\nno mpifort and mpirun here: nothing measured with ranks, and nothing estimated")
            return
        print("\nA pair of real transforms in single precision, FFTW over MPI")
        rate = measure_transforms(sizes, folder)
    print("\nOn paper: memory, processor time and exchange of a solution")
    estimate(bytes_a_node, pairs, seconds / (pairs * sizes[-1] ** 2 / rate), rate, sizes[-1])


if __name__ == "__main__":
    main()
