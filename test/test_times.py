"""Which times of a transient count: periodic passages, features without a place, what starts inside the contact; whole steps."""

import contextlib
import random

import h5py
import numpy as np
import pytest
from cases import STEADY, TRANSIENT, ended, text, write, write_profile

WAVE = "&surface_2 shape = 'sinusoid', amplitude = 3e-8, wavelength = 1e-4, position = 0.2 /\n"
RIDGE = "&surface_2 shape = 'feature', amplitude = 2e-7, wavelength = 1e-4{} /\n"
TIME = "&time transient = .true., end_time = {}, time_step = 0.01{} /\n"
PERIOD = 1e-4 / 1.05797e-4 / (11 / 6)


@contextlib.contextmanager
def run(asperity, folder, surface, end, others="", extra=""):
    """The result of a passage through Case 1, and what is said."""
    write(folder, "a.nml", STEADY + surface + TIME.format(end, others) + extra)
    done = ended(asperity("a.nml", "--verbose"))
    with h5py.File(folder / "a.h5") as file:
        yield file, " ".join((done.stderr + done.stdout).split())


@pytest.mark.parametrize(
    ("surface", "expected"),
    [
        (WAVE, None),
        (RIDGE.format(", position = 0.3"), None),
        (RIDGE.format(", position = -2.5"), (1 + 2.5 + 0.5e-4 / 1.05797e-4) / (11 / 6)),
        ("&surface_2 shape = 'file', file = 'z.csv', position = -9.0 /\n", (1 + 9.0 + 5e-4 / 1.05797e-4) / (11 / 6)),
    ],
    ids=["wave", "ridge inside", "ridge", "profile"],
)
def test_a_chosen_end_shows_everything(run_case, tmp_path, surface, expected):
    """Nothing is left to be told about the times; the last ridge or node leaves at |X| = 1."""
    write_profile(tmp_path / "z.csv", 1e-8 * np.sin(0.3 * np.arange(201)), 5e-6)
    done = run_case(STEADY + surface + "&time transient = .true., time_step = 0.04 /\n", "--verbose", name="a")
    assert "end_time" not in done.stderr
    with h5py.File(tmp_path / "a.h5") as file:
        end = file["input/effective/time"].attrs["end_time"]
        assert file["transient/time"][-1] == pytest.approx(end, rel=1e-12)
    assert expected is None or end == pytest.approx(expected, rel=2e-3)


def test_an_end_in_seconds_is_that_in_half_widths(run_case, asperity, tmp_path):
    """The same passage, to the last bit of its steps."""
    with run(asperity, tmp_path, RIDGE.format(""), 0.2) as (first, _):
        times, scale = first["transient/time"][()], first["transient/time"].attrs["si_scale"]
    run_case(STEADY + RIDGE.format("") + TIME.format(0.2, "").replace("end_time = 0.2", f"duration = {0.2 * scale:.17g}"), name="b")
    with h5py.File(tmp_path / "b.h5") as file:
        assert file["transient/time"][()] == pytest.approx(times, rel=1e-12)
        assert file["input/effective/time"].attrs["end_time"] == pytest.approx(0.2, rel=1e-12)


@pytest.mark.parametrize(("end", "expected"), [(500.0, None), (8e3, "about 5 min 7 s"), (1.2e5, "about 1 h 16 min")])
def test_a_check_says_how_long_a_passage_takes(run_case, end, expected):
    """Minutes, and of hours what makes them fewer."""
    done = run_case(STEADY + RIDGE.format("") + TIME.format(end, ""), "--check", name="a")
    assert (": no findings; about " in done.stdout) == (expected is not None)
    assert (expected or "") in done.stdout
    assert ("harmonics" in done.stdout) == (end > 1e5)


def test_periodic_passage_reports_its_last_periods(asperity, tmp_path):
    with run(asperity, tmp_path, WAVE, 9.0) as (file, told):
        attributes, series, h_min = file["summary"].attrs, file["transient"], file["summary/h_min"]
        begin, period = attributes["statistics_from"], attributes["period"]
        assert period == pytest.approx(PERIOD, rel=1e-5)
        periods = (9.0 - begin) / period
        assert periods == pytest.approx(round(periods), abs=1e-9)
        assert attributes["settled_from"] < begin < 9.0
        counted = series["time"][()] >= begin - 1e-9
        earlier = (series["time"][()] >= 2 * begin - 9.0 - 1e-9) & (series["time"][()] <= begin + 1e-9)
        values = series["h_min"][()]
        assert h_min.attrs["dimensionless"] == values[counted].min()
        scale = series["h_min"].attrs["si_scale"]
        change = abs(values[counted].min() - values[earlier].min())
        assert h_min.attrs["error_start"] == pytest.approx(change * scale, rel=1e-6, abs=0)
        assert 0 < h_min.attrs["error_start"] < h_min.attrs["error_estimate"] < 0.2 * h_min[()]
        assert "note" not in file["report"]
        assert float(file["input/effective/time"].attrs["statistics_from"]) == begin
    assert " count, periods of " in told


