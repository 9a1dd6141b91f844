"""Dry contacts and their domain: open or periodic, long enough for the contact, fine enough for the waves."""

import h5py
import pytest
from cases import ended, text, write
from dry_cases import solve

LINE = """&case problem = 'dry_line' /
&bodies reduced_radius = 0.01, reduced_modulus = 230e9 /
&load {load} /
&surface_1 shape = 'parabola' /
{more}
&domain length = {length}, intervals = 512{periodic} /
"""
HALF_WIDTH = 4 * 0.01 * 1e9 / 230e9  # of 1 GPa


def line(asperity, folder, *arguments, load="hertz_pressure = 1e9", more="", length=4 * HALF_WIDTH, periodic=""):
    write(folder, "case.nml", LINE.format(load=load, more=more, length=length, periodic=periodic))
    return asperity("case.nml", *arguments)


def test_open_and_periodic_unless_it_is_said(asperity, tmp_path, run_case):
    assert line(asperity, tmp_path, "--quiet").returncode == 0
    with h5py.File(tmp_path / "case.h5") as file:
        assert file["summary/p_max"][()] == pytest.approx(1e9, rel=1e-4)
        assert file["input/effective/domain"].attrs["periodic"].decode() == ".false."
        assert file["input/effective/domain"].attrs["kernel"].decode() == "element"
        assert "note" not in file["report"]
    surface = "shape = 'sinusoid', amplitude = 1e-7, wavelength = 1e-4"
    with solve(asperity, tmp_path, surface, [1e7], "", "&domain length = 1e-4, intervals = 64 /") as file:
        assert file["input/effective/domain"].attrs["periodic"].decode() == ".true."
        assert file["solution/x"][0] == 0.0
    write(tmp_path, "z.csv", "x,z\n" + "".join(f"{i}e-6,{1e-9 * (i % 2)}\n" for i in range(64)))
    punch = (
        "&case problem = 'dry_line' /\n&bodies reduced_modulus = 230e9 /\n&load mean_pressure = 1e9 /\n"
        "&surface_1 shape = 'file', file = 'z.csv' /\n&domain periodic = .false. /\n"
    )
    told = run_case(punch, "--quiet", status=2).stderr
    assert f"{BEYOND}, towards which the surface does not fall: no length is enough" in told


@pytest.mark.parametrize("problem", ["dry_line", "dry_area"])
def test_what_images_of_a_parabola_do_is_told(asperity, tmp_path, problem):
    if problem == "dry_line":
        done = line(asperity, tmp_path, periodic=", periodic = .true.")
    else:
        sizes = "length_x = 4e-4, length_y = 4e-4, intervals_x = 128, intervals_y = 128"
        content = LINE.format(load="hertz_pressure = 1e9", more="", length=1, periodic="").replace("dry_line", problem)
        write(tmp_path, "case.nml", content[: content.index("&domain")] + f"&domain {sizes}, periodic = .true. /\n")
        done = asperity("case.nml")
    assert done.returncode == 0
    with h5py.File(tmp_path / "case.h5") as file:
        rise = 100 * (file["summary/p_max"][()] / 1e9 - 1)
        note = file["report/note"][()].decode()
    assert note in " ".join(done.stdout.split())
    told = float(note.split("by about ")[1].split(" %")[0])
    assert rise > 1
    assert told == pytest.approx(rise, rel=0.1)


BEYOND = "the contact reaches the border of the open domain"


@pytest.mark.parametrize(("load", "room"), [("load_per_length = 1e6", 1.2), ("mean_pressure = 1e9", 1.2)])
def test_the_length_asked_for_is_enough(asperity, tmp_path, load, room):
    done = ended(line(asperity, tmp_path, "--check", load=load, length=2e-4), 1)
    wanted = float(done.stderr.split("expected about ")[1].split(" m")[0])
    assert line(asperity, tmp_path, "--quiet", load=load, length=wanted).returncode == 0
    with h5py.File(tmp_path / "case.h5") as file:
        assert file["sweep/contact_area_fraction"][0] == pytest.approx(1 / room, rel=0.05)


@pytest.mark.path
def test_contact_that_reaches_the_border_is_no_solution(asperity, tmp_path):
    rough = "&surface_2 shape = 'synthetic', rms_height = 1e-8, wavelength_short = 5e-5 /"
    loads = "mean_pressure = 1e7, 2e9, 1e8"
    done = ended(line(asperity, tmp_path, load=loads, more=rough, length=4e-4), 2)
    assert f"{BEYOND}, which should be about " in done.stderr
    assert "at a mean pressure of 2.00000E+09 Pa" in done.stderr
    with h5py.File(tmp_path / "case.h5") as file:
        assert file.attrs["converged"] == 0
        reason = text(file.attrs["reason"])
        assert BEYOND in reason
        wanted = float(reason.split("should be about ")[1].split(" m")[0])
        load = file["sweep/load"][1]
    assert line(asperity, tmp_path, "--quiet", load=f"load_per_length = {load}", more=rough, length=wanted).returncode == 0


@pytest.mark.parametrize(("wave", "nodes"), [("", "2.0"), (", wavelength_short = 4e-6", "4.0"), (", wavelength_short = 8e-6", "")])
def test_few_nodes_a_wave_are_told(asperity, tmp_path, wave, nodes):
    surface = f"shape = 'synthetic', rms_height = 1e-7{wave}"
    with solve(asperity, tmp_path, surface, [1e7], "", "&domain length = 2.56e-4, intervals = 256 /") as file:
        if not nodes:
            assert "note" not in file["report"]
            return
        note = file["report/note"][()].decode()
    assert note == f"the finest waves of the surface have {nodes} nodes, of 8 that are needed for its contact area"
