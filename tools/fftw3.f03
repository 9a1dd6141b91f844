! FFTW's own Fortran interface where fpm runs without make, which puts that of pkg-config before it.
include '/usr/include/fftw3.f03'
