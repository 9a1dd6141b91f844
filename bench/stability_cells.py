"""The maps of `make stability`: axes, methods, the namelist of each cell, and the class of its answer."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property

from bench_program import Answer
from chart import METHODS
from namelists import CASE_1_FILM, CASE_1_HALF_WIDTH, LAWS, RIDGE, WINDOW, Groups, case_1, moes, namelist, plane, steel

AUTO, NEWTON, DENSE = ({name: METHODS[name]} for name in ("auto", "newton_krylov", "newton_dense"))
CYCLES = {name: settings for name, settings in METHODS.items() if name.startswith("FAS")}
# The line smoother diverges with the squeeze term.
IN_TIME = {name: settings for name, settings in CYCLES.items() if "line" not in name}
# Without `intervals`: the program chooses them for 1 % in the film.
CHOSEN = "auto, its own grid"
NAMES = (
    *("moes_barus", "moes_roelands", "moes_eyring", "eyring_stress", "slide_to_roll", "intervals"),
    *("relaxation", "coarsest", "time_step", "rolling", "roughness", "ridge"),
)
MANY = 30
# Words in the reason of a run that did not converge, and its class; more of them: of the first one.
WORDS = {
    "grid too coarse": "too coarse",
    "of its wavelength, expected at most": "too coarse",  # what a feature moves in a time step
    "refused": "refused",
    "stopped from outside": "limit",
    "stagnation": "stalled",
    "cycle limit": "limit",
    "has stopped falling": "stalled",  # of dry contacts
    "the error is ": "limit",
}
# Method, column and row of a cell.
Place = tuple[str, int, int]
Text = Callable[[float, float, dict, str], "str | Groups | None"]


@dataclass
class Axis:
    """One axis of a map."""

    key: str
    label: str
    values: list


@dataclass
class StabilityMap:
    """A map: `text(x, y, settings, name)` makes the namelist of a cell, None where there is none."""

    key: str
    title: str
    x: Axis
    y: Axis
    methods: dict[str, dict]
    text: Text

    @cached_property
    def cells(self) -> dict[Place, str]:
        """Namelists of all cells, method by method."""
        found = {}
        for method, settings in self.methods.items():
            for column, x in enumerate(self.x.values):
                for row, y in enumerate(self.y.values):
                    text = self.text(x, y, settings, method)
                    if text is not None:
                        found[method, column, row] = namelist(text)
        return found


def iterations(answer: Answer) -> float:
    """Iterations on the finest grid, in time per step."""
    return answer["cycles"] / max(answer.get("steps", 1), 1) if answer.converged else 0


def status(answer: Answer | None) -> str:
    """The class of a cell."""
    if answer is None:
        return "blank"
    if answer.converged:
        return "converged" if iterations(answer) <= MANY else "late"
    return next((word for text, word in WORDS.items() if text in answer["reason"]), "failed")


def spread(first: float, last: float, count: int) -> list[float]:
    """Numbers at equal ratios, two digits."""
    return [float(f"{first * (last / first) ** (i / (count - 1)):.2g}") for i in range(count)]


def on_grid(groups: Groups, solver: dict, intervals: int | None) -> Groups:
    """Groups of a contact with a grid on the domain that the program chooses, and a method."""
    return groups | {"domain": {"intervals": intervals}, "solver": solver}


def mega(pressure: float) -> float | None:
    """A pressure [MPa] in Pa; none if infinite."""
    return None if math.isinf(pressure) else pressure * 1e6


def steady_maps(quick: bool) -> Iterator[StabilityMap]:
    """Maps over Moes' plane, of Newtonian oils and Reynolds-Eyring; tau_0 against load and slide; intervals against load."""
    n = 256 if quick else 1024
    given = f"{n} intervals"
    oils = [0, 5, 10, 20, 40] if quick else [0, 1, 2.5, 5, 7.5, 10, 15, 20, 25, 30, 40]
    loads = Axis("moes_m", "$M$ (speed sum)", spread(0.01, 2000, 8 if quick else 18))
    both = loads, Axis("moes_l", "$L$ (speed sum)", oils)
    methods = AUTO | {CHOSEN: {}} | NEWTON | CYCLES

    def over(groups: Callable[[float, float], Groups]) -> Text:
        return lambda x, y, solver, name: on_grid(groups(x, y), solver, None if name == CHOSEN else n)

    def thick(groups: Callable[[float, float], Groups]) -> Text:
        return lambda m, oil, solver, name: None if oil == 0 else over(groups)(m, oil, solver, name)

    yield StabilityMap("moes_barus", f"Newtonian, Barus, incompressible, {given}", *both, methods | DENSE, over(plane))
    roelands = thick(lambda m, oil: plane(m, oil, LAWS[3]))
    yield StabilityMap("moes_roelands", f"Newtonian, Roelands, compressible, {given}", *both, methods | DENSE, roelands)
    eyring = thick(lambda m, oil: steel(m, oil, 5 / 3, 3.3e6))
    yield StabilityMap("moes_eyring", f"Reynolds-Eyring 3.3 MPa, slide-to-roll 5/3, {given}", *both, methods | DENSE, eyring)

    stresses = [1, 3.3, 10, 100, math.inf] if quick else [1, 1.5, 2, 3.3, 5, 7, 10, 20, 50, 100, math.inf]
    y = Axis("eyring_stress_in_mpa", r"$\tau_0$ [MPa]", stresses)
    x = Axis("moes_m", "$M$ (speed sum)", spread(0.03, 2000, 7 if quick else 14))
    load = over(lambda m, tau: steel(m, 10, 5 / 3, mega(tau)))
    yield StabilityMap("eyring_stress", f"Slide-to-roll 5/3, $L$ = 10, {given}", x, y, methods, load)
    slides = [0, 0.2, 1, 5 / 3, 2, 3, 8] if quick else [0, 0.05, 0.2, 0.5, 1, 4 / 3, 5 / 3, 2, 2.5, 3, 4, 8, 20]
    x = Axis("slide_to_roll", "Slide-to-roll ratio", [round(slide, 3) for slide in slides])
    sliding = over(lambda slide, tau: steel(100, 10, slide, mega(tau)))
    yield StabilityMap("slide_to_roll", f"$M$ = 100, $L$ = 10, {given}", x, y, methods, sliding)

    x = Axis("intervals", "Intervals", [2**k for k in ((6, 8, 10, 12) if quick else (6, 7, 8, 9, 10, 12, 14, 16, 18, 20))])
    y = Axis("moes_m", "$M$ (speed sum)", [0.01, 1, 100, 2000] if quick else [0.01, 0.1, 1, 5, 20, 100, 500, 2000])
    lubricants = {"L = 10": (10, None), "L = 40": (40, None), "L = 10, 3.3 MPa": (10, 3.3e6), "L = 40, 1 MPa": (40, 1e6)}
    methods = {f"auto, {name}": {} for name in lubricants} | {"FAS, Gauss-Seidel, L = 10": CYCLES["FAS, Gauss-Seidel"]}

    def grids(intervals: float, m: float, solver: dict, name: str) -> Groups | None:
        if name.startswith("FAS") and intervals > 2**14:
            return None
        oil, stress = lubricants[name.split(", ", 2 if name.startswith("FAS") else 1)[-1]]
        return on_grid(steel(m, oil, 5 / 3, stress), solver, int(intervals))

    yield StabilityMap("intervals", "Slide-to-roll 5/3, Roelands, compressible", x, y, methods, grids)


