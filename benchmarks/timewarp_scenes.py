#!/usr/bin/env python3
"""Cost per body of the four scenes of Timewarp (B. Mirtich, SIGGRAPH 2000), from a tenth of the bodies to all.

    timewarp_scenes.py PROGRAM [SCENE ...]  simulates a tenth, a third and all of each; CPU seconds from the trajectory
    timewarp_scenes.py --write FOLDER       writes the scenes at their full size, as they are in scenes/
"""
import json, math, os, random, sqlite3, subprocess, sys, tempfile

ASSETS = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "assets")


def rounded(values):
    return [round(value, 9) for value in values]


def static(name, shape, material, **rest):
    return {"name": name, "shape": shape, "motion": "static", "material": material, **rest}


def divided_gas(part):
    """200 hard spheres in a box that a wall with a hole divides."""
    count, numbers = round(200 * part), random.Random(1)
    scale = part ** (1 / 3)  # the same density
    depth, height, length, hole = 1.2 * scale, 1.2 * scale, 1.4 * scale, 0.24 * scale
    ideal = {"restitution": 1, "staticFriction": 0, "dynamicFriction": 0}
    bodies = []
    for name, normal, place in (("floor", [0, 1, 0], [0, 0, 0]), ("ceiling", [0, -1, 0], [0, height, 0]),
                                ("left", [1, 0, 0], [-length, 0, 0]), ("right", [-1, 0, 0], [length, 0, 0]),
                                ("back", [0, 0, 1], [0, 0, -depth / 2]), ("front", [0, 0, -1], [0, 0, depth / 2])):
        bodies.append(static(name, {"plane": {"normal": normal}}, "wall", position=place))
    side, above = (depth / 2 - hole), (height / 2 - hole)
    for name, size, place in (("wallBelow", [0.04, above, depth], [0, above / 2, 0]),
                              ("wallAbove", [0.04, above, depth], [0, height - above / 2, 0]),
                              ("wallBehind", [0.04, 2 * hole, side], [0, height / 2, -hole - side / 2]),
                              ("wallBefore", [0.04, 2 * hole, side], [0, height / 2, hole + side / 2])):
        bodies.append(static(name, {"box": {"size": rounded(size)}}, "divider", position=rounded(place)))
    places = []
    while len(places) < count:
        place = [numbers.uniform(-length + 0.04, -0.07), numbers.uniform(0.04, height - 0.04),
                 numbers.uniform(-depth / 2 + 0.04, depth / 2 - 0.04)]
        if all(math.dist(place, other) > 0.075 for other in places):
            places.append(place)
    for i, place in enumerate(places):
        bodies.append({"name": f"ball{i}", "shape": {"sphere": {"radius": 0.035}}, "mass": 1, "material": "ball",
                       "position": rounded(place), "linearVelocity": rounded(numbers.gauss(0, 0.8) for _ in range(3))})
    return {"name": "Divided gas",
            "description": "Two hundred balls without friction and loss in a box without gravity, all on one side of "
                           "a wall. Through its hole they spread over both sides.",
            "duration": 10, "gravity": [0, 0, 0],
            "camera": {"position": [0.7, 1.9, 4.3], "target": [0.05, 0.5, 0], "verticalFieldOfViewDegrees": 32},
            "materials": {"ball": {**ideal, "baseColor": "#c0392b", "roughness": 0.25},
                          "divider": {**ideal, "baseColor": "#2e6fb0", "roughness": 0.5},
                          "wall": {**ideal, "baseColor": "#d8d4cc", "roughness": 0.8}}, "bodies": bodies}, count


