#!/usr/bin/env python3
"""What bodies cost that stand far from each other on one ground, against the sum of their single runs.

    islands_apart.py PROGRAM [MOST]

For prisms (boxes that tumble, accuracy 1e-6), balls that bounce (restitution 0.9, friction) and capsules, 1, 10, 100 ...
MOST (1000) of them, 3 m apart, each dropped from a height of its own, for 2 s; and for a box that tumbles beside as many
balls at rest. CPU seconds of the simulation alone, from the trajectory, medians of five; a single run's is the median of
ten bodies.
"""
import json, os, sqlite3, statistics, subprocess, sys, tempfile

SHAPES = {
    "prisms": ({"box": {"size": [0.1, 0.2, 0.15]}}, 0.3),
    "balls": ({"sphere": {"radius": 0.1}}, 0.9),
    "capsules": ({"capsule": {"radius": 0.05, "length": 0.2}}, 0.3),
}


def body(kind, i):
    return {"name": f"b{i}", "shape": SHAPES[kind][0], "material": kind, "position": [3 * i, 0.5 + 0.01 * (i % 10), 0],
            "linearVelocity": [0, 0, 0.3], "angularVelocity": [3, 2, 7]}


def at_rest(i):
    return {"name": f"r{i}", "shape": SHAPES["balls"][0], "material": "balls", "position": [3 * i + 3, 0.1, 0]}


def seconds(program, bodies):
    scene = {"schema": "cradle-scene/1", "name": "apart", "duration": 2, "accuracy": 1e-6,
             "materials": {kind: {"restitution": e, "staticFriction": 0.5, "dynamicFriction": 0.5}
                           for kind, (_, e) in SHAPES.items()},
             "bodies": [{"name": "ground", "shape": {"plane": {}}, "motion": "static", "material": "balls"}] + bodies}
    with tempfile.TemporaryDirectory() as folder:
        path, run = os.path.join(folder, "scene.json"), os.path.join(folder, "run.sqlite")
        with open(path, "w") as file:
            json.dump(scene, file)
        subprocess.run([program, "simulate", path, "-o", run, "--quiet"], check=True, capture_output=True)
        return float(sqlite3.connect(run).execute("select value from meta where key = 'cpuSeconds'").fetchone()[0])


def median(program, bodies):
    return statistics.median(seconds(program, bodies) for _ in range(5))


def table(title, single, counts, cost_of):
    print(f"{title}: a single one {1e3 * single:.2f} ms")
    for count in counts:
        cost = cost_of(count)
        print(f"  {count:5d}  {1e3 * cost:9.2f} ms  {cost / (single * count):5.2f} times", flush=True)


def main():
    program, most = os.path.abspath(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 1000
    counts = [count for count in (10, 100, 1000, 10000) if count <= most]
    for kind in SHAPES:
        single = statistics.mean(median(program, [body(kind, i)]) for i in range(10))
        table(kind, single, counts, lambda count: median(program, [body(kind, i) for i in range(count)]))
    busy = median(program, [body("prisms", 0)])
    print(f"a busy box: {1e3 * busy:.2f} ms")
    for count in counts:
        cost = median(program, [body("prisms", 0)] + [at_rest(i) for i in range(count)])
        print(f"  beside {count:5d} balls at rest  {1e3 * cost:9.2f} ms")


if __name__ == "__main__":
    main()
