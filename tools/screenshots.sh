#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes the pictures of docs/artists.md again, in a Blender window on a virtual screen:
#     tools/screenshots.sh [ZIP]
# ZIP: the extension, by default the newest dist/lamina-[0-9]*.zip. BLENDER names the executable, by default `blender`:
# 4.3 or newer, with the Python of a wheel in ZIP. Needs Xvfb and Mesa:
#     apt-get install xvfb xauth libgl1-mesa-dri libegl1
# The user's own Blender configuration is neither read nor written.
set -eu

cd "$(dirname "$0")/.."
zip="${1:-$(ls -t dist/lamina-[0-9]*.zip | head -n 1)}"
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
export BLENDER_USER_RESOURCES="$folder/profile" LIBGL_ALWAYS_SOFTWARE=1 LAMINA_SCREEN="$folder/Xvfb_screen0"

# With -fbdir, Xvfb keeps the screen in a file, in the format of xwd.
xvfb-run -a -s "-screen 0 1120x1300x24 +extension GLX -noreset -nocursor -fbdir $folder" \
    "${BLENDER:-blender}" --factory-startup --enable-event-simulate --window-geometry 0 0 1120 1300 \
    --python-exit-code 1 --python tools/screenshots.py -- "$zip" docs