def cars_among_pendulums(part):
    """Four cars with motors drive over bumps among 400 pendulums."""
    lanes = max(1, round(4 * math.sqrt(part)))
    rows = round(100 * part / lanes)
    bodies, hinges, rods = [static("ground", {"plane": {}}, "ground")], [], []
    for lane in range(lanes):
        z = 2.0 * (lane - (lanes - 1) / 2)
        for k in range(max(1, round(8 * rows / 25))):
            bodies.append(static(f"bump{lane}_{k}", {"capsule": {"radius": 0.035, "length": 0.7}}, "bump",
                                 position=rounded([0.9 + 1.2 * k + 0.17 * lane, 0, z]),
                                 orientation={"axis": [1, 0, 0], "angleDegrees": 90}))
        car = f"car{lane}"
        bodies.append({"name": car, "shape": {"box": {"size": [0.6, 0.12, 0.3]}}, "material": f"paint{lane}",
                       "position": rounded([0, 0.2, z])})
        for name, x, side in (("frontLeft", 0.22, 1), ("frontRight", 0.22, -1), ("rearLeft", -0.22, 1),
                              ("rearRight", -0.22, -1)):
            wheel = f"{car}_{name}"
            bodies.append({"name": wheel, "shape": {"sphere": {"radius": 0.12}}, "material": "tyre",
                           "position": rounded([x, 0.12, z + 0.28 * side])})
            hinges.append({"name": f"{wheel}Axle", "bodyA": wheel, "bodyB": car,
                           "anchorB": rounded([x, -0.08, 0.28 * side]), "axis": [0, 0, 1],
                           "motor": {"targetVelocity": -12, "maxTorque": 1.5}})
        for column, beside in enumerate((-0.78, -0.6, 0.6, 0.78)):
            bodies.append(static(f"beam{lane}_{column}", {"box": {"size": [0.4 * rows + 0.2, 0.05, 0.05]}}, "beam",
                                 position=rounded([0.5 + 0.2 * rows, 1.2, z + beside]), collision="none"))
        for k in range(rows):
            for column, beside in enumerate((-0.78, -0.6, 0.6, 0.78)):
                name, x = f"bob{lane}_{4 * k + column}", 0.7 + 0.4 * k
                angle = math.radians(4 + 10 * ((7 * k + 3 * lane) % 9) / 8) * math.copysign(1, beside)
                bodies.append({"name": name, "shape": {"sphere": {"radius": 0.06}}, "material": "bob",
                               "position": rounded([x, 1.2 - math.cos(angle), z + beside - math.sin(angle)])})
                rods.append({"name": f"{name}Rod", "bodyA": name, "bodyB": f"beam{lane}_{column}",
                             "anchorB": rounded([x - 0.5 - 0.2 * rows, 0, 0]), "length": 1})
    paints = {f"paint{i}": {"density": 300, "baseColor": color, "roughness": 0.35}
              for i, color in enumerate(("#2d7bd2", "#c0392b", "#2e9e5b", "#e0a526"))}
    rough = {"staticFriction": 0.8, "dynamicFriction": 0.8, "restitution": 0}
    return {"name": "Cars among pendulums",
            "description": "Four cars with a motor at each wheel drive over bumps, among four hundred pendulums that "
                           "swing into their lanes and are knocked about.",
            "duration": 6,
            "camera": {"position": [-2.2, 2.2, 6.4], "target": [3.6, 0.3, -0.4], "verticalFieldOfViewDegrees": 36},
            "materials": {**paints, "tyre": {"density": 500, **rough, "baseColor": "#3a3d42", "roughness": 0.8},
                          "bob": {"density": 600, "restitution": 0.4, "staticFriction": 0.3, "dynamicFriction": 0.3,
                                  "baseColor": "#e8b64c", "metallic": 1, "roughness": 0.25},
                          "beam": {"baseColor": "#4a5058", "metallic": 0.6, "roughness": 0.35},
                          "bump": {**rough, "baseColor": "#b9b4aa", "roughness": 0.8},
                          "ground": {**rough, "baseColor": "#d8d4cc", "roughness": 0.8}},
            "bodies": bodies, "hinges": hinges, "rods": rods}, lanes * 5 + len(rods)


def avalanche(part):
    """300 rocks, 12 different convex hulls, down a slope."""
    count, numbers = round(300 * part), random.Random(2)
    angle = math.radians(33)
    bodies = [static("slope", {"plane": {"normal": rounded([math.sin(angle), math.cos(angle), 0])}}, "slope")]
    across = max(1, round(20 * math.sqrt(part)))
    for i in range(count):
        row, column = divmod(i, across)
        along, up, beside = -0.5 * row, 0.35 + 0.1 * numbers.random(), 0.5 * (column - (across - 1) / 2)
        axis = [numbers.gauss(0, 1) for _ in range(3)]
        bodies.append({"name": f"rock{i}",
                       "shape": {"mesh": "../assets/rocks.3ds", "object": f"Rock{i % 12 + 1:02d}",
                                 "scale": round(0.1 + 0.08 * numbers.random(), 3)},
                       "material": "rock",
                       "position": rounded([along * math.cos(angle) + up * math.sin(angle),
                                            -along * math.sin(angle) + up * math.cos(angle), beside]),
                       "orientation": {"axis": rounded(axis), "angleDegrees": round(360 * numbers.random(), 3)}})
    return {"name": "Avalanche", "description": "Three hundred rocks of twelve shapes come down a slope.",
            "duration": 3, "accuracy": "visual",
            "camera": {"position": [9.0, -2.2, 5.6], "target": [0.6, -0.6, 0.3], "verticalFieldOfViewDegrees": 42,
                       "keyFrames": [{"time": 0.5}, {"time": 3, "position": [19.5, -9.0, 5.6],
                                                     "target": [11.1, -7.4, 0.3]}]},
            "materials": {"rock": {"density": 2600, "restitution": 0.1, "staticFriction": 0.25, "dynamicFriction": 0.25,
                                   "baseColor": "#8a8378", "roughness": 0.9},
                          "slope": {"restitution": 0.1, "staticFriction": 0.25, "dynamicFriction": 0.25, "baseColor": "#c9bfa8",
                                    "roughness": 0.9}},
            "bodies": bodies}, count


