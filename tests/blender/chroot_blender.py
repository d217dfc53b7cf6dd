# SPDX-License-Identifier: GPL-3.0-or-later
"""A Blender executable of another Debian release, run in the release's own root folder (tools/debian_root.sh).

Each run has mounts and process numbers of its own, which end with the run: nothing stays mounted, no process is left.
"""

import os
import shutil
import subprocess
from pathlib import Path

INSIDE = "/mnt"  # where Blender finds the test's folder
ENVIRONMENT = {
    "HOME": f"{INSIDE}/home",
    "PATH": "/usr/local/bin:/usr/bin:/bin",
    "LANG": "C.UTF-8",
    "TMPDIR": f"{INSIDE}/tmp",  # for the report of a crash
    "BLENDER_USER_RESOURCES": f"{INSIDE}/profile",
    "LIBGL_ALWAYS_SOFTWARE": "1",
    "MESA_SHADER_CACHE_DIR": "/var/cache/mesa",  # of the root: some shaders take 40 seconds to compile
    "LAMINA_SCREEN": f"{INSIDE}/screen/Xvfb_screen0",
}
MOUNT = """
root="$1"; folder="$2"; more="$3"; after="$4"; shift 4
mount -t proc proc "$root/proc"
mount --rbind /dev "$root/dev"
mount --bind "$folder" "$root/mnt"
eval "$more"
code=0
chroot "$root" env -i "$@" || code=$?
eval "$after"
exit "$code"
"""


class ChrootBlender:
    """`blender` of the release in `root`. It sees `folder` of this machine as INSIDE, and no other folder."""

    def __init__(self, root, folder):
        self.root, self.folder = Path(root).resolve(), Path(folder)
        for name in ("home", "profile", "screen", "tmp"):
            (self.folder / name).mkdir(parents=True, exist_ok=True)

    def run(self, *arguments, timeout=300, mounts="", after="", window=False):
        """subprocess.CompletedProcess of `blender ARGUMENTS`. mounts, after: shell commands before and after, in which
        $root is the root folder. window: on a virtual screen, otherwise in the background."""
        with self.started(*arguments, mounts=mounts, after=after, window=window) as process:
            try:
                out, error = process.communicate(timeout=timeout)
            except subprocess.TimeoutExpired:
                process.kill()
                out, error = process.communicate()
                raise AssertionError(f"Blender took longer than {timeout} s:\n{out[-3000:]}\n{error[-3000:]}") from None
        return subprocess.CompletedProcess(arguments, process.returncode, out, error)

    def started(self, *arguments, mounts="", after="", window=False):
        """subprocess.Popen of `blender ARGUMENTS`; kill() ends Blender and all its processes at once (SIGKILL)."""
        blender = ["blender", "-b", *arguments]
        if window:
            screen = f"-screen 0 1120x1300x24 +extension GLX -noreset -nocursor -fbdir {INSIDE}/screen"
            blender = ["xvfb-run", "-a", "-s", screen, "blender", "--window-geometry", "0", "0", "1120", "1300",
                       "--enable-event-simulate", *arguments]
        values = [f"{name}={value}" for name, value in ENVIRONMENT.items()]
        command = ["unshare", "--mount", "--pid", "--kill-child", "sh", "-euc", MOUNT, "sh", self.root, self.folder,
                   mounts, after, *values, *blender]
        return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                env={"PATH": os.environ["PATH"]})

    def put(self, *files):
        """Copy files of this machine into the folder. Returns their paths inside."""
        return [f"{INSIDE}/{Path(shutil.copy2(file, self.folder)).name}" for file in files]
