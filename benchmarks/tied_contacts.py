#!/usr/bin/env python3
"""Cost of contact of bodies that joints tie: chains that fall on a floor, and a cart that slides with a chain hung from it.

    tied_contacts.py PROGRAM [PROGRAM...]

Prints for each number of links the CPU seconds per simulated second, the least of three runs, of each program in turn. The
links on the floor are solved together, step by step; the cart's contacts last, and are followed by events.
"""
import json, math, os, sqlite3, subprocess, sys, tempfile

PROGRAMS = [os.path.abspath(path) for path in sys.argv[1:]] or sys.exit(__doc__)
REPEATS, LINK = 3, 0.1  # m
ON_FLOOR, ON_CART = (10, 20, 40, 80), (1, 3, 10, 30)
MATERIALS = {"m": {"restitution": 0.2, "staticFriction": 0.5, "dynamicFriction": 0.4}}


def scene(name, accuracy, bodies, joints):
    floor = {"name": "floor", "shape": {"plane": {}}, "material": "m", "motion": "static"}
    return {"schema": "cradle-scene/1", "name": name, "duration": 1, "accuracy": accuracy, "gravity": [0, -9.81, 0],
            "output": {"framesPerSecond": 10}, "materials": MATERIALS, "bodies": [floor] + bodies, "ballJoints": joints}


def chain_on_floor(links):
    """Capsules end to end, one degree from level."""
    angle = math.radians(1)
    along = (math.cos(angle), math.sin(angle))
    bodies = [{"name": f"link{i}", "shape": {"capsule": {"radius": 0.02, "length": 0.06}}, "material": "m", "mass": 0.1,
               "position": [i * LINK * along[0], 0.1 + i * LINK * along[1], 0],
               "orientation": {"axis": [0, 0, 1], "angleDegrees": -89}} for i in range(links)]
    joints = [{"bodyA": f"link{i - 1}", "bodyB": f"link{i}", "anchorA": [0, LINK / 2, 0], "anchorB": [0, -LINK / 2, 0]}
              for i in range(1, links)]
    return scene("chain on floor", 1e-3, bodies, joints)


def chain_on_cart(links):
    """A box that slides on its corners; the chain hangs beside it, 0.4 rad from straight down."""
    along = (math.sin(0.4), -math.cos(0.4))
    bodies = [{"name": "cart", "shape": {"box": {"size": [1, 3.8, 0.6]}}, "material": "m", "mass": 3, "position": [0, 1.9, 0],
               "linearVelocity": [1, 0, 0]}]
    joints = []
    for i in range(links):
        bodies.append({"name": f"link{i}", "shape": {"sphere": {"radius": 0.01}}, "material": "m", "mass": 0.1,
                       "position": [LINK * (i + 1) * along[0], 3.9 + LINK * (i + 1) * along[1], 0.5],
                       "linearVelocity": [1, 0, 0]})
        joints.append({"bodyA": f"link{i}", "anchorA": [-LINK * along[0], -LINK * along[1], 0],
                       "bodyB": f"link{i - 1}" if i else "cart", "anchorB": [0, 0, 0] if i else [0, 2, 0.5]})
    return scene("chain on cart", 1e-6, bodies, joints)


def costs_of(document):
    """Least CPU seconds of each program."""
    least = [math.inf] * len(PROGRAMS)
    with tempfile.TemporaryDirectory() as folder:
        path, out = os.path.join(folder, "scene.json"), os.path.join(folder, "run.sqlite")
        with open(path, "w") as file:
            json.dump(document, file)
        for _ in range(REPEATS):
            for i, program in enumerate(PROGRAMS):
                subprocess.run([program, "simulate", path, "-o", out, "--quiet"], check=True, stderr=subprocess.DEVNULL)
                (cost,), = sqlite3.connect(out).execute("SELECT value FROM meta WHERE key = 'cpuSeconds'")
                least[i] = min(least[i], float(cost))
                os.remove(out)
    return least


print("CPU seconds per simulated second" + "".join(f"  {path}" for path in PROGRAMS))
for make, counts in ((chain_on_floor, ON_FLOOR), (chain_on_cart, ON_CART)):
    for links in counts:
        document = make(links)
        print(f"{document['name']}, {links:2} links  " + "".join(f"{cost:9.3f}" for cost in costs_of(document)), flush=True)
