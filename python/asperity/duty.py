"""The history of a contact in gears or under a cam: a table of load, speeds and radius over time, and the namelist that takes it.

    asperity gear spur_gear.toml            a pair of teeth of involute gears, from its first to its last contact
    asperity cam cam.toml --output duty     a revolution of a cam under a flat follower, from the lift over the angle
    asperity cam cam.toml --force           replaces the files of an earlier call
    asperity gear spur_gear.toml --result spur_gear.h5    of a computed case extremes, their places on the teeth, and the loss

FILE.toml has a table [gear] or [cam] with the keys below. Its other tables ([bodies], [lubricant], [accuracy], ...) are groups of
the namelist. NAME.csv and NAME.nml go into the current folder, or that of --output, which is made if it is not there;
`asperity NAME.nml` computes them. Exit status 1: all that is wrong with the input, one line each; 3: a file cannot be written.

Places on the teeth are `path`, from the pitch point towards the tip of gear 1, and of both gears roll angle and radius. The loss
is that of all teeth: heat of one engagement [J/m] times length of the contact line, face width/cos b_b, times mesh frequency.

Lifts need many digits: errors e of theirs change the radius of the cam by up to 12 e/spacing^2, which at 1 deg is 0.04 mm for 1 nm.
Those of a measured lift are smoothed by `harmonics`, with what that moves in the line that is printed.
"""

from __future__ import annotations

import argparse
import math
import os
import sys
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from . import duty_result
from .case_file import written
from .errors import AsperityError, InputError
from .height_tables import Floats, Refusal
from .heights import Parser

COLUMNS = ("time [s]", "load_per_length [N/m]", "speed_1 [m/s]", "speed_2 [m/s]", "reduced_radius [m]")
LIFT_HEADER = "angle [deg],lift [mm]"
# A jump of the load lies between two rows this part of the path of contact apart.
JUMP = 1e-3
# The spline of the lift takes a full matrix.
MOST_LIFTS = 4000
Pair = Sequence[float]


class Key(NamedTuple):
    """What a key of the input may be: `size` numbers from `low` to `high`, or a text (size 0). Without default it is required."""

    words: str
    low: float = 0.0
    high: float = 0.0
    default: float | tuple[float, ...] | None = None
    size: int = 1
    kind: type = float

    def expected(self) -> str:
        """What to write."""
        kind = {float: "number", int: "whole number"}[self.kind]
        numbers = f"[{kind}, {kind}], each" if self.size == 2 else f"a {kind}"
        default = "" if self.default is None else f" (default {np.round(self.default, 4).tolist()})"
        return f"{numbers} from {self.low:g} to {self.high:g}{default}" if self.size else "a text"

    def fits(self, value: Any) -> bool:
        """Whether a value is what is expected."""
        if not self.size:
            return isinstance(value, str)
        numbers = [value] if self.size == 1 else value if isinstance(value, list | tuple) else []
        return len(numbers) == self.size and all(type(n) in (int, self.kind) and self.low <= n <= self.high for n in numbers)


KEYS = {
    "gear": {
        "module_mm": Key("normal module", 1e-3, 1e3),
        "teeth": Key("of pinion and wheel", 5, 1e5, size=2, kind=int),
        "pressure_angle_deg": Key("of the normal section", 5, 45, 20.0),
        "helix_angle_deg": Key("at the reference circle", 0, 60, 0.0),
        "profile_shift": Key("x1, x2 in modules", -3, 3, (0.0, 0.0), 2),
        "addendum_factor": Key("addenda in modules, without the shift", 0.1, 3, (1.0, 1.0), 2),
        "torque_Nm": Key("of the pinion, which drives", 1e-9, 1e9),
        "speed_rpm": Key("of the pinion", 1e-6, 1e6),
        "face_width_mm": Key("common face width", 1e-3, 1e4),
        "load_share_at_ends": Key("share of a pair at first and last contact", 1e-3, 0.5, 1 / 3),
        "rows": Key("of the table, evenly spaced; more at the kinks of the load", 2, 1e6, 200, kind=int),
    },
    "cam": {
        "lift": Key(f"CSV file, relative to FILE.toml, with the header `{LIFT_HEADER}`", size=0),
        "harmonics": Key("keep harmonics 1 to n of the lift; 0: a spline through all lifts", 0, 1000, 0, kind=int),
        "base_radius_mm": Key("radius of the cam where the lift is 0", 1e-3, 1e4),
        "width_mm": Key("width of the contact", 1e-3, 1e4),
        "speed_rpm": Key("of the cam", 1e-6, 1e6),
        "preload_N": Key("force of the spring at lift 0", 0, 1e9),
        "spring_rate_N_per_mm": Key("stiffness of the spring", 0, 1e9),
        "mass_kg": Key("what moves with the follower", 0, 1e6),
    },
}


