#!/usr/bin/env python3
"""The rule that pictures are compared by finds what a user would want to be told of: motion that is 0.1 ms late, shadows
that are gone, a light from elsewhere. And it lets pass what is drawn again.

    planted_defect_test.py PROGRAM SOURCE_FOLDER
"""
import json, os, re, shutil, subprocess, sys, tempfile, unittest

PROGRAM, SOURCE = [os.path.abspath(path) for path in sys.argv[1:3]]
FRAME = 24  # of 60 a second: the first ball is on its way down
LATE = 1e-4  # s
LIGHT = [-1, -2, -1]
NO_SHADOW = ("float softShadow(vec3 position, vec3 normal) {", "  return 1.0;")


def turned(direction, degrees_about_z):
    from math import cos, radians, sin
    x, y, z = direction
    c, s = cos(radians(degrees_about_z)), sin(radians(degrees_about_z))
    return [c * x - s * y, s * x + c * y, z]


class PlantedDefects(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)
        shutil.copytree(os.path.join(SOURCE, "assets"), os.path.join(self.folder, "assets"))
        os.mkdir(os.path.join(self.folder, "scenes"))
        with open(os.path.join(SOURCE, "scenes", "newtons_cradle.json")) as file:
            self.scene = json.loads(re.sub(r"^\s*//.*$", "", file.read(), flags=re.M))
        self.scene.update(duration=0.5, camera={"position": [0.25, 0.35, 0.75], "target": [0, 0.17, 0]})
        self.scene["lights"] = [{"direction": LIGHT}]
        self.expected = self.draw("expected")

    def draw(self, name, *options):
        path, pictures = os.path.join(self.folder, "scenes", name + ".json"), os.path.join(self.folder, name)
        with open(path, "w") as file:
            json.dump(self.scene, file)
        subprocess.run([PROGRAM, "render", path, "-o", pictures, "--frames", f"{FRAME}:{FRAME + 1}", "--quiet", *options],
                       check=True, capture_output=True)
        return pictures

    def compare(self, actual):
        return subprocess.run([PROGRAM, "compare", self.expected, actual], capture_output=True, text=True).returncode

    def test_the_same_scene_passes(self):
        self.assertEqual(self.compare(self.draw("again")), 0)

    def test_motion_of_a_tenth_of_a_millisecond_is_found(self):
        self.scene["output"] = {"framesPerSecond": FRAME / (FRAME / 60 + LATE)}
        self.assertEqual(self.compare(self.draw("late")), 9)

    def test_missing_shadows_are_found(self):
        shaders = os.path.join(self.folder, "shaders")
        shutil.copytree(os.path.join(SOURCE, "shaders"), shaders)
        with open(os.path.join(shaders, "shadow.glsl")) as file:
            text = file.read()
        self.assertIn(NO_SHADOW[0], text)
        with open(os.path.join(shaders, "shadow.glsl"), "w") as file:
            file.write(text.replace(NO_SHADOW[0], "\n".join(NO_SHADOW)))
        self.assertEqual(self.compare(self.draw("no_shadow", "--shaders", shaders)), 9)

    def test_a_light_moved_by_two_degrees_is_found(self):
        self.scene["lights"] = [{"direction": turned(LIGHT, 2)}]
        self.assertEqual(self.compare(self.draw("light")), 9)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
