"""The maps of `make stability`: one rule for the classes of all methods, and namelists that the program takes."""

import bench_program
import pytest
import stability
import stability_cells
from bench_program import Answer
from cases import write
from namelists import namelist


def answer(cycles, reason="converged", steps=0):
    return Answer({"converged": int(reason == "converged"), "cycles": cycles, "steps": steps, "reason": reason})


@pytest.mark.parametrize(
    ("found", "word"),
    [
        (answer(30), "converged"),
        (answer(31), "late"),
        (answer(300, steps=10), "converged"),
        (answer(301, steps=10), "late"),
        # whatever it took, a cell that did not converge is never late: 97 of 279 time steps
        (answer(3000, "FAS: stagnation at residual 1e-3, time step 97 of 279", steps=97), "stalled"),
        (answer(264, "newton_krylov: cycle limit, time step 264 of 279", steps=264), "limit"),
        (answer(5, "stopped from outside"), "limit"),
        (answer(5, "the residual is not a number"), "failed"),
        (answer(1, "grid too coarse for the film, needs 1024 intervals (has 256)"), "too coarse"),
        (answer(0, "refused: 1 finding"), "refused"),
        (answer(6000, "the error is 1.2E-05 after 6000 iterations"), "limit"),
        (answer(40, "the error has stopped falling at 1.2E-05"), "stalled"),
    ],
)
def test_class_of_a_cell(found, word):
    assert stability.status(found) == word


def test_every_class_has_a_look_and_what_failed_one_colour():
    looks = stability.CLASSES
    assert {looks[word][0] for word in ("limit", "stalled", "failed")} == {stability.NOT_CONVERGED}
    assert looks["late"][0] != stability.NOT_CONVERGED
    assert len({sign for _, sign, _ in looks.values()}) == len(looks)


def test_dry_cells_have_the_same_classes(program, monkeypatch):
    monkeypatch.setattr(bench_program, "ASPERITY", program)

    def word_of(method, **keys):
        case = stability_cells.dry_cell(**keys)
        case["solver"] |= {"method": method, "max_cycles": 100}
        return stability.status(bench_program.solve(namelist(case)))

    few, many = stability_cells.DRY_METHODS
    line = {"load": 0.03, "nodes": 512, "is_area": False}
    assert word_of(few, **line) == "converged"
    assert word_of(many, **line) == "limit"
    assert word_of(many, load=0.03, nodes=31, is_area=True) == "late"
    assert word_of(few, load=10.0, nodes=31, is_area=True) == "closed"
    assert word_of(few, load=1.0, nodes=31, is_area=True, hardness=0.3) == "refused"


def test_maps_in_time_have_contacts_without_sliding(asperity, tmp_path):
    each = next(each for each in stability_cells.passing_maps(quick=True) if each.key == "rolling")
    cells = list(each.cells.values())
    assert len(cells) == len(each.methods) * len(each.x.values) * len(each.y.values)
    assert {name.split(": ")[1] for name in each.methods} == {"Eyring", "Newtonian"}
    assert all("speed_1 = 0.6\n   speed_2 = 0.6\n" in cell for cell in cells)
    write(tmp_path, "cell.nml", cells[0])
    assert asperity("--check", "cell.nml").returncode == 0
