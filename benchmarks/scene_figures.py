#!/usr/bin/env python3
"""How fast and how exact the scenes run, as a table.

    scene_figures.py PROGRAM SCENES       SCENES: a folder of scenes, or one scene file

speed        simulated seconds a second of CPU time, integration alone
energy       largest drift of kinetic + potential + dissipated - work, relative to the largest kinetic energy
penetration  m: largest overlap in any frame, of everything with planes and of spheres and boxes with each other
length       m: how far rods are from their length, and ropes beyond it, at most, in any frame
"""
import glob, itertools, json, math, os, sqlite3, struct, subprocess, sys, tempfile


def dot(a, b): return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
def add(a, b): return [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
def sub(a, b): return [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
def scaled(s, a): return [s * a[0], s * a[1], s * a[2]]
def cross(a, b): return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
def norm(a): return math.sqrt(dot(a, a))
def times(matrix, a): return [dot(row, a) for row in matrix]
def transposed(matrix): return [list(column) for column in zip(*matrix)]
def in_world(pose, point): return add(times(pose[0], point), pose[1])
def is_ball(shape): return len(shape.points) == 1


def rotation_matrix(w, x, y, z):
    n = math.sqrt(w * w + x * x + y * y + z * z)
    w, x, y, z = w / n, x / n, y / n, z / n
    return [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]


def about(axis, degrees):
    half = math.radians(degrees) / 2
    return rotation_matrix(math.cos(half), *scaled(math.sin(half) / norm(axis), axis))


def orientation_of(document):
    if "w" in document:
        return rotation_matrix(*(document[key] for key in "wxyz"))
    if "axis" in document:
        return about(document["axis"], document["angleDegrees"])
    result = about([0, 0, 1], 0)
    for letter, degrees in zip(document.get("order", "zyx"), document.get("eulerDegrees", [0, 0, 0])):
        turn = about([float(letter == axis) for axis in "xyz"], degrees)
        result = [times(transposed(turn), row) for row in result]
    return result


def written_out(bodies):
    """Name, description and position of every body of a scene, copies included."""
    for body in bodies:
        copies, position = body.get("copies", {}), body.get("position", [0, 0, 0])
        for number, place in enumerate(itertools.product(*map(range, copies.get("count", [1, 1, 1])))):
            name = f'{body["name"]}_{number}' if "copies" in body else body["name"]
            yield name, body, add(position, [s * i for s, i in zip(copies.get("spacing", [1, 1, 1]), place)])


class Shape:
    """Points with a ball around each; a box also has centre, axes and half sizes, all in the body's frame."""
    def __init__(self, text, vertices):
        self.points, self.radius, self.box, self.normal = vertices, 0.0, None, None
        for kind, values in json.loads(text or "{}").items():
            if kind == "plane":
                self.normal = scaled(1 / norm(values["normal"]), values["normal"])
            elif kind == "box":
                self.make_box([0, 0, 0], [[1, 0, 0], [0, 1, 0], [0, 0, 1]], scaled(0.5, values["size"]))
            else:
                end = values.get("length", 0) / 2
                self.points = [[0, 0, 0]] if kind == "sphere" else [[0, end, 0], [0, -end, 0]]
                self.radius = values["radius"]
        if vertices:
            self.recognise(vertices)

    def make_box(self, center, axes, half):
        self.box = center, axes, half
        self.points = [add(center, [sum(s * h * a[i] for s, h, a in zip(signs, half, axes)) for i in range(3)])
                       for signs in itertools.product((-1, 1), repeat=3)]

    def recognise(self, vertices):  # as the program does
        center = scaled(1 / len(vertices), [sum(v[i] for v in vertices) for i in range(3)])
        radii = [norm(sub(v, center)) for v in vertices]
        if len(vertices) > 100 and max(radii) - min(radii) < 1e-6 * max(radii):
            self.points, self.radius = [center], max(radii)
        elif len(vertices) == 8:
            edges = [sub(v, vertices[0]) for v in vertices[1:]]
            for three in itertools.combinations(edges, 3):
                if all(abs(dot(a, b)) < 1e-5 * norm(a) * norm(b) for a, b in itertools.combinations(three, 2)):
                    return self.make_box(center, [scaled(1 / norm(e), e) for e in three], [norm(e) / 2 for e in three])


def depth_in_plane(shape, pose, plane, plane_pose):
    normal = times(plane_pose[0], plane.normal)
    in_body = times(transposed(pose[0]), normal)
    return dot(normal, sub(plane_pose[1], pose[1])) + shape.radius - min(dot(in_body, point) for point in shape.points)


def depth_in_box(ball, pose, other, other_pose):
    center, axes, half = other.box
    local = sub(times(transposed(other_pose[0]), sub(in_world(pose, ball.points[0]), other_pose[1])), center)
    beyond = [abs(dot(axis, local)) - h for axis, h in zip(axes, half)]
    return ball.radius - norm([max(0, b) for b in beyond]) - min(0, max(beyond))


def depth_of_boxes(a, pose_a, b, pose_b):
    """The least overlap along face normals and products of edges (separating axes)."""
    placed = [([times(pose[0], axis) for axis in s.box[1]], s.box[2]) for s, pose in ((a, pose_a), (b, pose_b))]
    between = sub(in_world(pose_b, b.box[0]), in_world(pose_a, a.box[0]))
    crossed = [cross(p, q) for p in placed[0][0] for q in placed[1][0]]
    least = math.inf
    for axis in placed[0][0] + placed[1][0] + [scaled(1 / norm(c), c) for c in crossed if norm(c) > 1e-6]:
        reach = sum(h * abs(dot(axis, e)) for axes, half in placed for e, h in zip(axes, half))
        least = min(least, reach - abs(dot(axis, between)))
        if least < 0:
            break
    return least


def depth(a, pose_a, b, pose_b):
    if a.normal or b.normal:
        return depth_in_plane(a, pose_a, b, pose_b) if b.normal else depth_in_plane(b, pose_b, a, pose_a)
    if is_ball(a) and is_ball(b):
        return a.radius + b.radius - norm(sub(in_world(pose_a, a.points[0]), in_world(pose_b, b.points[0])))
    if is_ball(a) and b.box or is_ball(b) and a.box:
        return depth_in_box(a, pose_a, b, pose_b) if b.box else depth_in_box(b, pose_b, a, pose_a)
    return depth_of_boxes(a, pose_a, b, pose_b) if a.box and b.box else 0


class Run:
    def __init__(self, path):
        database = sqlite3.connect(path)
        self.meta = dict(database.execute("select key, value from meta"))
        self.scene = json.loads(self.meta["scene"])
        meshes = {number: list(dict.fromkeys((x + 0.0, y + 0.0, z + 0.0) for x, y, z in struct.iter_unpack("<3d", blob)))
                  for number, blob in database.execute("select id, vertices from mesh")}
        rows = database.execute("select id, name, motion, mesh, shape, comx, comy, comz from body").fetchall()
        self.ids = {row[1]: row[0] for row in rows}
        self.moving = {row[0] for row in rows if row[2] == "dynamic"}
        self.vertices = {row[0]: meshes.get(row[3]) for row in rows}
        self.shapes = {row[0]: Shape(row[4], meshes.get(row[3])) for row in rows}
        centers = {row[0]: row[5:8] for row in rows}
        documents = {self.ids[name]: (body, position) for name, body, position in written_out(self.scene["bodies"])}
        self.ghosts = {number for number, (body, _) in documents.items() if body.get("collision") == "none"}
        fixed = {number: (orientation_of(body.get("orientation", {})), position)
                 for number, (body, position) in documents.items() if number not in self.moving}
        frames = {}
        for frame, body, px, py, pz, *q in database.execute("select frame, body, px, py, pz, qw, qx, qy, qz from state"):
            turn = rotation_matrix(*q)
            frames.setdefault(frame, dict(fixed))[body] = turn, sub([px, py, pz], times(turn, centers[body]))
        self.frames = [frames[number] for number in sorted(frames)]
        energies = "select kinetic, kinetic + potential + dissipated - work from energy order by frame"
        self.energies = database.execute(energies).fetchall()
        totals = "select max(time), (select count(*) from event) from frame"
        self.duration, self.events = database.execute(totals).fetchone()

    def energy_drift(self):
        drift = max(abs(constant - self.energies[0][1]) for _, constant in self.energies)
        return drift / (max(kinetic for kinetic, _ in self.energies) or 1)

    def penetration(self):
        solid = [number for number in self.shapes if number not in self.ghosts]
        pairs = [(a, b) for a, b in itertools.combinations(solid, 2) if a in self.moving or b in self.moving]
        return max([0, *(depth(self.shapes[a], at[a], self.shapes[b], at[b]) for at in self.frames for a, b in pairs)])

    def anchor(self, link, side):
        body, point = self.ids.get(link.get("body" + side)), link.get("anchor" + side, [0, 0, 0])
        return body, self.vertices[body][point["vertex"]] if isinstance(point, dict) else point

    def length_error(self):
        largest = None
        for kind, key in (("rods", "length"), ("ropes", "maxLength")):
            for link in self.scene.get(kind, []):
                ends = [self.anchor(link, side) for side in "AB"]
                lengths = [norm(sub(*(in_world(frame[body], point) if body is not None else point for body, point in ends)))
                           for frame in self.frames]
                over = [length - link.get(key, lengths[0]) for length in lengths]
                largest = max(largest or 0, max(over), -min(over) if kind == "rods" else 0)
        return largest


def main(program, scenes):
    paths = sorted(glob.glob(os.path.join(scenes, "*.json"))) if os.path.isdir(scenes) else [scenes]
    print(f'{"scene":24}{"speed":>10}{"energy":>10}{"penetration":>13}{"length":>10}{"events":>8}')
    for path in paths:
        with tempfile.TemporaryDirectory() as folder:
            name, result = os.path.basename(path)[:-5], os.path.join(folder, "run.sqlite")
            exit_code = subprocess.run([program, "simulate", path, "-o", result, "--quiet"]).returncode
            run = Run(result) if exit_code == 0 else None
        if run is None:
            print(f"{name:24}  ended with exit code {exit_code}")
            continue
        length = run.length_error()
        print(f'{name:24}{run.duration / run.meta["cpuSeconds"]:10.4g}{run.energy_drift():10.1e}'
              f'{run.penetration():13.1e}{"-" if length is None else format(length, ".1e"):>10}{run.events:8}')


if __name__ == "__main__":
    main(*sys.argv[1:]) if len(sys.argv) == 3 else sys.exit(__doc__)
