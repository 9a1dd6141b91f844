"""The maps of `make stability`: axes, methods, the namelist of each cell, and the class of its answer."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property

from bench_program import Answer
from chart import METHODS
from family_dry import PROBLEMS, sizes
from namelists import CASE_1_FILM, CASE_1_HALF_WIDTH, LAWS, RIDGE, WINDOW, Groups, case_1, moes, namelist, plane, steel

AUTO, NEWTON, DENSE = ({name: METHODS[name]} for name in ("auto", "newton_krylov", "newton_dense"))
CYCLES = {name: settings for name, settings in METHODS.items() if name.startswith("FAS")}
# The line smoother diverges with the squeeze term.
IN_TIME = {name: settings for name, settings in CYCLES.items() if "line" not in name}
# Without `intervals`: the program chooses them for 1 % in the film.
CHOSEN = "auto, its own grid"
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
# Of dry contacts: methods, material and surface, iterations at most; of finer areas steepest descent would take hours.
DRY_METHODS = ("conjugate_gradient", "steepest_descent")
MODULUS, HEIGHT, LENGTH = 200e9, 1e-6, 1e-3
MOST, MOST_NODES = 6000, {DRY_METHODS[1]: 256}
LABELS = {
    **{"moes_m": "$M$ (speed sum)", "moes_l": "$L$ (speed sum)", "eyring_stress_in_mpa": r"$\tau_0$ [MPa]"},
    **{"slide_to_roll": "Slide-to-roll ratio", "intervals": "Intervals", "relaxation": "Relaxation"},
    **{"sweeps": "Sweeps before and after", "coarsest": "Intervals of the coarsest level"},
    **{"time_step_over_dx": r"$\Delta T/\Delta X$", "wavelength_over_b": r"Wavelength $\Lambda/b$"},
    **{"amplitude_over_film": r"Amplitude $A/h_c$", "load": "Mean pressure over $E^* g$ [-]", "nodes": "Nodes a side"},
    **{"hardness": "Hardness/$E^* g$", "hurst": "Hurst exponent"},
}
# Method, column and row of a cell.
Place = tuple[str, int, int]
Text = Callable[[float, float, dict, str], "str | Groups | None"]


@dataclass
class Axis:
    """One axis of a map."""

    key: str
    values: list

    @property
    def label(self) -> str:
        """Its name in a figure."""
        return LABELS[self.key]

    def value(self, i: int) -> str:
        """A value; numbers of intervals as powers of two."""
        value = self.values[i]
        if self.key == "intervals":
            return f"$2^{{{round(math.log2(value))}}}$"
        return "none" if value is None else "∞" if math.isinf(value) else f"{value:g}"


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
        places = itertools.product(self.methods.items(), enumerate(self.x.values), enumerate(self.y.values))
        texts = {(name, i, j): self.text(x, y, settings, name) for (name, settings), (i, x), (j, y) in places}
        return {place: namelist(text) for place, text in texts.items() if text is not None}


def iterations(answer: Answer) -> float:
    """Iterations on the finest grid, in time per step."""
    return answer["cycles"] / max(answer.get("steps", 1), 1) if answer.converged else 0


def status(answer: Answer) -> str:
    """The class of a cell; `closed`: full contact or all plastic, in closed form; `no cycle`: one level, solved exactly."""
    if not answer.converged:
        return next((word for text, word in WORDS.items() if text in answer["reason"]), "failed")
    if answer.get("method") in ("full_contact", "all_plastic"):
        return "closed"
    if "fas" in answer.get("method", "") and answer["levels"] == 1:
        return "no cycle"
    return "converged" if iterations(answer) <= MANY else "late"


def spread(first: float, last: float, count: int) -> list[float]:
    """Numbers at equal ratios, two digits."""
    return [float(f"{first * (last / first) ** (i / (count - 1)):.2g}") for i in range(count)]


def on_grid(groups: Groups, solver: dict, intervals: int | None) -> Groups:
    """Groups of a contact with a grid on the domain that the program chooses, and a method."""
    return groups | {"domain": {"intervals": intervals}, "solver": solver}


def axis(key: str, values: list, quick: bool) -> Axis:
    """An axis, of a quick map with every third value."""
    return Axis(key, values[::3] if quick else values)


def si(m: float, oil: float, slide: float, stress: float) -> Groups:
    """A contact in SI by Moes' numbers, slide-to-roll ratio and Eyring stress [MPa]; infinite: Newtonian."""
    return steel(m, oil, slide, None if math.isinf(stress) else stress * 1e6)


