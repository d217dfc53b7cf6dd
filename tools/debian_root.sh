#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs a Debian release with some packages into a folder of its own, and makes $2 a link to that folder:
#     tools/debian_root.sh trixie build/blender-trixie PACKAGE ...
# The folder is kept outside the clone and used again. LAMINA_CACHE: another folder to keep it in.
# Exits with 3, after one sentence, where this machine allows no such folder.
set -eu

suite="$1" link="$2"
shift 2

refuse() {
    echo "lamina: no tests in Debian $suite: $1" >&2
    exit 3
}

[ "$(id -u)" = 0 ] || refuse "they need root"
command -v debootstrap >/dev/null || apt-get install -y -qq --no-install-recommends debootstrap >/dev/null 2>&1 ||
    refuse "debootstrap is missing"
unshare --mount mount -t tmpfs none /mnt 2>/dev/null || refuse "this machine allows no mounts"

cache="${LAMINA_CACHE:-${XDG_CACHE_HOME:-${HOME:-/nonexistent}/.cache}/lamina}"
mkdir -p "$cache"
name="debian-$suite-$({ cat "$0"; echo "$@"; } | sha256sum | cut -c1-16)"
root="$cache/$name" log="$cache/$name.log"
if [ ! -e "$root/.complete" ]; then
    echo "Installing Debian $suite with $* into $root (once)"
    # Mounts of an interrupted installation ended with its own mount namespace.
    rm -rf --one-file-system "$root"
    mirror=$(apt-get indextargets --format '$(REPO_URI) $(RELEASE)' 'Created-By: Packages' 2>/dev/null |
        awk '$2 == "bookworm" { print $1; exit }')
    # sid's list of packages says until when it holds; an archive that is mirrored seldom is past that date.
    apt="apt-get -qq -o Acquire::Check-Valid-Until=false -o Acquire::Retries=3"
    debootstrap --variant=minbase "$suite" "$root" ${mirror:+"$mirror"} >"$log" 2>&1 &&
        cp /etc/resolv.conf "$root/etc/" &&
        unshare --mount sh -c 'mount -t proc proc "$1/proc" && mount --rbind /dev "$1/dev" &&
            export DEBIAN_FRONTEND=noninteractive && chroot "$1" $2 update &&
            chroot "$1" $2 install -y --no-install-recommends $3 && chroot "$1" apt-get clean' \
            sh "$root" "$apt" "$*" >>"$log" 2>&1 || {
        tail -5 "$log" >&2
        refuse "the installation failed"
    }
    touch "$root/.complete"
fi
mkdir -p "$(dirname "$link")"
ln -sfn "$root" "$link"
