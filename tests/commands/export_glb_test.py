#!/usr/bin/env python3
"""The .glb of a trajectory, read by hand: what moves where, beside the table of states of the same trajectory.

    export_glb_test.py PROGRAM SOURCE_FOLDER
"""
import csv, json, math, os, shutil, signal, sqlite3, struct, subprocess, sys, tempfile, time, unittest

PROGRAM, SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
FLOAT, UNSIGNED = 5126, 5125
ROUNDING = 2.0**-24  # of a 32-bit number


def cradle(*arguments):
    return subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, timeout=300)


def product(p, q):
    """Of quaternions w, x, y, z."""
    (a, b, c, d), (e, f, g, h) = p, q
    return (a * e - b * f - c * g - d * h, a * f + b * e + c * h - d * g, a * g - b * h + c * e + d * f, a * h + b * g - c * f + d * e)


def turned(q, v):
    return product(product(q, (0, *v)), (q[0], -q[1], -q[2], -q[3]))[1:]


def plus(a, b):
    return tuple(x + y for x, y in zip(a, b))


def difference(a, b):
    return max(abs(x - y) for x, y in zip(a, b))


class Glb:
    """A .glb with what the format says of every such file checked."""

    def __init__(self, test, path):
        with open(path, "rb") as file:
            data = file.read()
        magic, version, length, json_length, json_kind = struct.unpack_from("<4sIII4s", data)
        test.assertEqual((magic, version, length, json_kind), (b"glTF", 2, len(data), b"JSON"))
        test.assertEqual(json_length % 4, 0)
        self.json = json.loads(data[20:20 + json_length])
        binary_length, binary_kind = struct.unpack_from("<I4s", data, 20 + json_length)
        test.assertEqual((28 + json_length + binary_length, binary_kind), (len(data), b"BIN\0"))
        self.binary = data[28 + json_length:]
        test.assertEqual(self.json["asset"]["version"], "2.0")
        test.assertEqual(self.json["buffers"], [{"byteLength": binary_length}])
        self.check_arrays(test)
        self.nodes = {node["name"]: node for node in self.json["nodes"]}
        test.assertEqual(len(self.nodes), len(self.json["nodes"]))
        self.check_tree(test)

    def check_arrays(self, test):
        self.arrays, end = [], 0
        for accessor in self.json["accessors"]:
            view = self.json["bufferViews"][accessor["bufferView"]]
            width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}[accessor["type"]]
            test.assertEqual((view["byteOffset"], view["byteLength"]), (end, 4 * width * accessor["count"]))
            test.assertGreater(accessor["count"], 0)
            end += view["byteLength"]
            kind = {FLOAT: "f", UNSIGNED: "I"}[accessor["componentType"]]
            numbers = struct.unpack_from(f"<{width * accessor['count']}{kind}", self.binary, view["byteOffset"])
            self.arrays.append([numbers[i:i + width] for i in range(0, len(numbers), width)])
            if "min" in accessor:
                test.assertEqual(accessor["min"], [min(column) for column in zip(*self.arrays[-1])])
                test.assertEqual(accessor["max"], [max(column) for column in zip(*self.arrays[-1])])
        self.images = []
        for image in self.json.get("images", []):
            view = self.json["bufferViews"][image["bufferView"]]
            test.assertEqual(view["byteOffset"], end)
            self.images.append(self.binary[end:end + view["byteLength"]])
            end += (view["byteLength"] + 3) // 4 * 4
        test.assertEqual(end, len(self.binary))
        for mesh in self.json["meshes"]:
            for primitive in mesh["primitives"]:
                vertices = len(self.arrays[primitive["attributes"]["POSITION"]])
                test.assertIn("min", self.json["accessors"][primitive["attributes"]["POSITION"]])
                test.assertEqual(len(self.arrays[primitive["attributes"]["NORMAL"]]), vertices)
                test.assertLess(max(self.arrays[primitive["indices"]])[0], vertices)
                test.assertEqual(len(self.arrays[primitive["indices"]]) % 3, 0)
                test.assertLess(primitive["material"], len(self.json["materials"]))
                color = self.json["materials"][primitive["material"]]["pbrMetallicRoughness"]
                test.assertEqual("baseColorTexture" in color, "TEXCOORD_0" in primitive["attributes"])
                if "baseColorTexture" in color:
                    test.assertEqual(len(self.arrays[primitive["attributes"]["TEXCOORD_0"]]), vertices)
                    texture = self.json["textures"][color["baseColorTexture"]["index"]]
                    test.assertLess(texture["source"], len(self.images))

    def check_tree(self, test):
        """Every node is in the scene once."""
        seen = list(self.json["scenes"][self.json["scene"]]["nodes"])
        for node in self.json["nodes"]:
            seen += node.get("children", [])
        test.assertEqual(sorted(seen), list(range(len(self.json["nodes"]))))

    def motion(self, name):
        """{property: [(time, value)]} of a node."""
        animation = self.json["animations"][0]
        motion = {}
        for channel in animation["channels"]:
            if self.json["nodes"][channel["target"]["node"]]["name"] != name:
                continue
            sampler = animation["samplers"][channel["sampler"]]
            assert sampler.get("interpolation", "LINEAR") == "LINEAR" and "min" in self.json["accessors"][sampler["input"]]
            times = [time for time, in self.arrays[sampler["input"]]]
            values = self.arrays[sampler["output"]]
            assert len(times) == len(values)
            motion[channel["target"]["path"]] = list(zip(times, values))
        return motion

    def shape(self, name):
        """The mesh of a node, or of its one child, and where the child is in it."""
        node = self.nodes[name]
        if "mesh" in node:
            return self.json["meshes"][node["mesh"]], (0, 0, 0)
        (child,) = node["children"]
        child = self.json["nodes"][child]
        assert child["rotation"] == [0, 0, 0, 1]
        return self.json["meshes"][child["mesh"]], tuple(child["translation"])

    def corners(self, name):
        """Positions of all vertices of a node's mesh, in the node's frame."""
        mesh, offset = self.shape(name)
        arrays = {primitive["attributes"]["POSITION"] for primitive in mesh["primitives"]}
        return [plus(corner, offset) for array in sorted(arrays) for corner in self.arrays[array]]

    def material(self, name):
        (primitive,) = self.shape(name)[0]["primitives"]
        return self.json["materials"][primitive["material"]]


