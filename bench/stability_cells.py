"""The maps of `make stability`: axes, methods, the namelist of each cell, and the class of its answer."""

from __future__ import annotations

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
# Of dry contacts: methods, material and surface, iterations at most; of finer areas steepest descent would take hours.
DRY_METHODS = ("conjugate_gradient", "steepest_descent")
MODULUS, HEIGHT, LENGTH = 200e9, 1e-6, 1e-3
MOST, MOST_NODES = 6000, {DRY_METHODS[1]: 256}
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


def passing_maps(quick: bool) -> Iterator[StabilityMap]:
    """Time steps: the ridge of Case 3 on the faster surface; ten steps of one that rolls in without sliding, of two oils."""
    n, ridge = 128 if quick else 256, RIDGE | {"position": -1.5}
    slides = [0, 1, 5 / 3, 3] if quick else [0, 0.2, 0.5, 1, 5 / 3, 2, 2.5, 4, 8]
    steps = "time_step_over_dx", r"$\Delta T/\Delta X$"

    def speeds(slide: float) -> dict:
        return {"speed_1": 0.6 * (1 - slide / 2), "speed_2": 0.6 * (1 + slide / 2)}

    def sliding(slide: float, factor: float, solver: dict, name: str) -> str:
        dx = 5.5 / n
        count = max(2, round(2.3 / (1 + slide / 2) / (factor * dx)))
        scheme = "backward_euler" if name.endswith("Euler") else None
        settings = {"transient": True, "end_time": count * factor * dx, "time_step": factor * dx, "scheme": scheme}
        return case_1(n, solver, bodies=speeds(slide), surface_2=ridge, time=settings)

    def rolling(intervals: float, factor: float, solver: dict, name: str) -> str:
        step, oil = factor * 5.5 / intervals, oils[name.split(": ")[1]]
        time = {"transient": True, "end_time": 10 * step, "time_step": step}
        return case_1(int(intervals), solver, bodies=speeds(0.0), lubricant=oil, surface_2=ridge, time=time)

    x = Axis("slide_to_roll", "Slide-to-roll ratio", [round(slide, 3) for slide in slides])
    y = Axis(*steps, [0.25, 0.5, 1, 2] if quick else [0.125, 0.25, 0.5, 1, 2, 4, 8])
    methods = AUTO | {"auto, backward Euler": {}} | NEWTON | IN_TIME | DENSE
    yield StabilityMap("time_step", f"A ridge passes, iterations per step, {n} intervals", x, y, methods, sliding)
    oils = {"Eyring": {}, "Newtonian": {"rheology": "newtonian", "eyring_stress": None}}
    methods = {f"{name}: {oil}": solver for oil in oils for name, solver in (AUTO | IN_TIME).items()}
    x = Axis("intervals", "Intervals", [2**k for k in ((6, 7, 8, 9) if quick else (6, 7, 8, 9, 10, 11, 12))])
    y = Axis(*steps, [0.0625, 0.25, 1] if quick else [0.0625, 0.125, 0.25, 0.5, 1, 2])
    yield StabilityMap("rolling", "A ridge rolls in without sliding, iterations per step", x, y, methods, rolling)


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
    for maps in (steady_maps, cycle_maps, passing_maps, roughness_maps):
        yield from maps(quick)


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
    step, nodes, few = (3, 64, 2) if quick else (1, 128, None)
    loads = Axis("load", "Mean pressure over $E^* g$ [-]", [1e-7, 1e-5, 1e-3, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0][::step])
    methods, title = {name: {"method": name} for name in DRY_METHODS}, f"Areas of {nodes}$^2$ nodes"
    y = Axis("hardness", "Hardness/$E^* g$", [None, 10.0, 3.0, 1.0, 0.3, 0.1, 0.03, 0.01][::step])
    yield StabilityMap("dry_hardness", title, loads, y, methods, dry_text(y.key, True, nodes=nodes))
    y = Axis("hurst", "Hurst exponent", [0.0, 0.2, 0.4, 0.6, 0.8, 1.0][::step])
    yield StabilityMap("dry_spectrum", f"{title}, elastic", loads, y, methods, dry_text(y.key, True, nodes=nodes))
    y = Axis("nodes", "Nodes a side", [31, 64, 100, 128, 256, 512][:few])
    yield StabilityMap("dry_areas", "Areas, elastic", loads, y, methods, dry_text(y.key, True))
    y = Axis("nodes", "Nodes", [63, 512, 1000, 4096, 16384][:few])
    yield StabilityMap("dry_profiles", "Profiles, elastic", loads, y, methods, dry_text(y.key, False))