def chains_that_throw(part):
    """20 chains of eight links swing down and throw blocks."""
    chains, across = round(20 * part), max(1, round(10 * part))
    bodies, joints = [static("ground", {"plane": {}}, "ground")], []
    for chain in range(chains):
        row, column = divmod(chain, across)
        x, z = 3.0 * row, 0.5 * (column - (across - 1) / 2)
        height, link, tilt = 1.55, 0.16, math.radians(75 + 3 * ((5 * chain) % 4))
        along = [-math.sin(tilt), -math.cos(tilt)]
        for k in range(8):
            middle = (k + 0.5) * link
            name = f"chain{chain}_{k}"
            shape = {"capsule": {"radius": 0.025, "length": 0.1}} if k < 7 else {"sphere": {"radius": 0.07}}
            bodies.append({"name": name, "shape": shape, "material": "link" if k < 7 else "weight",
                           "position": rounded([x + middle * along[0], height + middle * along[1], z]),
                           "orientation": {"axis": [0, 0, 1], "angleDegrees": round(-math.degrees(tilt), 9)}})
            joint = {"name": f"{name}Joint", "bodyA": name, "anchorA": rounded([0, link / 2, 0])}
            if k == 0:
                joint["anchorB"] = rounded([x, height, z])
            else:
                joint.update(bodyB=f"chain{chain}_{k - 1}", anchorB=rounded([0, -link / 2, 0]))
            joints.append(joint)
        bodies.append(static(f"stand{chain}", {"box": {"size": [0.12, 0.2, 0.12]}}, "stand",
                             position=rounded([x + 0.1, 0.1, z])))
        bodies.append({"name": f"block{chain}", "shape": {"box": {"size": [0.12, 0.12, 0.12]}}, "material": "block",
                       "position": rounded([x + 0.1, 0.26, z])})
    return {"name": "Chains that throw",
            "description": "Twenty chains of eight links swing down, each with a weight at its end, and throw blocks "
                           "off their stands.",
            "duration": 4,
            "camera": {"position": [-1.2, 2.6, 5.6], "target": [2.3, 0.6, -0.3], "verticalFieldOfViewDegrees": 40},
            "materials": {"link": {"density": 7000, "baseColor": "#4a5058", "metallic": 0.6, "roughness": 0.35},
                          "weight": {"density": 5000, "restitution": 0.5, "staticFriction": 0.3, "dynamicFriction": 0.3,
                                     "baseColor": "#c0392b", "roughness": 0.3},
                          "block": {"density": 500, "restitution": 0.3, "staticFriction": 0.5, "dynamicFriction": 0.5,
                                    "baseColor": "#e0a526", "roughness": 0.5},
                          "stand": {"restitution": 0.3, "staticFriction": 0.5, "dynamicFriction": 0.5,
                                    "baseColor": "#8c9096", "roughness": 0.7},
                          "ground": {"restitution": 0.3, "staticFriction": 0.5, "dynamicFriction": 0.5,
                                     "baseColor": "#d8d4cc", "roughness": 0.8}},
            "bodies": bodies, "ballJoints": joints}, 9 * chains


SCENES = {"divided_gas": divided_gas, "cars_among_pendulums": cars_among_pendulums, "avalanche": avalanche,
          "chains_that_throw": chains_that_throw}


def seconds(program, scene, folder):
    path, run = os.path.join(folder, "scene.json"), os.path.join(folder, "run.sqlite")
    with open(path, "w") as file:
        file.write(json.dumps({"schema": "cradle-scene/1", **scene}).replace("../assets", ASSETS))
    subprocess.run([program, "simulate", path, "-o", run, "--quiet"], check=True, capture_output=True)
    return float(sqlite3.connect(run).execute("select value from meta where key = 'cpuSeconds'").fetchone()[0])


def text_of(scene):
    """JSON with a line for each member, and for each member of its lists and objects."""
    def lines(value):
        if isinstance(value, dict) and value and all(isinstance(part, dict) for part in value.values()):
            return "{\n" + ",\n".join(f"    {json.dumps(key)}: {json.dumps(part)}" for key, part in value.items()) + "\n  }"
        if isinstance(value, list) and value and isinstance(value[0], dict):
            return "[\n" + ",\n".join(f"    {json.dumps(part)}" for part in value) + "\n  ]"
        return json.dumps(value)
    return "{\n" + ",\n".join(f"  {json.dumps(key)}: {lines(value)}" for key, value in scene.items()) + "\n}\n"


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    if sys.argv[1] == "--write":
        for name, make in SCENES.items():
            with open(os.path.join(sys.argv[2], f"{name}.json"), "w") as file:
                file.write(text_of({"schema": "cradle-scene/1", **make(1)[0]}))
        return
    for name, make in SCENES.items():
        if len(sys.argv) > 2 and name not in sys.argv[2:]:
            continue
        first = None
        for part in (0.1, 0.3, 1):
            scene, count = make(part)
            with tempfile.TemporaryDirectory() as folder:
                cost = seconds(os.path.abspath(sys.argv[1]), scene, folder)
            first = first or cost / count
            print(f"{name:22s} {count:5d} bodies  {cost:8.3f} s  {1e3 * cost / count:8.3f} ms a body  "
                  f"{cost / count / first:5.2f} times", flush=True)


if __name__ == "__main__":
    main()
