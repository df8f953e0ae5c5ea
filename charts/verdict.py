"""What the figures of a scene say, in words: every sentence here follows from numbers, losses too."""
import math
from collections import namedtuple

from frontier import WORST_ERROR, cost_at, cost_factors, error_factors, frontier, lost_levels
from study_file import points_of

OURS = "plan"  # the method that stands for us: what cradle chooses by itself
ENGINES = {"cradle": "Cradle", "bullet": "Bullet", "ode": "ODE", "mujoco": "MuJoCo", "simbody": "Simbody"}

# edge: its frontier. costs, errors: factors beside ours. lost: stretches of errors at which it costs less than we do.
Rival = namedtuple("Rival", "engine edge costs errors lost")


def our_edge(rows, floor):
    return frontier(points_of([row for row in rows if row.method == OURS], floor))


def rivals_of(rows, floor):
    ours, found = our_edge(rows, floor), []
    for engine in ENGINES:
        edge = frontier(points_of([row for row in rows if row.engine == engine], floor))
        if engine == "cradle" or not any(row.engine == engine for row in rows):
            continue
        costs = cost_factors(ours, edge)
        found.append(Rival(engine, edge, costs, error_factors(ours, edge), lost_levels(costs)))
    return found


def number(value):
    """Two digits, and no more zeros than are read at a glance."""
    if value == 0 or not math.isfinite(value):
        return "0" if value == 0 else "-"
    mantissa, exponent = f"{value:.1e}".split("e")
    if -2 <= int(exponent) < 4:
        return f"{float(f'{value:.1e}'):.4f}".rstrip("0").rstrip(".")
    return f"{mantissa.removesuffix('.0')}e{int(exponent)}"


def span(factors):
    """Least and greatest factor."""
    values = [number(value) for value in (min(f.value for f in factors), max(f.value for f in factors))]
    return values[0] if values[0] == values[1] else f"{values[0]} to {values[1]}"


def listed(names):
    return " and ".join(filter(None, [", ".join(names[:-1]), names[-1]]))


def losses(rivals, ours):
    """A sentence for each thing that another engine does better than we do."""
    found = []
    for rival in rivals:
        name = ENGINES[rival.engine]
        for worst, least, factor in rival.lost:
            where = f"at an error of {number(worst)}" if worst <= 1.01 * least else f"at errors from {number(worst)} to {number(least)}"
            found.append(f"{name} is cheaper than Cradle {where}: down to {number(factor)} of our cost.")
        if rival.edge and ours and rival.edge[-1][1] < ours[-1][1] and rival.edge[-1][1] <= WORST_ERROR:
            found.append(f"{name} reaches an error of {number(rival.edge[-1][1])}, Cradle only {number(ours[-1][1])}.")
        elif rival.edge and not ours:
            found.append(f"{name} reaches an error of {number(rival.edge[-1][1])}, Cradle none at all.")
    return found


def wins(rivals, ours):
    if not ours:
        return []
    able = [rival for rival in rivals if rival.costs]
    ahead = [rival for rival in able if not rival.lost]
    if not ahead:
        return []
    beside = [(factor.value, factor.at, ENGINES[rival.engine]) for rival in ahead for factor in rival.costs]
    least, most = min(beside), max(beside)
    everyone = len(ahead) == len(able) and len(able) > 1
    who = "every engine" if everyone else listed([ENGINES[rival.engine] for rival in ahead])
    text = (f"Cradle costs {'less' if least[0] > 1 else 'no more'} than {who} at every error up to {number(WORST_ERROR)} that "
            f"{'they reach: they cost' if len(ahead) > 1 else 'it reaches: it costs'} {number(least[0])} times as much "
            f"({least[2]}, at an error of {number(least[1])})")
    if most[0] > 1.05 * least[0]:
        text += f" up to {number(most[0])} times ({most[2]}, at {number(most[1])})"
    return [text + "."]


def notes(rivals, ours):
    """Who cannot be compared, and who has runs that cost less than any of ours, with what error."""
    found = [f"{ENGINES[rival.engine]} does not come below an error of {number(WORST_ERROR)}: there is nothing to compare."
             for rival in rivals if rival.edge and rival.edge[-1][1] > WORST_ERROR]
    found += [f"{ENGINES[rival.engine]} fails at every setting." for rival in rivals if not rival.edge]
    for rival in rivals if ours else []:
        cheaper = [error for cost, error in rival.edge if cost < ours[0][0] and WORST_ERROR < error < 1]
        if cheaper:
            found.append(f"{ENGINES[rival.engine]} has runs that cost less than any of ours, with errors of {number(cheaper[-1])} or more.")
    return found


def verdict(rows, floor):
    """(what is won, what is lost, what else is to say): lists of sentences."""
    ours, rivals = our_edge(rows, floor), rivals_of(rows, floor)
    return wins(rivals, ours), losses(rivals, ours), notes(rivals, ours)


def figures(rows, floor):
    """Lines of the table: engine, least error, its cost, our cost of that error, factors of cost and of error. Costs in CPU ms
    a simulated second."""
    ours = our_edge(rows, floor)
    lines = [["Cradle", *least(ours), "", "", ""]]
    for rival in rivals_of(rows, floor):
        our = cost_at(ours, rival.edge[-1][1]) if rival.edge else None
        lines.append([ENGINES[rival.engine], *least(rival.edge), number(1e3 * our) if our else "-",
                      span(rival.costs) if rival.costs else "-", span(rival.errors) if rival.errors else "-"])
    return lines


def least(edge):
    return (number(edge[-1][1]), number(1e3 * edge[-1][0])) if edge else ("-", "-")
