#!/usr/bin/env python3
"""Error and cost of smooth motion: three small scenes with known ends, chains of rods, and rows of suspended models.

    smooth_motion.py PROGRAM

Prints for each scene and accuracy the error at the end and the CPU milliseconds per simulated second (integration alone,
the least of five runs, one frame a second); then the cost of an evaluation per link of a chain and that of an island, which
should not depend on how many there are. References: a free box and a triple pendulum, by DOP853 and RK4 in long double;
a vertical spring, closed form.
"""
import json, math, os, sqlite3, subprocess, sys, tempfile

PROGRAM = os.path.abspath(sys.argv[1]) if len(sys.argv) > 1 else sys.exit(__doc__)
REPEATS = 5
FREE_BOX_END = (0.91299440034513210, -0.02676327986032762, 0.40594789521804807, 0.03051652269815690)  # w, x, y, z at 20 s
PINNED_END, TIED_END = (-2.69216544565380913, -0.28584971181580214), (-2.68071684876190517, -0.27746279810219625)  # m at 5 s


def scene(name, duration, bodies, **more):
    return {"schema": "cradle-scene/1", "name": name, "duration": duration, "output": {"framesPerSecond": 1}, "bodies": bodies, **more}


def ball(name, position, radius=0.05, **more):
    return {"name": name, "shape": {"sphere": {"radius": radius}}, "collision": "none", "mass": 1, "position": position, **more}


def diagonal(*d):
    return [[d[0], 0, 0], [0, d[1], 0], [0, 0, d[2]]]


def run(document, *options):
    """Frames {(frame, body): row}, least CPU time in s, evaluations."""
    with tempfile.TemporaryDirectory() as folder:
        path, out = os.path.join(folder, "scene.json"), os.path.join(folder, "run.sqlite")
        with open(path, "w") as file:
            json.dump(document, file)
        costs = []
        for _ in range(REPEATS):
            subprocess.run([PROGRAM, "simulate", path, "-o", out, "--quiet", *options], check=True)
            database = sqlite3.connect(out)
            meta = dict(database.execute("select key, value from meta where key in ('cpuSeconds', 'evaluations')"))
            costs.append(float(meta["cpuSeconds"]))
        rows = database.execute("select frame, body, px, py, pz, qw, qx, qy, qz from state order by frame, body").fetchall()
    return rows, min(costs), int(meta["evaluations"])


def free_box():
    body = {"name": "box", "shape": {"box": {"size": [1, 0.6, 0.2]}}, "mass": 1, "inertiaTensor": diagonal(0.4 / 12, 1.04 / 12, 1.36 / 12),
            "angularVelocityBody": [0.01, 2, 0.01]}
    return scene("free box", 20, [body], gravity=[0, 0, 0])


def free_box_error(rows):  # rad
    return 2 * math.sqrt(min(sum((a - sign * b) ** 2 for a, b in zip(rows[-1][5:], FREE_BOX_END)) for sign in (1, -1)))


def spring():
    return scene("spring", 10, [ball("bob", [0, -0.90981, 0])],
                 springs=[{"bodyA": "bob", "anchorA": [0, 0, 0], "anchorB": [0, 0, 0], "stiffness": 1000, "restLength": 1}])


def spring_error(rows):  # m
    return max(abs(row[3] - (-1.00981 + 0.1 * math.cos(math.sqrt(1000) * row[0]))) for row in rows)


def linked(kind, bodies, anchor):
    return {kind: [{"bodyA": f"b{i}", "anchorA": anchor, **({"bodyB": f"b{i - 1}"} if i > 1 else {}), "anchorB": [0, 0, 0]} for i in bodies]}


def tied():
    return scene("3 on rods", 5, [ball(f"b{i}", [i, 0, 0]) for i in (1, 2, 3)], **linked("rods", (1, 2, 3), [0, 0, 0]))


def pinned():
    return scene("3 on pins", 5, [ball(f"b{i}", [i, 0, 0], inertiaTensor=diagonal(0.001, 0.001, 0.001)) for i in (1, 2, 3)],
                 **linked("ballJoints", (1, 2, 3), [-1, 0, 0]))


def end_error(end):
    return lambda rows: math.dist(rows[-1][2:4], end)


def chain(links, end_mass):
    bodies = [ball(f"b{i}", [0.6 * i, -0.8 * i, 0], 0.01) for i in range(1, links + 1)]
    bodies[-1]["mass"] = end_mass
    return scene("chain", 2, bodies, **linked("rods", range(1, links + 1), [0, 0, 0]))


def suspended_models(count):
    bodies = [{"name": f"m{i}", "shape": {"box": {"size": [0.4, 0.6, 0.2]}}, "mass": 2, "position": [4 * i - 0.2, -0.8, 0]} for i in range(count)]
    springs = [{"bodyA": f"m{i}", "anchorA": [0.2, 0.3, 0.1], "anchorB": [4 * i, 0, 0], "stiffness": 200, "restLength": 0.5} for i in range(count)]
    return scene("suspended models", 2, bodies, springs=springs)


def main():
    print(f"{'scene':12} {'method':12} {'accuracy':>8} {'error':>9} {'ms per s':>9} {'evaluations per s':>18}")
    for document, error, method in ((free_box(), free_box_error, ""), (free_box(), free_box_error, "dop853"), (spring(), spring_error, ""),
                                    (tied(), end_error(TIED_END), ""), (pinned(), end_error(PINNED_END), "")):
        for accuracy in ("1e-6", "1e-7", "1e-8", "1e-9", "1e-10"):
            rows, cpu, evaluations = run(document, "--accuracy", accuracy, *(("--method", method) if method else ()))
            seconds = document["duration"]
            print(f"{document['name']:12} {method or 'the plan':12} {accuracy:>8} {error(rows):9.1e} {1000 * cpu / seconds:9.4f} {evaluations / seconds:18.0f}")
    for links in (10, 100, 1000):
        for mass in (1, 1000):
            _, cpu, evaluations = run(chain(links, mass))
            print(f"chain of {links:4} rods, end of {mass:4} kg: {1e9 * cpu / evaluations / links:6.0f} ns an evaluation and link")
    for count in (1, 10, 100, 1000):
        _, cpu, _ = run(suspended_models(count))
        print(f"{count:4} suspended models: {1e6 * cpu / count / 2:6.1f} us a model and simulated second")


if __name__ == "__main__":
    main()
