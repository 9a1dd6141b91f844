#!/bin/sh
# A bare Debian, made by debootstrap in a folder of its own, in which ./bootstrap is tried as on a fresh machine (as root):
#
#   tools/bare_root.sh demo test                  the words of ./bootstrap, one after the other
#   SUITE=trixie tools/bare_root.sh demo test     another Debian (default: bookworm)
#
# The last commit is laid into a folder with blanks in its name, without git. Of this machine the root has only what its
# package clients need to reach their registries.
set -eu
cd "$(dirname "$0")/.."
suite=${SUITE:-bookworm}
root=$(mktemp -d)
trap 'umount "$root/proc" "$root/dev/shm" 2> /dev/null || true; rm -rf --one-file-system "$root"' EXIT
trap 'exit 1' HUP INT TERM

debootstrap --variant=minbase --include=ca-certificates "$suite" "$root" > "$root.log" 2>&1 || { cat "$root.log" >&2; exit 1; }
rm -f "$root.log"
mount -t proc proc "$root/proc"
mkdir -p "$root/dev/shm"
mount -t tmpfs tmpfs "$root/dev/shm"
cp --remove-destination -L /etc/ssl/certs/ca-certificates.crt "$root/etc/ssl/certs/"
cp --remove-destination -L /etc/resolv.conf /etc/hosts "$root/etc/"
[ ! -e /etc/pip.conf ] || cp /etc/pip.conf "$root/etc/"

place="/home/a fresh machine/asperity"
mkdir -p "$root$place"
git archive HEAD | tar -x -C "$root$place"
for word in "$@"; do
  echo "=== Debian $(cat "$root/etc/debian_version"), $place: ./bootstrap $word"
  env -i HOME=/root LANG=C.UTF-8 PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin \
    ${https_proxy:+https_proxy="$https_proxy"} ${http_proxy:+http_proxy="$http_proxy"} \
    chroot "$root" "$place/bootstrap" "$word" < /dev/null
done
