# SPDX-License-Identifier: GPL-3.0-or-later
"""Types of arguments: numbers in a range. Others are refused in one sentence."""

import argparse
import math


def whole(least, most):
    """Reads whole numbers from `least` to `most`."""

    def read(text):
        try:
            number = int(text)
        except ValueError:
            number = least - 1
        if not least <= number <= most:
            raise argparse.ArgumentTypeError(f"{text!r}: must be a whole number from {least} to {most}")
        return number

    return read


def number(least, most):
    """Reads numbers from `least` to `most`."""

    def read(text):
        try:
            found = float(text)
        except ValueError:
            found = math.nan
        if not least <= found <= most:  # also refuses what is not a number
            raise argparse.ArgumentTypeError(f"{text!r}: must be a number from {least:g} to {most:g}")
        return found

    return read
