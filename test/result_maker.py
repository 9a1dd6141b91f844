"""Makes small result files in the layout of the program, for tests of the figures."""

from pathlib import Path

import h5py
import numpy as np
from cases import seal

HALF_WIDTH = 1.05797e-4  # [m]
HERTZ_PRESSURE = 0.601736e9  # [Pa]
FILM = 1.125e-6  # b^2/R [m]
TIME = 2 * HALF_WIDTH / 1.2  # 2b/u_s [s]

SCALES = {"x": ("m", HALF_WIDTH), "pressure": ("Pa", HERTZ_PRESSURE), "film_thickness": ("m", FILM), "time": ("s", TIME)}


def put(group: h5py.Group, name: str, values: object, units: str = "1", scale: float = 1.0) -> None:
    """A dataset with the attributes that every dataset has."""
    dataset = group.create_dataset(name, data=values)
    dataset.attrs["long_name"] = name.replace("_", " ")
    dataset.attrs["si_units"] = units
    dataset.attrs["si_scale"] = scale


def smooth_contact(nodes: int = 129) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """X, P, H that look like a smooth lubricated contact (shapes only, no solution)."""
    x = np.linspace(-4, 1.5, nodes)
    pressure = np.sqrt(np.maximum(1 - x**2, 0)) + 0.08 * np.exp(-10 * (x + 0.95) ** 2) * (x < 0.9)
    outside = np.maximum(np.abs(x) - 1, 0)
    film = 0.47 - 0.09 * np.exp(-60 * (x - 0.9) ** 2) + 1.2 * outside**1.5
    return x, pressure, film


def passage(nodes: int = 129, steps: int = 81, start: float = -2.5, speed: float = 11 / 6) -> dict[str, np.ndarray]:
    """A ridge that moves through the smooth contact, as /transient has it."""
    x, pressure, film = smooth_contact(nodes)
    time = np.linspace(0, (1.5 - start) / speed, steps)
    centre = (start + speed * time)[:, None]
    bump = np.exp(-25 * (x - centre) ** 2) * np.cos(2 * np.pi * (x - centre))
    return {"x": x, "time": time, "pressure": pressure * (1 + 0.25 * bump), "film_thickness": film * (1 - 0.3 * bump)}


def write_result(
    path: Path,
    fields: dict[str, np.ndarray],
    features: dict[str, object] | None = None,
    residuals: np.ndarray | None = None,
    converged: bool = True,
    has_si: bool = True,
    speeds: tuple[float, float] = (0.1, 1.1),
    has_profile_time: bool = True,
) -> Path:
    """Writes a result; `fields` with 'time' make a transient one; `features` is /surface_2.

    Without `has_profile_time` it is like those of older versions, which held no number but at the times of the profiles.
    """
    scales = SCALES if has_si else dict.fromkeys(SCALES, ("1", 1.0))
    is_transient = "time" in fields
    last = {name: fields[name][-1] if is_transient else fields[name] for name in ("pressure", "film_thickness")}
    history = np.geomspace(1e-2, 4e-9, 9) if residuals is None else residuals
    with h5py.File(path, "w") as file:
        reason = "converged" if converged else "cycle limit of 12 reached"
        file.attrs.update(program="asperity", version="0.0.0", problem="ehl_line", title="synthetic")
        file.attrs.update(converged=int(converged), reason=reason)
        inputs = {
            "bodies": {f"speed_{i}": speeds[i - 1] for i in (1, 2)},
            "surface_1": {"shape": "smooth"},
            "surface_2": features or {"shape": "smooth"},
        }
        for group, values in inputs.items():
            file.create_group(f"input/effective/{group}").attrs.update(values)
        file.create_group("scaling").attrs["half_width"] = scales["x"][1]
        for name in ("x", "pressure", "film_thickness"):
            put(file.require_group("solution"), name, last.get(name, fields[name]), *scales[name])
        if is_transient:
            stored = {"profile_time": fields["time"]} if has_profile_time else {}
            for name, values in ({name: fields[name] for name in ("time", "pressure", "film_thickness")} | stored).items():
                put(file.require_group("transient"), name, values, *scales[name.removeprefix("profile_")])
            put(file["transient"], "residual", np.append(history[-1], np.full(fields["time"].size - 1, 4e-7)))
        write_summary(file, fields, scales)
        report = file.create_group("report")
        if is_transient:
            steps = [2e-3, 3e-5, 4e-7] * (fields["time"].size - 1)
            history = np.concatenate((history, steps, [] if converged else [2e-3, np.finfo(float).max, 3e-2]))
        put(report, "residual_history", history)
        put(report, "load_error_history", np.minimum(0.01 * history, 1.0))
        put(report, "tolerance_effective", 1e-8)
        put(report, "cycles", history.size)
    seal(path)
    return path


def write_summary(file: h5py.File, fields: dict[str, np.ndarray], scales: dict[str, tuple[str, float]]) -> None:
    film, pressure = fields["film_thickness"], fields["pressure"]
    central = film[..., np.argmin(np.abs(fields["x"]))]
    films = ("h_min", film.min(), "film_thickness"), ("h_central", central.min(), "film_thickness")
    for name, value, like in (*films, ("p_max", pressure.max(), "pressure")):
        units, scale = scales[like]
        dataset = file.require_group("summary").create_dataset(name, data=value * scale)
        dataset.attrs.update(units=units, error_estimate=0.0)
