"""Limits of Reynolds' equation: contacts with a ridge at rest by both equations, and a rule for their difference.

Eyring stress, slope and length of the ridge, speed (film) and load are random; a rule is fitted to one sample and judged by
another.
"""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
from study import Case, Claims, Runner, StudyError, Table, base_case, changed, save, style

SEEDS = {"fit": 20261201, "judge": 20261202}
QUANTITIES = {"h_min": "difference_h_min", "pressure": "difference_pressure"}


def random_case(source: np.random.Generator) -> Case:
    """Case 1 with surface 1 at rest and a ridge on it somewhere in the contact."""

    def between(low: float, high: float) -> float:
        return float(np.exp(source.uniform(np.log(low), np.log(high))))

    stress, load, speed = between(1e6, 20e6), between(0.5e5, 2e5), between(0.4, 4.0)
    wavelength, slope, place = between(0.5e-4, 2e-4), between(5e-4, 6e-3), source.uniform(-0.6, 0.6)
    case = base_case("case1")
    case["case"]["equations"] = "stokes"
    return changed(
        case,
        bodies={"speed_1": 0.0, "speed_2": speed},
        load={"load_per_length": load},
        lubricant={"eyring_stress": stress},
        surface_1={"shape": "feature", "amplitude": slope * wavelength, "wavelength": wavelength, "position": place},
        solver={"space_scheme": "kappa"},
        domain={"intervals": 384},
        film={"layers": 10},
    )


def read_row(_: str, path: Path) -> dict[str, float]:
    """The differences, and the smallest film [m]."""
    with h5py.File(path) as file:
        found = {name: abs(float(file["momentum"][key][()])) for name, key in QUANTITIES.items()}
        found["t_max"] = float(file["momentum/stress_rise"][()])
        found["film"] = float(file["summary/h_min"][()]) * float(file["summary/h_min"].attrs["si_scale"])
    return found


def read_limits(_: str, path: Path) -> dict[str, float]:
    """What a result of Reynolds' equation says of its limits: T_max of the sliding, largest slope of a surface."""
    with h5py.File(path) as file:
        limits = file["adequacy/validity"]
        return {"sliding": float(limits["stokes_number"][()]), "surface_slope": float(limits["surface_slope"][()])}


def ridge_case(stress: float = 3.3, slope: float = 0.002, speed: float = 1.2) -> Case:
    """A ridge of the thesis's wavelength at rest in the middle of Case 1; stress [MPa], speed of the smooth surface [m/s]."""
    case = random_case(np.random.default_rng(0))
    wavelength = 1e-4
    return changed(
        case,
        bodies={"speed_1": 0.0, "speed_2": speed},
        load={"load_per_length": 1e5},
        lubricant={"eyring_stress": 1e6 * stress},
        surface_1={"shape": "feature", "amplitude": slope * wavelength, "wavelength": wavelength, "position": 0.0},
    )


SERIES = {
    "stress": (1.0, 1.5, 2.2, 3.3, 5.0, 7.0, 10.0, 14.0, 20.0),
    "slope": (0.0002, 0.0005, 0.001, 0.0015, 0.002, 0.003, 0.004),
    "speed": (0.6, 0.85, 1.2, 1.7, 2.4, 3.4, 4.8, 6.8),
}


def solve_both(runner: Runner, name: str, case: Case) -> dict[str, float] | None:
    """One contact by both equations; none where Reynolds' equation has no film."""
    plain = changed(case, film=None)
    plain["case"].pop("equations")
    try:
        limits = runner.run({f"{name}_plain": plain}, read_limits)[f"{name}_plain"]
        row = runner.run({name: case}, read_row)[name]
    except StudyError as reason:
        print(f"left out: {str(reason).splitlines()[1]}")
        return None
    ridge = case["surface_1"]
    row["stress"] = case["lubricant"]["eyring_stress"] / 1e6
    row["slope"] = ridge["amplitude"] / ridge["wavelength"]
    return row | limits


def fitted(rows: list[dict[str, float]], quantity: str) -> np.ndarray:
    """C, a, b of difference = C T^a (A/Lambda)^b by least squares of logarithms."""
    logs = {name: np.log([row[name] for row in rows]) for name in (quantity, "sliding", "slope")}
    sides = np.column_stack([np.ones(len(rows)), logs["sliding"], logs["slope"]])
    solution = np.linalg.lstsq(sides, logs[quantity], rcond=None)[0]
    return np.array([np.exp(solution[0]), *solution[1:]])


def ruled(rule: np.ndarray, rows: list[dict[str, float]]) -> np.ndarray:
    """The differences that a rule predicts."""
    return np.array([rule[0] * row["sliding"] ** rule[1] * row["slope"] ** rule[2] for row in rows])


