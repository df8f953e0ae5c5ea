#!/usr/bin/env python3
"""Every scene must look the same at half its time step, or at a hundredth of its accuracy where the program chooses the
steps: what a film shows is the motion, not the step.

    half_step_test.py PROGRAM SOURCE_FOLDER RUNS

RUNS: folder of runs of all scenes, made before by scene_runs.py. A body may be displaced by 2 % of the extent over which
the scene's bodies move, and turned by 0.15 rad: less than the eye sees when one picture follows the other. Scenes are made
so that errors stay unseen while they last: those that are chaotic ask for more accuracy. Heaps ask for no more than a look
(accuracy 1e-3): no motion is promised there, and none is compared.
"""
import json, os, re, sqlite3, subprocess, sys, tempfile, unittest

PROGRAM, SOURCE, RUNS = [os.path.abspath(path) for path in sys.argv[1:4]]
SCENES = os.path.join(SOURCE, "scenes")
DISPLACED, TURNED = 0.02, 0.15  # of the extent; rad
DEFAULT_ACCURACY = 1e-6
VISUAL = ("visual", 1e-3)


def without_comments(text):
    return re.sub(r"^\s*//.*$", "", text, flags=re.M)


def states_in(trajectory):
    """Frames of a run: {(frame, body): (px, py, pz, qw, qx, qy, qz)}."""
    rows = sqlite3.connect(trajectory).execute("select frame, body, px, py, pz, qw, qx, qy, qz from state")
    return {row[:2]: row[2:] for row in rows}


def states_of(scene, *overrides):
    with tempfile.TemporaryDirectory() as folder:
        trajectory = os.path.join(folder, "run.sqlite")
        run = subprocess.run([PROGRAM, "simulate", scene, "-o", trajectory, "--quiet", *overrides], capture_output=True, text=True)
        if run.returncode:
            raise AssertionError(f"{scene} {overrides}: exit {run.returncode}\n{run.stderr}")
        return states_in(trajectory)


def finer(scene):
    """Arguments that make a scene's steps shorter."""
    if "method" in scene:
        return "--method", scene["method"]["name"], "--time-step", repr(scene["method"]["timeStep"] / 2)
    return "--accuracy", repr(scene.get("accuracy", DEFAULT_ACCURACY) / 100)


def extent(run):
    return max(max(row[i] for row in run.values()) - min(row[i] for row in run.values()) for i in range(3))


class HalfStep(unittest.TestCase):
    def check(self, scene):
        with open(scene) as file:
            arguments = finer(json.loads(without_comments(file.read())))
        whole = states_in(os.path.join(RUNS, os.path.basename(scene)[:-len(".json")] + ".sqlite"))
        half = states_of(scene, *arguments)
        self.assertEqual(whole.keys(), half.keys())
        size = max(extent(whole), 0.1)  # m: a body that turns on the spot is about so large
        for key, pose in whole.items():
            distance = max(abs(a - b) for a, b in zip(pose[:3], half[key][:3]))
            cosine = min(1.0, abs(sum(a * b for a, b in zip(pose[3:], half[key][3:]))))
            self.assertLess(distance, DISPLACED * size, f"frame and body {key}")
            self.assertLess(2 * (1 - cosine), (TURNED / 2) ** 2, f"frame and body {key}")  # = (angle / 2)^2


def text_of(name):
    with open(os.path.join(SCENES, name)) as file:
        return json.loads(without_comments(file.read()))


for name in sorted(os.listdir(SCENES)):
    if name.endswith(".json") and text_of(name).get("accuracy") not in VISUAL:
        setattr(HalfStep, "test_" + name[:-5], lambda self, scene=os.path.join(SCENES, name): self.check(scene))

if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
