"""h_min of stiff oils at high pressures, behind a pressure spike that no grid resolves."""

import sys
from pathlib import Path

import h5py
import pytest

sys.path.append(str(Path(__file__).resolve().parent.parent / "bench"))

import namelists

# M and L (sum) of contacts with Barus' oil, its density, the wanted accuracy, and h_min (dimensionless) on the same domain, from
# up to 2^18 intervals and the order that they show: known to a twentieth of each error.
STIFF = [
    (23.9, 19.6, "constant", 0.01, 0.1002188),
    (154.1, 21.31, "constant", 0.01, 0.01335215),
    (46.05, 29.64, "constant", None, 0.06481315),
    (45.18, 28.82, "constant", 0.01, 0.06488308),
    (111.7, 16.04, "dowson_higginson", 0.003, 0.01516505),
    (11.82, 28.59, "dowson_higginson", 0.01, 0.269313),
    (37.15, 29.96, "dowson_higginson", 0.01, 0.07893926),
    (278.9, 15.66, "dowson_higginson", 0.01, 0.005331112),
]


@pytest.mark.parametrize(("m", "l", "density", "target", "truth"), STIFF)
def test_order_of_the_smallest_film_behind_a_spike_does_not_last(asperity, tmp_path, m, l, density, target, truth):  # noqa: E741
    """Coarse grids show an order near 2, finer ones 3/2 and, where the oil is compressible, 1."""
    oil = {"lubricant": {"viscosity_law": "barus", "density_law": density}, "accuracy": {"target": target}}
    moes = {"moes": {"moes_m": m, "moes_l": l, "velocity": "sum"}}
    (tmp_path / "case.nml").write_text(namelists.namelist(moes | oil), encoding="utf-8")
    assert asperity("--quiet", "case.nml").returncode == 0
    with h5py.File(tmp_path / "case.h5") as file:
        found = file["summary/h_min"].attrs
        error = abs(found["dimensionless"] - truth)
        estimate = found["error_grid"] * found["dimensionless"] / file["summary/h_min"][()]
    assert error <= estimate < 10 * error
    assert target is None or error <= target * truth
