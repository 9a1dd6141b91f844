#!/usr/bin/env python3
"""One contact solved by one of the other programs, in an environment of its own: dry_peer.py PEER IN.npz OUT.npz.

IN holds the heights z (N, N) on a unit square, the mean pressure over E* and the tolerance to ask for; OUT gets the pressure over
E* and the seconds of CPU of the solution alone.
"""

import sys
import time

import numpy as np


def tamaas(z, load, tolerance):
    """Tamaas: Polonsky-Keer."""
    import tamaas as tm  # noqa: PLC0415  (only this peer is there)

    tm.set_log_level(tm.LogLevel.error)
    model = tm.ModelFactory.createModel(tm.model_type.basic_2d, [1.0, 1.0], list(z.shape))
    model.E, model.nu = 1.0, 0.0
    solver = tm.PolonskyKeerRey(model, np.ascontiguousarray(z), tolerance)
    start = time.process_time()
    solver.solve(load)
    return np.array(model.traction), time.process_time() - start


def contact_mechanics(z, load, tolerance):
    """ContactMechanics: constrained conjugate gradients."""
    import ContactMechanics as contact  # noqa: PLC0415
    from SurfaceTopography import Topography  # noqa: PLC0415

    substrate = contact.PeriodicFFTElasticHalfSpace(z.shape, 1.0, (1.0, 1.0))
    system = contact.Systems.NonSmoothContactSystem(substrate, Topography(z, (1.0, 1.0), periodic=True))
    start = time.process_time()
    found = system.minimize_proxy(external_force=load, pentol=tolerance * z.std(), maxiter=2000)
    seconds = time.process_time() - start
    return np.abs(np.asarray(found.jac)) * z.size, seconds


def aspher(z, load, tolerance):
    """ASPHER: nested grids, preconditioned Polonsky-Keer; single precision first where the tolerance allows it."""
    import aspher as program  # noqa: PLC0415

    gap = np.ascontiguousarray(z.max() - z)
    start = time.process_time()
    found = program.solve_nested(
        z.shape[0], gap, load, domain_size=1.0, E_star=1.0, backend="periodic", precision="float_then_double", tol=tolerance
    )
    return np.array(found.pressure), time.process_time() - start


PEERS = {"aspher": aspher, "tamaas": tamaas, "ContactMechanics": contact_mechanics}


def main():
    """Solves, prints nothing."""
    with np.load(sys.argv[2]) as data:
        z, load, tolerance = data["z"], float(data["load"]), float(data["tolerance"])
    pressure, seconds = PEERS[sys.argv[1]](z, load, tolerance)
    np.savez(sys.argv[3], pressure=pressure, seconds=seconds)


if __name__ == "__main__":
    main()