@pytest.mark.path
def test_an_end_too_early_is_told(asperity, tmp_path):
    with run(asperity, tmp_path, WAVE, 3.0) as (file, told):
        note = text(file["report/note"][()])
        assert np.isnan(file["summary/h_min"].attrs["error_estimate"])
        assert text(file["summary/h_min"].attrs["no_estimate"]) == "the start is in the quantities, see /report/note"
    assert note in told
    needed = float(note.split("end_time = ")[1].split()[0])
    with run(asperity, tmp_path, WAVE, needed) as (file, told):
        assert "note" not in file["report"]
        assert np.isfinite(file["summary/h_min"].attrs["error_estimate"])


def test_a_ridge_without_a_place_begins_in_front(asperity, tmp_path):
    """It meets the same film as one that begins far outside, and all of its passage counts."""
    found = {}
    for position, end in (("", 3.0), (", position = -3.5", 3.5)):
        with run(asperity, tmp_path, RIDGE.format(position), end) as (file, _):
            found[position] = [file[f"summary/{name}"][()] for name in ("h_min", "h_central", "p_max")]
            place = float(file["input/effective/surface_2"].attrs["position"])
            assert file["summary"].attrs["statistics_from"] == 0
            assert "note" not in file["report"]
            assert place < -2.0
    first, other = found.values()
    assert first == pytest.approx(other, rel=5e-3)


@pytest.mark.parametrize(("position", "words"), [(0.3, "stands in the contact at T = 0"), (-12.0, "still in the contact or in")])
def test_a_passage_that_is_not_whole_is_told(asperity, tmp_path, position, words):
    with run(asperity, tmp_path, RIDGE.format(f", position = {position}"), 6.0) as (file, told):
        assert words in text(file["report/note"][()])
    assert words in told


@pytest.mark.parametrize(("position", "is_told"), [(-2.6, True), (-12.0, False)])
def test_a_ridge_that_passes_before_its_companion_has_settled_is_told(asperity, tmp_path, position, is_told):
    """A wave of the other surface is in the contact from T = 0 on; the ridge counts whole, or there is a note."""
    beside = "&surface_1 shape = 'sinusoid', amplitude = 1e-8, wavelength = 1e-4 /\n"
    with run(asperity, tmp_path, RIDGE.format(f", position = {position}"), 3.5 - position, "", beside) as (file, told):
        summary = file["summary/h_min"].attrs["dimensionless"]
        passage = file["transient/h_min"][()].min()
        assert (summary > 1.1 * passage) == is_told
        assert ("note" in file["report"]) == is_told
    words = "a feature that moves enters the contact at T = "
    assert (words in " ".join(told.split())) == is_told


def test_steps_too_long_for_an_estimate_are_told(asperity, tmp_path):
    """With the step that is not; nothing is told where no estimate is wanted."""
    case = STEADY + RIDGE.format(", position = -2.1") + "&time transient = .true., end_time = 2.0, time_step = {} /\n"
    note = "the error is not estimated: the finest moving wave passes in 20.6 time steps, an estimate needs 32, or steps of dX"
    write(tmp_path, "long.nml", case.format(0.025))
    write(tmp_path, "silent.nml", case.format(0.025) + "&accuracy error_bars = .false. /\n")
    done, silent = asperity("long.nml", "--verbose"), asperity("silent.nml")
    told = " ".join(done.stdout.split())
    assert note in told
    assert (done.returncode, silent.returncode, "not estimated" in silent.stdout + silent.stderr) == (0, 0, False)
    step = float(told.split(f"{note}: time_step = ")[1].split()[0])
    write(tmp_path, "short.nml", case.format(step))
    assert "not estimated" not in asperity("short.nml", "--verbose").stdout
    with h5py.File(tmp_path / "long.h5") as before, h5py.File(tmp_path / "short.h5") as after:
        assert [np.isfinite(file["summary/h_min"].attrs["error_estimate"]) for file in (before, after)] == [False, True]


