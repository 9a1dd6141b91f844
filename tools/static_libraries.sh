#!/bin/sh
# Fills build/static with the libraries that the linker shall put into the program, where this machine has them so; the linker
# looks there first, and what is missing comes from the shared libraries. A process then starts in a fraction of the time: the
# shared HDF5 brings thirty libraries of the network with it, and an OpenBLAS with threads starts them, used or not.
set -eu
place=build/static
if [ -e $place/tried ]; then
  exit 0
fi
rm -rf $place
mkdir -p $place

# The file that the linker would take for a name; nothing if there is none.
find_archive() {
  gfortran -print-file-name="$1" | grep '/' || true
}

# Takes the library $1, the text $2 for the linker, if a program links that calls its routine $3.
take() {
  echo "$2" > "$place/lib$1.a"
  cat > $place/try.f90 << SOURCE
interface
   subroutine routine() bind(c, name='$3')
   end subroutine
end interface
call routine()
end
SOURCE
  if ! gfortran $place/try.f90 -o $place/try -L$place "-l$1" -ldl -lm -lpthread 2> /dev/null; then
    rm -f "$place/lib$1.a"
  fi
  rm -f $place/try*
}

take fftw3 "INPUT ( $(find_archive libfftw3.a) )" fftw_cleanup
take fftw3f "INPUT ( $(find_archive libfftw3f.a) )" fftwf_cleanup
take openblas "INPUT ( $(find_archive openblas-serial/libopenblas.a) )" dgesv_ # without threads, else the shared one
folder=$(PKG_CONFIG_PATH=.pc:${PKG_CONFIG_PATH:-} pkg-config --libs-only-L hdf5 2> /dev/null | tr ' ' '\n' | sed -n 's/^-L//p' | head -n 1)
parts="$folder/libhdf5_fortran.a $folder/libhdf5.a $(find_archive libsz.a) $(find_archive libaec.a) $(find_archive libz.a)"
take hdf5_fortran "GROUP ( $parts )" h5open_c
take hdf5 "GROUP ( $parts )" h5open_c
touch $place/tried
