"""batch/plot.py and batch/all.py: figures of gathered tables, with error bars and with what failed."""

import os
import shutil
from types import SimpleNamespace

import h5py
import numpy as np
import pytest
from cases import ROOT
from gathered import read_gathered
from plot import is_logarithmic, wish_of
from plot_curves import Wish, draw_curves, draw_series, style
from plot_map import REGIMES, draw_map, on_grid, read_films
from plot_stribeck import draw_stribeck
from sweep_file import SweepError

TEXT = h5py.string_dtype()
NOTHING = dict.fromkeys(("x", "y", "colour", "facet", "log", "points", "kind", "regimes"))
SPEEDS, LOADS = np.geomspace(0.01, 1, 6), np.linspace(1e5, 3e5, 4)


@pytest.fixture
def table(tmp_path):
    """A made table: 6 speeds times 4 loads; one case not converged, one failed, one not run."""
    speed, load = (values.ravel() for values in np.meshgrid(SPEEDS, LOADS, indexing="ij"))
    film = 1e-6 * speed**0.7 * (load / 1e5) ** -0.1
    status = np.full(24, "done", dtype=object)
    status[[3, 10, 20]] = "not converged", "failed", "not run"
    film[[10, 20]] = np.nan
    columns = {"u": speed, "load.w": load, "status": status, "reason": status, "h_min": film, "h_min_error": 0.1 * film}
    columns |= {"h_central": 1.2 * film, "words": status, "scaling_moes_m_sum": 1 / speed, "scaling_moes_l_sum": load / 3e4}
    with h5py.File(tmp_path / "gathered.h5", "w", track_order=True) as file:
        file["case"] = np.array([f"case_{i:04d}" for i in range(24)], dtype=object)
        for name, values in columns.items():
            file.create_dataset(name, data=values, dtype=TEXT if values.dtype == object else float)
        file["h_min"].attrs["units"] = file["h_central"].attrs["units"] = "m"
        file.attrs["sweep"] = 'title = "A $made table"\n[plot]\nx = "u"\ny = ["h_min", "h_central"]\nlog = ["x", "y"]\n'
    return tmp_path / "gathered.h5"


def draw(table, **wish):
    found = read_gathered(table)
    chosen = Wish(**wish)
    return (draw_map if chosen.kind == "map" else draw_curves)(found, chosen)


def labels(figure):
    return [text.get_text() for text in figure.legends[0].get_texts()] if figure.legends else []


def test_series_and_medians():
    figure, axes = style.new_figure(3, 60)
    bars = draw_series(axes, np.array([2.0, 1.0]), np.array([5.0, 4.0]), np.array([0.5, np.nan]), "film", style.SERIES[0], False)
    np.testing.assert_array_equal(bars[0].get_xydata(), [[1, 4], [2, 5]])
    segments = bars[2][0].get_segments()
    np.testing.assert_array_equal(segments, [[[1, 4], [1, 4]], [[2, 4.5], [2, 5.5]]])  # not known: no bar
    style.plt.close(figure)
    figure, axes = style.new_figure(3, 60)
    line = draw_series(axes, np.repeat([1.0, 2.0], 5), np.arange(10.0), None, "film", style.SERIES[0], False)
    np.testing.assert_array_equal(line.get_xydata(), [[1, 2], [2, 7]])
    style.plt.close(figure)
    x, y = np.array([1.0, 2, 1, 2]), np.array([5.0, 5, 6, 6])
    columns, rows, values = on_grid(x, y, np.array([1.0, 2, 3, 4]))
    assert (list(columns), list(rows), values.tolist()) == ([1, 2], [5, 6], [[1, 2], [3, 4]])
    assert on_grid(x, np.array([5.0, 6, 7, 8]), x) is None
    assert on_grid(np.array([1.0, 1, 2, 2]), np.array([5.0, 5, 6, 6]), x) is None