def find_rule(runner: Runner, folder: Path, claims: Claims) -> None:
    """Both samples, the series, the rules with their errors, and the chart."""
    table = Table(
        sample="fit, judge, or what is varied in a series",
        stress="Eyring stress [MPa]",
        slope="A/Lambda of the ridge",
        film="smallest film [m]",
        sliding="T_max of the sliding",
        surface_slope="largest slope of a surface",
        t_max="T_max with the pressure gradient",
        h_min="difference of h_min, relative",
        pressure="largest difference of P [p_h]",
    )
    groups = {}
    for sample, seed in SEEDS.items():
        source = np.random.default_rng(seed)
        found = [solve_both(runner, f"{sample}_{i}", random_case(source)) for i in range(60)]
        groups[sample] = [row for row in found if row]
    for key, values in SERIES.items():
        found = [solve_both(runner, f"{key}_{value:g}", ridge_case(**{key: value})) for value in values]
        groups[key] = [row for row in found if row]
    for sample, rows in groups.items():
        for row in rows:
            table.add(sample=sample, **row)
    table.write(folder / "momentum_rule", "Contacts with a ridge at rest by both equations")
    rules = {quantity: fitted(groups["fit"], quantity) for quantity in QUANTITIES}
    for quantity, rule in rules.items():
        factors = np.array([row[quantity] for row in groups["judge"]]) / ruled(rule, groups["judge"])
        off = np.maximum(factors, 1 / factors)
        claims.check(
            f"Beyond the thesis: a rule for the difference of {quantity}, T_max of the sliding and A/Lambda",
            "fitted on one sample, judged by another",
            f"{rule[0]:.3g} T^{rule[1]:.2f} (A/Lambda)^{rule[2]:.2f}, fitted on {len(groups['fit'])} contacts; "
            f"of {len(off)} others {np.mean(off < 1.5):.0%} are within 1.5 times, {np.mean(off < 2):.0%} within 2, "
            f"the worst {off.max():.1f} times; three times the rule is exceeded by {np.mean(factors > 3):.0%}",
        )
    draw_rule(folder, groups, rules)


def draw_rule(folder: Path, groups: dict[str, list[dict[str, float]]], rules: dict[str, np.ndarray]) -> None:
    """Differences over Eyring stress, slope and film with the rules, and the rules beside the sample that judges them."""
    figure, axes = style.new_figure(style.TWO_COLUMNS, 120, nrows=2, ncols=2)
    places = {
        "stress": ("stress", 1, "Eyring stress [MPa]", (1, 2, 5, 10, 20)),
        "slope": ("slope", 1e3, "Ridge height over wavelength $A/\\Lambda$ [1e-3]", (0.2, 0.5, 1, 2, 4)),
        "speed": ("film", 1e6, "Smallest film thickness [µm]", (0.3, 0.5, 1)),
    }
    names = {"h_min": "smallest film", "pressure": "pressure, largest, over $p_\\mathrm{h}$"}
    for panel, (key, (column, unit, label, ticks)) in zip(axes.flat, places.items(), strict=False):
        rows = sorted(groups[key], key=lambda row, column=column: row[column])
        x = [unit * row[column] for row in rows]
        for quantity, look in zip(QUANTITIES, style.SERIES, strict=False):
            panel.loglog(x, [100 * row[quantity] for row in rows], label=names[quantity], **look)
            panel.loglog(x, 100 * ruled(rules[quantity], rows), color=look["color"], linewidth=0.8, linestyle=(0, (2, 2)))
        panel.set(xlabel=label, ylabel="Difference [%]", ylim=(0.01, 5))
        panel.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
        panel.minorticks_off()
    panel = axes.flat[3]
    rows = groups["judge"]
    for quantity, look in zip(QUANTITIES, style.SERIES, strict=False):
        marks = {**look, "linestyle": "none", "markersize": 3}
        panel.loglog(100 * ruled(rules[quantity], rows), [100 * row[quantity] for row in rows], **marks)
    ends = np.array([0.005, 5.0])
    for factor in (1 / 3, 1, 3):
        panel.loglog(ends, factor * ends, color="0.5", linewidth=0.6, zorder=0)
    panel.set(xlabel="Difference by the rule [%]", ylabel="Computed difference [%]", xlim=ends, ylim=ends)
    panel.minorticks_off()
    handles = axes.flat[0].get_legend_handles_labels()[0]
    for words, look in (
        ("rule", {"color": "0.2", "linestyle": (0, (2, 2))}),
        ("a third of the rule, the rule, three times the rule", {"color": "0.5"}),
    ):
        handles.append(style.plt.Line2D([], [], linewidth=0.8, label=words, **look))
    style.legend_below(figure, handles, 2)
    save(figure, folder, "momentum_rule")