def steady_maps(quick: bool) -> Iterator[StabilityMap]:
    """Over Moes' plane, of Newtonian oils and Reynolds-Eyring; tau_0 against load and slide; intervals against load."""
    n = 256 if quick else 1024
    methods = AUTO | {CHOSEN: {}} | NEWTON | CYCLES
    plane_axes = axis("moes_m", spread(0.01, 2000, 18), quick), axis("moes_l", [0, 1, 2.5, 5, 7.5, 10, 15, 20, 25, 30, 40], quick)
    stresses = axis("eyring_stress_in_mpa", [1, 1.5, 2, 3.3, 5, 7, 10, 20, 50, 100, math.inf], quick)
    slides = axis("slide_to_roll", [0, 0.05, 0.2, 0.5, 1, 1.333, 1.667, 2, 2.5, 3, 4, 8, 20], quick)
    sizes = axis("intervals", [2**k for k in (6, 7, 8, 9, 10, 12, 14, 16, 18, 20)], quick)

    def over(groups: Callable[[float, float], Groups], least: float = 0) -> Text:
        def text(x: float, y: float, solver: dict, name: str) -> Groups | None:
            return on_grid(groups(x, y), solver, None if name == CHOSEN else n) if y >= least else None

        return text

    for key, title, groups, least in (
        ("moes_barus", "Newtonian, Barus, incompressible", plane, 0),
        ("moes_roelands", "Newtonian, Roelands, compressible", lambda m, oil: plane(m, oil, LAWS[3]), 1),
        ("moes_eyring", "Reynolds-Eyring 3.3 MPa, slide-to-roll 5/3", lambda m, oil: si(m, oil, 5 / 3, 3.3), 1),
    ):
        yield StabilityMap(key, f"{title}, {n} intervals", *plane_axes, methods | DENSE, over(groups, least))
    title, loads = f"Slide-to-roll 5/3, $L$ = 10, {n} intervals", axis("moes_m", spread(0.03, 2000, 14), quick)
    yield StabilityMap("eyring_stress", title, loads, stresses, methods, over(lambda m, tau: si(m, 10, 5 / 3, tau)))
    title = f"$M$ = 100, $L$ = 10, {n} intervals"
    yield StabilityMap("slide_to_roll", title, slides, stresses, methods, over(lambda slide, tau: si(100, 10, slide, tau)))

    oils = {"L = 10": (10, math.inf), "L = 40": (40, math.inf), "L = 10, 3.3 MPa": (10, 3.3), "L = 40, 1 MPa": (40, 1)}
    methods = {f"auto, {name}": {} for name in oils} | {"FAS, Gauss-Seidel, L = 10": CYCLES["FAS, Gauss-Seidel"]}

    def grids(intervals: float, m: float, solver: dict, name: str) -> Groups | None:
        oil, stress = oils[name.removeprefix("auto, ").removeprefix("FAS, Gauss-Seidel, ")]
        return None if solver and intervals > 2**14 else on_grid(si(m, oil, 5 / 3, stress), solver, intervals)

    loads = axis("moes_m", [0.01, 0.1, 1, 5, 20, 100, 500, 2000], quick)
    yield StabilityMap("intervals", "Slide-to-roll 5/3, Roelands, compressible", sizes, loads, methods, grids)


