#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes $2 a virtual environment of the Python 3.13 $1 with the packages of requirements/bpy52.txt: Blender 5.2 as a
# Python module, and pytest. The packages are kept outside the clone, under a name made of all that they depend on, and
# used again. LAMINA_CACHE: another folder to keep them in.
#     tools/install_bpy52.sh PYTHON build/bpy52
set -eu

python="$1" environment="$2"
requirements=requirements/bpy52.txt

cache="${LAMINA_CACHE:-${XDG_CACHE_HOME:-${HOME:-/nonexistent}/.cache}/lamina}"
if ! mkdir -p "$cache" 2>/dev/null || [ ! -w "$cache" ]; then
    cache="$PWD/build/cache"
    mkdir -p "$cache"
fi
key=$({ cat "$0" "$requirements"; "$python" -c 'import sys; print(sys.version)'; } | sha256sum | cut -c1-16)
packages="$cache/bpy52-$key"

# The environment itself stays free for the clone's own wheel.
mkdir -p "$environment"
if [ "$(cat "$environment/packages" 2>/dev/null)" != "$packages" ]; then
    rm -rf "$environment"
    "$python" -m venv "$environment"
    site=$("$environment/bin/python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')
    echo "$packages" | tee "$site/bpy52.pth" >"$environment/packages"
fi
if [ ! -d "$packages" ]; then
    echo "Installing Blender 5.2 as a Python module into $packages (1 GB, once)"
    work=$(mktemp -d "$cache/installing.XXXXXX")
    trap 'rm -rf "$work"' EXIT
    trap 'exit 1' HUP INT TERM
    "$environment/bin/python" -m pip --quiet --disable-pip-version-check install --no-compile --target "$work" \
        -r "$requirements"
    mv -T "$work" "$packages" 2>/dev/null || [ -d "$packages" ] # another installation may have been quicker
fi
