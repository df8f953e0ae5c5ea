#!/usr/bin/env python3
"""Pages that play a motion, in a browser without a screen.

    player_test.py PROGRAM SOURCE_FOLDER
"""
import csv, json, os, shutil, subprocess, sys, tempfile, unittest, urllib.parse

from browser import Browser

PROGRAM, SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
RIGHT, LEFT, END = "\ue014", "\ue012", "\ue010"  # keys, as WebDriver names them
STATE = ["px_m", "py_m", "pz_m", "qw", "qx", "qy", "qz", "vx_m_s", "vy_m_s", "vz_m_s", "wx_rad_s", "wy_rad_s", "wz_rad_s"]
MAX_CALLS = 20
MAX_BYTES = 5_000_000  # of the page of Newton's cradle
HOSTILE = "</script><script>document.title=\"it ran\"</script>&{{title}}"


def document(bodies, **changes):
    return {"schema": "cradle-scene/1", "name": "test", "duration": 0.5, "bodies": bodies,
            "output": {"framesPerSecond": 60, "width": 160, "height": 90}, **changes}


def ball(name="ball", **changes):
    return {"name": name, "shape": {"sphere": {"radius": 0.1}}, "position": [0, 1, 0], "linearVelocity": [0.5, 0, 0],
            "angularVelocity": [1, 2, 3], **changes}


FLOOR = {"name": "floor", "shape": {"plane": {}}, "motion": "static"}


