"""What the dry studies compute and judge with, and that docs/dry.md has every statement that they judge."""

import math
import re

import chapter4_claims
import chapter7_claims
import numpy as np
import pytest
from asperities import DISTANCES, moment, summits_of
from conftest import ROOT
from dry_profiles import verdict

PAGE = (ROOT / "docs" / "dry.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("claims", [chapter4_claims, chapter7_claims])
def test_every_statement_is_on_the_page(claims):
    plain = {re.sub(r" \((?:un)?loaded\)", "", item.text) for item in claims.STATEMENTS}
    assert {text for text in plain if f"| {text} |" not in PAGE} == set()


def test_stand_ins_have_the_printed_parameters():
    # Ra, Rz, Rsk, Rk of Table 7.1 and Rq of Table C.1, to the last digit printed; Rz is the mean height of five parts.
    printed = {
        "A": (0.93, 5.50, 1.2, -1.00, 4.40),
        "B": (0.30, 1.69, 0.38, -0.25, 3.20),
        "C": (0.14, 0.78, 0.18, -0.02, 3.50),
        "D": (0.35, 2.22, 0.45, -0.07, 3.10),
    }
    data = np.genfromtxt(ROOT / "input" / "profiles_ABCD.csv", delimiter=",", names=True)
    for name, values in printed.items():
        z = 1e6 * (data[f"z{name}_m"] - data[f"z{name}_m"].mean())
        rms = (z**2).mean() ** 0.5
        height = np.mean([np.ptp(part) for part in np.array_split(z, 5)])
        found = (np.abs(z).mean(), height, rms, (z**3).mean() / rms**3, (z**4).mean() / rms**4)
        assert found == pytest.approx(values, abs=0.005), name


def test_verdicts_need_nearly_all_draws():
    assert verdict([True] * 45 + [False] * 5) == "agrees"
    assert verdict([True] * 44 + [False] * 6) == "not decidable with stand-ins"
    assert verdict([True] * 6 + [False] * 44) == "not decidable with stand-ins"
    assert verdict([True] * 5 + [False] * 45) == "disagrees"


def test_moments_of_the_asperity_heights():
    # F_1(t) = phi(t) - t Q(t), with the tail Q of the normal distribution; the error is that of the quadrature.
    exact = [math.exp(-(t**2) / 2) / (2 * math.pi) ** 0.5 - t * math.erfc(t / 2**0.5) / 2 for t in DISTANCES]
    np.testing.assert_allclose(moment(1.0), exact, atol=1e-5)


def test_summits_of_a_gaussian_surface():
    # P. R. Nayak, J. Lubr. Technol. 93, 1971, 398: density m4/(6 pi sqrt(3) m2), mean curvature 8/3 sqrt(m4/pi) with the moments of
    # a profile; eight neighbours on a grid of eight nodes in the shortest wave miss a few per cent, a surface of 1000 summits too.
    nodes, length = 512, 1e-3
    waves = np.hypot(np.fft.fftfreq(nodes, 1 / nodes)[:, None], np.arange(nodes // 2 + 1)[None, :])
    inside = (waves >= 8) & (waves <= 64)
    noise = np.fft.rfft2(np.random.default_rng(7).standard_normal((nodes, nodes)))
    spectrum = noise * np.where(inside, np.maximum(waves, 1) ** -1.8, 0)
    found = summits_of(np.fft.irfft2(spectrum, s=(nodes, nodes)), length)
    weight = np.full(nodes // 2 + 1, 2.0)
    weight[0] = 1.0
    power = np.abs(spectrum) ** 2 / nodes**4 * weight
    q = 2 * np.pi * waves / length
    m2, m4 = (power * q**2).sum() / 2, (power * q**4).sum() * 3 / 8
    assert found.density == pytest.approx(m4 / (6 * np.pi * 3**0.5 * m2), rel=0.05)
    assert found.curvature == pytest.approx(8 / 3 * (m4 / np.pi) ** 0.5, rel=0.03)
    # The same heights four times as large: four times the curvature, the same summits.
    other = summits_of(4 * np.fft.irfft2(spectrum, s=(nodes, nodes)), length)
    assert other.density == found.density
    assert other.curvature == pytest.approx(4 * found.curvature, rel=1e-12)
