"""asperity for Spack: put this folder into a repository as packages/asperity."""

from spack.package import *


class Asperity(Package):
    """Contacts between rough surfaces, with and without oil: elastohydrodynamic line and point contacts, dry contacts."""

    # a release gives address and checksum; until then: spack dev-build asperity@main in a checkout
    version("main")
    license("MIT")

    depends_on("fortran", type="build")
    depends_on("fpm@0.10:", type="build")
    depends_on("pkgconfig", type="build")
    depends_on("fftw@3.3: precision=float,double ~mpi")
    depends_on("hdf5@1.10: +fortran ~mpi")
    depends_on("openblas")

    def install(self, spec, prefix):
        """Plain fpm, which finds the libraries through pkg-config."""
        fpm = which("fpm", required=True)
        fpm("install", "--flag", "-O3 -funroll-loops -fopenmp", "--prefix", prefix)