class Pages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.browser = Browser()
        cls.addClassCleanup(cls.browser.close)

    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)

    def path(self, name):
        return os.path.join(self.folder, name)

    def cradle(self, *arguments):
        return subprocess.run([PROGRAM, "-q", *arguments], capture_output=True, text=True)

    def simulate(self, scene, name="a"):
        """A trajectory of a scene: a document, or a path."""
        if not isinstance(scene, str):
            with open(self.path(name + ".json"), "w") as file:
                json.dump(scene, file)
            scene = self.path(name + ".json")
        trajectory = self.path(name + ".sqlite")
        run = self.cradle("simulate", scene, "-o", trajectory)
        self.assertEqual(run.returncode, 0, run.stderr)
        return trajectory

    def exported(self, trajectory, *options):
        page = trajectory.replace(".sqlite", ".html")
        run = self.cradle("export", trajectory, "-o", page, *options)
        self.assertEqual((run.returncode, run.stderr), (0, ""))
        return page

    def open(self, page, fragment=""):
        """What the page says of itself; it has told no error."""
        data = self.browser.open(page, fragment)
        self.assertNotIn("error", data)
        self.assertEqual(self.browser.log(), [])
        return data

    def require_states_of_table(self, trajectory, page, frame, body):
        table = trajectory.replace(".sqlite", ".csv")
        self.assertEqual(self.cradle("export", trajectory, "-o", table).returncode, 0)
        with open(table, newline="") as file:
            (row,) = [row for row in csv.DictReader(file) if (row["frame"], row["body"]) == (str(frame), body)]
        data = self.open(page, f"frame={frame}&body={urllib.parse.quote(body)}")
        self.assertEqual((data["frame"], data["body"]), (str(frame), body))
        self.assertEqual(json.loads(data["state"]), [float(row[column]) for column in STATE])

    def color_count(self):
        """How many colours the picture has."""
        return self.browser.run("""
            const canvas = document.createElement("canvas"), picture = document.getElementById("picture");
            canvas.width = picture.width, canvas.height = picture.height;
            const context = canvas.getContext("2d");
            context.drawImage(picture, 0, 0);
            const colors = new Set(new Uint32Array(context.getImageData(0, 0, canvas.width, canvas.height).data.buffer));
            return colors.size;""")

    def test_newtons_cradle(self):
        trajectory = self.simulate(os.path.join(SOURCE, "scenes", "newtons_cradle.json"))
        page = self.exported(trajectory)
        self.assertLess(os.path.getsize(page), MAX_BYTES)
        self.require_states_of_table(trajectory, page, 37, "ball5")
        self.assertEqual(self.browser.run("return performance.getEntriesByType('resource').length"), 0)  # needs nothing else
        self.assertLessEqual(int(self.browser.data()["calls"]), MAX_CALLS)
        self.assertGreater(self.color_count(), 1000)

    def test_it_plays(self):
        page = self.exported(self.simulate(document([FLOOR, ball()])))
        self.assertEqual(self.open(page)["frame"], "0")
        self.open(page, "play")
        self.browser.wait_until(lambda: int(self.browser.data()["frame"]) > 5)
        self.browser.wait_until(lambda: self.browser.data()["frame"] == "30")  # and stops at its end

    def test_keys(self):
        self.open(self.exported(self.simulate(document([FLOOR, ball()]))), "frame=10")
        for key, frame in ((RIGHT, "11"), (LEFT, "10"), (END, "30"), ("f", "30"), ("t", "30"), ("g", "30")):
            self.browser.press(key)
            self.assertEqual(self.browser.data()["frame"], frame)
        self.assertEqual(self.browser.run("return location.hash"), "#frame=30")
        self.assertEqual(self.browser.log(), [])

    def test_a_body_that_is_clicked_at_tells_its_state(self):
        camera = {"position": [0, 1, 3], "target": [0, 1, 0]}
        still = ball(linearVelocity=[0, 0, 0], angularVelocity=[0, 0, 0])
        self.open(self.exported(self.simulate(document([FLOOR, still], gravity=[0, 0, 0], camera=camera))))
        free = "return [innerWidth / 2, (innerHeight - document.querySelector('footer').offsetHeight) / 2]"
        x, y = map(round, self.browser.run(free))  # the middle of the scene's picture
        self.browser.click(x, y)
        self.assertEqual(self.browser.data()["body"], "ball")
        self.browser.click(5, y)
        self.assertEqual(self.browser.data()["body"], "")

    def test_all_kinds_of_shapes_and_links(self):
        mesh = {"mesh": os.path.join(SOURCE, "assets", "l_prism.3ds")}
        shapes = [{"sphere": {"radius": 0.1}}, {"box": {"size": [0.2, 0.1, 0.3]}}, {"cylinder": {"radius": 0.1, "length": 0.3}},
                  {"capsule": {"radius": 0.1, "length": 0.3}}, mesh]
        bodies = [ball(f"body{k}", shape=shape, position=[k, 2, 0]) for k, shape in enumerate(shapes)]
        bodies += [ball(f"hung{k}", position=[k, 4, 0]) for k in range(6)]
        hung = lambda k: {"bodyA": f"hung{k}", "anchorA": [0, 0, 0], "anchorB": [k, 5, 0]}
        joined = lambda k: {**hung(k), "anchorB": [k, 4, 0]}
        scene = document([FLOOR, *bodies], springs=[{**hung(0), "stiffness": 50, "restLength": 1}], rods=[hung(1)], ropes=[{**hung(2), "maxLength": 1.1}],
                         hinges=[{**joined(3), "axis": [0, 0, 1]}], ballJoints=[joined(4)], sliders=[{**joined(5), "axis": [1, 0, 0]}])
        trajectory = self.simulate(scene)
        page = self.exported(trajectory)
        for body in ("body3", "body4", "hung5"):
            self.require_states_of_table(trajectory, page, 20, body)
        self.browser.press("f"), self.browser.press("t")
        self.assertLessEqual(int(self.browser.data()["calls"]), MAX_CALLS)
        self.assertEqual(self.browser.log(), [])

    def test_bodies_of_one_shape_are_drawn_at_once(self):
        scene = document([FLOOR, ball(copies={"count": [10, 10, 10], "spacing": [0.3, 0.3, 0.3]})], accuracy="visual", duration=0.1)
        self.assertLessEqual(int(self.open(self.exported(self.simulate(scene)), "frame=3")["calls"]), 4)

    def test_another_axis_is_up(self):
        trajectory = self.simulate(document([{**FLOOR, "shape": {"plane": {"normal": [0, 0, 1]}}}, ball(position=[0, 0, 1])], gravity=[0, 0, -9.81]))
        self.require_states_of_table(trajectory, self.exported(trajectory), 12, "ball")
        height = self.browser.run("return document.querySelector('#body table').innerText").split("height")[1].split()[0]
        self.assertAlmostEqual(float(height), json.loads(self.browser.data()["state"])[2], places=4)

    def test_two_trajectories_over_each_other(self):
        first, second = self.simulate(document([FLOOR, ball()])), self.simulate(document([FLOOR, ball(linearVelocity=[0.75, 0, 0])]), "b")
        self.open(self.exported(first, "--with", second), "frame=24&body=ball")
        table = self.browser.run("return document.querySelector('#body table').innerText")
        self.assertAlmostEqual(float(table.split("distance of the other")[1].split()[0]), 0.25 * 24 / 60, places=4)
        for other, words in ((document([FLOOR, ball("other")]), "other bodies"), (document([FLOOR, ball()], duration=0.4), "other times")):
            run = self.cradle("export", first, "-o", self.path("x.html"), "--with", self.simulate(other, "c"))
            self.assertEqual(run.returncode, 2)
            self.assertIn(words, run.stderr)
            self.assertFalse(os.path.exists(self.path("x.html")))

    def test_what_is_not_there_is_told(self):
        page = self.exported(self.simulate(document([FLOOR, ball()])))
        for fragment, words in (("body=bal", 'no body "bal"'), ("frame=31", "no frame 31; there are 0 to 30"), ("frame=x", "no frame x")):
            self.assertIn(words, self.browser.open(page, fragment)["error"])

    def test_names_are_no_markup(self):
        trajectory = self.simulate(document([FLOOR, ball(HOSTILE)], name=HOSTILE))
        page = self.exported(trajectory)
        self.require_states_of_table(trajectory, page, 3, HOSTILE)
        self.assertEqual(self.browser.run("return document.title"), HOSTILE)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
