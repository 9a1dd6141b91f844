"""Section 3.6 of the thesis, (3.15) to (3.19): the dry contact of a given profile depends on E' s/(4 w) only, s its rms height.

Contacts that share nothing but this number, and with a hardness H_s also H_s L/w, must have the same dimensionless pressures and
gaps P = p L/w and H = h E'/(4 w) over X = x/L.
"""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
from dry_profiles import PROFILES
from study import ROOT, Case, Claims, Runner, StudyError, save, style

PARAMETERS = tuple(float(value) for value in np.logspace(-1.5, 1.5, 13))  # E' s/(4 w)
# H_s L/w; 4 GPa and 100 kN/m make 16. No whole number of nodes carries the load at the hardness: there the plane may move freely.
HARDNESSES = (7.5, 15.0, 30.0)
ELASTIC = float("inf")
SAME = 1e-5  # what a tolerance of 1e-9 leaves in P and H


def shape_of(name: str) -> np.ndarray:
    """Heights of a stand-in over their rms."""
    data = np.genfromtxt(ROOT / "input" / "profiles_ABCD.csv", delimiter=",", names=True)
    heights = data[f"z{name}_m"] - data[f"z{name}_m"].mean()
    return heights / heights.std()


def contact(name: str, parameter: float, hardness: float, random: np.random.Generator, folder: Path) -> tuple[Case, np.ndarray]:
    """A contact with this number and hardness; modulus, length and load are drawn over decades. Also L, w and E'."""
    modulus, length, load = 10 ** random.uniform((9, -5, 1), (12, -1, 7))
    shape = shape_of(name)
    rms = 4 * load * parameter / modulus
    file = (folder / f"similar_{name}_{random.integers(1 << 40)}.csv").resolve()
    x = np.arange(shape.size) * length / shape.size
    np.savetxt(file, np.column_stack([x, rms * shape]), delimiter=",", header="x,z", comments="", fmt="%.17e")
    case = {
        "case": {"problem": "dry_line"},
        "bodies": {"reduced_modulus": float(modulus)},
        "load": {"mean_pressure": float(load / length)},
        "surface_1": {"shape": "file", "file": str(file), "x_unit": "m", "z_unit": "m"},
        "accuracy": {"error_bars": False},
        "output": {"adequacy": False},
        "solver": {"tolerance": 1e-9},
    }
    if hardness < ELASTIC:
        case["bodies"]["hardness"] = float(hardness * load / length)
    return case, np.array([length, load, modulus])


def study(runner: Runner, count: int, claims: Claims) -> None:
    """`count` contacts for each profile, number and hardness: figure and statements."""
    random = np.random.default_rng(1)
    cases, scales = {}, {}
    for name in PROFILES:
        for i, parameter in enumerate(PARAMETERS):
            for hardness in (ELASTIC, *HARDNESSES):
                for k in range(count):
                    key = f"{name}_{i}_{hardness:g}_{k}"
                    cases[key], scales[key] = contact(name, parameter, hardness, random, runner.folder)

    def read(key: str, path: Path) -> tuple[float, np.ndarray, np.ndarray]:
        length, load, modulus = scales[key]
        _, place, hardness, _ = key.split("_")
        with h5py.File(path) as file:
            held = file["scaling"].attrs
            wanted = (PARAMETERS[int(place)], float(hardness))
            if not np.allclose((held["similarity_number"], held.get("hardness_number", ELASTIC)), wanted, rtol=1e-12):
                raise StudyError(f"{path}: /scaling does not hold the numbers {wanted} of the contact")
            pressure, gap = file["solution/pressure"][()] * length / load, file["solution/gap"][()] * modulus / (4 * load)
            return float(file["summary/contact_area_fraction"][()]), pressure, gap

    found = runner.run(cases, read)
    for file in runner.folder.glob("similar_*.csv"):
        file.unlink()

    def deviation(hardnesses: tuple[float, ...]) -> float:
        """Largest difference in P and H within the contacts of one number, over the largest P and H."""
        worst = 0.0
        for name in PROFILES:
            for i in range(len(PARAMETERS)):
                for hardness in hardnesses:
                    group = [found[f"{name}_{i}_{hardness:g}_{k}"] for k in range(count)]
                    for field in (1, 2):
                        first = group[0][field]
                        worst = max([worst] + [np.abs(other[field] - first).max() / first.max() for other in group[1:]])
        return worst

    elastic = deviation((ELASTIC,))
    claims.check(
        "(3.16) to (3.19): E'/(4 w) alone determines the elastic contact of a given dimensionless profile",
        elastic < SAME,
        f"{count} contacts for each of 4 profiles and {len(PARAMETERS)} numbers, modulus, length and load over 3, 4 and 6 decades: "
        f"P and H differ by at most {elastic:.0e} of their largest values",
    )
    middle = min(range(len(PARAMETERS)), key=lambda i: abs(PARAMETERS[i] - 1))
    areas = {h: np.array([found[f"{name}_{middle}_{h:g}_0"][0] for name in PROFILES]) for h in HARDNESSES}
    ratio = areas[HARDNESSES[0]] / areas[HARDNESSES[-1]]
    both = deviation(HARDNESSES)
    claims.check(
        "the results may be used for the elastic-perfectly plastic model too",
        "partly" if both < SAME else False,
        f"with a second number, H_s L/w: at the same both P and H differ by at most {both:.0e}; at the same E' s/(4 w) = "
        f"{PARAMETERS[middle]:.2g} the area is {ratio.min():.1f} to {ratio.max():.1f} times larger with a quarter of the hardness",
    )
    draw(found, count, runner.folder)


def draw(found: dict[str, tuple], count: int, folder: Path) -> None:
    """Contact area over the number: lines through the first contact of each, marks for all others."""
    figure, axes = style.new_figure(style.TWO_COLUMNS, 75, ncols=2)

    def plot(panel: object, name: str, hardness: float, label: str, series: dict) -> None:
        areas = np.array([[100 * found[f"{name}_{i}_{hardness:g}_{k}"][0] for k in range(count)] for i in range(len(PARAMETERS))])
        panel.loglog(PARAMETERS, areas[:, 0], color=series["color"], linestyle=series["linestyle"])
        look = {"color": series["color"], "linestyle": "none", "markerfacecolor": "none"}
        for k in range(count):
            panel.loglog(PARAMETERS, areas[:, k], marker=series["marker"], **look, label=None if k else label)

    for name, series in zip(PROFILES, style.SERIES, strict=False):
        plot(axes[0], name, ELASTIC, name, series)
    for hardness, series in zip((*HARDNESSES, ELASTIC), style.SERIES, strict=False):
        plot(axes[1], "A", hardness, f"$H_s L/w = {hardness:g}$" if hardness < ELASTIC else "elastic", series)
    for panel, title in zip(axes, ("elastic, four profiles", "profile A, with a hardness"), strict=True):
        panel.set(xlabel=r"$E'\,s/(4w)$ [-]", ylabel="Contact area [%]", title=title)
        panel.legend()
    save(figure, folder, "chapter3_similarity")
