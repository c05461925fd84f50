"""The arithmetic of studies: medians, power laws, Richardson's extrapolation, Pareto fronts. Pure functions."""

import math
from dataclasses import dataclass

import numpy as np


def median(values):
    return float(np.median(values)) if len(values) else None


def spread(values):
    """(largest - smallest) / median."""
    return (max(values) - min(values)) / median(values) if len(values) and median(values) > 0.0 else 0.0


@dataclass
class Power:
    """y = c x^exponent fitted to `count` points; `deviation` is the standard error of the exponent, `fit` the share of
    the variance of log y that the law explains (1: all), `last` the exponent between the last two points."""
    exponent: float
    deviation: float
    fit: float
    count: int
    last: float

    @property
    def clear(self):
        """Do the points lie on a power law well enough to speak of a rate?"""
        return self.fit >= 0.9 and abs(self.exponent) > max(0.05, 2.0 * self.deviation)


def fit_power(x, y):
    """Least squares of log y over log x; the points in order of cost. None with fewer than three usable points (both
    coordinates positive) or without any variation of x."""
    pairs = [(math.log(a), math.log(b)) for a, b in zip(x, y) if a is not None and b is not None and a > 0 and b > 0]
    if len(pairs) < 3:
        return None
    u, v = np.array(pairs).T
    about = u - u.mean()
    if np.sum(about**2) < 1e-12:
        return None
    exponent = float(np.sum(about * (v - v.mean())) / np.sum(about**2))
    rest = v - v.mean() - exponent * about
    total = float(np.sum((v - v.mean())**2))
    fit = 1.0 - float(np.sum(rest**2)) / total if total > 0.0 else 1.0
    deviation = math.sqrt(float(np.sum(rest**2)) / (len(u) - 2) / float(np.sum(about**2)))
    step = u[-1] - u[-2]
    return Power(exponent, deviation, fit, len(u), float((v[-1] - v[-2]) / step) if step else exponent)


def extrapolate(sizes, values):
    """The limit of q(s) = q + c s^p for s -> 0 through the three finest of `sizes` (given from coarse to fine).

    Returns (limit, uncertainty, p): the uncertainty is what the extrapolation has added to the finest value. Where the
    three do not lie on such a curve with p between 0.2 and 8 (they oscillate, or do not converge), the finest value
    itself is returned, with the last change as uncertainty and p = None.
    Source: L. F. Richardson, Phil. Trans. R. Soc. A 210 (1911); for ratios that differ, P. J. Roache, Verification and
    Validation in Computational Science and Engineering (1998), 5.
    """
    if len(sizes) < 3:
        return values[-1], abs(values[-1] - values[-2]) if len(values) > 1 else math.inf, None
    (s1, s2, s3), (q1, q2, q3) = sizes[-3:], values[-3:]
    if q1 == q2 == q3:
        return q3, 0.0, None
    ratio = (q1 - q2) / (q2 - q3) if q2 != q3 else math.inf

    def ratio_of(p):
        return (s1**p - s2**p) / (s2**p - s3**p)

    low, high = 0.2, 8.0
    if not ratio_of(low) <= ratio <= ratio_of(high):
        return q3, abs(q3 - q2), None
    for _ in range(100):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if ratio_of(middle) < ratio else (low, middle)
    limit = q3 - (q2 - q3) * s3**low / (s2**low - s3**low)
    return limit, abs(limit - q3), low


def pareto(costs, errors):
    """Indices, by rising cost, of the points that no other point beats in both cost and error."""
    front, best = [], math.inf
    for i in sorted(range(len(costs)), key=lambda i: (costs[i], errors[i])):
        if errors[i] < best:
            front.append(i)
            best = errors[i]
    return front


def cheapest(costs, errors, target):
    """Index of the cheapest point with an error of at most `target`; None when there is none."""
    good = [i for i, error in enumerate(errors) if error <= target]
    return min(good, key=lambda i: costs[i]) if good else None
