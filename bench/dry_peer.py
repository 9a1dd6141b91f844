#!/usr/bin/env python3
"""One contact solved by one of the other programs, in an environment of its own: dry_peer.py PEER IN.npz OUT.npz.

IN holds the heights z (N, N) on a unit square, the mean pressure over E*, the tolerance to ask for, the hardness over E* (0: none)
and whether the half-space is open; OUT gets the pressure over E* and the seconds of CPU of the solution alone.
"""

import sys
import time

import numpy as np


def tamaas(case):
    """Tamaas: Polonsky-Keer; saturated pressures by Kato's method."""
    import tamaas as tm  # noqa: PLC0415  (only this peer is there)

    tm.set_log_level(tm.LogLevel.error)
    z = np.ascontiguousarray(case["z"])
    model = tm.ModelFactory.createModel(tm.model_type.basic_2d, [1.0, 1.0], list(z.shape))
    model.E, model.nu = 1.0, 0.0
    if case["hardness"] > 0:
        solver = tm.KatoSaturated(model, z, float(case["tolerance"]), float(case["hardness"]))
        solver.max_iter = 20000
    else:
        solver = tm.PolonskyKeerRey(model, z, float(case["tolerance"]))
    if case["is_open"]:
        tm.ModelFactory.registerNonPeriodic(model, "dcfft")
        solver.setIntegralOperator("dcfft")
    start = time.process_time()
    solver.solve(float(case["load"]))
    return np.array(model.traction), time.process_time() - start


def contact_mechanics(case):
    """ContactMechanics: constrained conjugate gradients."""
    import ContactMechanics as contact  # noqa: PLC0415
    from SurfaceTopography import Topography  # noqa: PLC0415

    z, is_open = case["z"], bool(case["is_open"])
    kind = contact.FreeFFTElasticHalfSpace if is_open else contact.PeriodicFFTElasticHalfSpace
    substrate = kind(z.shape, 1.0, (1.0, 1.0))
    system = contact.Systems.NonSmoothContactSystem(substrate, Topography(z, (1.0, 1.0), periodic=not is_open))
    options = {"hardness": float(case["hardness"]) / z.size} if case["hardness"] > 0 else {}
    start = time.process_time()
    found = system.minimize_proxy(
        external_force=float(case["load"]), pentol=float(case["tolerance"]) * z.std(), maxiter=5000, **options
    )
    seconds = time.process_time() - start
    return np.abs(np.asarray(found.jac))[: z.shape[0], : z.shape[1]] * z.size, seconds


def aspher(case):
    """ASPHER: nested grids, preconditioned Polonsky-Keer; single precision first where the tolerance allows it."""
    import aspher as program  # noqa: PLC0415

    if case["hardness"] > 0:
        raise NotImplementedError("no hardness")
    z = case["z"]
    gap = np.ascontiguousarray(z.max() - z)
    # On the open sphere it is faster without its preconditioner than with it, and by FFT than by hierarchical matrices.
    options = {"backend": "fft", "precond": False} if case["is_open"] else {"backend": "periodic"}
    start = time.process_time()
    options |= {"domain_size": 1.0, "E_star": 1.0, "tol": float(case["tolerance"]), "precision": "float_then_double"}
    found = program.solve_nested(z.shape[0], gap, float(case["load"]), **options)
    return np.array(found.pressure), time.process_time() - start


PEERS = {"aspher": aspher, "tamaas": tamaas, "ContactMechanics": contact_mechanics}


def main():
    """Solves, prints nothing."""
    with np.load(sys.argv[2]) as data:
        case = {name: data[name] for name in data.files}
    pressure, seconds = PEERS[sys.argv[1]](case)
    np.savez(sys.argv[3], pressure=pressure, seconds=seconds)


if __name__ == "__main__":
    main()
