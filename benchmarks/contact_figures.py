#!/usr/bin/env python3
"""Contact beside other engines: error, energy, drift at rest, penetration and cost of scenes of contact, as a table.

    contact_figures.py PROGRAM [NAME ...]      NAME: a scene of benchmarks/scenes without folder and ending, or one of
                                               cradle_N_K, tray_of_balls, balls_49, balls_216, piles; all if none is given

PROGRAM is cradle; other engines run by peer_trajectory beside it, if that was built (CMake: CRADLE_PEERS), in turn with cradle.
Progress goes to stderr.
error        m, at the worst frame, unless the scene's line says otherwise
energy       largest drift of kinetic + potential + dissipated - work in parts of the largest kinetic energy; of others only
             where nothing dissipates
drift        m: how far a body that should lie still goes
penetration  m: deepest overlap in the frames looked at
ms/s         CPU milliseconds per simulated second, steps alone: the median of at least three runs (of one, if it is long)
ratio        to the first row of the scene
cradle_N_K   N touching balls on rods, K of them lifted by 45 degrees
piles        is what benchmark_pile says of 1000 bodies in 10 s
"""
import json, os, sqlite3, statistics, subprocess, sys, tempfile, time

from contact_cases import CASES
from scene_figures import Run, norm, sub

PEERS = (("bullet", 60), ("bulletTuned", 60), ("bulletTuned", 1000), ("bulletTuned100", 1000), ("ode", 60), ("ode", 1000),
         ("odeQuick100", 60), ("odeQuick100", 1000), ("mujoco", 60), ("mujocoTuned", 60), ("mujocoTuned", 1000))  # steps a second
LEAST_RUNS, LONG_RUN = 3, 2.0  # CPU s
LONGEST_RUN = 60  # s
FAR = 0.5  # m: a stack that has moved that far has collapsed


class Result:
    """One run of one program; states[name] is a list of (time, position, velocity), by frame."""
    def __init__(self, path):
        self.run = Run(path)
        database = sqlite3.connect(path)
        query = ("select b.name, f.time, s.px, s.py, s.pz, s.vx, s.vy, s.vz from state s join frame f on f.id = s.frame "
                 "join body b on b.id = s.body order by s.frame")
        self.states = {}
        for name, time, *numbers in database.execute(query):
            self.states.setdefault(name, []).append((time, numbers[:3], numbers[3:]))
        self.events = database.execute("select time, kind from event order by time").fetchall()
        self.cpu = float(self.run.meta["cpuSeconds"])

    def moved(self, name, since=0.0):
        rows = [row for row in self.states[name] if row[0] >= since]
        return max(norm(sub(row[1], rows[0][1])) for row in rows)


def run_once(command, path):
    if os.path.exists(path):
        os.remove(path)
    try:
        done = subprocess.run([*command, path], capture_output=True, text=True, timeout=LONGEST_RUN)
    except subprocess.TimeoutExpired:
        return f"takes more than {LONGEST_RUN} s"
    return Result(path) if done.returncode == 0 else (done.stderr or done.stdout).strip().splitlines()[-1]


def programs(cradle_program, case, scene):
    """Name and command of each row; the path of the trajectory comes last."""
    for accuracy in case.accuracies:
        yield f"cradle {accuracy}", [cradle_program, "simulate", scene, "--quiet", "--accuracy", accuracy, "-o"]
    peer = os.path.join(os.path.dirname(cradle_program), "peer_trajectory")
    if case.has_peer and os.path.exists(peer):
        for method, steps in PEERS:
            yield f"{method} 1/{steps} s", [peer, scene, method, repr(1 / steps)]


def show(value, form=".1e"):
    return "-" if value is None else format(value, form)


def scene_file(case, folder):
    if isinstance(case.scene, str):
        return case.scene
    path = os.path.join(folder, "scene.json")
    with open(path, "w") as stream:
        json.dump(case.scene, stream)
    return path


def measure(cradle_program, name, folder):
    """The lines of a scene."""
    case, path = CASES[name], os.path.join(folder, "run.sqlite")
    commands = list(programs(cradle_program, case, scene_file(case, folder)))
    results, costs = {}, {row: [] for row, _ in commands}
    for turn in range(LEAST_RUNS):
        for row, command in commands:
            if turn > 0 and (isinstance(results[row], str) or results[row].cpu > LONG_RUN):
                continue
            results[row] = run_once(command, path)
            if not isinstance(results[row], str):
                costs[row].append(1000 * results[row].cpu / results[row].run.duration)
    yield f"{name}{': ' + case.meaning if case.meaning else ''}"
    first = None
    for row, result in results.items():
        if isinstance(result, str):
            yield f"  {row:24} failed: {result[:140]}"
            continue
        (error, drift, note), cost = case.figures(result), statistics.median(costs[row])
        first = cost if row == commands[0][0] else first
        knows_energy = case.keeps_energy or row.startswith("cradle")
        yield (f"  {row:24}{show(error):>10}{show(result.run.energy_drift() if knows_energy else None):>10}"
               f"{'collapsed' if drift is not None and drift > FAR else show(drift):>12}{show(result.run.penetration()):>13}"
               f"{cost:12.4f}{show(first and cost / first, '.3g'):>10}   {note}").rstrip()


def piles(cradle_program):
    program = os.path.join(os.path.dirname(cradle_program), "../benchmarks/benchmark_pile")
    if not os.path.exists(program):
        return ["piles: benchmark_pile was not built"]
    runs = [subprocess.run([program, "1000", kind, "10"], check=True, capture_output=True, text=True)
            for kind in ("spheres", "boxes", "turned")]
    return ["piles", *[line for run in runs for line in run.stdout.splitlines()]]


def main(program, *names):
    program, names = os.path.abspath(program), names or [*CASES, "piles"]
    lines = [f"  {'':24}{'error':>10}{'energy':>10}{'drift':>12}{'penetration':>13}{'ms/s':>12}{'ratio':>10}"]
    start = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        for done, name in enumerate(names):
            left = f", about {(time.monotonic() - start) / done * (len(names) - done):.0f} s left" if done else ""
            print(f"{done + 1} of {len(names)}: {name}{left}", file=sys.stderr)
            lines += piles(program) if name == "piles" else measure(program, name, folder)
    print("\n".join(lines))


if __name__ == "__main__":
    main(*sys.argv[1:]) if len(sys.argv) > 1 else sys.exit(__doc__)
