"""The dry half of the thesis again, in short: each study is called with --quick; what they judge with, and the page."""

import math
import re

import chapter4_claims
import chapter7_claims
import numpy as np
import pytest
from asperities import DISTANCES, moment, summits_of
from cases import ROOT, rows, run_quick
from dry_profiles import verdict


def verdicts(path):
    return {row["claim"]: row["verdict"] for row in rows(path)}


@pytest.mark.nightly
def test_chapter_3_quick_form(program, tmp_path):
    run_quick("chapter3.py", program, tmp_path)
    assert set(verdicts(tmp_path / "statements.csv").values()) == {"agrees", "partly"}
    partly = [claim for claim, held in verdicts(tmp_path / "statements.csv").items() if held == "partly"]
    assert partly == ["the results may be used for the elastic-perfectly plastic model too"]
    found = {(row["profile"], row["kind"], row["counter"]): row for row in rows(tmp_path / "chapter3.csv") if row["load"] == "100"}
    # The reference table of the profiles: profile A at 100 kN/m.
    assert float(found["A", "plastic", "rigid"]["contact_area_fraction"]) == pytest.approx(34 / 512)
    assert float(found["A", "elastic", "rigid"]["p_max"]) == pytest.approx(37e9, rel=0.02)
    assert {path.name for path in tmp_path.glob("*.png")} == {
        "chapter3_profile.png",
        "chapter3_loads.png",
        "chapter3_cycle.png",
        "chapter3_similarity.png",
    }


def test_chapter_4_quick_form(program, tmp_path):
    output = run_quick("chapter4.py", program, tmp_path)
    assert "disagrees" not in output.lower()  # a short list of harmonics proves nothing
    table = rows(tmp_path / "chapter4_truncation.csv")
    for name in "ABCD":
        cut = {int(row["harmonics"]): row for row in table if row["profile"] == name and row["kind"] == "elastic"}
        # Fewer harmonics: less slope, larger contact.
        slope = [float(cut[n]["rms_slope_undeformed"]) for n in sorted(cut)]
        area = [float(cut[n]["contact_area_fraction"]) for n in sorted(cut)]
        assert np.all(np.diff(slope) > 0)
        assert area[0] > 1.5 * area[-1]
    grids = [row for row in rows(tmp_path / "chapter4_grids.csv") if row["kind"] == "plastic"]
    assert [int(row["nodes"]) for row in grids] == [256, 512, 1024, 65536]
    energy = [float(row["dissipated_energy"]) for row in grids]
    assert energy[1] == pytest.approx(energy[-1], rel=0.05, abs=0)
    assert [float(row["p_max"]) for row in grids] == [4e9] * 4
    # Figure 4.1: about 0.5 um printed; the error bar of the result is 0.04 um.
    [depth] = [row for row in rows(tmp_path / "statements.csv") if "0.5 µm deep" in row["claim"]]
    assert float(depth["numbers"].split()[0]) == pytest.approx(0.447, abs=0.001)
    assert {path.name for path in tmp_path.glob("figure*.png")} == {
        "figure_4_1_depth.png",
        "figure_4_2_area.png",
        "figure_4_3_to_4_6_parameters.png",
    }


def test_rough_area_quick_form(program, tmp_path):
    run_quick("area.py", program, tmp_path)
    assert set(verdicts(tmp_path / "statements.csv").values()) == {"agrees", "measured"}
    found = rows(tmp_path / "area.csv")
    # Between Persson's constant and that of asperities, and falling with the load.
    kappa = [float(row["kappa"]) for row in found]
    assert 1.6 < kappa[-1] < kappa[0] < 2.51
    assert float(found[1]["kappa"]) == pytest.approx(2.3, abs=0.15)


def test_chapter_7_quick_form(program, tmp_path):
    run_quick("chapter7.py", program, tmp_path)
    found = {(row["profile"], row["load"]): row for row in rows(tmp_path / "chapter7.csv")}
    assert len(found) == 4 * 18
    assert float(found["C", "100"]["contact_area_fraction"]) == pytest.approx(44 / 512)
    assert float(found["C", "100"]["plasticity_index"]) == pytest.approx(0.523, abs=1e-3)
    # Paper C goes on to 150 kN/m: the area is at least load over hardness.
    assert all(float(found[name, "150"]["contact_area_fraction"]) >= 375e6 / 4e9 for name in "ABCD")
    statements = {row["claim"]: row for row in rows(tmp_path / "statements.csv")}
    kept = {claim: row["stand_ins"] for claim, row in statements.items() if claim.startswith("Rsk (unloaded) keeps")}
    assert kept == {"Rsk (unloaded) keeps its ranking": "no"}  # B and D change places at 100 kN/m
    assert statements["The mean separation keeps the ranking of Ra"]["draws"] == "5"
    assert statements["Rk (unloaded) is altered least for D"]["stand_ins"] == "no"
    assert len(list(tmp_path.glob("figure_7*.png"))) == 4


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
