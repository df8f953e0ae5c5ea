#!/usr/bin/env python3
"""Every scene with springs also runs with rods of the start length in their place, and keeps its energy.

    rods_for_springs_test.py PROGRAM SOURCE_FOLDER

The energy constant may change by 1 % of the largest kinetic energy: far above every method's error here (3e-4 with contact,
1e-6 without), far below what a constraint that does work would show.
"""
import json, os, re, sqlite3, subprocess, sys, tempfile, unittest

PROGRAM, SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
SCENES = os.path.join(SOURCE, "scenes")
MOST_DRIFT = 0.01  # of the largest kinetic energy
LONGEST = 1.5  # s


def with_rods(scene):
    """The scene with a rod for each spring."""
    rods = [{key: value for key, value in spring.items() if key not in ("stiffness", "damping", "restLength")} for spring in scene["springs"]]
    kept = {key: value for key, value in scene.items() if key != "springs"}
    return {**kept, "rods": scene.get("rods", []) + rods, "duration": min(scene["duration"], LONGEST)}


class RodsForSprings(unittest.TestCase):
    def check(self, scene):
        with tempfile.TemporaryDirectory() as folder:
            path, out = os.path.join(folder, "scene.json"), os.path.join(folder, "run.sqlite")
            with open(path, "w") as file:
                json.dump(with_rods(scene), file)
            run = subprocess.run([PROGRAM, "simulate", path, "-o", out, "--quiet"], capture_output=True, text=True)
            self.assertEqual(run.returncode, 0, run.stderr)
            rows = sqlite3.connect(out).execute("select kinetic, potential, dissipated, work from energy").fetchall()
        constants = [kinetic + potential + dissipated - work for kinetic, potential, dissipated, work in rows]
        drift = max(abs(constant - constants[0]) for constant in constants)
        self.assertLess(drift, MOST_DRIFT * max(row[0] for row in rows))


def load(name):
    with open(os.path.join(SCENES, name)) as file:
        text = re.sub(r"^\s*//.*$", "", file.read(), flags=re.M)
    return json.loads(text.replace('"../assets/', '"' + os.path.join(SOURCE, "assets", "")))


for name in sorted(os.listdir(SCENES)):
    if name.endswith(".json") and load(name).get("springs"):
        setattr(RodsForSprings, "test_" + name[:-5], lambda self, scene=load(name): self.check(scene))

if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
