#!/bin/sh
# Before fpm: tools that must be there, the right HDF5 for pkg-config, the interface of FFTW and the git commit for the program.
set -eu

for tool in fpm gfortran pkg-config; do
  if ! command -v "$tool" > /dev/null; then
    echo "$tool is missing: run ./bootstrap build" >&2
    exit 1
  fi
done

# A machine with the MPI build of HDF5 too may call that one hdf5.pc; it does not link with a serial program.
if folder=$(pkg-config --variable=pcfiledir hdf5-serial 2> /dev/null) && [ -n "$folder" ]; then
  mkdir -p .pc
  ln -sf "$folder/hdf5-serial.pc" .pc/hdf5.pc
fi

tools/static_libraries.sh

# FFTW's own Fortran interface; gfortran does not look for it in the folders of the system.
mkdir -p build/info
ln -sf "$(pkg-config --variable=includedir fftw3)/fftw3.f03" build/info/

# The file is only touched when the commit changes; fpm does not watch included files, so its note of build_info goes too.
if commit=$(git describe --always --dirty --abbrev=12 --exclude '*' 2> /dev/null); then
  line="commit = '$commit'"
else
  line=$(cat tools/git_commit.inc) # a tarball knows its commit
fi
if [ "$(cat build/info/git_commit.inc 2> /dev/null)" != "$line" ]; then
  echo "$line" > build/info/git_commit.inc
  rm -f build/gfortran_*/*/src_base_build_info.f90.o.digest
fi

# A source is built again if a text that it includes has changed.
for text in src/numerics/*.inc; do
  grep -l "^ *include '${text##*/}'" src/*/*.f90 | tr / _ | while read -r source; do
    find build/gfortran_*/ -name "$source.o.digest" ! -newer "$text" -exec rm -f {} + 2> /dev/null || true
  done
done

# Objects of sources that are gone or have moved would stay in the library: they go, and the library with them.
sources=$(echo src/*/*.f90 | tr / _)
for object in build/gfortran_*/asperity/src_*.f90.o; do
  source=${object##*/}
  case " $sources " in
  *" ${source%.o} "*) ;;
  *) rm -f "$object" "$object".* build/gfortran_*/asperity/libasperity.a ;;
  esac
done