def involute(angle: float) -> float:
    """inv a = tan a - a, angle [rad]."""
    return math.tan(angle) - angle


def involute_angle(value: float) -> float:
    """The angle [rad] whose involute function is `value` (> 0): Newton's method falls to it from above."""
    angle = min(math.cbrt(3 * value), 1.5)
    for _ in range(40):
        angle -= (involute(angle) - value) / math.tan(angle) ** 2
    return angle


@dataclass(frozen=True)
class Mesh:
    """Two external involute gears in the transverse plane; lengths [m], angles [rad].

    s is measured along the line of action from the point where it touches the base circle of gear 1, N (`line`) is that of gear 2.
    Contact begins at s_A (`start`), where the tip of gear 2 crosses the line, and ends at s_E (`end`), with that of gear 1.
    """

    working_angle: float
    base_helix_angle: float
    base_radii: tuple[float, ...]
    base_pitch: float
    line: float
    start: float
    end: float

    @property
    def contact_ratio(self) -> float:
        """Path of contact over base pitch."""
        return (self.end - self.start) / self.base_pitch

    def radius(self, s: Floats) -> Floats:
        """R1 R2/(R1 + R2) with R1 = s, R2 = N - s, over cos b_b: the section normal to the contact line (ISO/TS 6336-22)."""
        return s * (self.line - s) / (self.line * math.cos(self.base_helix_angle))

    def share(self, s: Floats, at_ends: float) -> Floats:
        """The share of a pair in the load: 1 alone, beside another one from `at_ends` linearly to 1 - `at_ends` at the jump.

        ISO/TS 6336-22, unmodified profiles: 1/3 to 2/3. The shares of both pairs, at s and s + p_b, add up to 1.
        """
        slope = (1 - 2 * at_ends) / (self.end - self.start - self.base_pitch)
        is_alone = (s > self.end - self.base_pitch) & (s < self.start + self.base_pitch)
        return np.where(is_alone, 1.0, at_ends + slope * np.minimum(s - self.start, self.end - s))

    def path(self, rows: int) -> Floats:
        """Evenly spaced s of the path of contact, and the kinks of the load: of a jump both sides."""
        first, last = self.end - self.base_pitch, self.start + self.base_pitch
        gap = min(JUMP * (self.end - self.start), (last - first) / 4, (first - self.start) / 4)
        kinks = np.array([self.start, first, first + gap, last - gap, last, self.end])
        even = np.linspace(self.start, self.end, rows)
        return np.union1d(kinks, even[np.abs(even[:, None] - kinks).min(axis=1) > gap / 2])


