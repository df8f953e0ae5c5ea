#!/usr/bin/env python3
"""Ground truth that is right is found to be, and each planted fault is found and named.

    verify_test.py PROGRAM SOURCE_FOLDER
"""
import json, os, shutil, subprocess, sys, tempfile, unittest

import numpy as np

PROGRAM, SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
WIDTH, HEIGHT = 96, 64


def cradle(*arguments):
    return subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, timeout=300)


def everything(**changes):
    """Each shape, a mesh, links, contacts and an orbiting camera."""
    gear = os.path.join(SOURCE, "assets", "gear.3ds")
    document = {
        "schema": "cradle-scene/1", "name": "truth", "duration": 0.15,
        "output": {"framesPerSecond": 60, "width": WIDTH, "height": HEIGHT},
        "materials": {"rubber": {"restitution": 0.5, "staticFriction": 0.75, "dynamicFriction": 0.25}},
        "bodies": [
            {"name": "ball", "shape": {"sphere": {"radius": 0.25}}, "position": [0.1, 0.26, 0.4], "linearVelocity": [1, -1, 0.3],
             "angularVelocity": [1, 2, 3], "category": "toy", "material": "rubber"},
            {"name": "box", "shape": {"box": {"size": [0.5, 0.3, 0.4]}}, "position": [-0.6, 0.6, 0.1], "angularVelocity": [3, 1, 2]},
            {"name": "drum", "shape": {"cylinder": {"radius": 0.2, "length": 0.5}}, "position": [0.8, 0.7, -0.3], "angularVelocity": [1, 3, -2]},
            {"name": "pill", "shape": {"capsule": {"radius": 0.12, "length": 0.3}}, "position": [0.2, 1.2, 0], "angularVelocity": [5, 0, 2]},
            {"name": "gear", "shape": {"mesh": gear, "scale": 1.6}, "position": [-0.5, 1.3, -0.2],
             "orientation": {"axis": [1, 0, 0], "angleDegrees": 70}, "angularVelocity": [0, 2, 4]},
            {"name": "ground", "shape": {"plane": {}}, "motion": "static"}],
        "rods": [{"bodyA": "box", "bodyB": "drum"}],
        "springs": [{"bodyA": "pill", "anchorB": [0.2, 1.9, 0], "stiffness": 30}],
        "camera": {"position": [0.5, 1.4, 3.2], "target": [0, 0.7, 0], "orbit": {"period": 3}}}
    document.update(changes)
    return document


def turned(vector):
    """What is along y is along -x: gravity along x."""
    x, y, z = vector
    return [-y, x, z]


