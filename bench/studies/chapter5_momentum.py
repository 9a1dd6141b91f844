"""Chapter 5: the full momentum equations of the film against Reynolds' equation, smooth and steady.

Case 1 on several grids and numbers of layers, with inertia, with the speeds exchanged, and with other Eyring stresses.
"""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
from chapter5_passages import draw_difference
from study import Case, Claims, Runner, Table, base_case, changed, save, style

STRESSES = (1.0, 1.5, 2.2, 3.3, 5.0, 7.0, 10.0, 14.0, 20.0)  # MPa
GRIDS = ((256, 20), (512, 20), (1024, 20), (512, 10), (512, 40))
NUMBERS = ("difference_h_min", "difference_h_central", "difference_p_max", "difference_pressure", "pressure_variation")


def momentum_case(intervals: int, layers: int, inertia: bool = False) -> Case:
    """Case 1 with its full momentum equations."""
    case = base_case("case1")
    case["case"]["equations"] = "stokes"
    return changed(
        case,
        solver={"space_scheme": "kappa"},
        domain={"intervals": intervals},
        film={"layers": layers, "inertia": inertia},
    )


def read_differences(_: str, path: Path) -> dict[str, float]:
    """The differences from the Reynolds equation, and T_max."""
    with h5py.File(path) as file:
        found = {name: float(file["momentum"][name][()]) for name in NUMBERS}
        found["t_max"] = float(file["momentum/stress_rise"][()])
        found["seconds"] = float(file["report/wall_seconds"][()])
        found["memory"] = float(file["report/peak_memory"][()]) / 1e6
    return found


def read_profiles(_: str, path: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """X, and the differences of P [% of p_h] and H [% of the central film]."""
    with h5py.File(path) as file:
        x, pressure, film = (file["solution"][name][()] for name in ("x", "pressure", "film_thickness"))
        before = [file["momentum"][f"reynolds_{name}"][()] for name in ("pressure", "film_thickness")]
    return x, 100 * (pressure - before[0]), 100 * (film - before[1]) / float(np.interp(0, x, before[1]))


def draw_smooth(folder: Path, profiles: tuple[np.ndarray, np.ndarray, np.ndarray]) -> None:
    """Figure 5.4."""
    figure, axes = style.new_figure(style.ONE_COLUMN, 62)
    _, pressure, film = profiles
    lines = draw_difference(axes, *profiles, [1.15 * np.abs(pressure).max(), 1.15 * np.abs(film).max()])
    axes.set_xlabel("Position $X$ [-]")
    style.legend_below(figure, lines, 2)
    save(figure, folder, "figure_5_4_difference_case1")


def differences_table() -> Table:
    """An empty table."""
    return Table(
        name="case",
        intervals="intervals in X",
        layers="layers across the film",
        stress="Eyring stress [MPa]",
        t_max="T_max, largest d tau/dp at a given shear rate",
        difference_h_min="h_min over that of Reynolds' equation on the same grid, less 1",
        difference_h_central="h_central likewise",
        difference_p_max="p_max likewise",
        difference_pressure="largest difference of the mean pressure [p_h]",
        pressure_variation="largest difference of pressures across the film [p_h]",
        seconds="wall time of the run [s]",
        memory="most memory of the run [MB]",
    )


def compare(runner: Runner, folder: Path, claims: Claims) -> None:
    """The table, and the statements of the chapter on smooth surfaces."""
    table = differences_table()
    cases = {f"case1_{n}x{m}": momentum_case(n, m) for n, m in GRIDS}
    given = momentum_case(512, 20)
    cases["case1_inertia"] = momentum_case(512, 20, inertia=True)
    cases["case1_speeds_exchanged"] = changed(given, bodies={"speed_1": 1.1, "speed_2": 0.1})
    cases |= {f"stress_{s:g}": changed(given, lubricant={"eyring_stress": 1e6 * s}) for s in STRESSES}
    found = runner.run(cases, read_differences)
    for name, case in cases.items():
        layers, stress = case["film"]["layers"], case["lubricant"]["eyring_stress"] / 1e6
        table.add(name=name, intervals=case["domain"]["intervals"], layers=layers, stress=stress, **found[name])
    table.show(
        "Full momentum beside Reynolds, Case 1",
        name="",
        stress="g",
        t_max=".4f",
        **dict.fromkeys(NUMBERS, ".3e"),
        seconds=".2f",
        memory=".0f",
    )
    table.write(folder / "momentum", "Case 1 by the full momentum equations beside Reynolds' equation")
    draw_smooth(folder, runner.run({"case1": given}, read_profiles)["case1"])
    smooth, other = found["case1_512x20"], found["case1_speeds_exchanged"]
    claims.check(
        "Case 1: deviations from the full momentum equations are extremely small",
        max(abs(smooth[name]) for name in NUMBERS) < 1e-3,
        f"h_min {smooth['difference_h_min']:+.2e}, h_central {smooth['difference_h_central']:+.2e} of itself, "
        f"P by at most {smooth['difference_pressure']:.2e} of p_h",
    )
    shift = max(abs(other[name] - smooth[name]) for name in ("difference_h_min", "difference_h_central"))
    claims.check(
        "Case 1: nor has the sign of the slide-to-roll ratio an influence with the full momentum equations",
        shift < 1e-3,
        f"the differences from Reynolds' equation change by up to {shift:.1e} of the film: the slow surface is then the flat one",
    )
