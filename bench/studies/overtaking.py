"""Overtaking of ridges and dents (thesis, chapter 6): the cases, what is read of a result, the film-thinning measure (6.1)."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np
from study import Case, Runner, base_case, changed

MEETING = -0.3253  # X where the centres meet
START = -3.0  # X of the feature on surface 1 at T = 0
WINDOW = (-1.3, 0.0)  # X of the measure (6.1)
MEAN_SPEED = 0.6  # m/s
AMPLITUDE = 2e-7  # m, of l = 1
WAVELENGTH = 1e-4  # m, of m = 1
LENGTH = 5.5  # of the domain, half-widths


@dataclass(frozen=True)
class Form:
    """Grid and time step: thesis (a), fine (b), and two coarser ones for the error of (b)."""

    intervals: int
    scheme: str
    steps_per_interval: float

    @property
    def time_step(self) -> float:
        """Dimensionless time step."""
        return LENGTH / self.intervals / self.steps_per_interval


FORMS = {
    "a": Form(256, "backward_euler", 1),
    "b": Form(512, "bdf2", 2),
    "b_step": Form(512, "bdf2", 1),
    "b_grid": Form(256, "bdf2", 2),
}
FINEST = Form(1024, "bdf2", 2)


@dataclass(frozen=True, order=True)
class Situation:
    """Feature l1, m1 on the slow surface 1 and l2, m2 on the fast surface 2 (l = 0: smooth); slip is 3 s."""

    slip: int = 5
    load: float = 1e5
    l1: float = 1
    m1: int = 1
    l2: float = 0
    m2: int = 1

    @property
    def slide_to_roll(self) -> float:
        """s = 2 (u2 - u1)/(u1 + u2)."""
        return self.slip / 3

    @property
    def speeds(self) -> tuple[float, float]:
        """Half-widths per unit of T."""
        return 1 - self.slide_to_roll / 2, 1 + self.slide_to_roll / 2

    @property
    def meeting_time(self) -> float:
        """T at which both centres are at MEETING."""
        return (MEETING - START) / self.speeds[0]

    @property
    def end_time(self) -> float:
        """The feature on surface 2 has then left the contact."""
        return self.meeting_time + (1 - MEETING) / self.speeds[1] + 0.6

    @property
    def position_2(self) -> float:
        """X of the feature on surface 2 at T = 0."""
        return MEETING - self.speeds[1] * self.meeting_time

    @property
    def name(self) -> str:
        """Name of its files."""
        load = f"w{self.load / 1e5:g}"
        return f"s{self.slip}_{load}_l{self.l1:g}_m{self.m1}_l{self.l2:g}_m{self.m2}"

    @property
    def reference(self) -> Situation:
        """The same without the feature on surface 2."""
        return Situation(self.slip, self.load, self.l1, self.m1)

    def case(self, form: Form, fields: tuple[str, ...] = ("film_thickness",)) -> Case:
        """The namelist of the run, whole steps long.

        Profiles are stored every dX of T, which moves the maximum of (6.1) by at most 0.1 %.
        """
        end_time = round(self.end_time / form.time_step) * form.time_step
        groups: dict[str, dict[str, object] | None] = {
            "bodies": {f"speed_{i}": MEAN_SPEED * self.speeds[i - 1] for i in (1, 2)},
            "load": {"load_per_length": self.load},
            "domain": {"intervals": form.intervals},
            "time": {"end_time": end_time, "time_step": form.time_step, "scheme": form.scheme},
            "output": {"fields": list(fields), "profile_stride": max(1, int(form.steps_per_interval))},
        }
        features = ((self.l1, self.m1, START), (self.l2, self.m2, self.position_2))
        for i, (height, width, position) in enumerate(features, start=1):
            values = {"amplitude": AMPLITUDE * height, "wavelength": WAVELENGTH * width, "position": position}
            groups[f"surface_{i}"] = values if height else None
        return changed(base_case("overtaking"), **groups)


@dataclass(frozen=True)
class Film:
    """Film thickness over time in the window of (6.1), its ends interpolated, and the smallest film over the whole contact."""

    time: np.ndarray
    x: np.ndarray
    film: np.ndarray
    h_start: float
    h_min: float


def read_film(path: Path) -> Film:
    """What (6.1) needs of a result."""
    with h5py.File(path) as file:
        x, film = file["solution/x"][()], file["transient/film_thickness"]
        first, last = np.searchsorted(x, WINDOW[0]) - 1, np.searchsorted(x, WINDOW[1], side="right")
        values, start = film[:, first : last + 1], film[0].min()
        time, h_min = file["transient/profile_time"][()], file["transient/h_min"][()].min()
    places = np.concatenate(([WINDOW[0]], x[first + 1 : last], [WINDOW[1]]))
    return Film(time, places, at_places(x[first : last + 1], values, places), float(start), float(h_min))


def read_whole_film(path: Path) -> np.ndarray:
    """Film thickness at all stored times and nodes."""
    with h5py.File(path) as file:
        return file["transient/film_thickness"][()]


def film_errors(runner: Runner, situation: Situation) -> tuple[float, float]:
    """What halving the step and halving the grid change in the film of form (a), largest over X and T, over the smooth one."""
    forms = {"given": FORMS["a"], "step": Form(256, "backward_euler", 2), "grid": Form(512, "backward_euler", 0.5)}
    cases = {words: situation.case(form) for words, form in forms.items()}
    film = runner.run(cases, lambda _, path: read_whole_film(path))
    smooth = film["given"][0].min()
    count = min(len(film["given"]), len(film["step"]))
    step = np.abs(film["step"][:count] - film["given"][:count]).max() / smooth
    return float(step), float(np.abs(film["grid"][:, ::2] - film["given"]).max() / 3 / smooth)


def at_places(x: np.ndarray, values: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Linear interpolation of every row to `places`."""
    left = np.clip(np.searchsorted(x, places, side="right") - 1, 0, x.size - 2)
    weight = (places - x[left]) / (x[left + 1] - x[left])
    return values[:, left] * (1 - weight) + values[:, left + 1] * weight


@dataclass(frozen=True)
class Thinning:
    """The measure (6.1), the same for X >= -1, where and when it is reached, the smallest film over the smooth one."""

    xi: float
    contact: float
    x: float
    time: float
    h_min: float

    @property
    def edge(self) -> str:
        """Which end of the window holds the maximum, if one does."""
        return {WINDOW[0]: "inlet", WINDOW[1]: "centre"}.get(self.x, "")


def thinning(film: Film, reference: Film) -> Thinning:
    """Largest H_ref - H in the window over all stored times, over the smallest film at T = 0."""
    difference = reference.film - film.film
    step, place = np.unravel_index(np.argmax(difference), difference.shape)
    start = film.h_start
    contact = difference[:, film.x >= -1].max()
    found = (difference[step, place] / start, contact / start)
    return Thinning(*found, float(film.x[place]), float(film.time[step]), film.h_min / start)


def measure(runner: Runner, situations: list[Situation], form: Form) -> dict[Situation, Thinning]:
    """Runs the references, then the situations, and evaluates (6.1) for each."""
    references = sorted({situation.reference for situation in situations})
    films = runner.run({item.name: item.case(form) for item in references}, lambda _, path: read_film(path))
    by_name = {item.name: item for item in situations}

    def evaluate(name: str, path: Path) -> Thinning:
        return thinning(read_film(path), films[by_name[name].reference.name])

    # The longest runs first: both cores end at about the same time.
    order = sorted(situations, key=lambda item: -item.end_time)
    found = runner.run({item.name: item.case(form) for item in order}, evaluate)
    return {item: found[item.name] for item in situations}
