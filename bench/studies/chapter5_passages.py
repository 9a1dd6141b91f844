"""Chapter 5 in time: Cases 2 and 3 by the full momentum equations against Reynolds' equation.

Both use the same time steps and grid, so that their errors nearly cancel in the difference; half of the intervals, half of the
layers and twice the step measure the rest.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np
from chapter5_figures import CENTRE, CENTRES
from study import Case, Claims, Runner, Table, base_case, changed, save, style

SPEEDS = {"case2": 1 / 6, "case3": 11 / 6}  # of the ridge, half-widths per unit of T, from X = -2.5
STEPS = {"case2": 96, "case3": 48}  # from one of the five places to the next
INTERVALS, LAYERS = 512, 10
WINDOW = (-1.6, 1.3)


@dataclass(frozen=True)
class Difference:
    """Profiles of both equations (time, node) with the ridge on its way, and the largest pressure difference across the film."""

    ridge: np.ndarray
    x: np.ndarray
    pressure: np.ndarray
    film: np.ndarray
    central: float
    across: float
    seconds: float
    memory: float

    def at(self, centre: float) -> int:
        """The profile with the ridge at a place."""
        return int(np.argmin(np.abs(self.ridge - centre)))

    def largest(self) -> dict[str, float]:
        """Largest differences of all times: of P [p_h], of H over the smooth central film, and of P across the film [p_h]."""
        film = np.abs(self.film).max() / self.central
        return {"pressure": float(np.abs(self.pressure).max()), "film": float(film), "across": self.across}


def passage_case(name: str, intervals: int = INTERVALS, layers: int = LAYERS, factor: int = 1) -> Case:
    """Case 2 or 3 by both equations, with a multiple of the time step, until the ridge has left; a profile every four steps."""
    case = base_case(name)
    case["case"]["equations"] = "stokes"
    step = 0.5 / SPEEDS[name] / STEPS[name] * factor
    return changed(
        case,
        solver={"space_scheme": "kappa"},
        domain={"intervals": intervals},
        film={"layers": layers},
        time={"time_step": step, "end_time": 8 * STEPS[name] // factor * step, "scheme": "bdf2"},
        output={"profile_stride": 4 // factor},
    )


def read_difference(name: str, path: Path) -> Difference:
    """What the full equations change."""
    with h5py.File(path) as file:
        both = file["transient"], file["momentum/transient"]
        change = [both[1][key][()] - both[0][key][()] for key in ("pressure", "film_thickness")]
        time, x = both[1]["profile_time"][()], file["solution/x"][()]
        central = float(np.interp(0, x, both[0]["film_thickness"][0]))
        across = float(file["momentum/pressure_variation"][()])
        seconds, memory = float(file["report/wall_seconds"][()]), float(file["report/peak_memory"][()]) / 1e6
    return Difference(-2.5 + SPEEDS[name[:5]] * time, x, *change, central, across, seconds, memory)


def passages_table() -> Table:
    """An empty table."""
    return Table(
        name="case",
        place="X of the ridge, or all",
        pressure="largest difference of P [% of p_h]",
        pressure_error="its error: changes with half the intervals, half the layers and twice the step, added",
        film="largest difference of H [% of the smooth central film]",
        film_error="its error likewise",
        across="largest difference of P across the film [% of p_h], all times",
        across_error="its error likewise",
        seconds="wall time of the run [s]",
        memory="most memory of the run [MB]",
    )


def compare_passages(runner: Runner, folder: Path, claims: Claims) -> None:
    """Table, figures 5.5 and 5.6, and the statements."""
    table, found = passages_table(), {}
    for name in SPEEDS:
        other = {"base": (256, 10, 1), "layers": (256, 5, 1), "step": (256, 10, 2), "given": (INTERVALS, LAYERS, 1)}
        cases = {f"{name}_{kind}": passage_case(name, *settings) for kind, settings in other.items()}
        runs = runner.run(cases, read_difference)
        given, base, *changes = (runs[f"{name}_{kind}"] for kind in ("given", "base", "layers", "step"))
        found[name] = given
        for centre in (*CENTRES, None):
            values, errors = numbers(given, centre), 0.0
            for pair in ((given, base), *((base, run) for run in changes)):
                errors = errors + np.abs(numbers(pair[0], centre) - numbers(pair[1], centre))
            row = dict(zip(("pressure", "film", "across"), 100 * values, strict=True))
            row |= dict(zip(("pressure_error", "film_error", "across_error"), 100 * errors, strict=True))
            if centre is not None:
                row = {key: value for key, value in row.items() if not key.startswith("across")}
            if centre is None:
                row |= {"seconds": given.seconds, "memory": given.memory}
            table.add(name=name, place="all" if centre is None else f"{centre:g}", **row)
        draw_passage(folder, given, name)
    table.show(
        "Full momentum beside Reynolds, Cases 2 and 3 [%]",
        name="",
        place="",
        **dict.fromkeys(list(table.columns)[2:8], ".4f"),
        seconds=".0f",
        memory=".0f",
    )
    table.write(folder / "momentum_passages", "Cases 2 and 3 by the full momentum equations beside Reynolds' equation")
    check(claims, {row["name"]: row for row in table.rows if row["place"] == "all"})


def numbers(run: Difference, centre: float | None) -> np.ndarray:
    """Largest difference of P, of H and of P across the film, with the ridge at a place or over all times."""
    largest = run.largest()
    if centre is None:
        return np.array(list(largest.values()))
    row = run.at(centre)
    return np.array([np.abs(run.pressure[row]).max(), np.abs(run.film[row]).max() / run.central, largest["across"]])


def check(claims: Claims, rows: dict[str, dict[str, float]]) -> None:
    """The statements about CFD beside Reynolds' equation."""
    slow, fast = rows["case2"], rows["case3"]

    def sizes(row: dict[str, float]) -> str:
        return (
            f"P {row['pressure']:.3f} +- {row['pressure_error']:.3f} % of p_h, "
            f"H {row['film']:.3f} +- {row['film_error']:.3f} % of the central film"
        )

    claims.check("5.4: Case 2, once again the deviations are very small", slow["pressure"] < 0.5, sizes(slow))
    claims.check(
        "5.4: Case 3, the largest deviation is about 1 %, smaller than the errors of the numerics",
        f"the equations differ by {fast['pressure']:.2f} %: most of the 1 % is numerical" if fast["pressure"] < 0.5 else "agrees",
        sizes(fast),
    )
    vanishes = all(row["pressure"] < 2 * row["pressure_error"] for row in rows.values())
    claims.check(
        "5.4: with finer steps and grids the deviation will probably vanish",
        vanishes or "partly: it falls to a tenth of a per cent, which stays",
        "differences on one grid with the error of grid, layers and step: " + "; ".join(sizes(row) for row in (slow, fast)),
    )
    ratios = [row["pressure"] / row["film"] for row in (slow, fast)]
    claims.check(
        "5.5: the deviation in pressure is 10 to 20 times that in film",
        all(10 <= ratio <= 20 for ratio in ratios),
        "P in units of p_h over H in units of the central film: " + ", ".join(f"{ratio:.1f}" for ratio in ratios),
    )
    claims.check(
        "5.5: the fast ridge is harder to simulate; its transient effects are larger",
        "not by the equations" if fast["pressure"] < 1.2 * slow["pressure"] else "agrees",
        f"largest difference of P: {slow['pressure']:.3f} % (Case 2), {fast['pressure']:.3f} % (Case 3)",
    )


