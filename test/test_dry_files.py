"""Measured heights on other nodes than those of the file: Fourier resampling, and where it is refused."""

import numpy as np
import pytest
from dry_cases import HEIGHTS, case_text, solve, write_heights


def resampled(z, nodes):
    spectrum = np.fft.rfft(z)
    n = len(z)
    if n % 2 == 0 and nodes > n:
        spectrum[-1] /= 2
    kept = min(len(spectrum), (nodes + 1) // 2)
    return np.fft.irfft(np.concatenate([spectrum[:kept], np.zeros(nodes // 2 + 1 - kept)]), nodes) * nodes / n


def heights(nodes, seed=1):
    return np.random.default_rng(seed).standard_normal(nodes) * 1e-7


def write_profile(path, z, spacing=1e-6):
    path.write_text("x,z\n" + "".join(f"{i * spacing!r},{float(h)!r}\n" for i, h in enumerate(z)), encoding="utf-8")


FILE = "shape = 'file', file = 'z.csv'"


@pytest.mark.parametrize(("old", "new"), [(64, 96), (64, 97), (63, 200), (64, 48), (96, 33), (50, 50)])
def test_profile_on_other_nodes(asperity, tmp_path, old, new):
    z = heights(old)
    write_profile(tmp_path / "z.csv", z)
    with solve(asperity, tmp_path, FILE, [1e7], "", f"&domain intervals = {new} /") as file:
        expected = z if new == old else resampled(z, new)
        np.testing.assert_allclose(file["solution/height_undeformed"][()], expected, rtol=0, atol=1e-20)
        assert file["solution/x"][()][-1] == pytest.approx(old * 1e-6 * (new - 1) / new)


def test_files_on_other_nodes(asperity, tmp_path):
    # A wave is measured completely with a few nodes: Westergaard's gap to the accuracy of the fine grid.
    height, length, share, modulus = 1e-6, 1e-3, 0.3, 230e9
    write_profile(tmp_path / "z.csv", height * np.cos(2 * np.pi * np.arange(12) / 12), length / 12)
    load = float(share * np.pi * modulus / 2 * height / length)
    with solve(asperity, tmp_path, FILE, [load], "", "&domain intervals = 2000 /", modulus=modulus) as file:
        gap = file["sweep/mean_separation"][0] / height
        assert file["sweep/contact_area_fraction"][0] == pytest.approx(2 * np.arcsin(np.sqrt(share)) / np.pi, abs=2 / 2000)
    assert gap == pytest.approx(1 - share * (1 - np.log(share)), rel=1e-4)
    z = heights(24 * 20).reshape(20, 24)
    write_heights(tmp_path, z, 1e-6)
    domain = "&domain intervals_x = 36, intervals_y = 15 /"
    with solve(asperity, tmp_path, HEIGHTS, [1e7], "", domain, "dry_area") as file:
        rows = np.array([resampled(row, 36) for row in z])
        expected = np.array([resampled(column, 15) for column in rows.T]).T
        np.testing.assert_allclose(file["solution/height_undeformed"][()], expected, rtol=0, atol=1e-20)
    first, second = heights(64), heights(48, 2)
    write_profile(tmp_path / "z.csv", first, 3e-6)
    write_profile(tmp_path / "other.csv", second, 4e-6)
    more = "&surface_2 shape = 'file', file = 'other.csv' /\n&domain periodic = .true. /"
    with solve(asperity, tmp_path, FILE, [1e7], "", more) as file:
        np.testing.assert_allclose(file["solution/height_undeformed"][()], first + resampled(second, 64), rtol=0, atol=1e-20)


REFUSED = {
    "open": ("&domain intervals = 96, periodic = .false. /", "&domain intervals: found 96, expected the 64 nodes of the file"),
    "other_length": ("&surface_2 shape = 'file', file = 'other.csv' /", "expected the length of the domain"),
    "length_of_domain": ("&domain length = 1e-3 /", "nodes times spacing of the file"),
    "other_nodes_open": (
        "&surface_2 shape = 'file', file = 'coarse.csv' /\n&domain periodic = .false. /",
        "&surface_2 file: found 32 x 1 nodes, expected 64 x 1 as in the other surface",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_resampled(run_case, tmp_path, name):
    more, message = REFUSED[name]
    write_profile(tmp_path / "z.csv", heights(64))
    write_profile(tmp_path / "other.csv", heights(64), 2e-6)
    write_profile(tmp_path / "coarse.csv", heights(32), 2e-6)
    assert message in run_case(case_text(FILE, [1e7], "", more), status=1).stderr