def mesh_of(
    module: float, teeth: Pair, normal_angle: float, helix_angle: float = 0.0, shift: Pair = (0, 0), addendum: Pair = (1, 1)
) -> Mesh:
    """Gears at the distance without backlash (ISO 21771:2007): inv a_w = inv a_t + 2 tan a_n (x1 + x2)/(z1 + z2).

    Normal module [m] and pressure angle [rad]; addenda in modules. Raises Refusal: such teeth do not mesh.
    """
    angle = math.atan(math.tan(normal_angle) / math.cos(helix_angle))
    working = involute(angle) + 2 * math.tan(normal_angle) * sum(shift) / sum(teeth)
    if working <= 0:
        raise Refusal(f"[gear] profile_shift: found the sum {sum(shift):g}, expected a larger one: no distance is free of backlash")
    working_angle, findings, base, legs = involute_angle(working), [], [], []
    for z, x, h in zip(teeth, shift, addendum, strict=True):
        reference = module * z / (2 * math.cos(helix_angle))
        base.append(reference * math.cos(angle))
        tip = max(reference + module * (h + x), base[-1])
        legs.append(math.sqrt(tip**2 - base[-1] ** 2))
        # half the angle of a tooth at its tip
        if (math.pi / 2 + 2 * x * math.tan(normal_angle)) / z + involute(angle) <= involute(math.acos(base[-1] / tip)):
            findings.append(f"[gear] found pointed teeth of gear {len(base)}, expected less profile_shift or addendum_factor")
    line = sum(base) * math.tan(working_angle)
    base_helix_angle = math.asin(math.sin(helix_angle) * math.cos(normal_angle))
    base_pitch = math.pi * module * math.cos(angle) / math.cos(helix_angle)
    mesh = Mesh(working_angle, base_helix_angle, tuple(base), base_pitch, line, line - legs[1], legs[0])
    findings += [
        f"[gear] found tips of gear {3 - foot} that reach {beyond * 1e3:.3g} mm beyond the involute of gear {foot}, expected "
        "lower addendum_factor, more teeth or profile_shift"
        for foot, beyond in ((1, -mesh.start), (2, mesh.end - line))
        if beyond >= 0
    ]
    if not 1 < mesh.contact_ratio < 2:
        findings.append(f"[gear] found a contact ratio of {mesh.contact_ratio:.4g}, expected more than 1 and less than 2")
    if findings:
        raise Refusal("\n".join(findings))
    return mesh


def mesh_from(values: dict[str, Any]) -> Mesh:
    """The gears of the input. Raises Refusal."""
    angle, helix_angle = (math.radians(values[name]) for name in ("pressure_angle_deg", "helix_angle_deg"))
    shapes = values["profile_shift"], values["addendum_factor"]
    return mesh_of(values["module_mm"] * 1e-3, values["teeth"], angle, helix_angle, *shapes)


def gear_history(values: dict[str, Any]) -> tuple[Floats, str]:
    """The table of one pair of teeth, and what is to be known of the mesh.

    The contact travels at w1 r_b1 and surfaces at u1 = w1 s, u2 = w2 (N - s). A line across the face has the load per length
    torque/(r_b1 face_width): of helical teeth line and force grow alike. Their overlap is not counted.
    """
    mesh = mesh_from(values)
    s = mesh.path(values["rows"])
    w1 = values["speed_rpm"] * math.pi / 30
    w2 = w1 * mesh.base_radii[0] / mesh.base_radii[1]
    load = values["torque_Nm"] / (mesh.base_radii[0] * values["face_width_mm"] * 1e-3) * mesh.share(s, values["load_share_at_ends"])
    time = (s - s[0]) / (w1 * mesh.base_radii[0])
    words = f"contact ratio {mesh.contact_ratio:.4g}, path of contact {(s[-1] - s[0]) * 1e3:.4g} mm, "
    words += f"working pressure angle {math.degrees(mesh.working_angle):.4f} deg"
    return np.column_stack([time, load, w1 * s, w2 * (mesh.line - s), mesh.radius(s)]), words


def second_derivatives(x: Floats, y: Floats, period: float) -> Floats:
    """d2y/dx2 at the knots x of the periodic cubic spline through y. Errors e of y become up to 12 e/spacing^2."""
    after = np.diff(np.append(x, x[0] + period))
    before = np.roll(after, 1)
    slope = (np.roll(y, -1) - y) / after
    matrix, i = np.diag(2 * (before + after)), np.arange(x.size)
    matrix[i, (i + 1) % x.size] += after
    matrix[i, i - 1] += before
    return np.asarray(np.linalg.solve(matrix, 6 * (slope - np.roll(slope, 1))))


def text_of(path: Path, name: str = "") -> str:
    """A text in UTF-8. Raises Refusal."""
    try:
        return path.read_text(encoding="utf-8-sig")
    except (OSError, ValueError) as error:
        raise Refusal(f"{name}found {path.name}, which cannot be read: {getattr(error, 'strerror', None) or error}") from error


