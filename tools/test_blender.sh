#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests the extension in a Blender executable: tools/test_blender.sh PYTHON trixie|sid [PYTEST OPTION ...]
# Passes, after one sentence, where this machine cannot run the release.
# LAMINA_SEEDS, LAMINA_ACTIONS: the number of seeds of the random actions, by default 1, and of actions, by default 200.
set -eu

python="$1" suite="$2"
shift 2
case "$suite" in
trixie) tag=cp313 more="" ;;                                                # Blender 4.3, 1.5 GB
sid) tag=cp314 more="python3-cattr python3-requests python3-zstandard" ;; # Blender 5.2
*)
    echo "lamina: test_blender $suite: must be trixie or sid" >&2
    exit 2
    ;;
esac

wheel=$(ls -t build/wheels/lamina-*-$tag-*linux*_x86_64.whl dist/wheels/lamina-*-$tag-*linux*_x86_64.whl 2>/dev/null |
    head -n 1)
if [ -z "$wheel" ]; then
    echo "lamina: no tests in Blender of Debian $suite: no wheel for its Python ($tag) in build/wheels or dist/wheels"
    exit 0
fi
tools/debian_root.sh "$suite" "build/blender-$suite" blender python3-numpy xvfb xauth libgl1-mesa-dri libegl1 $more || {
    [ $? = 3 ] && exit 0
    exit 1
}
LAMINA_ZIP=$("$python" tools/build_extension.py "$wheel" --output "build/extension-$tag" | cut -d : -f 1)
LAMINA_BLENDER_ROOT="build/blender-$suite"
export LAMINA_ZIP LAMINA_BLENDER_ROOT
"$python" -m pytest -n 2 -p no:cacheprovider tests/blender "$@"
