#!/usr/bin/env python3
"""The same rasteriser draws the same bytes whichever context it is reached by, and whichever process draws a frame.

    same_bytes_test.py PROGRAM PROGRAM_BY_EGL SOURCE_FOLDER
"""
import os, pathlib, subprocess, sys, tempfile, unittest

PROGRAM, BY_EGL, SOURCES = (os.path.abspath(argument) for argument in sys.argv[1:4])
# Balls that mirror each other, coils, meshes with shadows, a rope of many rods.
SCENES = ["newtons_cradle", "suspended_model", "gears_on_platform", "rope_bridge"]
FRAMES = 4  # drawn as changes of the one before


def simulated(scene, folder):
    trajectory = os.path.join(folder, scene + ".sqlite")
    source = os.path.join(SOURCES, "scenes", scene + ".json")
    subprocess.run([PROGRAM, "simulate", source, "-o", trajectory, "--duration", "0.2", "--quiet"], check=True,
                   capture_output=True)
    return trajectory


def pictures(program, trajectory, frames):
    """Bytes of the PNG files by name."""
    with tempfile.TemporaryDirectory() as folder:
        output = os.path.join(folder, "pictures")
        subprocess.run([program, "render", trajectory, "-o", output, "--frames", frames, "--size", "320x180", "--quiet"],
                       check=True)
        return {path.name: path.read_bytes() for path in pathlib.Path(output).iterdir()}


class SameBytes(unittest.TestCase):
    def test_by_osmesa_and_by_egl(self):
        with tempfile.TemporaryDirectory() as folder:
            for scene in SCENES:
                trajectory = simulated(scene, folder)
                expected = pictures(PROGRAM, trajectory, f"0:{FRAMES}")
                self.assertEqual(len(expected), FRAMES)
                self.assertEqual(expected, pictures(BY_EGL, trajectory, f"0:{FRAMES}"), scene)

    def test_of_two_processes_that_draw_half_each(self):
        with tempfile.TemporaryDirectory() as folder:
            for scene in SCENES:
                trajectory = simulated(scene, folder)
                first, second = (pictures(PROGRAM, trajectory, part) for part in (f"0:{FRAMES // 2}", f"{FRAMES // 2}:{FRAMES}"))
                self.assertEqual(pictures(PROGRAM, trajectory, f"0:{FRAMES}"), {**first, **second}, scene)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
