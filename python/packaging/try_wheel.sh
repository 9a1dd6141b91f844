#!/bin/sh
# Tries a wheel where there is nothing but Python: python/packaging/try_wheel.sh WHEEL (as root)
# A new root folder gets Python, its standard library and the C libraries that these need; pip puts the wheel and what it asks for
# in, from PyPI; then a case is computed inside, and read.
set -eu
wheel=$1
case=${2:-input/minimal.nml}
root=$(mktemp -d)
trap 'umount "$root/proc" 2> /dev/null || true; rm -rf --one-file-system "$root"' EXIT

# put FILE: copies it with the folders above it.
put() {
  mkdir -p "$root$(dirname "$1")"
  cp -L "$1" "$root$1"
}

python=$(python3 -c 'import os, sys; print(os.path.realpath(sys.executable))')
library=$(python3 -c 'import sysconfig; print(sysconfig.get_path("stdlib"))')
mkdir -p "$root$library" "$root/tmp" "$root/work" "$root/dev"
tar -C "$library" --exclude=./site-packages --exclude=./test --exclude=./dist-packages -cf - . | tar -C "$root$library" -xf -
put "$python"
# what would bring in libraries that the program could lean on
rm -f "$root$library"/lib-dynload/_ssl* "$root$library"/lib-dynload/_hashlib* "$root$library"/lib-dynload/_sqlite3* \
  "$root$library"/lib-dynload/_tkinter* "$root$library"/lib-dynload/*curses* "$root$library"/lib-dynload/readline* \
  "$root$library"/lib-dynload/*dbm* "$root$library"/lib-dynload/nis*
find "$root$library/lib-dynload" -name '*.so' -exec ldd "$python" {} + 2> /dev/null | awk '/=> \// {print $3} /^\t\/.*ld-linux/ {print $1}' |
  sort -u | while read -r file; do put "$file"; done
# what manylinux wheels may take for granted: the rest of the C library, and the run time of C++ (numpy's)
folder=$(dirname "$(ldd "$python" | awk '$1 == "libc.so.6" {print $3}')")
for name in libdl.so.2 libmvec.so.1 libpthread.so.0 libresolv.so.2 librt.so.1 libutil.so.1 libgcc_s.so.1 libstdc++.so.6; do
  for file in "$folder/$name" "/usr$folder/$name"; do
    [ ! -e "$file" ] || put "$file"
  done
done
mkdir "$root/proc"
mount -t proc proc "$root/proc"   # where the loader finds the folder of a program
mknod -m 666 "$root/dev/null" c 1 3
mknod -m 444 "$root/dev/urandom" c 1 9

python3 -m pip install -q --disable-pip-version-check --root-user-action ignore --target "$root/site" "$wheel" 2> "$root/work/pip.log" ||
  { cat "$root/work/pip.log" >&2; exit 1; }
cp "$case" "$root/work/case.nml"
echo "shared libraries beside the wheel: $(find "$root" -name 'lib*.so*' -not -path "$root/site/*" -printf '%f ')"
chroot=$(command -v chroot)
env -i PYTHONPATH=/site PATH=/site/bin "$chroot" "$root" "$python" -c '
import asperity
print(asperity.version())
result = asperity.run("/work/case.nml")
print(result)
assert result.converged and result.film.min() > 0
print("OK")
'