def draw_passage(folder: Path, run: Difference, name: str) -> None:
    """Figures 5.5 and 5.6: differences of P and H over X with the ridge at five places."""
    figure, axes = style.new_figure(style.ONE_COLUMN, 190, nrows=len(CENTRES), sharex=True)
    pressure, film = 100 * run.pressure, 100 * run.film / run.central
    limits = [1.15 * max(np.abs(values[run.at(centre)]).max() for centre in CENTRES) for values in (pressure, film)]
    for panel, centre in zip(axes, CENTRES, strict=True):
        row = run.at(centre)
        lines = draw_difference(panel, run.x, pressure[row], film[row], limits)
        lines.append(panel.axvline(run.ridge[row], label="centre of the ridge", **CENTRE))
        panel.set_title(f"ridge at $X$ = {centre:g}".replace("-", "\N{MINUS SIGN}"))
    axes[-1].set_xlabel("Position $X$ [-]")
    figure.suptitle(f"Case {name[-1]}: full momentum less Reynolds", fontsize=9)
    style.legend_below(figure, lines, 3)
    save(figure, folder, f"figure_5_{int(name[-1]) + 3}_difference_{name}")


def draw_difference(panel: object, x: np.ndarray, pressure: np.ndarray, film: np.ndarray, limits: list[float]) -> list:
    """Film on the left, pressure on the right, both in per cent with the zero in the middle."""
    twin = panel.twinx()
    lines = panel.plot(x, film, label="film", **style.FILM)
    lines += twin.plot(x, pressure, label="pressure", **style.PRESSURE)
    panel.set(xlim=WINDOW, ylim=(-limits[1], limits[1]), ylabel="$\\Delta h/h_\\mathrm{c}$ [%]")
    twin.set(ylim=(-limits[0], limits[0]), ylabel="$\\Delta p/p_\\mathrm{h}$ [%]")
    panel.tick_params(right=False)
    twin.tick_params(left=False)
    return lines