def cycle_maps(quick: bool) -> Iterator[StabilityMap]:
    """Relaxation against sweeps, for each smoother on a light and a heavy contact; coarsest level of the cycle against the load."""
    n, levels = (256, 3) if quick else (1024, 5)
    sweeps = Axis("sweeps", "Sweeps before and after", [1, 2, 5, 10] if quick else [1, 2, 3, 5, 7, 10, 15])
    relaxations = [0.2, 0.4, 0.6, 0.8, 1.0] if quick else [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1]
    methods = {f"{name}: {case}": solver for case in ("Case 1", "Barus 20, 10") for name, solver in CYCLES.items()}

    def relaxed(relaxation: float, count: float, solver: dict, name: str) -> str:
        cycle = solver | {"relaxation": relaxation, "pre_sweeps": int(count), "post_sweeps": int(count), "levels": levels}
        return case_1(n, cycle) if name.endswith("Case 1") else moes(20, 10, n, cycle, domain=WINDOW)

    title = f"Relaxation and sweeps, {n} intervals, {levels} levels"
    yield StabilityMap("relaxation", title, Axis("relaxation", "Relaxation", relaxations), sweeps, methods, relaxed)
    intervals = 512 if quick else 1024
    coarsest = [8, 32, 128, 512] if quick else [8, 16, 32, 64, 128, 256, 512]
    x = Axis("moes_m", "$M$ (speed sum)", [1, 10, 100, 1000] if quick else [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000])

    def deep(m: float, nodes: float, solver: dict, _: str) -> str:
        return moes(m, 10, intervals, solver | {"levels": 1 + round(math.log2(intervals / nodes))}, domain=WINDOW)

    title = f"Barus, $L$ = 10, coarsest level of the cycle, {intervals} intervals"
    yield StabilityMap("coarsest", title, x, Axis("coarsest", "Intervals of the coarsest level", coarsest), AUTO | CYCLES, deep)


