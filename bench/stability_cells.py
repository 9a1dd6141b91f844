"""The maps of `make stability`: axes, methods, and the namelist of each cell."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import namelists

FAS = "fas_block_jacobi"
AUTO = {"auto": {}}
NEWTON = {"newton_krylov": {"method": "newton_krylov"}}
DENSE = {"newton_dense": {"method": "newton_dense"}}
CYCLES = {
    "FAS, line": {"method": FAS, "smoother": "line"},
    "FAS, Gauss-Seidel": {"method": FAS, "smoother": "gauss_seidel"},
    "FAS, Block-Jacobi": {"method": FAS, "smoother": "block_jacobi"},
}
# Without `intervals`: the program chooses them for 1 % in the film.
CHOSEN = "auto, its own grid"
NAMES = (
    "moes_barus",
    "moes_roelands",
    "moes_eyring",
    "eyring_stress",
    "slide_to_roll",
    "intervals",
    "relaxation",
    "coarsest",
    "time_step",
    "rolling",
    "roughness",
    "ridge",
)


@dataclass
class Axis:
    """One axis of a map."""

    key: str
    label: str
    values: list[float]


@dataclass
class Cell:
    """One contact solved by one method."""

    method: str
    column: int
    row: int
    namelist: str


@dataclass
class StabilityMap:
    """A map: `text(x, y, settings, name)` makes the namelist of a cell, None where there is none."""

    key: str
    title: str
    x: Axis
    y: Axis
    methods: dict[str, dict]
    text: Callable[[float, float, dict, str], str | None]

    def cells(self) -> Iterator[Cell]:
        """All cells, method by method."""
        for method, settings in self.methods.items():
            for column, x in enumerate(self.x.values):
                for row, y in enumerate(self.y.values):
                    text = self.text(x, y, settings, method)
                    if text is not None:
                        yield Cell(method, column, row, text)


def spread(first: float, last: float, count: int) -> list[float]:
    """Numbers at equal ratios, two digits."""
    return [float(f"{first * (last / first) ** (i / (count - 1)):.2g}") for i in range(count)]


def moes_axes(quick: bool) -> tuple[Axis, Axis]:
    """Moes' plane."""
    loads = spread(0.01, 2000, 8 if quick else 18)
    oils = [0, 5, 10, 20, 40] if quick else [0, 1, 2.5, 5, 7.5, 10, 15, 20, 25, 30, 40]
    return Axis("moes_m", "$M$ (speed sum)", loads), Axis("moes_l", "$L$ (speed sum)", oils)


def moes_maps(quick: bool) -> Iterator[StabilityMap]:
    """Newtonian contacts over Moes' plane: Barus incompressible, Roelands compressible, Reynolds-Eyring."""
    intervals = 256 if quick else 1024
    x, y = moes_axes(quick)
    methods = AUTO | {CHOSEN: {}} | NEWTON | CYCLES | DENSE
    mineral = {"lubricant": {"viscosity_law": "roelands", "density_law": "dowson_higginson"}}

    def barus(m: float, oil: float, solver: dict, name: str) -> str:
        return namelists.moes(m, oil, None if name == CHOSEN else intervals, solver)

    def roelands(m: float, oil: float, solver: dict, name: str) -> str | None:
        if oil == 0:
            return None
        return namelists.moes(m, oil, None if name == CHOSEN else intervals, solver, **mineral)

    def eyring(m: float, oil: float, solver: dict, name: str) -> str | None:
        if oil == 0:
            return None
        groups = namelists.steel(m, oil, 5 / 3, 3.3e6)
        return with_numerics(groups, solver, None if name == CHOSEN else intervals)

    yield StabilityMap("moes_barus", f"Newtonian, Barus, incompressible, {intervals} intervals", x, y, methods, barus)
    yield StabilityMap("moes_roelands", f"Newtonian, Roelands, compressible, {intervals} intervals", x, y, methods, roelands)
    yield StabilityMap("moes_eyring", f"Reynolds-Eyring 3.3 MPa, slide-to-roll 5/3, {intervals} intervals", x, y, methods, eyring)


def with_numerics(groups: dict[str, dict], solver: dict, intervals: int | None, **others: dict) -> str:
    """A namelist of physical groups, a grid on the domain that the program chooses, and a method."""
    return namelists.namelist(groups | {"domain": {"intervals": intervals}, "solver": solver} | others)


