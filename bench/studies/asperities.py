"""Greenwood and Williamson (Proc. R. Soc. Lond. A 295, 1966, 300) beside the areas of this program.

Spherical summits of one radius beta, density eta and normally distributed heights (standard deviation sigma), each a contact of
Hertz that does not know of the others. With t = d/sigma, d the distance of the plane from the mean of the summits, and
F_n(t) the integral of (s - t)^n over the normal density from t on:

    Ar/An = pi eta beta sigma F_1(t),   pbar = 4/3 eta E* beta^(1/2) sigma^(3/2) F_3/2(t).

All input is taken from the summits of the surfaces themselves: nodes higher than their eight neighbours.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from study import Claims, save, style

DISTANCES = np.linspace(-4.0, 4.5, 400)  # d/sigma


def wavenumbers(nodes: int, length: float) -> np.ndarray:
    """|q| of the coefficients of a real transform."""
    return 2 * np.pi / length * np.hypot(np.fft.fftfreq(nodes, 1 / nodes)[:, None], np.arange(nodes // 2 + 1)[None, :])


@dataclass(frozen=True)
class Summits:
    """Density [1/m2], mean and standard deviation of the heights [m], mean curvature [1/m] and its variation."""

    density: float
    mean: float
    deviation: float
    curvature: float
    variation: float

    def area(self) -> np.ndarray:
        """Ar/An over DISTANCES."""
        return np.pi * self.density / self.curvature * self.deviation * moment(1.0)

    def pressure(self, modulus: float) -> np.ndarray:
        """Mean pressure over DISTANCES; `modulus` is E*."""
        return 4 / 3 * self.density * modulus * self.curvature**-0.5 * self.deviation**1.5 * moment(1.5)


def moment(power: float) -> np.ndarray:
    """F_n over DISTANCES."""
    s = np.linspace(0, 12, 6001)
    density = np.exp(-((DISTANCES[:, None] + s[None, :]) ** 2) / 2) / (2 * np.pi) ** 0.5
    return np.trapezoid(s**power * density, s, axis=1)


def summits_of(z: np.ndarray, length: float, waves: float = np.inf) -> Summits:
    """The summits of periodic heights, of which only the first `waves` on the length are resolved."""
    nodes = z.shape[0]
    q = wavenumbers(nodes, length)
    spectrum = np.fft.rfft2(z - z.mean()) * (q <= 2 * np.pi / length * waves)
    z = np.fft.irfft2(spectrum, s=z.shape)
    curvature = np.fft.irfft2(q**2 * spectrum, s=z.shape) / 2
    shifts = [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if (i, j) != (0, 0)]
    top = np.all([z > np.roll(z, shift, (0, 1)) for shift in shifts], axis=0)
    heights, bent = z[top], curvature[top]
    return Summits(
        density=float(top.sum() / length**2),
        mean=float(heights.mean()),
        deviation=float(heights.std()),
        curvature=float(bent.mean()),
        variation=float(bent.std() / bent.mean()),
    )


def compare(found: list[dict], modulus: float, claims: Claims, folder: Path) -> None:
    """Areas and separations of the program (`found`: a result for each surface) beside those of the asperities; E* = `modulus`."""
    share = np.mean([result["share"] for result in found], axis=0)
    area = np.mean([result["contact_area_fraction_corrected"] for result in found], axis=0)
    rms = found[0]["rq_undeformed"][0]
    gap = np.mean([result["mean_separation"] for result in found], axis=0) / rms
    models = {}
    for waves in ("all", "half"):
        areas, gaps = [], []
        for result in found:
            summits = result[f"summits_{waves}"]
            # Interpolation wants a rising abscissa; the load falls with the distance.
            load = np.log(summits.pressure(modulus) / (modulus * result["gradient"]))[::-1]
            areas.append(np.exp(np.interp(np.log(share), load, np.log(summits.area())[::-1])))
            gaps.append(np.interp(np.log(share), load, (summits.mean + summits.deviation * DISTANCES)[::-1]) / rms)
        models[waves] = np.mean(areas, axis=0), np.mean(gaps, axis=0)
    whole, half = ([result[f"summits_{waves}"] for result in found] for waves in ("all", "half"))
    ratio = models["all"][0] / area
    claims.check(
        "Greenwood and Williamson beside the deterministic model",
        "measured",
        f"theirs over ours {ratio[0]:.2f} at {100 * area[0]:.1f} % of contact, {ratio[-1]:.2f} at {100 * area[-1]:.0f} %; "
        f"mean separation {models['all'][1][0]:.2f} and {models['all'][1][-1]:.2f} Rq, ours {gap[0]:.2f} and {gap[-1]:.2f}",
    )
    change = np.mean([a.curvature / b.curvature for a, b in zip(whole, half, strict=True)])
    claims.check(
        "the asperity curvature depends on the measurement resolution",
        bool(change > 1.1),
        f"mean curvature of the summits with all waves {change:.2f} times that with the longer half; at the same load the area is "
        f"then {np.mean(models['half'][0] / models['all'][0]):.2f} times as large",
    )
    variation = np.mean([summits.variation for summits in whole])
    claims.check(
        "asperity curvatures vary considerably between the asperities of a surface",
        bool(variation > 0.25),
        f"standard deviation {100 * variation:.0f} % of the mean",
    )
    draw(share, (area, gap), models, folder)


def draw(share: np.ndarray, ours: tuple, models: dict[str, tuple], folder: Path) -> None:
    """Contact area and separation over the load."""
    figure, axes = style.new_figure(style.TWO_COLUMNS, 72, ncols=2)
    curves = {"this program": ours, "Greenwood-Williamson": models["all"], "the same, half of the waves resolved": models["half"]}
    lines = []
    for (label, (area, gap)), series in zip(curves.items(), style.SERIES, strict=False):
        lines += axes[0].loglog(share, 100 * area, label=label, **series)
        axes[1].semilogx(share, gap, **series)
    axes[0].set(xlabel=r"Load $\bar p/(E^* g)$ [-]", ylabel="Contact area [%]")
    axes[1].set(xlabel=r"Load $\bar p/(E^* g)$ [-]", ylabel="Mean separation over $Rq$ [-]", ylim=(0, None))
    style.legend_below(figure, lines, 3)
    save(figure, folder, "area_asperities")