def read_lift(path: Path) -> tuple[Floats, Floats]:
    """Angles [rad] of one revolution and lifts [m]; the first is not repeated, behind an event comes the base circle."""
    lines = [line for line in text_of(path, "[cam] lift: ").splitlines() if line.strip() and not line.startswith("#")]
    if not lines or lines[0].replace(" ", "") != LIFT_HEADER.replace(" ", ""):
        raise Refusal(f"[cam] lift: found {''.join(lines[:1])!r:.60}, expected the header {LIFT_HEADER!r}")
    if not 8 < len(lines) <= MOST_LIFTS:
        raise Refusal(f"[cam] lift: found {len(lines) - 1} rows, expected 8 to {MOST_LIFTS}")
    try:
        degrees, lift = np.loadtxt(lines[1:], delimiter=",", unpack=True)
    except ValueError as error:
        raise Refusal(f"[cam] lift: expected rows of two numbers: {error}") from error
    angle, lift = np.radians(degrees), lift * 1e-3
    steps, rest = np.diff(angle), 2 * math.pi - (angle[-1] - angle[0])
    if not np.all(np.isfinite(lift)) or not steps.min() > 0 or rest < -1e-9:
        raise Refusal("[cam] lift: found angles that do not rise, more than 360 deg, or no numbers, expected those of a revolution")
    is_whole, is_event = abs(rest) < 1e-9, rest > 1.5 * steps.max()
    if (is_whole and abs(lift[-1] - lift[0]) > 1e-9) or (is_event and np.abs(lift[[0, -1]]).max() > 1e-9):
        words = f"{degrees[-1] - degrees[0]:g} deg with lifts of {lift[0] * 1e3:g} and {lift[-1] * 1e3:g} mm at its ends"
        raise Refusal(f"[cam] lift: found {words}, expected a revolution, or an event from lift 0 to lift 0")
    base = angle[-1] + np.linspace(0, rest, math.ceil(rest / np.median(steps)) + 1)[1:-1] if is_event else angle[:0]
    return np.append(angle[: -1 if is_whole else None], base), np.append(lift[: -1 if is_whole else None], 0 * base)


def cam_history(values: dict[str, Any]) -> tuple[Floats, str]:
    """The table of one revolution, and what the harmonics left out.

    With the lift L over the angle, a flat follower touches the cam at L' beside its axis, where the radius of curvature is
    rho = r_b + L + L''. Seen from the contact, which moves at w L'', the cam moves at u1 = w rho and the follower at u2 = w L''
    (D. Dowson, C. M. Taylor, G. Zhu, J. Phys. D 25 (1992) A313: u1 + u2 = w (r_b + L + 2 L'')). The load is
    preload + k L + m w^2 L''.
    """
    angle, lift = read_lift(values["lift"])
    words, count = f"lift up to {lift.max() * 1e3:.4g} mm", values["harmonics"]
    if 2 * count + 1 > lift.size:
        raise Refusal(f"[cam] harmonics: found {count}, expected at most {(lift.size - 1) // 2} for {lift.size} lifts")
    if count:
        order = np.arange(1, count + 1)
        waves = np.outer(angle, order)
        basis = np.hstack([np.ones((angle.size, 1)), np.cos(waves), np.sin(waves)])
        weights = np.linalg.lstsq(basis, lift, rcond=None)[0]
        words += f", changed by at most {np.abs(basis @ weights - lift).max() * 1e6:.3g} um"
        lift, bend = basis @ weights, basis @ (weights * -(np.concatenate([[0], order, order]) ** 2.0))
    else:
        bend = second_derivatives(angle, lift, 2 * math.pi)
    w = values["speed_rpm"] * math.pi / 30
    rho = values["base_radius_mm"] * 1e-3 + lift + bend
    force = values["preload_N"] + values["spring_rate_N_per_mm"] * 1e3 * lift + values["mass_kg"] * w**2 * bend
    findings = [
        f"[cam] found {name} of {low.min() * scale:.4g} {unit} at {np.degrees(angle[low.argmin()]):.5g} deg, expected > 0: {why}"
        for name, low, scale, unit, why in (
            ("a radius of curvature", rho, 1e3, "mm", "a flat follower needs a convex cam, and lifts without noise (harmonics)"),
            ("a load", force, 1, "N", "the follower leaves the cam"),
        )
        if low.min() <= 0
    ]
    if findings:
        raise Refusal("\n".join(findings))
    table = np.column_stack([(angle - angle[0]) / w, force / (values["width_mm"] * 1e-3), w * rho, w * bend, rho])
    return np.vstack([table, [2 * math.pi / w, *table[0, 1:]]]), words


