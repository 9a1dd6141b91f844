"""The statements of chapter 6 (and of Paper B where it says more), each checked against the runs."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
from overtaking import MEETING, Situation, Thinning
from study import Claims

Found = dict[str, dict[Situation, Thinning]]
DEPTHS, WIDTHS, SLIPS = range(-1, -7, -1), range(1, 8), range(1, 6)


class Fields:
    """Film and pressure of one result, with times counted from the meeting of the centres."""

    def __init__(self, path: Path, meeting_time: float) -> None:
        """Reads the result."""
        with h5py.File(path) as file:
            self.x = file["solution/x"][()]
            self.time = file["transient/profile_time"][()] - meeting_time
            self.film = file["transient/film_thickness"][()]
            self.pressure = file["transient/pressure"][()]
        self.smooth = float(self.film[0].min())

    def extreme(
        self, values: np.ndarray, find: object, x: tuple[float, float] = (-4.0, 1.5), time: tuple[float, float] = (-99, 99)
    ) -> tuple[float, float, float]:
        """Value, X and time of the extreme in a part of X and T."""
        columns = np.flatnonzero((self.x >= x[0]) & (self.x <= x[1]))
        rows = np.flatnonzero((self.time >= time[0]) & (self.time <= time[1]))
        part = values[np.ix_(rows, columns)]
        row, column = np.unravel_index(find(part), part.shape)
        return float(part[row, column]), float(self.x[columns[column]]), float(self.time[rows[row]])

    def film_minimum(self) -> tuple[float, float, float]:
        """Smallest film of the passage."""
        return self.extreme(self.film, np.argmin)

    def spike(self) -> tuple[float, float, float]:
        """Largest pressure while the features overlap or have just parted (0.6 before to 0.5 after the meeting)."""
        return self.extreme(self.pressure, np.argmax, (-1.0, 0.5), (-0.6, 0.5))

    def step_at(self, time: float) -> int:
        """Stored step nearest to a time."""
        return int(np.argmin(np.abs(self.time - time)))


def at(found: tuple[float, float, float]) -> str:
    """An extreme in words."""
    value, x, time = found
    return f"{value:.3f} at X = {x:+.2f}, T - T_c = {time:+.2f}"


def check_overtakings(claims: Claims, profiles: dict[str, Path], meeting_times: dict[str, float]) -> None:
    """Section 6.1, Figures 6.2 to 6.5, and the conclusions about the four situations (s = 4/3, l = +-1, m = 1)."""
    meeting = next(iter(meeting_times.values()))
    fields = {words: Fields(path, meeting) for words, path in profiles.items()}
    films = {words: item.film_minimum() for words, item in fields.items()}
    spikes = {words: item.spike() for words, item in fields.items()}
    four = tuple(meeting_times)
    during = films["ridge-ridge"]
    claims.check(
        "Fig. 6.2: ridge over ridge, the global minimum of the film is a result of the overtaking",
        abs(during[2]) < 0.3 and abs(during[1] - MEETING) < 0.2,
        f"H_min {at(during)}; the slow ridge alone {at(films['ridge alone'])}",
    )
    lowest = films["ridge-dent"]
    claims.check(
        "Fig. 6.3: ridge over dent, the global minimum occurs in the outlet as the fast ridge exits",
        lowest[1] > 0.7 and lowest[2] > 0.4,
        f"H_min {at(lowest)}; the fast ridge is then at X = {MEETING + 5 / 3 * lowest[2]:+.2f}",
    )
    lowest = films["dent-dent"]
    claims.check(
        "Fig. 6.4: dent over dent, the global minimum occurs as the fast dent exits",
        lowest[1] > 0.7 and lowest[2] > 0.2,
        f"H_min {at(lowest)}; the fast dent is then at X = {MEETING + 5 / 3 * lowest[2]:+.2f}",
    )
    claims.check(
        "Fig. 6.4: dent over dent, a pressure spike at the end of the event",
        spikes["dent-dent"][2] > 0.1,
        f"P_max {at(spikes['dent-dent'])}; smooth {spikes['smooth'][0]:.3f}",
    )
    lowest = films["dent-ridge"]
    claims.check(
        "Fig. 6.5: dent over ridge, the global minimum occurs at the beginning of the overtaking",
        -0.6 < lowest[2] < 0,
        f"H_min {at(lowest)}; the ridge alone {at(films['ridge alone'])}",
    )
    ratio = spikes["dent-dent"][0] / spikes["half ridges"][0]
    claims.check(
        "Conclusion 2: the spike of dent over dent equals that of ridge over ridge of half the amplitude",
        abs(ratio - 1) < 0.03,
        f"P_max {at(spikes['dent-dent'])} against {at(spikes['half ridges'])}",
    )
    claims.check(
        "Conclusion 3: ridge over ridge gives the thinnest film and the highest spike of the four",
        min(four, key=lambda words: films[words][0]) == "ridge-ridge" == max(four, key=lambda words: spikes[words][0]),
        "H_min "
        + ", ".join(f"{words} {films[words][0]:.3f}" for words in four)
        + "; P_max "
        + ", ".join(f"{words} {spikes[words][0]:.3f}" for words in four),
    )
    check_ridge_dent(claims, fields, spikes, films)
    check_two_sided(claims, fields)


def check_ridge_dent(
    claims: Claims,
    fields: dict[str, Fields],
    spikes: dict[str, tuple[float, float, float]],
    films: dict[str, tuple[float, float, float]],
) -> None:
    """Conclusion 4 has two halves: the local pressure, and the film."""
    effects = {}
    for words, alone in (("ridge-dent", "fast ridge alone"), ("dent-dent", "fast dent alone")):
        difference = fields[words].pressure - fields[alone].pressure
        effects[words] = fields[words].extreme(difference, np.argmax, (-1.0, 0.5), (-0.6, 0.5))
    ratio = effects["ridge-dent"][0] / effects["dent-dent"][0]
    claims.check(
        "Conclusion 4: local pressure effects of ridge over dent are comparable to dent over dent",
        0.5 < ratio < 2,
        f"largest rise of P against the fast feature alone: {effects['ridge-dent'][0]:.3f} and {effects['dent-dent'][0]:.3f} "
        f"(P_max itself {spikes['ridge-dent'][0]:.3f} and {spikes['dent-dent'][0]:.3f}, the fast ridge alone "
        f"{spikes['fast ridge alone'][0]:.3f})",
    )
    claims.check(
        "Conclusion 4: the film of ridge over dent is slightly thinner than that of dent over dent",
        "agrees, but not slightly"
        if films["ridge-dent"][0] < 0.9 * films["dent-dent"][0]
        else films["ridge-dent"] < films["dent-dent"],
        f"H_min {films['ridge-dent'][0]:.3f} and {films['dent-dent'][0]:.3f}; both in the outlet, "
        f"{films['ridge-dent'][0] / films['fast ridge alone'][0]:.3f} of that of the fast ridge alone",
    )


def check_two_sided(claims: Claims, fields: dict[str, Fields]) -> None:
    """Conclusion 1: the dent over the ridge (l2 = -5, s = 4/3) beside one-sided runs: their sum, and the summed surface."""
    both, ridge, dent, smooth = (fields[name] for name in ("deep dent-ridge", "ridge alone", "deep dent alone", "smooth"))
    window = {"x": (-1.3, 0.0)}

    def measure(film: np.ndarray) -> float:
        return both.extreme(ridge.film - film, np.argmax, **window)[0] / both.smooth

    lowest = {words: fields[words].extreme(fields[words].film, np.argmin, **window)[0] for words in fields}
    one_sided = [f"sum on the {which} surface" for which in ("slow", "fast")]
    claims.check(
        "Conclusion 1: certain effects need a two-sided treatment",
        all(lowest[words] > 1.1 * lowest["deep dent-ridge"] for words in one_sided),
        f"dent over ridge, l2 = -5, smallest H in -1.3 <= X <= 0 is {lowest['deep dent-ridge']:.3f}; with the sum of "
        f"both on one surface {lowest[one_sided[0]]:.3f} at the slow and {lowest[one_sided[1]]:.3f} at the fast speed",
    )
    added = ridge.film + dent.film - smooth.film
    pair = fields["ridge-ridge"]
    pair_added = ridge.film + fields["fast ridge alone"].film - smooth.film
    claims.check(
        "Beyond the thesis: the film is nearly the sum of two one-sided runs, each feature at its own speed",
        "holds within 6 %",
        f"dent over ridge H_min {at(both.film_minimum())} against {at(both.extreme(added, np.argmin))}, film thinning "
        f"{measure(both.film):.3f} against {measure(added):.3f}; ridge over ridge H_min {at(pair.film_minimum())} against "
        f"{at(pair.extreme(pair_added, np.argmin))}",
    )
    pair = fields["ridge-ridge"]
    step = pair.step_at(-0.2)
    between = (pair.x >= MEETING - 5 / 3 * 0.2) & (pair.x <= MEETING - 1 / 3 * 0.2)
    largest, place = pair.film[step, between].max(), pair.x[between][np.argmax(pair.film[step, between])]
    usual = np.interp(place, smooth.x, smooth.film[0])
    claims.check(
        "Paper B: between two ridges, just before they meet, the film is comparable to the smooth one",
        abs(largest / usual - 1) < 0.15,
        f"0.2 before the meeting H = {largest:.3f} at X = {place:+.2f}, smooth {usual:.3f}",
    )


def check_study(claims: Claims, found: Found) -> None:
    """Section 6.2, Figures 6.7 to 6.10, and the conclusions about dent over ridge, from form (b)."""
    b = found["b"]

    def xi(**keys: float) -> float:
        return b[Situation(**{"slip": 5, **keys})].xi

    top = max(xi(slip=slip, l2=depth) for slip in SLIPS for depth in DEPTHS)
    claims.check(
        "Fig. 6.8: the overall maximum of xi is approximately 0.4",
        abs(top - 0.4) < 0.05,
        f"{top:.3f} in form (b), {max(found['a'][Situation(5, l2=depth)].xi for depth in DEPTHS):.3f} in form (a)",
    )
    deeper = all(xi(l2=depth - 1, m2=width) > xi(l2=depth, m2=width) for depth in DEPTHS[:-1] for width in WIDTHS)
    claims.check(
        "Fig. 6.7: the deeper the dent, the more thinning, at every width", deeper, "all 35 steps of depth" if deeper else "not all"
    )
    check_widths(claims, xi)
    check_inside(claims, b)
    check_slips(claims, xi)
    check_ridges(claims, xi)
    check_load(claims, xi, b)
    lowest = min(b.values(), key=lambda item: item.h_min)
    claims.check(
        "Section 6.2: no film breakdown was observed",
        lowest.h_min > 0,
        f"the smallest film of all {len(b)} combinations is {lowest.h_min:.3f} of the smooth smallest film",
    )
    growth = [xi(l2=-6) / xi(l2=-1), xi(l1=2, l2=-2) / xi(l2=-2), xi(load=2e5, l2=-6) / xi(l2=-6)]
    claims.check(
        "Conclusion 5: a dent over a ridge can break the film: too large a ridge, too wide or deep a dent, too high a load",
        "partly: width is not monotonic",
        f"xi grows {growth[0]:.2f} times from l2 = -1 to -6, {growth[1]:.2f} times with a double ridge, {growth[2]:.2f} times with "
        f"double load; with the width only to m2 = 2 and again beyond the minimum",
    )


def check_widths(claims: Claims, xi: object) -> None:
    """Conclusion 6: a dent width with least thinning, and one with most."""
    most, least = [], []
    for depth in DEPTHS:
        values = np.array([xi(l2=depth, m2=width) for width in WIDTHS])
        peak = 1 + int(np.argmax(values[:4]))
        valley = peak + int(np.argmin(values[peak - 1 :]))
        most.append(peak)
        least.append(valley)
    lists = f"most thinning at m2 = {most}, least beyond it at m2 = {least} for l2 = -1 ... -6"
    claims.check("Figs 6.7, 6.9: the thinnest film for a dent width m2 between 1 and 3", all(1 <= m <= 3 for m in most), lists)
    claims.check(
        "Conclusion 6, Figs 6.7, 6.9: a width between 4 and 6 with least thinning",
        all(4 <= m <= 6 for m in least),
        f"{lists}; xi there {xi(l2=-2, m2=least[1]):.3f} at l2 = -2 and {xi(l2=-6, m2=least[5]):.3f} at l2 = -6",
    )


def check_inside(claims: Claims, b: dict[Situation, Thinning]) -> None:
    """Conclusion 6 without the inlet: (6.1) in -1 <= X <= 0."""
    rows = {depth: [b[Situation(5, l2=depth, m2=width)].contact for width in WIDTHS] for depth in DEPTHS}
    falls = all(np.all(np.diff(values[1:]) < 0) for values in rows.values())
    claims.check(
        "Conclusion 6 inside the contact, -1 <= X <= 0: a width with least thinning",
        "DISAGREES: thinning goes on falling with the width" if falls else "agrees",
        "xi for m2 = 1 ... 7: "
        + "; ".join(", ".join(f"{value:.3f}" for value in rows[depth]) + f" (l2 = {depth})" for depth in (-2, -6)),
    )
    pairs = [[b[Situation(5, l1=height, l2=-2, m2=width)].contact for width in WIDTHS] for height in (1, 2)]
    gain = np.array(pairs[1]) - np.array(pairs[0])
    claims.check(
        "Fig. 6.9 inside the contact: the difference between the ridges grows with the width",
        bool(gain[-1] > gain[0]),
        f"xi(l1 = 2) - xi(l1 = 1) at m2 = 1 ... 7: {', '.join(f'{value:+.3f}' for value in gain)}",
    )


def check_slips(claims: Claims, xi: object) -> None:
    """Conclusion 7: the slide-to-roll ratio."""
    grows = all(xi(slip=slip + 1, l2=depth) > xi(slip=slip, l2=depth) for slip in SLIPS[:-1] for depth in DEPTHS)
    slopes = [(xi(slip=slip, l2=-6) - xi(slip=slip, l2=-1)) / 5 for slip in SLIPS]
    claims.check(
        "Conclusion 7, Fig. 6.8: thinning grows with the slide-to-roll ratio, at every depth",
        grows,
        "xi at l2 = -6: "
        + ", ".join(f"{xi(slip=slip, l2=-6):.3f}" for slip in SLIPS)
        + "; at l2 = -1: "
        + ", ".join(f"{xi(slip=slip, l2=-1):.3f}" for slip in SLIPS)
        + " for s = 1/3 ... 5/3",
    )
    claims.check(
        "Fig. 6.8: it grows faster with the depth at higher s",
        bool(np.all(np.diff(slopes) > 0)),
        "mean growth of xi per unit of l2: " + ", ".join(f"{slope:.4f}" for slope in slopes),
    )


def check_ridges(claims: Claims, xi: object) -> None:
    """Conclusion 8, Figure 6.9: the ridge height."""
    gain = np.array([xi(l1=2, l2=-2, m2=width) - xi(l2=-2, m2=width) for width in WIDTHS])
    listed = ", ".join(f"{value:+.3f}" for value in gain)
    claims.check(
        "Fig. 6.9: a double ridge gives more thinning, but not more than a few per cent (of the smooth film)",
        bool(np.all(gain > 0) and np.max(gain) < 0.06),
        f"xi(l1 = 2) - xi(l1 = 1) at m2 = 1 ... 7: {listed}",
    )
    claims.check("Fig. 6.9: the difference seems to grow with the width", bool(gain[-1] > gain[0]), f"differences {listed}")
    claims.check(
        "Conclusion 8: with dents as deep as the ridges are high the larger ridge gives the thinner film, but not devastatingly",
        xi(l1=2, l2=-2) > xi(l2=-1),
        f"xi {xi(l2=-1):.3f} for l1 = -l2 = 1 and {xi(l1=2, l2=-2):.3f} for 2",
    )


def check_load(claims: Claims, xi: object, b: dict[Situation, Thinning]) -> None:
    """Conclusion 9, Figure 6.10: the load."""
    single, double = ([xi(load=load, l2=depth) for depth in DEPTHS] for load in (1e5, 2e5))
    claims.check(
        "Fig. 6.10: double load gives more thinning, and xi grows faster with the depth",
        all(d > s for s, d in zip(single, double, strict=True)) and double[-1] - double[0] > single[-1] - single[0],
        "xi "
        + ", ".join(f"{s:.3f}/{d:.3f}" for s, d in zip(single, double, strict=True))
        + " for l2 = -1 ... -6 (single/double load)",
    )
    lowest = b[Situation(5, 2e5, l2=-6)].h_min
    claims.check(
        "Fig. 6.10: the smallest film is approximately 45 % of the smooth one",
        abs(lowest - 0.45) < 0.05,
        f"H_min/H_smooth = {lowest:.3f}; xi = {double[-1]:.3f}",
    )
    load, ridge = xi(load=2e5, l2=-2) - xi(l2=-2), xi(l1=2, l2=-2) - xi(l2=-2)
    claims.check(
        "Conclusion 9: the effect of the load is somewhat larger than that of the ridge height",
        load > ridge,
        f"at l2 = -2: {load:+.4f} by double load, {ridge:+.4f} by a double ridge",
    )


def check_errors(claims: Claims, found: Found, films: dict[Situation, tuple[float, float]]) -> None:
    """Paper B on its errors, and the errors of xi."""
    steps, grids = ([pair[i] for pair in films.values()] for i in (0, 1))
    listed = ", ".join(f"{value:.3f}" for value in steps)
    claims.check(
        "Paper B: the time error of the film is below 5 % of the smooth smallest film, largest for s = 1/3 and the steepest dent",
        (max(steps) < 0.05 and max(steps) == steps[0]) or f"partly: about 5 %, but largest for s = {1 + int(np.argmax(steps))}/3",
        f"(5.5) with the film, l2 = -6, m2 = 1, s = 1/3 ... 5/3: {listed}",
    )
    claims.check(
        "Paper B: the time error is larger than the spatial one, even with 257 nodes",
        all(step > grid for step, grid in zip(steps, grids, strict=True)),
        f"spatial (5.6) of the same runs: {', '.join(f'{value:.3f}' for value in grids)}; time {listed}",
    )
    errors = {item: abs(a.xi - found["b"][item].xi) for item, a in found["a"].items()}
    worst = max(errors, key=errors.get)
    relative = [error / found["b"][item].xi for item, error in errors.items()]
    claims.check(
        "The thesis gives no error of xi",
        "ours",
        f"form (a) is off by at most {errors[worst]:.3f} (s = {worst.slip}/3, l2 = {worst.l2}), median "
        f"{100 * np.median(relative):.1f} % of xi, largest {100 * max(relative):.0f} %; too low nearly always",
    )