def test_failed_cases_are_marked_and_counted(table):
    figure = draw(table, x="u", y=("h_min",), colour="load.w", log=("x", "y"))
    assert labels(figure)[-2:] == ["not converged (1)", "no result (2)"]
    panel = figure.axes[0]
    crosses = [line for line in panel.lines if line.get_marker() == "x"]
    np.testing.assert_allclose(crosses[0].get_xdata(), SPEEDS[[10 // 4, 20 // 4]])
    circles = [line.get_xdata() for line in panel.lines if line.get_markerfacecolor() == "none" and len(line.get_xdata())]
    np.testing.assert_allclose(np.concatenate(circles), SPEEDS[[3 // 4]])
    # the values of the case that did not converge are in no curve
    assert sum(len(container[0].get_xdata()) for container in panel.containers) == 21
    style.plt.close(figure)


def test_facets_units_and_labels(table):
    figure = draw(table, x="u", y=("h_min", "h_central"), facet="load.w")
    assert len(figure.axes) == 4
    assert figure.axes[0].get_title() == "W = 1e+05"
    words = (figure.axes[0].get_ylabel(), *labels(figure)[:2])
    assert words == ("Film thickness [µm]", "Smallest film thickness h_min", "Central film thickness h_central")
    style.plt.close(figure)


def test_a_map_has_cells_where_the_grid_is_full_none_where_cases_failed_and_labels_beside_words(table):
    figure = draw(table, kind="map", x="u", colour="load.w", y=("h_min",), log=("x", "z"), regimes=True)
    values = np.ma.filled(figure.axes[0].collections[0].get_array(), np.nan)
    assert values.shape == (4, 6)
    assert np.isnan(values).sum() == 3
    np.testing.assert_allclose(values[1, 5], 1e3 * (LOADS[1] / 1e5) ** -0.1)  # nm, at 1 m/s
    assert labels(figure) == ["not converged (1)", "no result (2)"]
    # the regimes that the chart of Moes has between M = 1 and 100, L = 3.3 and 10
    moes_m, moes_l = np.meshgrid(np.geomspace(1, 100, 50), np.linspace(1e5, 3e5, 50) / 3e4)
    expected = {REGIMES[i] for i in np.unique(read_films().regime(moes_m, moes_l))}
    assert {text.get_text() for text in figure.axes[0].texts} & set(REGIMES) == expected
    assert len(expected) > 1
    # no label of a line is under words
    texts = figure.axes[0].texts
    boxes = [text.get_bbox_patch().get_window_extent() for text in texts if text.get_bbox_patch()]
    figure.axes[0].text(0.5, 0.5, "under", transform=figure.axes[0].transAxes)
    figure.axes[0].text(0.5, 0.5, "over", transform=figure.axes[0].transAxes, bbox={"pad": 1})
    figure.axes[0].text(0.01, 0.99, "apart", transform=figure.axes[0].transAxes)
    style.hide_covered(figure)
    assert boxes
    shown = {text.get_text(): text.get_visible() for text in texts}
    assert (shown["under"], shown["over"], shown["apart"]) == (False, True, True)
    style.plt.close(figure)


@pytest.mark.parametrize("key", ["bodies.u", "u"])
def test_axes_are_as_the_sweep_varies(key):
    vary = {"u": {"from": 1, "to": 2, "count": 3, "spacing": "log"}}
    assert is_logarithmic({"vary": {"bodies": vary} if "." in key else vary}, key)
    assert not is_logarithmic({"vary": vary}, "bodies.v")


def test_long_names_stand_below_each_other_along_an_axis(table):
    with h5py.File(table, "a") as file:
        for name in (names := ["the_contact_area_of_body_1", "the_plastic_area_of_body_2"]):
            file.copy("h_min", name)
    figure = draw(table, x="u", y=tuple(names))
    assert figure.axes[0].get_ylabel().startswith(",\n".join(names))
    style.plt.close(figure)


def test_the_sweep_and_the_command_line_say_what_to_draw_also_by_formula(table):
    found = read_gathered(table)
    assert found.compute("lambda = h_min/sqrt(2*1e-7**2)") == "lambda"
    np.testing.assert_allclose(found.numbers("lambda"), found.numbers("h_min") / np.sqrt(2e-14))
    assert np.isnan(found.numbers("lambda")).sum() == 2
    with pytest.raises(SweepError, match="h_mean"):
        found.compute("lambda = h_mean/1e-7")
    assert wish_of(found, SimpleNamespace(**NOTHING)) == Wish("u", ("h_min", "h_central"), log=("x", "y"))
    other = SimpleNamespace(**(NOTHING | {"y": ["h_min"], "colour": "load.w"}))
    assert wish_of(found, other) == Wish("u", ("h_min",), colour="load.w", log=("x", "y"))
    found.sweep["sample"] = {}
    assert wish_of(found, SimpleNamespace(**NOTHING)).points
    found.sweep["plot"]["hue"] = "red"
    with pytest.raises(SweepError, match="found hue = 'red'"):
        wish_of(found, SimpleNamespace(**NOTHING))


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--x", "speed", "--y", "h_min"], "found no column speed"),
        (["--x", "u", "--y", "words"], "words holds words, expected numbers"),
        (["--x", "u", "--y", "h_min", "--kind", "map"], "a map needs --colour"),
        (["--x", "u", "--y", "h_min", "--facet", "h_central"], "expected at most 12 panels"),
        (["--x", "u", "--kind", "stribeck", "--colour", "load.w"], "a Stribeck curve has --x alone"),
        (["--x", "u", "--kind", "stribeck"], "found no column friction_coefficient"),
    ],
)
def test_bad_wishes(batch, table, options, words):
    assert words in batch("plot.py", table, *options, status=1).stderr


def test_damaged_tables_and_wishes(table):
    """Each is one line of words: columns of another shape or kind, wishes that are no names."""
    content = table.read_bytes()

    def words_of(change, **wish):
        table.write_bytes(content)
        with h5py.File(table, "a") as file:
            change(file)
        with pytest.raises(SweepError) as error:
            draw(table, **vars(wish_of(read_gathered(table), SimpleNamespace(**NOTHING))), **wish)
        return str(error.value)

    def put(name, values):
        def change(file):
            del file[name]
            file[name] = values

        return change

    assert "h_min has the shape (24, 2), expected (24,)" in words_of(put("h_min", np.ones((24, 2))))
    assert "u has the shape (23,)" in words_of(put("u", np.ones(23)))
    assert "is no gathered table" in words_of(put("u", np.zeros(24, dtype=[("a", float), ("b", int)])))
    assert "is no gathered table" in words_of(put("status", np.ones(24)))
    assert "is no gathered table" in words_of(lambda file: file.create_group("h_tiny"))
    for text in ("plot = 3", "plot.y = [1, 2]", "plot.log = [['x']]", "plot.x = 1"):
        words = words_of(lambda file, t=text: file.attrs.__setitem__("sweep", t))
        assert "is no gathered table" in words or "found" in words


def shipped(folder, base, sweep, name):
    """Copies a shipped sweep with its base; its text."""
    shutil.copy(ROOT / "input" / f"{base}.nml", folder)
    text = (ROOT / "input" / "sweeps" / f"{sweep}.toml").read_text(encoding="utf-8").replace("../", "")
    (folder / f"{name}.toml").write_text(text, encoding="utf-8")
    return text


def test_files_that_are_no_tables(batch, tmp_path):
    (tmp_path / "text.h5").write_text("no table", encoding="utf-8")
    os.mkfifo(tmp_path / "pipe.h5")
    for name, words in (("none.h5", "is not there"), ("text.h5", "is no gathered table"), ("pipe.h5", "found a folder, pipe")):
        assert words in batch("plot.py", name, "--x", "u", "--y", "h_min", status=1).stderr
    shipped(tmp_path, "minimal", "film_over_speed", "film")
    batch("sweep.py", "film.toml")
    batch("gather.py", "film")
    assert "found no column h_min" in batch("plot.py", "film", status=1).stderr


def test_one_command_from_the_sweep_to_its_picture(batch, tmp_path):
    assert len(shipped(tmp_path, "minimal", "film_over_speed", "film").splitlines()) <= 11
    done = batch("all.py", "film.toml")
    assert done.stderr == "30 of 30 cases\n"
    words = ["film: 30 cases, checked", "  done               30", "film/gathered.h5: 30 done", "film/plot.png", "film/plot.pdf"]
    assert done.stdout.splitlines() == words
    assert (tmp_path / "film" / "plot.png").stat().st_size > 10_000
    with h5py.File(tmp_path / "film" / "gathered.h5") as file:
        speed, film = file["bodies.speed_1"][()], file["h_central"][()]
        # between the corners of Moes, h ~ u^(2/3) (rigid) and u^(3/4) (elastic), piezoviscous both
        power = np.diff(np.log(film[speed < 1])) / np.diff(np.log(speed[speed < 1]))
    assert power.min() > 2 / 3
    assert power.max() < 3 / 4


def test_a_stribeck_curve_by_one_command(batch, tmp_path):
    text = shipped(tmp_path, "mixed_bearing", "stribeck", "stribeck")
    text = text.replace("count = 30", "count = 5").replace("= 512", "= 256").replace("thermal.", "# ")  # as cold as the inlet
    (tmp_path / "stribeck.toml").write_text(text, encoding="utf-8")
    batch("all.py", "stribeck.toml")
    assert (tmp_path / "stribeck" / "plot.png").stat().st_size > 20_000
    found = read_gathered(tmp_path / "stribeck")
    total, oil, boundary = (found.numbers(f"friction_coefficient{part}") for part in ("", "_oil", "_boundary"))
    np.testing.assert_allclose(oil + boundary, total, rtol=1e-13)
    assert total.argmin() == 3  # neither at the slow nor at the fast end
    share, speed = found.numbers("asperity_load_share"), found.numbers("entrainment_speed")
    assert (np.diff(share, prepend=1.0, append=0.0) < 0).all()
    found.columns["temperature_rise_film"] = np.arange(5.0)
    found.columns["status"][2] = "failed"
    figure = draw_stribeck(found, Wish("entrainment_speed", (), log=("x",)))
    assert len(figure.axes) == 4
    for panel in figure.axes:
        assert [list(line.get_xdata()) for line in panel.lines if line.get_marker() == "x"] == [[speed[2]]]
    bars, done = figure.axes[0].containers[0], [0, 1, 3, 4]
    np.testing.assert_allclose(bars[0].get_ydata(), total[done])
    ends = np.array(bars[2][0].get_segments())[..., 1]
    np.testing.assert_allclose(np.diff(ends)[:, 0], 2 * found.errors("friction_coefficient")[done])
    places = (list(line.get_xdata()) for line in figure.axes[2].lines)
    borders = [place[0] for place in places if len(place) == 2 and place[0] == place[1]]
    expected = np.exp(np.interp([0.9, 0.01], share[done][::-1], np.log(speed[done])[::-1]))
    np.testing.assert_allclose(borders, expected, rtol=0.01)
    assert labels(figure) == ["no result (1)"]
    assert [words.get_text().split("\n")[0] for words in figure.axes[1].texts] == ["full film", "mixed", "boundary"]
    style.plt.close(figure)
