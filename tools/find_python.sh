#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Prints the executable of a Python release: the one on PATH, or the newest that pyenv has installed.
# Prints nothing if there is none that can make environments.
#     tools/find_python.sh python3.13
set -eu

versions="${PYENV_ROOT:-${HOME:-/nonexistent}/.pyenv}/versions"
for python in "$1" $(ls -d "$versions/${1#python}".*/bin/"$1" 2>/dev/null | sort -rV); do
    # On PATH there may be a shim of pyenv, which fails for a release that is not selected.
    "$python" -c 'import ensurepip, sys, venv; print(sys.executable)' 2>/dev/null && exit
done
exit 0