class InFolder(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp()
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.scene = cls.write("scene.json", everything())

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder, name)

    @classmethod
    def write(cls, name, document):
        with open(cls.path(name), "w") as file:
            json.dump(document, file)
        return cls.path(name)

    def render(self, name, source, *options):
        result = cradle("render", source, "-o", self.path(name), "--passes", *options)
        self.assertEqual(result.returncode, 0, result.stderr)
        return self.path(name)

    def verifies(self, folder):
        """What is checked, by its name: how many values."""
        result = cradle("verify", folder, "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        report = json.loads(result.stdout)
        self.assertTrue(report["holds"])
        return {check["check"]: check["values"] for check in report["checks"]}


class RightTruth(InFolder):
    def test_all_passes_of_a_scene_hold(self):
        folder = self.render("all", self.scene, "all")
        values = self.verifies(folder)
        pixels = 9 * WIDTH * HEIGHT
        self.assertEqual(set(values), {"camera", "depth", "normal", "segmentation", "objectCoordinates", "flow", "backwardFlow",
                                       "hidden", "reprojection", "silhouette", "instances", "events"})
        for check in ("depth", "normal", "segmentation", "objectCoordinates"):
            self.assertGreaterEqual(values[check], pixels, check)
        for check in ("flow", "backwardFlow", "hidden"):
            self.assertGreater(values[check], 0.7 * pixels, check)
        self.assertGreater(values["reprojection"], 0.3 * pixels)
        self.assertGreater(values["events"], 1)
        words = cradle("-q", "verify", folder)
        self.assertEqual((words.returncode, words.stderr), (0, ""))
        self.assertRegex(words.stdout, r"(?m)^9 frames\n(\w+ +\d+ values, worst off by \S+ [\w ]+, \S+ allowed\n){12}$")

    def test_some_passes_hold_and_what_is_missing_is_not_missed(self):
        self.assertEqual(set(self.verifies(self.render("depth", self.scene, "depth"))),
                         {"camera", "depth", "segmentation", "silhouette", "instances", "events"})
        values = self.verifies(self.render("flow", self.scene, "flow,normal"))
        self.assertGreater(values["flow"], 5000)  # of bodies with forms, without their depths
        self.assertGreater(values["normal"], 5000)

    def test_frames_of_a_trajectory_hold_where_it_stays(self):
        self.assertEqual(cradle("simulate", self.scene, "-o", self.path("t.sqlite")).returncode, 0)
        folder = self.render("parts", self.path("t.sqlite"), "all", "--frames", "3:6")
        self.render("parts", self.path("t.sqlite"), "depth,flow", "--frames", "8:10")
        self.assertFalse(os.path.exists(os.path.join(folder, "trajectory.sqlite")))
        self.verifies(folder)
        os.rename(self.path("t.sqlite"), self.path("moved.sqlite"))
        result = cradle("verify", folder)
        self.assertEqual(result.returncode, 2)
        self.assertIn("t.sqlite", result.stderr)
        other = self.write("other.json", everything(gravity=[0, -9, 0]))
        self.assertEqual(cradle("simulate", other, "-o", self.path("t.sqlite")).returncode, 0)
        result = cradle("verify", folder)
        self.assertEqual(result.returncode, 2)
        self.assertIn("is not the trajectory that", result.stderr)

    def test_runs_that_draw_parts_keep_one_trajectory(self):
        command = [PROGRAM, "render", self.scene, "-o", self.path("shared"), "--passes", "depth,segmentation"]
        runs = [subprocess.Popen([*command, "--frames", frames], stderr=subprocess.PIPE, text=True) for frames in ("0:3", "3:6", "6:9")]
        for process in runs:
            _, stderr = process.communicate(timeout=60)
            self.assertEqual(process.returncode, 0, stderr)
        self.verifies(self.path("shared"))
        self.assertEqual([name for name in os.listdir(self.path("shared")) if "sqlite" in name], ["trajectory.sqlite"])

    def test_a_film_that_replaces_another_brings_its_trajectory(self):
        options = ("depth,flow", "--frames", "0:2")
        folder = self.render("replaced", self.scene, *options)
        other = self.write("lighter.json", everything(gravity=[0, -5, 0]))
        self.render("replaced", other, *options, "--overwrite")
        self.verifies(folder)
        os.truncate(os.path.join(folder, "trajectory.sqlite"), 5000)
        self.assertEqual(cradle("verify", folder).returncode, 2)
        self.render("replaced", other, *options, "--overwrite")
        self.verifies(folder)

    def test_gravity_along_another_axis_holds(self):
        document = everything(gravity=[9.81, 0, 0])
        for body in document["bodies"]:
            for key in ("position", "linearVelocity"):
                if key in body:
                    body[key] = turned(body[key])
        document["bodies"][-1]["shape"] = {"plane": {"normal": [-1, 0, 0]}}
        document["springs"][0]["anchorB"] = turned(document["springs"][0]["anchorB"])
        for key in ("position", "target"):
            document["camera"][key] = turned(document["camera"][key])
        values = self.verifies(self.render("turned", self.write("turned.json", document), "all"))
        self.assertGreater(values["reprojection"], 10000)

    def test_what_is_seen_between_wires_thinner_than_a_pixel_holds(self):
        prism = os.path.join(SOURCE, "assets", "l_prism.3ds")
        bodies = [{"name": "ground", "shape": {"plane": {}}, "motion": "static"},
                  {"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "position": [0, 0.4, 0], "linearVelocity": [-0.5, 0, 0]},
                  {"name": "can", "shape": {"cylinder": {"radius": 0.08, "length": 0.2}}, "position": [-0.3, 0.3, 0.1], "angularVelocity": [1, 2, 3]},
                  {"name": "pill", "shape": {"capsule": {"radius": 0.05, "length": 0.2}}, "position": [0.3, 0.3, 0.1], "angularVelocity": [3, 2, 1]},
                  {"name": "prism", "shape": {"mesh": prism}, "position": [0.1, 0.5, -0.4]}]
        document = everything(duration=0.2, accuracy="visual", output={"framesPerSecond": 60, "width": 160, "height": 90}, rods=[],
                              bodies=bodies, springs=[{"bodyA": "ball", "anchorB": [0, 1, 0]}])
        del document["camera"]
        path = self.write("wires.json", document)
        checked = self.verifies(self.render("wires", path, "all"))
        self.assertGreater(checked["reprojection"], 50000)

    def test_layers_of_openexr_files_hold_as_the_passes_of_numpy_files_do(self):
        values = self.verifies(self.render("exr", self.scene, "all", "--pass-format", "exr", "--frames", "0:4"))
        self.assertEqual(values, self.verifies(self.render("npy", self.scene, "all", "--frames", "0:4")))
        self.assertGreater(values["depth"], 4 * WIDTH * HEIGHT - 1)
        folder = self.path("exr")
        os.rename(os.path.join(folder, "passes_000001.exr"), os.path.join(folder, "kept"))
        shutil.copy(os.path.join(folder, "passes_000003.exr"), os.path.join(folder, "passes_000001.exr"))
        result = cradle("verify", folder)
        self.assertEqual(result.returncode, 9)
        self.assertRegex(result.stderr, r"passes_000001.exr: pixel \(\d+, \d+\): depth")
        os.truncate(os.path.join(folder, "passes_000001.exr"), 700)
        result = cradle("verify", folder)
        self.assertEqual((result.returncode, result.stderr.count("passes_000001.exr")), (2, 1), result.stderr)

    def test_cameras_that_follow_or_are_chosen_are_those_of_the_trajectory(self):
        follows = {"position": [0.5, 1.4, 3.2], "follow": {"body": "ball"}}
        for name, members in (("follows", {"camera": follows}), ("chosen", {"camera": {}})):
            folder = self.render(name + "_kept", self.write(name + "_kept.json", everything(**members)), "depth", "--frames", "0:3")
            self.verifies(folder)
            with open(os.path.join(folder, "camera.json")) as file:
                document = json.load(file)
            for key in ("worldFromCamera", "worldFromCameraOpenCV"):
                document["frames"][2][key][0][3] += 1e-9
            with open(os.path.join(folder, "camera.json"), "w") as file:
                json.dump(document, file)
            result = cradle("verify", folder)
            self.assertEqual(result.returncode, 9)
            self.assertIn("camera.json: camera: found position", result.stderr)

    def test_a_still_camera_and_one_that_is_chosen_hold(self):
        still = {"position": [0.5, 1.4, 3.2], "target": [0, 0.7, 0], "verticalFieldOfViewDegrees": 55}
        self.verifies(self.render("still", self.write("still.json", everything(camera=still)), "all", "--frames", "0:3"))
        self.verifies(self.render("chosen", self.write("chosen.json", everything(camera={})), "all", "--frames", "0:3"))


class PlantedFaults(InFolder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        result = cradle("render", cls.scene, "-o", cls.path("right"), "--passes", "all", "--frames", "2:6")
        assert result.returncode == 0, result.stderr

    def setUp(self):
        self.copy = self.path(self.id().split(".")[-1])
        shutil.copytree(self.path("right"), self.copy)

    def file(self, name):
        return os.path.join(self.copy, name)

    def load(self, kind, frame=3):
        return np.load(self.file(f"{kind}_{frame:06}.npy"))

    def save(self, kind, numbers, frame=3):
        np.save(self.file(f"{kind}_{frame:06}.npy"), np.ascontiguousarray(numbers))

    def edit(self, name, change):
        with open(self.file(name)) as file:
            document = json.load(file)
        change(document)
        with open(self.file(name), "w") as file:
            json.dump(document, file)

    def annotate(self, change, body="ball", frame=3):
        def find(document):
            change(next(record for record in document["annotations"] if record["name"] == body))
        self.edit(f"instances_{frame:06}.json", find)

    def finds(self, *words):
        result = cradle("verify", self.copy)
        self.assertEqual(result.returncode, 9, result.stdout + result.stderr)
        for word in words:
            self.assertIn(word, result.stderr)
        report = json.loads(cradle("verify", self.copy, "--json").stdout)
        self.assertFalse(report["holds"])
        return result.stderr

    def rays(self, frame=3):
        """Directions of depth 1 through the centres of pixels, in the camera."""
        with open(self.file("camera.json")) as file:
            K = np.array(json.load(file)["frames"][frame]["K"])
        rows, columns = np.indices((HEIGHT, WIDTH))
        return np.stack([columns + 0.5, rows + 0.5, np.ones((HEIGHT, WIDTH))], axis=-1) @ np.linalg.inv(K).T

    def test_flow_of_the_other_sign(self):
        self.save("flow", -self.load("flow"))
        self.finds("flow_000003.npy: pixel (")

    def test_flow_by_another_convention(self):
        self.save("flow", self.load("flow")[..., ::-1])
        self.finds("flow_000003.npy: pixel (")

    def test_backward_flow_that_is_the_forward_one(self):
        self.save("backwardFlow", self.load("flow"))
        self.finds("backwardFlow_000003.npy: pixel (")

    def test_depth_along_the_ray(self):
        self.save("depth", (self.load("depth") * np.linalg.norm(self.rays(), axis=-1)).astype(np.float32))
        self.finds("depth_000003.npy: pixel (", "where the ray meets body")

    def test_depth_of_a_mesh_that_is_too_far(self):
        depth, ids = self.load("depth"), self.load("segmentation")
        self.assertGreater((ids == 5).sum(), 50)
        self.save("depth", np.where(ids == 5, depth * np.float32(1 + 1e-5), depth))
        self.finds("depth_000003.npy: pixel (", "on the surface of body \"gear\"")

    def test_normals_of_a_mesh_that_are_smooth(self):
        normal, ids = self.load("normal"), self.load("segmentation")
        normal[ids == 5] += np.float32(1e-5) * (np.indices(ids.shape)[1][ids == 5, None] % 3)
        self.save("normal", normal / np.linalg.norm(normal, axis=-1, keepdims=True))
        self.finds("normal_000003.npy: pixel (", "a triangle of body \"gear\"")

    def test_depth_at_the_corners_of_pixels(self):
        """Of the ground, whose inverse depth is linear in the picture."""
        depth, ids = self.load("depth").astype(float), self.load("segmentation")
        inverse = 1 / depth
        with np.errstate(divide="ignore"):  # of the sky
            shifted = 1 / (inverse + np.gradient(inverse, axis=0) / 2)
        whole = (ids == 6) & (np.roll(ids, 1, 0) == 6) & (np.roll(ids, -1, 0) == 6)
        self.assertGreater(whole.sum(), 500)
        self.save("depth", np.where(whole, shifted, depth).astype(np.float32))
        self.finds("depth_000003.npy: pixel (", "\"ground\"")

    def test_a_middle_half_a_pixel_off(self):
        def shift(document):
            for camera in document["frames"]:
                camera["K"][0][2] += 0.5
        self.edit("camera.json", shift)
        self.finds("camera.json: camera: found K [", "depth_00000", "flow_00000")

    def test_rows_from_below(self):
        for kind in ("depth", "normal", "segmentation", "objectCoordinates"):
            self.save(kind, self.load(kind)[::-1])
        self.finds("depth_000003.npy: pixel (", "segmentation_000003.npy: pixel (", "objectCoordinates_000003.npy: pixel (")

    def test_normals_with_two_components_exchanged(self):
        self.save("normal", self.load("normal")[..., [1, 0, 2]])
        self.finds("normal_000003.npy: pixel (")

    def test_normals_of_the_camera_in_place_of_the_world(self):
        with open(self.file("camera.json")) as file:
            turn = np.array(json.load(file)["frames"][3]["worldFromCamera"])[:3, :3]
        self.save("normal", (self.load("normal") @ turn).astype(np.float32))
        self.finds("normal_000003.npy: pixel (")

    def test_normals_on_the_other_side(self):
        self.save("normal", -self.load("normal"))
        self.finds("normal_000003.npy: pixel (")

    def test_ids_a_pixel_off(self):
        self.save("segmentation", np.roll(self.load("segmentation"), 1, axis=1))
        self.finds("segmentation_000003.npy: pixel (", "instances_000003.json: instances: found run lengths")

    def test_one_pixel_of_sky_in_a_body(self):
        ids, depth = self.load("segmentation"), self.load("depth")
        y, x = np.argwhere(ids == 1)[20]
        ids[y, x], depth[y, x] = 0, np.inf
        self.save("segmentation", ids)
        self.save("depth", depth)
        self.finds(f"segmentation_000003.npy: pixel ({x}, {y})", "before it")

    def test_coordinates_in_the_world(self):
        local, ids = self.load("objectCoordinates"), self.load("segmentation")
        local[ids == 5] += np.float32(1e-4)  # the gear's, a mesh
        self.save("objectCoordinates", local)
        self.finds("objectCoordinates_000003.npy: pixel (", "\"gear\"")

    def test_nothing_hidden_where_something_is(self):
        hidden = self.load("hidden")
        hidden[:] = 0
        self.save("hidden", hidden)
        self.finds("hidden_000003.npy: pixel (")

    def test_everything_hidden_where_little_is(self):
        hidden = self.load("hidden")
        hidden[:] = 1
        self.save("hidden", hidden)
        self.finds("hidden_000003.npy: pixel (", "1, and in the next frame the same")

    def test_a_camera_that_is_turned(self):
        def turn(document):
            camera = document["frames"][3]
            angle = 1e-6
            step = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
            for key in ("worldFromCamera", "worldFromCameraOpenCV"):
                matrix = np.array(camera[key])
                matrix[:3, :3] = step @ matrix[:3, :3]
                camera[key] = matrix.tolist()
        self.edit("camera.json", turn)
        self.finds("camera.json: camera: found rotation", "of frame 3")

    def test_axes_of_one_camera_in_the_place_of_anothers(self):
        self.edit("camera.json", lambda document: document["frames"][2].update(worldFromCamera=document["frames"][2]["worldFromCameraOpenCV"]))
        self.finds("camera.json: camera: found worldFromCameraOpenCV", "of frame 2")

    def test_a_camera_of_another_frame(self):
        self.edit("camera.json", lambda document: document["frames"][3].update(
            {key: document["frames"][4][key] for key in ("worldFromCamera", "worldFromCameraOpenCV")}))
        self.finds("camera.json: camera: found", "depth_000003.npy", "flow_000003.npy")

    def test_wrong_numbers_of_a_body(self):
        for key, wrong in (("mass", 2.5), ("restitution", 0.25), ("dynamicFriction", 0.5), ("category", "tool"), ("motion", "static"),
                           ("bbox", [1, 2, 3, 4]), ("area", 7), ("wholeArea", 3), ("wholeBox", [0, 0, 2, 2]), ("visibleFraction", 0.5),
                           ("position", [0, 0, 0]), ("orientation", [1, 0, 0, 0]), ("linearVelocity", [0, 0, 0]),
                           ("angularVelocity", [1, 2, 4])):
            with self.subTest(key):
                self.annotate(lambda record: record.update({"was": record[key], key: wrong}))
                self.finds(f"found {key} ", "instances_000003.json")
                self.annotate(lambda record: record.update({key: record["was"]}))

    def test_run_lengths_of_rows_in_place_of_columns(self):
        mask = self.load("segmentation") == 1
        changes = np.flatnonzero(np.diff(np.concatenate([[False], mask.ravel(), [False]]).astype(np.int8)))
        counts = np.diff(np.concatenate([[0], changes, [mask.size]])).tolist()
        self.annotate(lambda record: record["segmentation"].update(counts=counts))
        self.finds("instances_000003.json: instances: found run lengths other than segmentation")

    def test_run_lengths_that_end_early(self):
        self.annotate(lambda record: record["segmentation"]["counts"].pop())
        self.finds("instances_000003.json: instances: found run lengths that are not those of the picture")

    def test_a_body_without_annotation(self):
        self.edit("instances_000003.json", lambda document: document["annotations"].pop(0))
        self.finds("instances_000003.json: instances: found number of annotations 0 of body \"ball\"")

    def test_an_event_that_is_missing_and_one_that_is_changed(self):
        self.edit("events.json", lambda document: document["events"][0].update(impulse=document["events"][0]["impulse"] * 1.001))
        self.finds("events.json: events: found impulse")
        self.edit("events.json", lambda document: document["events"].pop(0))
        self.finds("events.json: events: found number of events")

    def refuses(self, *words):
        result = cradle("verify", self.copy)
        self.assertEqual(result.returncode, 2, result.stderr)
        for word in words:
            self.assertIn(word, result.stderr)

    def test_files_that_are_damaged_or_missing_are_named(self):
        os.truncate(self.file("depth_000003.npy"), 500)
        self.refuses("depth_000003.npy", "has 500 bytes")
        self.save("depth", self.load("normal"))
        self.refuses("depth_000003.npy", "has the header", "expected is")
        os.remove(self.file("depth_000003.npy"))
        os.remove(self.file("instances_000004.json"))
        self.refuses("instances_000004.json", "no such file")
        with open(self.file("instances_000004.json"), "w") as file:
            file.write("{\"images\": [")
        self.refuses("instances_000004.json", "cannot be read")
        os.remove(self.file("trajectory.sqlite"))
        self.refuses("trajectory.sqlite")
        os.remove(self.file("truth.json"))
        self.refuses("truth.json", "--passes")

    def test_folders_without_truth_are_refused(self):
        for folder, words in ((self.path("none"), "No such file"), (SOURCE, "truth.json")):
            result = cradle("verify", folder)
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertIn(words, result.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