def test_what_is_asked_for_counts(asperity, tmp_path):
    """From the given time on; statistics of the film too, and after an interruption as well (test_resume.py)."""
    with run(asperity, tmp_path, WAVE, 6.0, ", statistics_from = 5.0", "&output film_thresholds = 4e-7 /\n") as (file, _):
        values = file["transient/h_min"][()][file["transient/time"][()] >= 5.0 - 1e-9]
        assert file["summary/h_min"].attrs["dimensionless"] == values.min()
        below = values * file["transient/h_min"].attrs["si_scale"] < 4e-7
        assert file["statistics/time_below"][()] == pytest.approx([below.mean()])
        assert "note" not in file["report"]
    with run(asperity, tmp_path, WAVE, 6.0, ", statistics_from = 0.0") as (file, told):
        assert file["summary/h_min"].attrs["dimensionless"] == file["transient/h_min"][()].min()
    assert "statistics_from lies in the artificial start" in told


@pytest.mark.parametrize(
    ("ridge", "others", "first"),
    [
        (RIDGE.format(", position = -6.0"), "", "arrival"),
        (RIDGE.replace("surface_2", "surface_1").format(", position = -2.6"), "", "arrival"),
        (RIDGE.format(", position = -6.0"), ", statistics_from = 0.5", 0.5),
        (RIDGE.format(", position = -40.0"), "", 0.0),
    ],
)
def test_statistics_begin_when_the_ridge_arrives(asperity, tmp_path, ridge, others, first):
    """The smooth film before it is no peak of the distribution, unless asked for; what never arrives leaves all times."""
    end = 12.0 if "surface_1" in ridge else 5.0
    with run(asperity, tmp_path, ridge, end, others, "&output film_thresholds = 4e-7 /\n") as (file, _):
        time, films = file["transient/time"][()], file["transient/h_min"]
        values = films[()] * films.attrs["si_scale"]
        begin = file["statistics"].attrs["statistics_from"]
        if first == "arrival":
            change = abs(values / values[0] - 1)
            assert 3 * change[time < begin].max() < 0.03 < change.max()
            film = file["summary/h_central"].attrs["dimensionless"]
            speed, place = (2 * 1.1 / 1.2, -6.0) if "position = -6" in ridge else (2 * 0.1 / 1.2, -2.6)
            edge = place + 0.5 * 1e-4 / file["scaling"].attrs["half_width"]
            assert begin == pytest.approx((-1 - 0.5 * np.sqrt(2 * film) - edge) / speed, rel=0.15)
        else:
            assert begin == pytest.approx(first, abs=1e-6)
        counted = (time > 0) & (time >= begin)
        edges, shares = file["statistics/h_min_edges"][()], file["statistics/h_min_share"][()]
        assert shares.sum() == pytest.approx(1.0)
        expected = np.histogram(values[counted], edges)[0] / counted.sum()
        assert shares == pytest.approx(expected, abs=2.5 / counted.sum())


FAST = "&accuracy error_bars = .false. /\n"
SOURCE = random.Random(20261122)
# End and step; the last one is given to a few digits only: rounding adds no step.
STEPS = [(0.37, 0.1), (0.3, 0.1), (0.1, 0.1), (0.218066, 0.0272583)]
STEPS += [(round(SOURCE.uniform(0.05, 0.4), 4), round(SOURCE.uniform(0.01, 0.05), 4)) for _ in range(8)]


def stepped(end, step):
    return TRANSIENT.replace("end_time = 1.0", f"end_time = {end}").replace("time_step = 0.05", f"time_step = {step}") + FAST


def test_steps_end_at_the_end_time(asperity, tmp_path, solved_case):
    for i, (end, step) in enumerate(STEPS):
        write(tmp_path, f"{i}.nml", stepped(end, step))
    assert asperity(*(f"{i}.nml" for i in range(len(STEPS))), "--quiet").returncode == 0
    for i, (end, step) in enumerate(STEPS):
        with h5py.File(tmp_path / f"{i}.h5") as file:
            times, taken = file["transient/time"][()], file["input/effective/time"].attrs["time_step"]
        assert times[-1] == pytest.approx(end, rel=1e-14)
        assert np.diff(times) == pytest.approx(taken, rel=1e-9)
        # the given step or shorter, by no more than the last step was too long
        assert taken <= step * (1 + 1e-3)
        assert len(times) - 1 == int(np.ceil(end / step - 1e-3))
    step = 5.37109375e-3
    with solved_case(stepped(20 * step, step)) as file:
        assert file["input/effective/time"].attrs["time_step"] == step
