"""A dry contact counts as converged where its error measure is at most the bound that the result states, whatever found it."""

import random

import h5py
import pytest
from cases import write

KINDS = ("full", "plastic", "flat", "partial", "separation")


def member(kind, source):
    """A small periodic contact that ends in a closed form, in an iteration or in a search for its load, and its bound."""
    wave, modulus = 10 ** source.uniform(-5, -3), 10 ** source.uniform(9, 12)
    amplitude = wave * 10 ** source.uniform(-6, -3)
    full = modulus * amplitude / wave  # about the least mean pressure of full contact, times pi/2
    bodies, load = f"reduced_modulus = {modulus!r}", f"mean_pressure = {full * source.uniform(0.01, 0.4)!r}"
    surface = f"shape = 'sinusoid', amplitude = {amplitude!r}, wavelength = {wave / source.randint(1, 4)!r}"
    tolerance = 10 ** source.uniform(-13, -6)
    if kind == "full":
        load = f"mean_pressure = {full * 10 ** source.uniform(1.5, 6)!r}"
    elif kind == "plastic":
        load = f"mean_pressure = {full!r}"
        bodies += f", hardness = {full!r}"
    elif kind == "flat":
        surface = "shape = 'file', file = 'two.csv', detrend = 'parabola'"
    elif kind == "separation":
        load = f"separation = {amplitude * source.uniform(0.2, 0.9)!r}"
        bodies += f", hardness = {full * source.uniform(0.05, 0.3)!r}"
    groups = f"&bodies {bodies} /\n&load {load} /\n&surface_1 {surface} /\n"
    domain = "" if kind == "flat" else f"&domain length = {wave!r}, intervals = {2 ** source.randint(4, 7)} /\n"
    return f"&case problem = 'dry_line' /\n{groups}{domain}&solver tolerance = {tolerance!r}, max_cycles = 3000 /\n", tolerance


@pytest.mark.path
@pytest.mark.parametrize("kind", KINDS)
def test_converged_means_below_the_bound(asperity, tmp_path, kind):
    source = random.Random(kind)
    heights = [source.uniform(-1e-8, 1e-8) for _ in range(2)]
    write(tmp_path, "two.csv", f"x_m,z_m\n0,{heights[0]!r}\n1e-6,{heights[1]!r}\n")
    bounds = {}
    for number in range(8):
        text, bounds[f"{number}"] = member(kind, source)
        write(tmp_path, f"{number}.nml", text)
    done = asperity(*(f"{name}.nml" for name in bounds), "--quiet")
    assert done.returncode in (0, 2), done.stderr
    for name, bound in bounds.items():
        with h5py.File(tmp_path / f"{name}.h5") as file:
            error = file["sweep/kkt"][-1]
            assert file["report/tolerance_effective"][()] == bound, name
            assert file["report/residual"][()] == error, name
            assert file.attrs["converged"] == (error <= bound), (name, error, bound)
            if kind in ("full", "flat", "plastic"):
                assert file.attrs["converged"] == 1, (name, error, bound, file.attrs["reason"])