def eyring_maps(quick: bool) -> Iterator[StabilityMap]:
    """tau_0 against the load, and against slide-to-roll."""
    intervals = 256 if quick else 1024
    stresses = [1, 3.3, 10, 100, math.inf] if quick else [1, 1.5, 2, 3.3, 5, 7, 10, 20, 50, 100, math.inf]
    slides = [0, 0.2, 1, 5 / 3, 2, 3, 8] if quick else [0, 0.05, 0.2, 0.5, 1, 4 / 3, 5 / 3, 2, 2.5, 3, 4, 8, 20]
    loads = spread(0.03, 2000, 7 if quick else 14)
    y = Axis("eyring_stress_in_mpa", r"$\tau_0$ [MPa]", stresses)
    methods = AUTO | {CHOSEN: {}} | NEWTON | CYCLES

    def stress(megapascal: float) -> float | None:
        return None if math.isinf(megapascal) else megapascal * 1e6

    def load(m: float, tau: float, solver: dict, name: str) -> str:
        return with_numerics(namelists.steel(m, 10, 5 / 3, stress(tau)), solver, None if name == CHOSEN else intervals)

    def sliding(slide: float, tau: float, solver: dict, name: str) -> str:
        return with_numerics(namelists.steel(100, 10, slide, stress(tau)), solver, None if name == CHOSEN else intervals)

    x = Axis("moes_m", "$M$ (speed sum)", loads)
    yield StabilityMap("eyring_stress", f"Slide-to-roll 5/3, $L$ = 10, {intervals} intervals", x, y, methods, load)
    x = Axis("slide_to_roll", "Slide-to-roll ratio", [round(slide, 3) for slide in slides])
    yield StabilityMap("slide_to_roll", f"$M$ = 100, $L$ = 10, {intervals} intervals", x, y, methods, sliding)


def intervals_map(quick: bool) -> StabilityMap:
    """The given number of intervals against the load, for four lubricants."""
    counts = [2**k for k in ((6, 8, 10, 12) if quick else (6, 7, 8, 9, 10, 12, 14, 16, 18, 20))]
    loads = [0.01, 1, 100, 2000] if quick else [0.01, 0.1, 1, 5, 20, 100, 500, 2000]
    lubricants = {"L = 10": (10, None), "L = 40": (40, None), "L = 10, 3.3 MPa": (10, 3.3e6), "L = 40, 1 MPa": (40, 1e6)}
    methods = {f"auto, {name}": {} for name in lubricants} | {"FAS, Gauss-Seidel, L = 10": CYCLES["FAS, Gauss-Seidel"]}

    def text(intervals: float, m: float, solver: dict, name: str) -> str | None:
        if name.startswith("FAS") and intervals > 2**14:
            return None
        oil, stress = lubricants[name.split(", ", 2 if name.startswith("FAS") else 1)[-1]]
        return with_numerics(namelists.steel(m, oil, 5 / 3, stress), solver, int(intervals))

    x, y = Axis("intervals", "Intervals", counts), Axis("moes_m", "$M$ (speed sum)", loads)
    return StabilityMap("intervals", "Slide-to-roll 5/3, Roelands, compressible", x, y, methods, text)


def relaxation_map(quick: bool) -> StabilityMap:
    """Relaxation against sweeps, for each smoother on a light and a heavy contact."""
    intervals, levels = (256, 3) if quick else (1024, 5)
    relaxations = [0.2, 0.4, 0.6, 0.8, 1.0] if quick else [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1]
    sweeps = [1, 2, 5, 10] if quick else [1, 2, 3, 5, 7, 10, 15]
    methods = {f"{name}: {case}": solver for case in ("Case 1", "Barus 20, 10") for name, solver in CYCLES.items()}

    def text(relaxation: float, count: float, solver: dict, name: str) -> str:
        cycle = {"relaxation": relaxation, "pre_sweeps": int(count), "post_sweeps": int(count), "levels": levels}
        settings = solver | cycle
        if name.endswith("Case 1"):
            return namelists.case_1(intervals, settings)
        return namelists.moes(20, 10, intervals, settings, domain=namelists.WINDOW)

    x, y = Axis("relaxation", "Relaxation", relaxations), Axis("sweeps", "Sweeps before and after", sweeps)
    return StabilityMap("relaxation", f"Relaxation and sweeps, {intervals} intervals, {levels} levels", x, y, methods, text)


def coarsest_map(quick: bool) -> StabilityMap:
    """Coarsest level of the cycle against the load."""
    intervals = 512 if quick else 1024
    coarsest = [8, 32, 128, 512] if quick else [8, 16, 32, 64, 128, 256, 512]
    loads = [1, 10, 100, 1000] if quick else [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000]

    def text(m: float, nodes: float, solver: dict, _: str) -> str:
        levels = 1 + round(math.log2(intervals / nodes))
        return namelists.moes(m, 10, intervals, solver | {"levels": levels}, domain=namelists.WINDOW)

    x, y = Axis("moes_m", "$M$ (speed sum)", loads), Axis("coarsest", "Intervals of the coarsest level", coarsest)
    title = f"Barus, $L$ = 10, coarsest level of the cycle, {intervals} intervals"
    return StabilityMap("coarsest", title, x, y, AUTO | CYCLES, text)


