"""The laws that plans are made with: error over cell size, unknowns over cell size, cost over unknowns. Pure functions."""

import math
from dataclasses import dataclass

import numpy as np

from study_analysis import extrapolate, fit_power


@dataclass
class PowerLaw:
    """y = anchor_y (x / anchor_x)^exponent, through the finest pilot run."""
    anchor_x: float
    anchor_y: float
    exponent: float

    def __call__(self, x):
        return self.anchor_y * (x / self.anchor_x)**self.exponent

    def inverse(self, y):
        return self.anchor_x * (y / self.anchor_y)**(1.0 / self.exponent)


def power_law(x, y):
    """Through the last two of three or more points, from coarse to fine: the first shows more of what dies out on finer
    meshes than of the rate. None when y does not follow a power law."""
    fit = fit_power(x, y)
    if fit is None or not math.isfinite(fit.last) or fit.last == 0.0:
        return None
    return PowerLaw(x[-1], y[-1], fit.last)


@dataclass
class CostLaw:
    """y = start + rate N^exponent: what every run costs, and what grows with the unknowns."""
    start: float
    rate: float
    exponent: float

    def __call__(self, unknowns):
        return self.start + self.rate * unknowns**self.exponent

    def inverse(self, cost):
        return (max(0.0, cost - self.start) / self.rate)**(1.0 / self.exponent) if self.rate > 0.0 else math.inf


# Direct factorization with nested dissection: work ~ N^(3/2) in the plane and N^2 in space, memory ~ N log N and N^(4/3)
# (A. George, J. W. Liu, Computer Solution of Large Sparse Positive Definite Systems, 1981); assembly and contact ~ N. The
# exponents of work are those measured between 1e4 and 1e5 unknowns, where both parts count.
WORK = {2: 1.2, 3: 1.7}
MEMORY = {2: 1.05, 3: 4.0 / 3.0}


def cost_law(unknowns, costs, exponent):
    """Start and rate by least squares of relative differences, neither below zero."""
    n, y = np.array(unknowns, float)**exponent, np.array(costs, float)
    matrix = np.stack([1.0 / y, n / y], 1)
    start, rate = np.linalg.lstsq(matrix, np.ones_like(y), rcond=None)[0]
    if rate <= 0.0:
        start, rate = float(y.mean()), 0.0
    elif start < 0.0:
        start, rate = 0.0, float(np.sum(n / y) / np.sum((n / y)**2))
    return CostLaw(float(start), float(rate), exponent)


FURTHER = 4.0  # times the unknowns of the largest pilot: a larger plan asks for one more
GROWTH = 3.0  # of the unknowns from one such pilot to the next


def further_pilot(planned, largest, most, dim):
    """Cell size of one more pilot over that of the largest, for a plan of `planned` unknowns; None where pilots are near enough
    to the plan or to `most` unknowns. A small deck's pilots are as small, and mostly show what every run costs."""
    if 2 * largest > most or planned < FURTHER * largest:
        return None
    return min(GROWTH, most / largest)**(-1.0 / dim)


def errors_of_values(sizes, values):
    """Relative errors of the values of a figure on meshes of these sizes (coarse to fine), against Richardson's limit."""
    limit, uncertainty, order = extrapolate(sizes, values)
    if order is None:
        uncertainty = max(uncertainty, abs(values[-1] - values[-2]))
        return [max(abs(value - limit), uncertainty) / abs(limit) for value in values]
    return [abs(value - limit) / abs(limit) for value in values]


def fewest_increments(tried, target, declared):
    """How many increments a step needs, and the relative error that they leave.

    `tried`: increments -> figures of the end of the run, None where it did not get there; the error of the implicit
    rule is of first order in the increment, so n increments are off by twice what 2 n change (or n / (n - m) of what m
    and n differ by)."""
    whole = {n: figures for n, figures in sorted(tried.items()) if figures}
    if len(whole) < 2:
        return declared, None
    best = max(whole)

    def difference(n):
        pairs = [(a, b) for a, b in zip(whole[n], whole[best]) if max(abs(a), abs(b)) > 0.0]
        return max((abs(a - b) / max(abs(a), abs(b)) for a, b in pairs), default=0.0)

    error = {n: difference(n) * best / (best - n) for n in whole if n != best}
    enough = [n for n in sorted(error) if error[n] <= target]
    if enough:
        return enough[0], error[enough[0]]
    last = max(error)
    left = error[last] * last / best
    if left <= target:
        return best, left
    return math.ceil(best * left / target), target
