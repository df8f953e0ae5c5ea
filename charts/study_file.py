"""Reads what a study leaves: study.csv, a row a run, and references.csv, what their errors are measured against."""
import csv, math
from collections import namedtuple

# setting: time step in s, or accuracy. error: max |x - x_ref| / (1 + |x_ref|) at the end. cost: CPU s a simulated s.
# energy: drift in parts of the largest kinetic energy. constraint, penetration: m. Numbers that a run does not have are NaN.
Row = namedtuple("Row", "scene engine method setting error cost evaluations energy constraint penetration status")
Reference = namedtuple("Reference", "uncertainty made_by confirmation")

LEAST_COST = 1e-9  # s a simulated s: what took less than the clock shows
ROUNDING = 1e-16  # no error is known better


def read_rows(path):
    with open(path, newline="") as file:
        return [Row(*line[:3], *(float(field) for field in line[3:10]), line[10]) for line in list(csv.reader(file))[1:]]


def read_references(path):
    with open(path, newline="") as file:
        return {row["scene"]: Reference(float(row["uncertainty"]), row["made_by"], row["confirmation"])
                for row in csv.DictReader(file)}


def floor_of(reference):
    """Errors below mean nothing. The uncertainty is how far two runs end from each other: the reference, one of them, may be that
    far off too, so that what is exact may seem to have twice that error."""
    return max(2 * reference.uncertainty, ROUNDING) if math.isfinite(reference.uncertainty) else ROUNDING


def points_of(rows, floor):
    """(cost, error) of the runs that went well, in the order of the rows; errors that mean nothing are the floor."""
    return [(max(row.cost, LEAST_COST), max(row.error, floor)) for row in rows
            if row.status == "ok" and math.isfinite(row.error)]


def order_of(rows, floor):
    """The power of the setting that errors go down by: the median over halvings (or tenths) between 0.1 and ten times
    the floor; None without any."""
    runs = [(row.setting, row.error) for row in rows if row.status == "ok" and 10 * floor < row.error < 0.1]
    slopes = sorted(math.log(a[1] / b[1]) / math.log(a[0] / b[0]) for a, b in zip(runs, runs[1:]))
    return slopes[len(slopes) // 2] if slopes else None
