# SPDX-License-Identifier: GPL-3.0-or-later
"""The platforms and Pythons that wheels are released for: those of Blender 4.2 to 5.2."""

import argparse
from dataclasses import dataclass

# Python's version, and the version of the Maven artifact org.bytedeco:cpython that has the headers.
PYTHONS = {"3.11": "3.11.3-1.5.9", "3.13": "3.13.5-1.5.12", "3.14": "3.14.3-1.5.13"}


@dataclass(frozen=True)
class Platform:
    name: str  # Blender's name; release/NAME.cmake is the toolchain file
    tag: str  # the wheel's platform tag
    module: str  # end of a compiled module's file name, with the digits of Python's version for {}
    classifier: str  # the artifact's name of the platform

    def module_end(self, python):
        return self.module.format(digits(python))


PLATFORMS = (
    Platform("windows-x64", "win_amd64", ".cp{}-win_amd64.pyd", "windows-x86_64"),
    Platform("linux-x64", "manylinux_2_28_x86_64", ".cpython-{}-x86_64-linux-gnu.so", "linux-x86_64"),
    Platform("linux-arm64", "manylinux_2_28_aarch64", ".cpython-{}-aarch64-linux-gnu.so", "linux-arm64"),
    Platform("macos-arm64", "macosx_11_0_arm64", ".cpython-{}-darwin.so", "macosx-arm64"),
)

# Pythons that the artifact lacks on a platform, and another one with the same headers: pyconfig.h has the same sizes
# and alignments on both 64-bit processors.
SAME_HEADERS = {("3.13", "linux-arm64"): "linux-x86_64", ("3.11", "macosx-arm64"): "macosx-x86_64"}


def classifier_of(platform, python):
    """The artifact's name of the platform whose headers serve `python` on `platform`."""
    return SAME_HEADERS.get((python, platform.classifier), platform.classifier)


def digits(python):
    """Such as 311 for Python 3.11, in names of tags, modules and libraries."""
    return python.replace(".", "")


def python_tag(python):
    return "cp" + digits(python)


def wheel_name(version, platform, python):
    tag = python_tag(python)
    return f"lamina-{version}-{tag}-{tag}-{platform.tag}.whl"


def parser_of(description):
    """An argument parser with the options --platforms and --pythons, by default all."""
    parser = argparse.ArgumentParser(description=description)
    names = [platform.name for platform in PLATFORMS]
    parser.add_argument("--platforms", nargs="+", choices=names, default=names)
    parser.add_argument("--pythons", nargs="+", choices=list(PYTHONS), default=list(PYTHONS))
    return parser


def chosen(arguments):
    """[(platform, Python's version)] that the options name, one platform after the other."""
    return [(platform, python) for platform in PLATFORMS if platform.name in arguments.platforms
            for python in arguments.pythons]
