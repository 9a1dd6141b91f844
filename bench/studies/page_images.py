#!/usr/bin/env python3
"""Copies the figures of the studies that docs/thesis.md and docs/dry.md show to docs/images/.

page_images.py chapter5 chapter6 ...: the studies whose figures are copied.
"""

from __future__ import annotations

import shutil
import sys

from study import ROOT

FIGURES = {
    "chapter3": ("chapter3_profile", "chapter3_loads", "chapter3_cycle", "chapter3_similarity"),
    "chapter4": ("figure_4_1_depth", "figure_4_2_area", "figure_4_3_to_4_6_parameters", "chapter4_truncation", "chapter4_grids"),
    "chapter7": ("figure_7_1_heights", "figure_7_2_contact", "figure_7_3_amplitudes", "figure_7_4_shape"),
    "area": ("area_load", "area_asperities"),
    "chart": ("dry_chart",),
    "stability": ("dry_stability",),
    "chapter5": (
        "figure_5_1_smooth",
        "figure_5_2_case2",
        "figure_5_3_case3",
        "time_errors",
        "figure_5_4_difference_case1",
        "figure_5_5_difference_case2",
        "figure_5_6_difference_case3",
        "momentum_rule",
    ),
    "chapter6": (
        "figure_6_1_situations",
        "figure_6_2_to_6_5_overtakings",
        "figure_6_6_dent_over_ridge",
        "figure_6_7_depth_and_width",
        "figure_6_8_slide_to_roll",
        "figure_6_9_ridge_amplitude",
        "figure_6_10_load",
    ),
    "amplitude": ("amplitude_master", "amplitude_sliding", "amplitude_linearity"),
}


def main() -> None:
    """All figures; one that is missing ends with status 1."""
    target = ROOT / "docs" / "images"
    target.mkdir(parents=True, exist_ok=True)
    for folder in sys.argv[1:]:
        for name in FIGURES[folder]:
            source = ROOT / "results" / folder / f"{name}.png"
            if not source.exists():
                sys.exit(f"page_images.py: {source} is missing: make {folder}")
            shutil.copy(source, target)


if __name__ == "__main__":
    main()