def cycle_maps(quick: bool) -> Iterator[StabilityMap]:
    """Relaxation against sweeps, for each smoother on a light and a heavy contact; coarsest level of the cycle against the load."""
    n, levels = (256, 3) if quick else (1024, 5)

    def relaxed(relaxation: float, count: int, solver: dict, name: str) -> str:
        cycle = solver | {"relaxation": relaxation, "pre_sweeps": count, "post_sweeps": count, "levels": levels}
        return case_1(n, cycle) if name.endswith("Case 1") else moes(20, 10, n, cycle, domain=WINDOW)

    def deep(m: float, nodes: float, solver: dict, _: str) -> str:
        return moes(m, 10, 1024, solver | {"levels": 1 + round(math.log2(1024 / nodes))}, domain=WINDOW)

    methods = {f"{name}: {case}": solver for case in ("Case 1", "Barus 20, 10") for name, solver in CYCLES.items()}
    relaxations = axis("relaxation", [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1], quick)
    title, sweeps = f"Relaxation and sweeps, {n} intervals, {levels} levels", axis("sweeps", [1, 2, 3, 5, 7, 10, 15], quick)
    yield StabilityMap("relaxation", title, relaxations, sweeps, methods, relaxed)
    title, coarsest = "Barus, $L$ = 10, coarsest level of the cycle", axis("coarsest", [8, 16, 32, 64, 128, 256, 512], quick)
    loads = axis("moes_m", [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000], quick)
    yield StabilityMap("coarsest", f"{title}, 1024 intervals", loads, coarsest, AUTO | CYCLES, deep)


def passing_maps(quick: bool) -> Iterator[StabilityMap]:
    """Time steps: the ridge of Case 3 on the faster surface; ten steps of one that rolls in without sliding, of two oils."""
    n, ridge = 128 if quick else 256, RIDGE | {"position": -1.5}

    def speeds(slide: float) -> dict:
        return {"speed_1": 0.6 * (1 - slide / 2), "speed_2": 0.6 * (1 + slide / 2)}

    def sliding(slide: float, factor: float, solver: dict, name: str) -> str:
        step = factor * 5.5 / n
        count = max(2, round(2.3 / (1 + slide / 2) / step))
        scheme = "backward_euler" if name.endswith("Euler") else None
        settings = {"transient": True, "end_time": count * step, "time_step": step, "scheme": scheme}
        return case_1(n, solver, bodies=speeds(slide), surface_2=ridge, time=settings)

    def rolling(intervals: int, factor: float, solver: dict, name: str) -> str:
        step, oil = factor * 5.5 / intervals, oils[name.split(": ")[1]]
        time = {"transient": True, "end_time": 10 * step, "time_step": step}
        return case_1(intervals, solver, bodies=speeds(0.0), lubricant=oil, surface_2=ridge, time=time)

    slides = axis("slide_to_roll", [0, 0.2, 0.5, 1, 1.667, 2, 2.5, 4, 8], quick)
    steps = axis("time_step_over_dx", [0.125, 0.25, 0.5, 1, 2, 4, 8], quick)
    methods = AUTO | {"auto, backward Euler": {}} | NEWTON | IN_TIME | DENSE
    yield StabilityMap("time_step", f"A ridge passes, iterations per step, {n} intervals", slides, steps, methods, sliding)
    oils = {"Eyring": {}, "Newtonian": {"rheology": "newtonian", "eyring_stress": None}}
    methods = {f"{name}: {oil}": solver for oil in oils for name, solver in (AUTO | IN_TIME).items()}
    sizes = axis("intervals", [2**k for k in range(6, 13)], quick)
    steps = axis("time_step_over_dx", [0.0625, 0.125, 0.25, 0.5, 1, 2], quick)
    yield StabilityMap("rolling", "A ridge rolls in without sliding, iterations per step", sizes, steps, methods, rolling)