def time_step_map(quick: bool) -> StabilityMap:
    """Time step against slide-to-roll: the ridge of Case 3 on the faster surface."""
    n = 128 if quick else 256
    slides = [0, 1, 5 / 3, 3] if quick else [0, 0.2, 0.5, 1, 5 / 3, 2, 2.5, 4, 8]
    methods = AUTO | {"auto, backward Euler": {}} | NEWTON | IN_TIME | DENSE

    def text(slide: float, factor: float, solver: dict, name: str) -> str:
        mean, dx = 0.6, 5.5 / n
        speeds = {"speed_1": mean * (1 - slide / 2), "speed_2": mean * (1 + slide / 2)}
        steps = max(2, round(2.3 / (1 + slide / 2) / (factor * dx)))
        scheme = "backward_euler" if name.endswith("Euler") else None
        settings = {"transient": True, "end_time": steps * factor * dx, "time_step": factor * dx, "scheme": scheme}
        return case_1(n, solver, bodies=speeds, surface_2=RIDGE | {"position": -1.5}, time=settings)

    x = Axis("slide_to_roll", "Slide-to-roll ratio", [round(slide, 3) for slide in slides])
    y = Axis("time_step_over_dx", r"$\Delta T/\Delta X$", [0.25, 0.5, 1, 2] if quick else [0.125, 0.25, 0.5, 1, 2, 4, 8])
    return StabilityMap("time_step", f"A ridge passes, iterations per step, {n} intervals", x, y, methods, text)


def rolling_map(quick: bool) -> StabilityMap:
    """Without sliding: intervals against time step, ten steps of a ridge in Case 1, its oil and a Newtonian one."""
    oils = {"Eyring": {}, "Newtonian": {"rheology": "newtonian", "eyring_stress": None}}
    methods = {f"{name}: {oil}": solver for oil in oils for name, solver in (AUTO | IN_TIME).items()}

    def text(intervals: float, factor: float, solver: dict, name: str) -> str:
        step = factor * 5.5 / intervals
        return case_1(
            int(intervals),
            solver,
            bodies={"speed_1": 0.6, "speed_2": 0.6},
            lubricant=oils[name.split(": ")[1]],
            surface_2=RIDGE | {"position": -1.5},
            time={"transient": True, "end_time": 10 * step, "time_step": step},
        )

    x = Axis("intervals", "Intervals", [2**k for k in ((6, 7, 8, 9) if quick else (6, 7, 8, 9, 10, 11, 12))])
    y = Axis("time_step_over_dx", r"$\Delta T/\Delta X$", [0.0625, 0.25, 1] if quick else [0.0625, 0.125, 0.25, 0.5, 1, 2])
    return StabilityMap("rolling", "A ridge rolls in without sliding, iterations per step", x, y, methods, text)


def roughness_maps(quick: bool) -> Iterator[StabilityMap]:
    """Amplitude against wavelength: a wavy surface at rest under a sliding one, and a ridge that passes."""
    waves = [0.25, 0.5, 1, 2] if quick else [0.125, 0.25, 0.5, 0.75, 1, 1.5, 2, 3, 4]
    heights = [0.1, 0.3, 0.6, 1.0] if quick else [0.01, 0.03, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0, 1.2]
    both = Axis("wavelength_over_b", r"Wavelength $\Lambda/b$", waves), Axis("amplitude_over_film", r"Amplitude $A/h_c$", heights)
    n, nodes = (512, 256) if quick else (2048, 512)

    def shape(kind: str, wave: float, height: float) -> dict:
        return {"shape": kind, "amplitude": height * CASE_1_FILM, "wavelength": wave * CASE_1_HALF_WIDTH}

    def wavy(wave: float, height: float, solver: dict, _: str) -> str:
        return case_1(n, solver, bodies={"speed_1": 0.0, "speed_2": 1.2}, surface_1=shape("sinusoid", wave, height))

    def ridge(wave: float, height: float, solver: dict, _: str) -> str:
        time = {"transient": True, "end_time": 1.5, "time_step": 5.5 / nodes / 2}
        return case_1(nodes, solver, surface_2=shape("feature", wave, height) | {"position": -2.0}, time=time)

    title = f"Case 1, sinusoid on a surface at rest, steady, {n} intervals"
    yield StabilityMap("roughness", title, *both, AUTO | NEWTON | CYCLES, wavy)
    title = f"Case 3 with other ridges, iterations per step, {nodes} intervals"
    yield StabilityMap("ridge", title, *both, AUTO | NEWTON | IN_TIME, ridge)


def all_maps(quick: bool) -> Iterator[StabilityMap]:
    """All maps in the order of NAMES."""
    yield from steady_maps(quick)
    yield from cycle_maps(quick)
    yield time_step_map(quick)
    yield rolling_map(quick)
    yield from roughness_maps(quick)
