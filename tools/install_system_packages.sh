#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs the Debian packages that the build needs, those that bpy needs without an X server, and the optional packages
# among the arguments if Debian has them. Does nothing if all are installed; otherwise needs root or sudo.
#     tools/install_system_packages.sh PYTHON [OPTIONAL PACKAGE ...]
set -eu

python="${1:-}"
[ -n "$python" ] && "$python" -c 'import sys; sys.exit(sys.version_info[:2] != (3, 11))' 2>/dev/null || {
    echo "lamina: no Python 3.11, which bpy 4.5 LTS needs: install python3.11 and its venv (on releases without one," \
        "pyenv install 3.11), or name it: make PYTHON=FILE" >&2
    exit 1
}
command -v dpkg-query >/dev/null || {
    echo "lamina: no dpkg-query, and the build takes its compiler and libraries from Debian's packages: build on" \
        "Debian 12, for example in a container" >&2
    exit 1
}
shift

packages="g++ cmake git xz-utils libeigen3-dev libx11-6 libxrender1 libxxf86vm1 libxfixes3 libxi6 libxkbcommon0
libgomp1 libsm6 libice6 libxext6 libgl1"
# Of the Python itself: python3-venv would be another release's where python3.11 is not the distribution's own.
"$python" -c 'import ensurepip, venv' 2>/dev/null || packages="$packages python3.11-venv"
"$python" -c 'import os, sysconfig, sys; sys.exit(not os.path.exists(sysconfig.get_path("include") + "/Python.h"))' ||
    packages="$packages python3.11-dev"

missing_of() {
    for package in "$@"; do
        dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || printf ' %s' "$package"
    done
}

missing="$(missing_of $packages)"
optional="$(missing_of "$@")"
[ -n "$missing$optional" ] || exit 0

if [ "$(id -u)" = 0 ]; then
    as_root=""
elif command -v sudo >/dev/null; then
    as_root="sudo"
elif [ -n "$missing" ]; then
    echo "lamina: these packages are missing and this is neither root nor a machine with sudo:$missing" >&2
    exit 1
else
    echo "lamina: going on without the optional packages$optional: this is neither root nor a machine with sudo" >&2
    exit 0
fi
export DEBIAN_FRONTEND=noninteractive
install() {
    echo "Installing Debian packages: $*"
    $as_root apt-get install -y -qq --no-install-recommends "$@" >/dev/null
}

$as_root apt-get update -qq || [ -z "$missing" ]
[ -z "$missing" ] || install $missing
for package in $optional; do
    install "$package" || echo "lamina: going on without the optional package $package" >&2
done