def time_step_map(quick: bool) -> StabilityMap:
    """Time step against slide-to-roll: the ridge of Case 3 on the faster surface."""
    intervals = 128 if quick else 256
    factors = [0.25, 0.5, 1, 2] if quick else [0.125, 0.25, 0.5, 1, 2, 4, 8]
    slides = [0, 1, 5 / 3, 3] if quick else [0, 0.2, 0.5, 1, 5 / 3, 2, 2.5, 4, 8]
    methods = AUTO | {"auto, backward Euler": {}} | NEWTON | dict(list(CYCLES.items())[1:]) | DENSE

    def text(slide: float, factor: float, solver: dict, name: str) -> str:
        mean, dx = 0.6, 5.5 / intervals
        speeds = {"speed_1": mean * (1 - slide / 2), "speed_2": mean * (1 + slide / 2)}
        steps = max(2, round(2.3 / (1 + slide / 2) / (factor * dx)))
        scheme = "backward_euler" if name.endswith("Euler") else None
        settings = {"transient": True, "end_time": steps * factor * dx, "time_step": factor * dx, "scheme": scheme}
        ridge = namelists.RIDGE | {"position": -1.5}
        return namelists.case_1(intervals, solver, bodies=speeds, surface_2=ridge, time=settings)

    x = Axis("slide_to_roll", "Slide-to-roll ratio", [round(slide, 3) for slide in slides])
    y = Axis("time_step_over_dx", r"$\Delta T/\Delta X$", factors)
    return StabilityMap("time_step", f"A ridge passes, iterations per step, {intervals} intervals", x, y, methods, text)


def rolling_map(quick: bool) -> StabilityMap:
    """Without sliding: intervals against time step, ten steps of a ridge in Case 1, its oil and a Newtonian one."""
    counts = [2**k for k in ((6, 7, 8, 9) if quick else (6, 7, 8, 9, 10, 11, 12))]
    factors = [0.0625, 0.25, 1] if quick else [0.0625, 0.125, 0.25, 0.5, 1, 2]
    solvers = AUTO | dict(list(CYCLES.items())[1:])
    oils = {"Eyring": {}, "Newtonian": {"rheology": "newtonian", "eyring_stress": None}}
    methods = {f"{name}: {oil}": solver for oil in oils for name, solver in solvers.items()}

    def text(intervals: float, factor: float, solver: dict, name: str) -> str:
        step = factor * 5.5 / intervals
        return namelists.case_1(
            int(intervals),
            solver,
            bodies={"speed_1": 0.6, "speed_2": 0.6},
            lubricant=oils[name.split(": ")[1]],
            surface_2=namelists.RIDGE | {"position": -1.5},
            time={"transient": True, "end_time": 10 * step, "time_step": step},
        )

    x, y = Axis("intervals", "Intervals", counts), Axis("time_step_over_dx", r"$\Delta T/\Delta X$", factors)
    return StabilityMap("rolling", "A ridge rolls in without sliding, iterations per step", x, y, methods, text)


def roughness_axes(quick: bool) -> tuple[Axis, Axis]:
    """Wavelength and amplitude."""
    waves = [0.25, 0.5, 1, 2] if quick else [0.125, 0.25, 0.5, 0.75, 1, 1.5, 2, 3, 4]
    heights = [0.1, 0.3, 0.6, 1.0] if quick else [0.01, 0.03, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0, 1.2]
    return Axis("wavelength_over_b", r"$\Lambda/b$", waves), Axis("amplitude_over_film", r"Amplitude$/h_c$", heights)


def roughness_maps(quick: bool) -> Iterator[StabilityMap]:
    """Amplitude against wavelength: a wavy surface at rest under a sliding one, and a ridge that passes."""
    x, y = roughness_axes(quick)
    intervals = 512 if quick else 2048

    def wavy(wave: float, height: float, solver: dict, _: str) -> str:
        surface = {
            "shape": "sinusoid",
            "amplitude": height * namelists.CASE_1_FILM,
            "wavelength": wave * namelists.CASE_1_HALF_WIDTH,
        }
        return namelists.case_1(intervals, solver, bodies={"speed_1": 0.0, "speed_2": 1.2}, surface_1=surface)

    title = f"Case 1, sinusoid on a surface at rest, steady, {intervals} intervals"
    yield StabilityMap("roughness", title, x, y, AUTO | NEWTON | CYCLES, wavy)
    nodes = 256 if quick else 512

    def ridge(wave: float, height: float, solver: dict, _: str) -> str:
        surface = {
            "shape": "feature",
            "amplitude": height * namelists.CASE_1_FILM,
            "wavelength": wave * namelists.CASE_1_HALF_WIDTH,
            "position": -2.0,
        }
        time = {"transient": True, "end_time": 1.5, "time_step": 5.5 / nodes / 2}
        return namelists.case_1(nodes, solver, surface_2=surface, time=time)

    title = f"Case 3 with other ridges, iterations per step, {nodes} intervals"
    yield StabilityMap("ridge", title, x, y, AUTO | NEWTON | dict(list(CYCLES.items())[1:]), ridge)


def all_maps(quick: bool) -> Iterator[StabilityMap]:
    """All maps in the order of NAMES."""
    yield from moes_maps(quick)
    yield from eyring_maps(quick)
    yield intervals_map(quick)
    yield relaxation_map(quick)
    yield coarsest_map(quick)
    yield time_step_map(quick)
    yield rolling_map(quick)
    yield from roughness_maps(quick)
