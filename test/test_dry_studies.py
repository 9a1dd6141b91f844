"""The dry half of the thesis again, in short: chapters 3, 4 and 7, and rough areas. Each study is called with --quick."""

import numpy as np
import pytest
from cases import rows
from study_runs import run_quick


def verdicts(path):
    return {row["claim"]: row["verdict"] for row in rows(path)}


@pytest.mark.nightly
def test_chapter_3_quick_form(program, tmp_path):
    run_quick("chapter3.py", program, tmp_path)
    assert set(verdicts(tmp_path / "statements.csv").values()) == {"agrees", "partly"}
    assert [claim for claim, held in verdicts(tmp_path / "statements.csv").items() if held == "partly"] == [
        "the results may be used for the elastic-perfectly plastic model too"
    ]
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
    assert {claim: row["stand_ins"] for claim, row in statements.items() if claim.startswith("Rsk (unloaded) keeps")} == {
        "Rsk (unloaded) keeps its ranking": "no"  # B and D change places at 100 kN/m
    }
    assert statements["The mean separation keeps the ranking of Ra"]["draws"] == "5"
    assert statements["Rk (unloaded) is altered least for D"]["stand_ins"] == "no"
    assert len(list(tmp_path.glob("figure_7*.png"))) == 4