def roughness_maps(quick: bool) -> Iterator[StabilityMap]:
    """Amplitude against wavelength: a wavy surface at rest under a sliding one, and a ridge that passes."""
    n, nodes = (512, 256) if quick else (2048, 512)
    waves = axis("wavelength_over_b", [0.125, 0.25, 0.5, 0.75, 1, 1.5, 2, 3, 4], quick)
    heights = axis("amplitude_over_film", [0.01, 0.03, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0, 1.2], quick)

    def shape(kind: str, wave: float, height: float) -> dict:
        return {"shape": kind, "amplitude": height * CASE_1_FILM, "wavelength": wave * CASE_1_HALF_WIDTH}

    def wavy(wave: float, height: float, solver: dict, _: str) -> str:
        return case_1(n, solver, bodies={"speed_1": 0.0, "speed_2": 1.2}, surface_1=shape("sinusoid", wave, height))

    def ridge(wave: float, height: float, solver: dict, _: str) -> str:
        time = {"transient": True, "end_time": 1.5, "time_step": 5.5 / nodes / 2}
        return case_1(nodes, solver, surface_2=shape("feature", wave, height) | {"position": -2.0}, time=time)

    title = f"Case 1, sinusoid on a surface at rest, steady, {n} intervals"
    yield StabilityMap("roughness", title, waves, heights, AUTO | NEWTON | CYCLES, wavy)
    title = f"Case 3 with other ridges, iterations per step, {nodes} intervals"
    yield StabilityMap("ridge", title, waves, heights, AUTO | NEWTON | IN_TIME, ridge)


def all_maps(quick: bool) -> Iterator[StabilityMap]:
    """All maps of lubricated contacts."""
    for maps in (steady_maps, cycle_maps, passing_maps, roughness_maps):
        yield from maps(quick)


NAMES = [each.key for each in all_maps(True)]


def dry_cell(load: float, nodes: int, is_area: bool, hurst: float = 0.8, hardness: float | None = None) -> Groups:
    """A dry contact; loads and hardnesses in units of the pressure E* g, g = 2 pi rms height over the roll-off wavelength."""
    unit = 0.5 * MODULUS * 2 * math.pi * HEIGHT / (LENGTH / 4)
    return {
        "case": {"problem": PROBLEMS[is_area]},
        "bodies": {"reduced_modulus": MODULUS, "hardness": hardness * unit if hardness else None},
        "load": {"mean_pressure": load * unit},
        "surface_1": {"shape": "synthetic", "seed": 3, "hurst": hurst, "rms_height": HEIGHT, "wavelength_rolloff": LENGTH / 4},
        "domain": sizes(1 + is_area, nodes),
        "solver": {"tolerance": 1e-8, "max_cycles": MOST},
    }


def dry_text(axis: str, is_area: bool, **fixed: float) -> Text:
    """Makes the namelists of a map over loads and an axis; areas that are too fine for a method are left out."""

    def text(load: float, value: float, settings: dict, name: str) -> Groups | None:
        keys = fixed | {axis: value}
        if is_area and keys["nodes"] > MOST_NODES.get(name, keys["nodes"]):
            return None
        cell = dry_cell(load, is_area=is_area, **keys)
        return cell | {"solver": cell["solver"] | settings}

    return text


def dry_maps(quick: bool) -> Iterator[StabilityMap]:
    """Load from first touch to full contact against hardness (none to all plastic), Hurst exponent, and nodes; to 1e-8."""
    nodes, areas = (64, "Areas of 64$^2$ nodes") if quick else (128, "Areas of 128$^2$ nodes")
    loads = axis("load", [1e-7, 1e-5, 1e-3, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0], quick)
    for key, title, y, is_area, fixed in (
        ("hardness", areas, axis("hardness", [None, 10.0, 3.0, 1.0, 0.3, 0.1, 0.03, 0.01], quick), True, {"nodes": nodes}),
        ("spectrum", f"{areas}, elastic", axis("hurst", [0.0, 0.2, 0.4, 0.6, 0.8, 1.0], quick), True, {"nodes": nodes}),
        ("areas", "Areas, elastic", axis("nodes", [31, 64, 100, 128, 256, 512], quick), True, {}),
        ("profiles", "Profiles, elastic", axis("nodes", [63, 512, 1000, 4096, 16384], quick), False, {}),
    ):
        methods = {name: {"method": name} for name in DRY_METHODS}
        yield StabilityMap(f"dry_{key}", title, loads, y, methods, dry_text(y.key, is_area, **fixed))