def told(table: Floats, bodies: dict[str, Any]) -> str:
    """What the contact sees, so that wrong units are seen: p_h = sqrt(w E'/(2 pi R)) if the bodies have their moduli."""
    _, load, u1, u2, radius = table.T
    words = f"{len(table)} rows, {table[-1, 0] * 1e3:.4g} ms; load {load.min() * 1e-3:.4g} to {load.max() * 1e-3:.4g} N/mm, "
    words += (
        f"R {radius.min() * 1e3:.4g} to {radius.max() * 1e3:.4g} mm, u1 + u2 {(u1 + u2).min():.4g} to {(u1 + u2).max():.4g} m/s"
    )
    try:
        softness = [
            (1 - bodies[f"poisson_ratio_{i}"] ** 2) / bodies[f"youngs_modulus_{i}"] for i in "12" if "reduced_modulus" not in bodies
        ]
        pressure = math.sqrt((load / radius).max() * (2 / sum(softness) if softness else bodies["reduced_modulus"]) / (2 * math.pi))
    except (KeyError, TypeError, ValueError, ZeroDivisionError):  # the program says what is wrong with them
        return words
    return f"{words}, Hertz pressure up to {pressure * 1e-9:.4g} GPa"


def read_input(path: Path, command: str) -> tuple[dict[str, Any], dict[str, Any]]:
    """The values of the command's table, and the groups of the namelist. Raises Refusal with all findings."""
    try:
        tables = tomllib.loads(text_of(path))
    except (ValueError, RecursionError) as error:
        raise Refusal(f"found no TOML: {error}") from error
    keys, given = KEYS[command], tables.pop(command, None)
    if not isinstance(given, dict):
        raise Refusal(f"found no table [{command}], expected it with {', '.join(keys)}")
    findings = [f"[{command}] {key}: found a key that is unknown, expected {', '.join(keys)}" for key in given if key not in keys]
    values = {name: given.get(name, key.default) for name, key in keys.items()}
    findings += [
        f"[{command}] {name}: found {'nothing' if values[name] is None else repr(values[name])}, expected {key.expected()}"
        for name, key in keys.items()
        if not key.fits(values[name])
    ]
    try:
        written(tables)
    except InputError as error:
        findings += [f"[{found.group}] {found.key}: {found.text}".replace(" : ", " ") for found in error.findings]
    if findings:
        raise Refusal("\n".join(findings))
    return values, tables


def gear_told(result: Path, values: dict[str, Any], table: Floats) -> str:
    """Extremes of a pair of teeth with their places, and the loss of all: a pair engages for contact ratio times a mesh period."""
    mesh, w1 = mesh_from(values), values["speed_rpm"] * math.pi / 30
    pitch = mesh.base_radii[0] * math.tan(mesh.working_angle)

    def place(time: float) -> str:
        s = mesh.start + w1 * mesh.base_radii[0] * time
        legs = list(zip((s, mesh.line - s), mesh.base_radii, strict=True))
        numbers = [math.degrees(leg / base) for leg, base in legs] + [math.hypot(leg, base) * 1e3 for leg, base in legs]
        return f"{(s - pitch) * 1e3:7.2f}" + "".join(f"{number:7.2f}" for number in numbers)

    heads = "   path roll 1 roll 2 radius 1, 2", "   [mm]  [deg]  [deg]        [mm]"
    length = values["face_width_mm"] * 1e-3 / math.cos(mesh.base_helix_angle) * mesh.contact_ratio
    lines, loss, error = duty_result.told(result, table, duty_result.Places(heads, place), length)
    power = values["torque_Nm"] * w1
    words = f"{duty_result.prefixed(loss, 'W')}, {100 * loss / power:.4g} % of {duty_result.prefixed(power, 'W')}"
    return f"{lines}\nloss of the mesh: {words}; error {duty_result.share(loss, error)}"


