# SPDX-License-Identifier: GPL-3.0-or-later
"""The limit of Z-scores that all statistical tests share."""

from statistics import NormalDist


def z_limit(count: int, level: float = 0.01, degrees: int | None = None) -> float:
    """The absolute value that the largest of `count` independent Z-scores exceeds by chance with probability `level`.

    Two-sided, with Sidak's correction for the family. `degrees`: degrees of freedom if the standard error is from so
    few samples that the score follows Student's t; None: the normal distribution.
    """
    tail = 0.5 * (1.0 - (1.0 - level) ** (1.0 / count))
    if degrees is None:
        return NormalDist().inv_cdf(1.0 - tail)
    from scipy.stats import t

    return float(t.isf(tail, degrees))
