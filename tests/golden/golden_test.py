#!/usr/bin/env python3
"""Pictures and states of the scenes, compared with those that were looked at and accepted.

    golden_test.py PROGRAM REDRAW_CHECK SOURCE_FOLDER RUNS [--accept]

RUNS: folder of runs of all scenes, made before by scene_runs.py. What changes from a frame to the next is drawn with the
same bytes as all of it, and `cradle render` draws the same bytes. Pictures pass by the rule of `cradle compare`; states to
1e-9, of 1 + their size. When a change means to change them:
draw the old and the new picture (`cradle render SCENE -o FOLDER --frames N:M --size 320x180`), look at both at full size,
and only then run with --accept, which writes tests/golden/SCENE/ anew; commit it with the reason.
"""
import csv, os, shutil, subprocess, sys, tempfile, unittest

PROGRAM, REDRAW_CHECK, SOURCE, RUNS = [os.path.abspath(path) for path in sys.argv[1:5]]
ACCEPT = "--accept" in sys.argv
GOLDEN = os.path.join(SOURCE, "tests", "golden")
FRAMES = {  # scene: frames that are drawn; states are kept for these too
    "newtons_cradle": (0, 14, 40, 300, 599),
    "suspended_model": (0, 45, 300, 700),
    "suspended_model_rod": (0, 45, 300),
    "dropped_model": (0, 19, 40, 149),
    "struck_model": (25, 31, 155, 300),
    "two_models_one_spring": (0, 100, 300),
    "two_models_one_rod": (0, 100, 300),
    "platform_drop": (0, 40, 80, 170),
    "platform_drop_rods": (0, 40, 80, 170),
    "slack_rope": (0, 30, 60, 120),
    "rope_bridge": (0, 30, 100),
    "rod_pendulum": (0, 60, 300),
    "rolling_race": (0, 120, 299),
    "bouncing_balls": (0, 30, 100, 250),
    "sliding_blocks": (0, 75, 145),
    "spinning_handle": (0, 200, 400),
    "gimbal_lock": (0, 50, 200),
    "dice": (0, 20, 45, 108),
    "orientation_drift": (30, 400, 660),
    "overlap_by_mass": (30, 300, 600),
    "gears_fall": (0, 30, 60, 170),
    "double_pendulum": (0, 150, 400),
    "triple_pendulum": (0, 150, 400),
    "coupled_pendulums": (0, 180, 400),
    "coupled_pendulums_rod": (0, 150, 400),
    "hanging_chain": (0, 60, 400),
    "lagrange_top": (0, 150, 260),
    "cart": (0, 120, 260),
    "rope_slack_taut": (0, 60, 180),
    "newtons_cradles": (0, 30, 330),
    "billiard_break": (0, 30, 200),
    "backspin_ball": (0, 60, 150),
    "top_on_ground": (0, 150, 350),
    "hard_sphere_gas": (0, 60, 200),
    "heavy_top_stack": (0, 60, 170),
    "dominoes": (0, 80, 200),
    "tray_of_balls": (0, 120, 230),
    "gears_on_platform": (0, 30, 70, 110),
    "ball_tray": (0, 60, 290),
    "box_tray": (0, 60, 290),
    "arch": (0, 90, 200),
    "piston": (0, 25, 300),
    "four_bar": (0, 50, 200),
    "gate": (0, 40, 120),
    "car": (0, 150, 300),
    "belt": (0, 60, 300),
    "divided_gas": (0, 60, 300),
    "cars_among_pendulums": (0, 90, 240),
    "avalanche": (0, 60, 150),
    "chains_that_throw": (0, 60, 150),
    "drag_and_drop": (0, 60, 180, 350),
    "kapitza": (0, 160, 300),
    "shaken_table": (0, 40, 250),
    "turntable": (0, 20, 250),
}
TOLERANCE = 1e-9


def cradle(*arguments):
    result = subprocess.run([PROGRAM, *arguments, "--quiet"], capture_output=True, text=True)
    if result.returncode:
        raise AssertionError(f"cradle {' '.join(arguments)}: exit {result.returncode}\n{result.stdout}{result.stderr}")
    return result.stdout


def make(scene, folder):
    """Pictures and states.csv of a scene's golden frames."""
    trajectory, table = os.path.join(RUNS, scene + ".sqlite"), os.path.join(folder, "run.csv")
    cradle("export", trajectory, "-o", table)
    with open(table) as source, open(os.path.join(folder, "states.csv"), "w", newline="") as target:
        rows = csv.DictReader(source)
        writer = csv.DictWriter(target, rows.fieldnames, lineterminator="\n")
        writer.writeheader()
        writer.writerows(row for row in rows if int(row["frame"]) in FRAMES[scene])
    os.remove(table)
    pictures = os.path.join(folder, "pictures")
    os.mkdir(pictures)
    redraw = subprocess.run([REDRAW_CHECK, trajectory, pictures, *map(str, FRAMES[scene])], capture_output=True, text=True)
    if redraw.returncode:
        raise AssertionError(f"{scene}: {redraw.stdout}{redraw.stderr}")


def content(path):
    with open(path, "rb") as file:
        return file.read()


class Golden(unittest.TestCase):
    def check(self, scene):
        with tempfile.TemporaryDirectory() as folder:
            make(scene, folder)
            self.require_same_by_command(scene, folder)
            expected = os.path.join(GOLDEN, scene)
            if ACCEPT:
                shutil.rmtree(expected, ignore_errors=True)
                shutil.copytree(folder, expected)
            self.compare_states(os.path.join(expected, "states.csv"), os.path.join(folder, "states.csv"))
            cradle("compare", os.path.join(expected, "pictures"), os.path.join(folder, "pictures"))

    def require_same_by_command(self, scene, folder):
        frame = FRAMES[scene][-1]
        with tempfile.TemporaryDirectory() as again:
            cradle("render", os.path.join(RUNS, scene + ".sqlite"), "-o", again, "--frames", f"{frame}:{frame + 1}", "--size", "320x180")
            self.assertEqual(os.listdir(again), [f"frame_{frame:06}.png"])
            for name in os.listdir(again):
                self.assertEqual(content(os.path.join(again, name)), content(os.path.join(folder, "pictures", name)), name)

    def compare_states(self, expected, actual):
        with open(expected) as a, open(actual) as b:
            expected_rows, actual_rows = list(csv.DictReader(a)), list(csv.DictReader(b))
        self.assertEqual(len(expected_rows), len(actual_rows))
        for row, other in zip(expected_rows, actual_rows):
            for column, value in row.items():
                if column in ("body", "frame", "joint") or not value:
                    self.assertEqual(value, other[column])
                else:
                    self.assertAlmostEqual(float(value), float(other[column]), delta=TOLERANCE * (1 + abs(float(value))),
                                           msg=f"{row['body'] or row['joint']}, frame {row['frame']}, {column}")


for name in FRAMES:
    setattr(Golden, "test_" + name, lambda self, scene=name: self.check(scene))

if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