def linear(hexadecimal):
    """IEC 61966-2-1."""
    channels = [int(hexadecimal[i:i + 2], 16) / 255 for i in (1, 3, 5)]
    return [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055)**2.4 for c in channels]


class ExportGlb(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)

    def path(self, name):
        return os.path.join(self.folder, name)

    def simulate(self, bodies, **changes):
        document = {"schema": "cradle-scene/1", "name": "Käse \"moves\"", "duration": 0.5, "gravity": [0, 0, 0],
                    "output": {"framesPerSecond": 60, "width": 64, "height": 36}, "bodies": bodies, **changes}
        with open(self.path("s.json"), "w") as file:
            json.dump(document, file)
        result = cradle("simulate", self.path("s.json"), "-o", self.path("a.sqlite"))
        self.assertEqual(result.returncode, 0, result.stderr)

    def export(self):
        for ending in ("glb", "csv"):
            result = cradle("export", self.path("a.sqlite"), "-o", self.path("a." + ending))
            self.assertEqual(result.returncode, 0, result.stderr)
        self.states = {}
        with open(self.path("a.csv")) as file:
            for row in csv.DictReader(file):
                if not row["body"]:  # of a joint
                    continue
                numbers = [float(row[key]) for key in ("time_s", "px_m", "py_m", "pz_m", "qw", "qx", "qy", "qz")]
                self.states.setdefault(row["body"], []).append((numbers[0], tuple(numbers[1:4]), tuple(numbers[4:])))
        return Glb(self, self.path("a.glb"))

    def moves_as_in_the_table(self, glb, name):
        motion, states = glb.motion(name), self.states[name]
        self.assertEqual(sorted(motion), ["rotation", "translation"])
        last = None
        for (time, position, (w, x, y, z)), (at, translation), (again, (i, j, k, real)) in zip(
                states, motion["translation"], motion["rotation"], strict=True):
            self.assertEqual(at, again)
            self.assertLessEqual(abs(at - time), ROUNDING * time)
            for exact, rounded in zip(position, translation):
                self.assertLessEqual(abs(exact - rounded), ROUNDING * abs(exact) + 1e-44)
            sign = 1 if w * real + x * i + y * j + z * k > 0 else -1
            self.assertLessEqual(difference((w, x, y, z), tuple(sign * c for c in (real, i, j, k))), ROUNDING)
            if last:
                self.assertGreater(sum(a * b for a, b in zip(last, (i, j, k, real))), 0)
            last = (i, j, k, real)
        node = glb.nodes[name]
        self.assertEqual((node["translation"], node["rotation"]),
                         (list(motion["translation"][0][1]), list(motion["rotation"][0][1])))

    def test_textures_go_with_their_meshes(self):
        """Of the die, three columns and two rows: 1 faces along x, 6 against it. Rows of pictures begin at the top."""
        shutil.copy(os.path.join(SOURCE, "assets/die.3ds"), self.path("d.3ds"))
        shutil.copy(os.path.join(SOURCE, "assets/die.png"), self.path("die.png"))
        shutil.copy(os.path.join(SOURCE, "assets/die.png"), self.path("other.png"))
        bodies = [{"name": "a", "shape": {"mesh": "d.3ds"}},
                  {"name": "b", "shape": {"mesh": "d.3ds"}, "position": [1, 0, 0]},
                  {"name": "c", "shape": {"mesh": "d.3ds"}, "position": [2, 0, 0], "material": "plain"},
                  {"name": "d", "shape": {"mesh": "d.3ds"}, "position": [3, 0, 0], "material": "own"}]
        materials = {"plain": {"baseColor": "#ff0000"}, "own": {"texture": "other.png", "baseColor": "#808080"}}
        self.simulate(bodies, materials=materials)
        glb = self.export()
        with open(self.path("die.png"), "rb") as file:
            self.assertEqual(glb.images, [file.read()] * 2)
        self.assertEqual([(image["name"], image["mimeType"]) for image in glb.json["images"]],
                         [("die.png", "image/png"), ("other.png", "image/png")])
        (primitive,) = glb.shape("a")[0]["primitives"]
        names = ("POSITION", "NORMAL", "TEXCOORD_0")
        positions, normals, places = (glb.arrays[primitive["attributes"][name]] for name in names)
        self.assertEqual(len(positions), 24)
        for normal, place in zip(normals, places):
            if abs(normal[0]) > 0.5:
                column, row = (0, 0) if normal[0] > 0 else (2, 1)
                self.assertTrue(column / 3 - 1e-6 <= place[0] <= (column + 1) / 3 + 1e-6, (normal, place))
                self.assertTrue(row / 2 - 1e-6 <= place[1] <= (row + 1) / 2 + 1e-6, (normal, place))
        self.assertIs(glb.shape("a")[0], glb.shape("b")[0])
        colors = {name: glb.material(name)["pbrMetallicRoughness"] for name in "acd"}
        self.assertEqual([colors[name].get("baseColorTexture") for name in "acd"], [{"index": 0}, None, {"index": 1}])
        for found, expected in zip(colors["d"]["baseColorFactor"], linear("#808080")):
            self.assertAlmostEqual(found, expected, delta=1e-6)

    def test_bodies_are_where_the_table_says(self):
        prism = {"name": "prism", "shape": {"mesh": os.path.join(SOURCE, "assets", "l_prism.3ds"), "scale": 0.2},
                 "position": [1, 2, 3], "orientation": {"axis": [1, 2, 3], "angleDegrees": 250},
                 "linearVelocity": [3, -1, 0.5], "angularVelocity": [9, 4, 2]}
        box = {"name": "box", "shape": {"box": {"size": [0.1, 0.2, 0.3]}}, "position": [-1, 0, 0], "angularVelocity": [20, 1, 0]}
        self.simulate([prism, box], duration=2)
        database = sqlite3.connect(self.path("a.sqlite"))
        database.execute("UPDATE state SET qw = -qw, qx = -qx, qy = -qy, qz = -qz WHERE frame % 3 = 1")  # as q and -q are the same
        database.commit()
        glb = self.export()
        self.assertEqual(len(self.states["prism"]), 121)
        self.moves_as_in_the_table(glb, "prism")
        self.moves_as_in_the_table(glb, "box")
        self.assertEqual(glb.json["scenes"][0]["name"], 'Käse "moves"')

        # A vertex of the file at the point p + q (r - com) q*, as docs/trajectory_file.md says, in every frame.
        com = database.execute("SELECT comx, comy, comz FROM body WHERE name = 'prism'").fetchone()
        blob, normals, triangles = database.execute("SELECT vertices, normals, triangles FROM mesh").fetchone()
        vertices = [struct.unpack_from("<3d", blob, at) for at in range(0, len(blob), 24)]
        self.assertGreater(math.hypot(*com), 0.02)
        corners = glb.corners("prism")
        motion = glb.motion("prism")
        for (_, position, q), (_, translation), (_, (i, j, k, real)) in zip(
                self.states["prism"], motion["translation"], motion["rotation"], strict=True):
            for vertex, corner in zip(vertices, corners, strict=True):
                expected = plus(position, turned(q, tuple(a - b for a, b in zip(vertex, com))))
                found = plus(translation, turned((real, i, j, k), corner))
                self.assertLess(difference(expected, found), 1e-6)  # 8 m, and as much as 20 roundings of it
        mesh = glb.shape("prism")[0]["primitives"]
        self.assertEqual([number for primitive in mesh for number, in glb.arrays[primitive["indices"]]],
                         list(struct.unpack(f"<{len(triangles) // 4}I", triangles)))
        self.assertEqual([number for normal in glb.arrays[mesh[0]["attributes"]["NORMAL"]] for number in normal],
                         list(struct.unpack(f"<{len(normals) // 4}f", normals)))

    def test_driven_bodies_move(self):
        prism = {"name": "prism", "shape": {"mesh": os.path.join(SOURCE, "assets", "l_prism.3ds")}, "motion": "driven",
                 "position": [1, 2, 3], "linearVelocity": [1, 0, 0], "angularVelocity": [0, 3, 0]}
        ball = {"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "linearVelocity": [0, 1, 0]}
        self.simulate([prism, ball])
        glb = self.export()
        self.moves_as_in_the_table(glb, "prism")
        self.moves_as_in_the_table(glb, "ball")
        # Velocities of a driven body are those of its frame's origin, whose place the states have.
        for time, position, q in self.states["prism"]:
            self.assertLess(difference(position, (1 + time, 2, 3)), 1e-14)
            self.assertLess(difference(q, (math.cos(1.5 * time), 0, math.sin(1.5 * time), 0)), 1e-14)
        (blob,) = sqlite3.connect(self.path("a.sqlite")).execute("SELECT vertices FROM mesh").fetchone()
        for at, corner in zip(range(0, len(blob), 24), glb.corners("prism"), strict=True):
            self.assertLess(difference(struct.unpack_from("<3d", blob, at), corner), 2 * ROUNDING)

    def test_times_are_simulated_ones_whatever_the_speed_of_the_film(self):
        self.simulate([{"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "linearVelocity": [1, 0, 0]}],
                      output={"framesPerSecond": 10, "playbackSpeed": 0.25})
        glb = self.export()
        times = [time for time, _ in glb.motion("ball")["translation"]]
        self.assertEqual(len(times), 21)
        for k, time in enumerate(times):
            self.assertLessEqual(abs(time - k * 0.025), 1.5 * ROUNDING * time)

    def test_all_shapes_are_there_in_their_sizes_and_colours(self):
        shapes = {"sphere": ({"radius": 0.3}, (0.6, 0.6, 0.6)), "box": ({"size": [1, 2, 3]}, (1, 2, 3)),
                  "cylinder": ({"radius": 0.5, "length": 3}, (1, 3, 1)), "capsule": ({"radius": 0.5, "length": 3}, (1, 4, 1))}
        bodies = [{"name": name, "shape": {name: numbers}, "motion": "static", "material": "red", "position": [i, 2, 3],
                   "orientation": {"axis": [0, 0, 1], "angleDegrees": 90}} for i, (name, (numbers, _)) in enumerate(shapes.items())]
        bodies.append({"name": "floor", "shape": {"plane": {"normal": [0, 1, 0]}}, "motion": "static", "position": [7, -1, 0]})
        bodies.append({"name": "wall", "shape": {"plane": {"normal": [0, 0, 1]}}, "motion": "static", "position": [0, 0, -9],
                       "orientation": {"axis": [0, 1, 0], "angleDegrees": 90}})  # faces x, through the origin
        self.simulate(bodies, materials={"red": {"baseColor": "#c82010", "metallic": 0.25, "roughness": 0.75}})
        glb = self.export()
        self.assertNotIn("animations", glb.json)
        self.assertEqual(set(glb.nodes), {*shapes, "floor", "wall", "camera", "light0"})
        for i, (name, (_, size)) in enumerate(shapes.items()):
            found = [max(column) - min(column) for column in zip(*glb.corners(name))]
            self.assertLess(difference(found, size), 1e-2 if name == "sphere" else 1e-6)
            self.assertEqual(glb.nodes[name]["translation"], [i, 2, 3])
            self.assertLess(difference(glb.nodes[name]["rotation"], (0, 0, math.sqrt(0.5), math.sqrt(0.5))), 1e-7)
            material = glb.material(name)
            self.assertEqual(material["name"], "red")
            finish = material["pbrMetallicRoughness"]
            self.assertLess(difference(finish["baseColorFactor"], [*linear("#c82010"), 1]), 1e-6)
            self.assertEqual((finish["metallicFactor"], finish["roughnessFactor"]), (0.25, 0.75))
        self.assertLess(difference(glb.material("floor")["pbrMetallicRoughness"]["baseColorFactor"], [*linear("#b0b0b0"), 1]), 1e-3)
        for name, axis, at in (("floor", 1, -1), ("wall", 0, 0)):
            x, y, z, w = glb.nodes[name]["rotation"]
            world = [plus(glb.nodes[name]["translation"], turned((w, x, y, z), corner)) for corner in glb.corners(name)]
            for column in range(3):
                values = [corner[column] for corner in world]
                if column == axis:
                    self.assertLess(max(abs(value - at) for value in values), 1e-5)
                else:
                    self.assertGreater(max(values) - min(values), 10)
            for primitive in glb.shape(name)[0]["primitives"]:
                a, b, c = (world[i] for i, in glb.arrays[primitive["indices"]][:3])
                u, v = plus(b, (-a[0], -a[1], -a[2])), plus(c, (-a[0], -a[1], -a[2]))
                normal = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
                self.assertGreater(normal[axis], 1)  # seen from the side that is free

    def test_equal_shapes_share_a_mesh_and_other_materials_only_its_arrays(self):
        bodies = [{"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "copies": {"count": [3, 3, 1]}},
                  {"name": "red", "shape": {"sphere": {"radius": 0.1}}, "material": "red", "position": [0, 0, 5]}]
        self.simulate(bodies, materials={"red": {"baseColor": "#ff0000"}})
        glb = self.export()
        self.assertEqual((len(glb.nodes), len(glb.json["meshes"]), len(glb.json["materials"])), (12, 2, 2))  # camera and light, too
        positions = {mesh["primitives"][0]["attributes"]["POSITION"] for mesh in glb.json["meshes"]}
        self.assertEqual(len(positions), 1)
        inputs = {sampler["input"] for sampler in glb.json["animations"][0]["samplers"]}
        self.assertEqual(len(inputs), 1)

    def test_links_reach_from_anchor_to_anchor_in_every_frame(self):
        bodies = [{"name": "bob", "shape": {"box": {"size": [0.1, 0.2, 0.3]}}, "position": [1, 0, 0],
                   "mass": 2, "centerOfMass": [0.01, 0.02, 0.03], "inertiaTensor": [[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]]},
                  {"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "position": [1, -1, 0]},
                  {"name": "post", "shape": {"sphere": {"radius": 0.1}}, "motion": "static", "position": [2, 3, 0], "collision": "none"}]
        self.simulate(bodies, duration=3, gravity=[0, -9.81, 0],
                      rods=[{"name": "rod", "bodyA": "bob", "anchorA": [0, 0.1, 0], "anchorB": [0, 0.1, 0]}],
                      springs=[{"bodyA": "ball", "anchorA": [0, 0.1, 0], "bodyB": "bob", "anchorB": [0, -0.1, 0], "stiffness": 300}],
                      ropes=[{"name": "rope", "bodyA": "ball", "anchorA": [0, 0, 0], "bodyB": "post", "anchorB": [0, -0.1, 0], "maxLength": 5}])
        glb = self.export()
        self.moves_as_in_the_table(glb, "bob")
        com = {"bob": (0.01, 0.02, 0.03), "ball": (0, 0, 0)}

        def point(body, anchor, frame):
            _, position, q = self.states[body][frame]
            return plus(position, turned(q, tuple(a - b for a, b in zip(anchor, com[body]))))

        ends = {"rod": lambda k: (point("bob", (0, 0.1, 0), k), (0, 0.1, 0)),
                "spring0": lambda k: (point("ball", (0, 0.1, 0), k), point("bob", (0, -0.1, 0), k)),
                "rope": lambda k: (point("ball", (0, 0, 0), k), (2, 2.9, 0))}
        self.assertEqual(set(glb.nodes), {"bob", "bob shape", "ball", "post", "camera", "light0", *ends})
        for name, ends_at in ends.items():
            heights = [corner[1] for corner in glb.corners(name)]
            self.assertEqual((min(heights), max(heights)), (-0.5, 0.5))
            motion, last = glb.motion(name), None
            for k, ((_, middle), (_, (i, j, l, w)), (_, (width, length, depth))) in enumerate(
                    zip(motion["translation"], motion["rotation"], motion["scale"], strict=True)):
                half = turned((w, i, j, l), (0, length / 2, 0))
                a, b = ends_at(k)
                self.assertLess(difference(plus(middle, half), a), 2e-6)
                self.assertLess(difference(plus(middle, tuple(-x for x in half)), b), 2e-6)
                self.assertTrue(0.001 < width == depth < 0.02)
                if last:  # as little as the motion asks: no half turns between frames
                    self.assertGreater(sum(x * y for x, y in zip(last, (i, j, l, w))), 0.9)
                last = (i, j, l, w)

    def test_joints_are_parts_of_their_bodies(self):
        half = [[0.5, 0, 0], [0, 0.5, 0], [0, 0, 0.5]]
        bodies = [{"name": "lid", "shape": {"box": {"size": [0.4, 0.1, 0.2]}}, "position": [0, 1, 0], "mass": 2, "centerOfMass": [0.02, 0.01, 0],
                   "inertiaTensor": half, "orientation": {"axis": [0, 1, 0], "angleDegrees": 90}},
                  {"name": "cart", "shape": {"box": {"size": [0.2, 0.1, 0.1]}}, "position": [3, 0, 0], "linearVelocity": [4, 0, 0]},
                  {"name": "track", "shape": {"box": {"size": [1, 0.1, 0.1]}}, "position": [3, -1, 0], "motion": "static", "collision": "none",
                   "orientation": {"axis": [0, 0, 1], "angleDegrees": 90}},
                  {"name": "mast", "shape": {"sphere": {"radius": 0.1}}, "position": [3, 1, 0]}]
        self.simulate(bodies, duration=1, gravity=[0, -9.81, 0],
                      hinges=[{"name": "pin", "bodyA": "lid", "anchorA": [-0.2, 0, 0], "anchorB": [0, 1, 0.2], "axis": [0, 0, 1]}],
                      sliders=[{"name": "sleeve", "bodyA": "cart", "bodyB": "track", "anchorB": [1, 0, 0], "axis": [1, 0, 0]}],
                      welds=[{"name": "bead", "bodyA": "cart", "anchorA": [0, 0.5, 0], "bodyB": "mast", "anchorB": [0, -0.5, 0]}])
        glb = self.export()
        parents = {child: node for node in glb.json["nodes"] for child in node.get("children", [])}
        number = {node["name"]: i for i, node in enumerate(glb.json["nodes"])}

        def ends(name, frame):
            """Of a bar, in the world."""
            node, parent = glb.nodes[name], parents.get(number[name])
            (i, j, k, w), middle, length = node["rotation"], tuple(node["translation"]), node["scale"][1]
            points = [plus(middle, turned((w, i, j, k), (0, sign * length / 2, 0))) for sign in (-1, 1)]
            if not parent:
                return points
            pose = ((*parent["rotation"],), (*parent["translation"],))
            if parent["name"] in self.states and frame is not None:
                _, position, q = self.states[parent["name"]][frame]
                pose = ((*q[1:], q[0]), position)
            (i, j, k, w), at = pose
            return [plus(at, turned((w, i, j, k), point)) for point in points]

        for frame, (_, position, q) in enumerate(self.states["lid"]):
            near, far = ends("pin", frame)
            anchor = plus(position, turned(q, (-0.22, -0.01, 0)))
            self.assertLess(difference(plus(near, far), plus(anchor, anchor)), 1e-6)
            axis = tuple(a - b for a, b in zip(far, near))
            self.assertLess(difference(axis, (math.dist(near, far), 0, 0)), 1e-6)
            near, far = ends("sleeve", frame)
            sleeve = self.states["cart"][frame][1]
            self.assertLess(difference(plus(near, far), plus(sleeve, sleeve)), 1e-5)
            (from_x, _, _), (to_x, _, _) = ends("sleeve rail", frame)
            self.assertLess(from_x, near[0] + 1e-6)
            self.assertGreater(to_x, far[0] - 1e-6)
        self.assertLess(difference(ends("sleeve rail", None)[0][1:], (0, 0)), 1e-6)
        self.assertAlmostEqual(to_x - self.states["cart"][-1][1][0], math.dist(near, far) / 2, 5)
        self.assertEqual(glb.nodes["bead"]["translation"], [0, 0.5, 0])
        self.assertEqual(parents[number["bead"]]["name"], "cart")
        self.assertEqual(parents[number["bead arm of mast"]]["name"], "mast")

    def test_the_camera_is_that_of_the_pictures_and_lights_shine_their_way(self):
        ball = {"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "linearVelocity": [1, 0, 0]}
        for camera in (None, {"position": [1, 2, 5], "target": [0, 0, 0], "verticalFieldOfViewDegrees": 50},
                       {"position": [1, 2, 5], "target": "ball", "orbit": {"period": 2}}):
            lights = [{"direction": [0, -2, 0], "color": "#ff8000", "intensity": 2}, {"direction": [3, 0, 4]}]
            self.simulate([ball], lights=lights, **({"camera": camera} if camera else {}))
            glb = self.export()
            shutil.rmtree(self.path("f"), ignore_errors=True)
            self.assertEqual(cradle("render", self.path("a.sqlite"), "-o", self.path("f"), "--passes", "depth", "--frames", "0").returncode, 0)
            with open(self.path("f/camera.json")) as file:
                frames = json.load(file)["frames"]
            node, motion = glb.nodes["camera"], glb.motion("camera")
            self.assertEqual(sorted(motion), ["rotation", "translation"] if camera and "orbit" in camera else [])
            poses = list(zip(motion["translation"], motion["rotation"])) if motion else [((0, node["translation"]), (0, node["rotation"]))]
            for frame, ((_, place), (_, turn)) in zip(frames, poses):
                matrix = frame["worldFromCamera"]
                for axis in range(3):
                    unit = tuple(1.0 if i == axis else 0.0 for i in range(3))
                    column = tuple(matrix[i][axis] for i in range(3))
                    self.assertLess(difference(turned((turn[3], *turn[:3]), unit), column), 1e-6)
                self.assertLess(difference(tuple(place), tuple(row[3] for row in matrix[:3])), 1e-6 * 6)
            perspective = glb.json["cameras"][node["camera"]]["perspective"]
            height = 2 * math.tan(perspective["yfov"] / 2) * frames[0]["K"][1][1]
            self.assertAlmostEqual(height, 36, delta=1e-9)
            self.assertAlmostEqual(perspective["aspectRatio"], 64 / 36, delta=1e-12)
            self.assertEqual(glb.json["extensionsUsed"], ["KHR_lights_punctual"])
            shining = glb.json["extensions"]["KHR_lights_punctual"]["lights"]
            for number, (direction, color, intensity) in enumerate((((0, -1, 0), linear("#ff8000"), 2), ((0.6, 0, 0.8), [1, 1, 1], 3))):
                node = glb.nodes[f"light{number}"]
                self.assertLess(difference(turned((node["rotation"][3], *node["rotation"][:3]), (0, 0, -1)), direction), 1e-6)
                light = shining[node["extensions"]["KHR_lights_punctual"]["light"]]
                self.assertEqual((light["type"], light["intensity"]), ("directional", intensity))
                self.assertLess(difference(tuple(light["color"]), tuple(color)), 1e-6)

    def test_colours_of_a_models_file_stand_for_their_triangles(self):
        frame = {"name": "frame", "shape": {"mesh": os.path.join(SOURCE, "assets", "cradle_frame.3ds")}, "motion": "static", "collision": "none"}
        painted = {**frame, "name": "painted", "material": "red"}
        self.simulate([frame, painted], materials={"red": {"baseColor": "#ff0000"}})
        ranges = json.loads(sqlite3.connect(self.path("a.sqlite")).execute("SELECT material FROM mesh").fetchone()[0])
        glb = self.export()
        primitives = glb.shape("frame")[0]["primitives"]
        self.assertEqual(len(primitives), len(ranges))
        for primitive, part in zip(primitives, ranges):
            self.assertEqual(len(glb.arrays[primitive["indices"]]), 3 * part["triangleCount"])
            color = glb.json["materials"][primitive["material"]]["pbrMetallicRoughness"]["baseColorFactor"]
            self.assertLess(difference(color, [*linear(part["baseColor"]), 1]), 1e-6)
        self.assertEqual({glb.json["materials"][primitive["material"]]["name"] for primitive in glb.shape("painted")[0]["primitives"]}, {"red"})

    def test_only_models_that_are_open_show_their_inside(self):
        with open(self.path("open.obj"), "w") as file:
            file.write("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        self.simulate([{"name": "open", "shape": {"mesh": self.path("open.obj")}, "motion": "static", "collision": "none"},
                       {"name": "closed", "shape": {"mesh": os.path.join(SOURCE, "assets", "ball.3ds")}}])
        glb = self.export()
        self.assertIs(glb.material("open").get("doubleSided"), True)
        self.assertNotIn("doubleSided", glb.material("closed"))

    def test_names_in_mesh_files_need_not_be_utf_8(self):
        self.simulate([{"name": "frame", "shape": {"mesh": os.path.join(SOURCE, "assets", "cradle_frame.3ds")}, "motion": "static", "collision": "none"}])
        database = sqlite3.connect(self.path("a.sqlite"))
        database.execute("UPDATE mesh SET material = replace(material, 'Walnut', CAST(x'4be473' AS TEXT))")
        database.commit()
        names = [material["name"] for material in self.export().json["materials"]]
        self.assertIn("K\N{REPLACEMENT CHARACTER}s", names)

    def test_the_program_itself_loads_it(self):
        self.simulate([{"name": "box", "shape": {"box": {"size": [1, 2, 3]}}, "position": [4, 5, 6]}])
        self.export()
        result = cradle("inspect", "--json", self.path("a.glb"))
        self.assertEqual(result.returncode, 0, result.stderr)
        (found,) = json.loads(result.stdout)["objects"]
        self.assertAlmostEqual(found["volume"], 6, delta=1e-5)
        self.assertLess(difference(found["centerOfMass"], (4, 5, 6)), 1e-5)

    def refuses(self, exit_code, words, output):
        before = sorted(os.listdir(self.folder))
        result = cradle("export", self.path("a.sqlite"), "-o", output)
        self.assertEqual(result.returncode, exit_code, result.stderr)
        for word in words:
            self.assertIn(word, result.stderr)
        self.assertEqual(sorted(os.listdir(self.folder)), before)

    def test_what_cannot_be_written_is_refused(self):
        self.simulate([{"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "copies": {"count": [10, 10, 1]}}])
        self.refuses(2, ["a.gltf", "FILE.csv", "FILE.glb"], self.path("a.gltf"))
        os.mkdir(self.path("b.glb"))
        self.refuses(5, ["is a folder"], self.path("b.glb"))
        os.mkfifo(self.path("pipe.glb"))
        self.refuses(5, ["pipe.glb", "not a regular file"], self.path("pipe.glb"))
        with open(self.path("kept.glb"), "w") as file:
            file.write("precious")
        database = sqlite3.connect(self.path("a.sqlite"))
        database.execute("UPDATE frame SET time = time + 1e6")  # 32-bit numbers there are 1/16 s apart
        database.commit()
        self.refuses(2, ["32-bit times", "FILE.csv"], self.path("kept.glb"))
        database.execute("WITH RECURSIVE n(i) AS (SELECT 31 UNION ALL SELECT i + 1 FROM n WHERE i < 1600000) "
                         "INSERT INTO frame SELECT i, 1e6 + i FROM n")
        database.commit()
        self.refuses(8, ["kept.glb", "4.5 GB", "FILE.csv"], self.path("kept.glb"))
        database.execute("DELETE FROM frame")
        database.execute("DELETE FROM meta WHERE key = 'stateHash'")  # as a run leaves it that has just begun
        database.commit()
        self.refuses(2, ["no frames yet"], self.path("kept.glb"))
        with open(self.path("kept.glb")) as file:
            self.assertEqual(file.read(), "precious")

    def test_interruption_leaves_nothing(self):
        self.simulate([{"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "copies": {"count": [10, 10, 1]}}], duration=60)
        for number, exit_code in ((signal.SIGINT, 130), (signal.SIGTERM, 143)):
            process = subprocess.Popen([PROGRAM, "export", self.path("a.sqlite"), "-o", self.path("a.glb")])
            while process.poll() is None and not os.path.exists(self.path("a.glb.part")):
                time.sleep(0.001)
            process.send_signal(number)
            self.assertEqual(process.wait(), exit_code)
            self.assertEqual(sorted(os.listdir(self.folder)), ["a.sqlite", "s.json"])


unittest.main(argv=[sys.argv[0]])
