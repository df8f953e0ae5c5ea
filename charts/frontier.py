"""The least cost of each error, and the least error of each cost, that an engine reaches by any of its methods; and by what
factors two engines differ in them.

A frontier is the lower left edge of an engine's points (cost, error): cost goes up and error down along it. Between its
points it is interpolated linearly in log cost and log error. Left of its first point there is nothing: nothing costs less.
An error above the first point's costs what the first point costs; costs beyond the last point's gain nothing.
"""
import math
from collections import namedtuple

WORST_ERROR = 0.1  # above, a motion is another one: such errors are not compared

Factor = namedtuple("Factor", "at value")  # at: the error, or the cost, that both have


def frontier(points):
    edge = []
    for cost, error in sorted(points):
        if not edge or error < edge[-1][1]:
            edge.append((cost, error))
    return edge


def between(x, a, b):
    """The y of log-log interpolation at x between the points a and b."""
    part = math.log(x / a[0]) / math.log(b[0] / a[0])
    return math.exp(math.log(a[1]) + part * math.log(b[1] / a[1]))


def cost_at(edge, error):
    """The least cost of that error; None if it is not reached."""
    if not edge or error < edge[-1][1]:
        return None
    if error >= edge[0][1]:
        return edge[0][0]
    for a, b in zip(edge, edge[1:]):
        if error >= b[1]:
            return between(error, a[::-1], b[::-1])


def error_at(edge, cost):
    """The least error of that cost; None if nothing costs so little."""
    if not edge or cost < edge[0][0]:
        return None
    for a, b in zip(edge, edge[1:]):
        if cost < b[0]:
            return between(cost, a, b)
    return edge[-1][1]


def cost_factors(ours, theirs):
    """What they cost in parts of what we do, at every corner of either frontier that both reach, from WORST_ERROR down:
    factors between the corners are between those at them."""
    levels = {WORST_ERROR} | {error for _, error in ours + theirs if error <= WORST_ERROR}
    both = [(level, cost_at(ours, level), cost_at(theirs, level)) for level in sorted(levels, reverse=True)]
    return [Factor(level, their / our) for level, our, their in both if our and their]


def error_factors(ours, theirs):
    """Their error in parts of ours, at every corner of either frontier whose cost both may have, where one of them is
    below WORST_ERROR."""
    both = [(cost, error_at(ours, cost), error_at(theirs, cost)) for cost in sorted({cost for cost, _ in ours + theirs})]
    return [Factor(cost, their / our) for cost, our, their in both if our and their and min(our, their) <= WORST_ERROR]


def lost_levels(factors):
    """Stretches (worst error, least error, least factor) in which they cost less than we do; ends are interpolated."""
    stretches, inside = [], None
    for i, factor in enumerate(factors):
        if factor.value < 1:
            if inside is None:
                start = factor.at if i == 0 else crossing(factors[i - 1], factor)
                inside = [start, factor.at, factor.value]
            inside[1:] = factor.at, min(inside[2], factor.value)
        elif inside:
            stretches.append((inside[0], crossing(factors[i - 1], factor), inside[2]))
            inside = None
    return stretches + ([tuple(inside)] if inside else [])


def crossing(a, b):
    """The level between two factors at which it is 1, by log-log interpolation."""
    part = math.log(a.value) / math.log(a.value / b.value)
    return math.exp(math.log(a.at) + part * math.log(b.at / a.at))