def cam_told(result: Path, values: dict[str, Any], table: Floats) -> str:
    """Extremes of a revolution with their angles in those of the lift, and the loss."""
    first, w = read_lift(values["lift"])[0][0], values["speed_rpm"] * math.pi / 30
    places = duty_result.Places(("     cam", "   [deg]"), lambda time: f"{round(math.degrees(first + w * time), 2) + 0.0:8.2f}")
    lines, loss, error = duty_result.told(result, table, places, values["width_mm"] * 1e-3)
    words = f"{duty_result.prefixed(loss, 'W')}, a mean torque of {duty_result.prefixed(loss / w, 'N m')}"
    return f"{lines}\nloss of the contact: {words}; error {duty_result.share(loss, error)}"


def history_of(command: str, path: Path) -> tuple[dict[str, Any], dict[str, Any], Floats, str]:
    """The values of the input, the groups of the namelist, the table and what is to be known of it. Raises Refusal."""
    values, groups = read_input(path, command)
    if command == "cam":
        values["lift"] = path.parent / values["lift"]
    return values, groups, *(gear_history if command == "gear" else cam_history)(values)


def convert(command: str, path: Path, folder: Path, force: bool) -> str:
    """Reads and writes; returns the line that says what was written. Raises OSError, Refusal."""
    values, groups, table, words = history_of(command, path)
    names = [folder / f"{path.stem}{ending}" for ending in (".csv", ".nml")]
    for name in names:
        if name.exists() and not (force and name.resolve() != values.get("lift", path).resolve()):
            raise Refusal(f"{name}: found a file of that name, expected none, another --output, or --force")
    history = {"file": names[0].name, "interpolation": "linear", "periodic": command == "cam"}
    own: dict[str, dict[str, Any]] = {"case": {"problem": "ehl_line"}, "history": history, "time": {"transient": True}}
    case = {group: {**own.get(group, {}), **groups.get(group, {})} for group in [*own, *groups]}
    # Paths of a namelist are relative to it; those of the input to itself.
    text = written(case, lambda file: file if file == names[0].name else os.path.relpath(path.parent / file, folder))
    folder.mkdir(parents=True, exist_ok=True)
    rows = "\n".join(",".join(f"{number:.12g}" for number in row) for row in table)
    title = f"asperity {command} {path.name}: {words}".encode("utf-8", "replace").decode()
    names[0].write_text(f"# {title}\n{','.join(COLUMNS)}\n{rows}\n", encoding="utf-8")
    names[1].write_text(f"! {title}\n{text}", encoding="utf-8")
    return f"{names[0]}, {names[1]}: {words}; {told(table, case.get('bodies', {}))}"


def main(arguments: list[str] | None = None, program: str = "asperity-duty") -> int:
    """Command line; returns the exit status."""
    parser = Parser(prog=program, description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter, allow_abbrev=False)
    commands = parser.add_subparsers(dest="command", required=True, metavar="gear|cam")
    for name, keys in KEYS.items():
        epilog = "\n  ".join([f"keys of [{name}]:", *(f"{key:21} {rule.words}: {rule.expected()}" for key, rule in keys.items())])
        command = commands.add_parser(name, description=__doc__, epilog=epilog, formatter_class=parser.formatter_class)
        command.add_argument("file", type=Path, metavar="FILE.toml", help="gears or cam, and the groups of the namelist")
        command.add_argument("--output", type=Path, default=Path(), metavar="DIR", help="folder of the table and the namelist")
        command.add_argument("--force", action="store_true", help="replace files that are there")
        command.add_argument(
            "--result", type=Path, metavar="NAME.h5", help="write nothing, but tell of this result extremes and loss"
        )
    options = parser.parse_args(arguments)
    try:
        if options.result:
            values, _, table, _ = history_of(options.command, options.file)
            print({"gear": gear_told, "cam": cam_told}[options.command](options.result, values, table))
        else:
            print(convert(options.command, options.file, options.output, options.force))
    except AsperityError as error:
        print(error, file=sys.stderr)
        return 1
    except Refusal as error:
        print("\n".join(f"{options.file}: {line}" for line in str(error).splitlines()), file=sys.stderr)
        return 1
    except OSError as error:
        print(f"{program}: {error.filename or ''}: {error.strerror or error}", file=sys.stderr)
        return 3
    return 0


if __name__ == "__main__":
    sys.exit(main())
