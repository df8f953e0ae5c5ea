#!/usr/bin/env python3
"""Cost and accuracy of ground truth beside Blender and MuJoCo: the scene of ground_truth.py, 320x240, ten bodies.

Blender (Cycles, CPU, one thread, one sample a pixel) draws the .glb of the trajectory; MuJoCo (its own renderer, by EGL)
a model with the same bodies at the same places. Programs take turns. A peer that is not there is left out.

ms/frame      CPU milliseconds a frame, of all threads, files written: the difference of many frames and one; the median
              of the runs
ratio         to Cradle's .npy files of the same passes: the median of the ratios of each run
MB/frame      of the files
depth error   relative to Cradle's: median and largest of the ten bodies' pixels whose eight neighbours show the same body
other ids     % of pixels that show another body than Cradle's
"""
import argparse, collections, glob, json, os, shutil, sqlite3, statistics, struct, subprocess, sys, tempfile, zlib

import numpy as np

from ground_truth import FRAMES, cpu_seconds, scene

HERE = os.path.dirname(os.path.abspath(__file__))
ALL_PASSES = "depth,normal,segmentation,flow,backwardFlow"
BOTH_PASSES = "depth,segmentation"  # that MuJoCo has
COMPARED_FRAMES = 10

# Spheres and cylinders of MuJoCo are triangles, slices around and stacks along the axis; its depth buffer has 24 bits between
# two planes (m).
Quality = collections.namedtuple("Quality", "slices stacks near far")
MUJOCO_ROWS = {"MuJoCo, defaults": Quality(28, 16, 0.01, 50),
               "MuJoCo, as .glb": Quality(64, 32, 0.3, 30),  # the triangles of the .glb, planes as the scene allows
               "MuJoCo, finest": Quality(200, 100, 0.3, 30)}

Row = collections.namedtuple("Row", "title passes command read")  # command(frames, folder); read(folder, frame): arrays by name


class Film:
    """The scene simulated: its trajectory and what other programs need of it, as files in a folder."""

    def __init__(self, program, folder):
        self.program, self.folder = program, folder
        self.trajectory, self.glb = self.path("drop.sqlite"), self.path("drop.glb")
        subprocess.run([program, "simulate", scene(folder), "-o", self.trajectory, "-qq"], check=True)
        subprocess.run([program, "render", self.trajectory, "-o", self.path("first"), "-q", "--passes", "depth", "--frames", "0"], check=True)
        with open(self.path("first/camera.json")) as file:
            document = json.load(file)
        self.width, self.height, self.camera = document["width"], document["height"], document["frames"][0]
        self.frames_per_second = round(1 / (document["frames"][1]["time"] - document["frames"][0]["time"]))
        database = sqlite3.connect(self.trajectory)
        self.bodies = database.execute("select id, name, motion, shape, mesh, comx, comy, comz from body order by id").fetchall()
        self.meshes = {key: (np.frombuffer(vertices, "<f8"), np.frombuffer(triangles, "<u4"))
                       for key, vertices, triangles in database.execute("select id, vertices, triangles from mesh")}
        poses = database.execute("select px, py, pz, qw, qx, qy, qz from state order by frame, body").fetchall()
        np.array(poses, "<f8").tofile(self.path("poses"))

    def path(self, name):
        return os.path.join(self.folder, name)


def numbers(values):
    return " ".join(map(repr, np.ravel(values).tolist()))


# Cradle

def cradle_row(film, title, passes, *options):
    def command(frames, folder):
        return [film.program, "render", film.trajectory, "-o", folder, "-q", "--passes", passes, "--frames", f"0:{frames}", *options]

    def read(folder, frame):
        return {name: np.load(f"{folder}/{name}_{frame:06}.npy") for name in passes.split(",")}
    return Row(title, passes, command, read)


# Blender

def exr_channels(path):
    """The channels of an OpenEXR file of scan lines of float32, in blocks of 16 lines by ZIP."""
    with open(path, "rb") as file:
        data = file.read()
    place, header = 8, {}
    while data[place]:
        name, kind, rest = data[place:].split(b"\0", 2)
        place += len(name) + len(kind) + 2
        size, = struct.unpack_from("<i", data, place)
        header[name], place = data[place + 4:place + 4 + size], place + 4 + size
    names, left = [], header[b"channels"]
    while left[0]:
        name, left = left.split(b"\0", 1)
        names, left = [*names, name.decode()], left[16:]
    left, top, right, bottom = struct.unpack("<4i", header[b"dataWindow"])
    width, height = right - left + 1, bottom - top + 1
    lines, blocks = [], -(-height // 16)
    for offset in struct.unpack_from(f"<{blocks}Q", data, place + 1):
        first, size = struct.unpack_from("<2i", data, offset)
        count = min(16, bottom + 1 - first)
        block, length = data[offset + 8:offset + 8 + size], 4 * len(names) * width * count
        if size < length:  # differences of the bytes, all even ones before the odd ones
            coded = np.frombuffer(zlib.decompress(block), np.uint8).astype(np.int64)
            sums = (np.cumsum(coded - 128) + 128).astype(np.uint8)
            block = np.stack([sums[:length // 2], sums[length // 2:]], axis=-1).tobytes()
        lines.append(np.frombuffer(block, "<f4").reshape(count, len(names), width))
    return dict(zip(names, np.concatenate(lines).transpose(1, 0, 2)))


def blender_row(film, passes):
    ids = film.path("ids.json")
    with open(ids, "w") as file:
        json.dump({name: number + 1 for number, name, *_ in film.bodies}, file)
    known = {"depth": "z", "normal": "normal", "segmentation": "object_index", "flow": "vector", "backwardFlow": "vector"}
    wanted = ",".join(dict.fromkeys(known[name] for name in passes.split(",")))

    def command(frames, folder):
        return ["blender", "-b", "--factory-startup", "--python-exit-code", "1", "--python", os.path.join(HERE, "blender_passes.py"), "--", film.glb,
                ids, str(film.width), str(film.height), str(film.frames_per_second), str(frames), wanted, folder]

    def read(folder, frame):
        channels = {name.split(".", 1)[1]: values for name, values in exr_channels(f"{folder}/passes_{frame:06}.exr").items()}
        arrays = {"depth": channels["Depth.Z"], "segmentation": np.rint(channels["IndexOB.X"])}
        if "flow" in passes:
            x, y, z, w = (channels["Vector." + letter] for letter in "XYZW")
            arrays["backwardFlow"], arrays["flow"] = np.stack([x, -y], axis=-1), np.stack([-z, w], axis=-1)
        if "normal" in passes:
            x, y, z = (channels["Normal." + letter] for letter in "XYZ")
            arrays["normal"] = np.stack([x, z, -y], axis=-1)
        return arrays
    return Row("Blender", passes, command, read)


# MuJoCo

def geom(film, body):
    """Its place is that of the body's frame, whose origin is the centre of mass for MuJoCo's body."""
    number, name, motion, shape, mesh, *center = body
    (kind, form), = json.loads(shape).items() if shape else [("mesh", {})]
    place = "" if motion == "static" else f'pos="{numbers(-np.array(center))}"'
    upright = 'euler="-90 0 0"'  # from MuJoCo's axis, z, to y
    return {"sphere": lambda: f'<geom type="sphere" size="{form["radius"]}" {place}/>',
            "box": lambda: f'<geom type="box" size="{numbers(np.array(form["size"]) / 2)}" {place}/>',
            "cylinder": lambda: f'<geom type="cylinder" size="{form["radius"]} {form["length"] / 2}" {place} {upright}/>',
            "mesh": lambda: f'<geom type="mesh" mesh="mesh{mesh}" {place}/>',
            "plane": lambda: f'<geom type="plane" size="0 0 1" {upright}/>'}[kind]()


def mujoco_model(film, quality):
    pose = np.array(film.camera["worldFromCamera"])
    field_of_view = np.degrees(2 * np.arctan(film.height / 2 / film.camera["K"][1][1]))
    meshes = [f'<mesh name="mesh{key}" vertex="{numbers(vertices)}" face="{numbers(triangles)}"/>' for key, (vertices, triangles) in film.meshes.items()]
    geoms = [geom(film, body) if body[2] == "static" else f'<body mocap="true">{geom(film, body)}</body>' for body in film.bodies]
    return (f'<mujoco><statistic extent="1"/><visual><map znear="{quality.near}" zfar="{quality.far}"/>'
            f'<quality offsamples="0" numslices="{quality.slices}" numstacks="{quality.stacks}"/>'
            f'<global offwidth="{film.width}" offheight="{film.height}"/></visual><asset>{"".join(meshes)}</asset><worldbody>'
            f'<camera fovy="{field_of_view}" pos="{numbers(pose[:3, 3])}" xyaxes="{numbers(pose[:3, :2].T)}"/>{"".join(geoms)}</worldbody></mujoco>')


def mujoco_row(film, mujoco_program, title):
    model = film.path(title + ".xml")
    with open(model, "w") as file:
        file.write(mujoco_model(film, MUJOCO_ROWS[title]))

    def command(frames, folder):
        return [mujoco_program, model, film.path("poses"), str(frames), folder]

    def read(folder, frame):
        return {name: np.fromfile(f"{folder}/{file}_{frame:06}.{kind}", dtype).reshape(film.height, film.width)
                for name, file, kind, dtype in (("depth", "depth", "f32", "<f4"), ("segmentation", "ids", "u16", "<u2"))}
    return Row(title, BOTH_PASSES, command, read)


# Measurement

def rows_of(film, mujoco_program):
    for passes in (BOTH_PASSES, ALL_PASSES):
        yield cradle_row(film, "Cradle", passes)
        yield cradle_row(film, "Cradle, OpenEXR", passes, "--pass-format", "exr")
        if shutil.which("blender"):
            yield blender_row(film, passes)
        if mujoco_program and passes == BOTH_PASSES:
            for title in MUJOCO_ROWS:
                yield mujoco_row(film, mujoco_program, title)


def run(row, frames, folder):
    """CPU seconds."""
    shutil.rmtree(folder, ignore_errors=True)
    os.mkdir(folder)
    with open(folder + ".log", "w") as log:
        try:
            return cpu_seconds(row.command(frames, folder), stdout=log, stderr=log)
        except subprocess.CalledProcessError:
            sys.exit(f"{row.title} failed: {open(folder + '.log').read()[-2000:]}")


def inside(ids):
    """Whether the eight pixels around one have its id; not at the picture's rim."""
    around = np.lib.stride_tricks.sliding_window_view(ids, (3, 3))
    return np.pad((around == ids[1:-1, 1:-1, None, None]).all(axis=(2, 3)), 1)


def relative(theirs, mine):
    return np.abs(theirs.astype(float) / mine - 1)


def degrees(theirs, mine):
    """The angle of unit vectors by their distance, which rounding does not disturb."""
    return np.degrees(2 * np.arcsin(np.minimum(1, np.linalg.norm(theirs.astype(float) - mine, axis=-1) / 2)))


def distance(theirs, mine):
    lengths = np.linalg.norm(theirs.astype(float) - mine, axis=-1)
    return lengths[np.isfinite(lengths)]  # flow is NaN where there is no other frame


def differences(row, ours, folders, frames, moving):
    """A peer's arrays beside Cradle's, of all frames compared, by name. `moving`: ids of bodies that move."""
    found = collections.defaultdict(list)
    for frame in range(0, frames, max(1, frames // COMPARED_FRAMES)):
        mine, theirs = ours.read(folders[ours], frame), row.read(folders[row], frame)
        ids = mine["segmentation"]
        other, is_inside = ids != theirs["segmentation"], inside(ids)
        found["ids"].append(other.ravel())
        found["ids at edges"].append(other[1:-1, 1:-1][~is_inside[1:-1, 1:-1]])
        is_inside &= inside(theirs["segmentation"]) & ~other
        seen = is_inside & np.isin(ids, moving)
        found["depth"].append(relative(theirs["depth"][seen], mine["depth"][seen]))
        rest = is_inside & ~seen & (ids > 0)
        found["depth of the ground"].append(relative(theirs["depth"][rest], mine["depth"][rest]))
        for name, difference in (("normal", degrees), ("flow", distance), ("backwardFlow", distance)):
            if name in theirs:
                found[name].append(difference(theirs[name][seen], mine[name][seen]))
    return {name: np.concatenate(values) for name, values in found.items()}


def measure(film, mujoco_program, runs, frames):
    rows = list(rows_of(film, mujoco_program))
    folders = {row: film.path(f"out{index}") for index, row in enumerate(rows)}
    costs = {row: [] for row in rows}
    for turn in range(runs):
        for row in rows:
            print(f"run {turn + 1} of {runs}: {row.title}, {row.passes}", file=sys.stderr)
            one = run(row, 1, folders[row])
            costs[row].append((run(row, frames, folders[row]) - one) / (frames - 1))
    return rows, folders, costs


def remarks(row, found):
    yield f"{row.title}: other ids at {100 * found['ids at edges'].mean():.1f}% of the pixels beside another body"
    for name, unit in (("depth of the ground", "relative"), ("normal", "degrees"), ("flow", "pixels"), ("backwardFlow", "pixels")):
        if name in found:
            median, most, largest = np.percentile(found[name], [50, 99, 100])
            yield f"{row.title}: {name} differs by {median:.1e}, in one pixel of a hundred by {most:.1e} or more, at most by {largest:.1e} ({unit})"


def show(film, rows, folders, costs, frames):
    print(f"{'passes':45}{'program':18}{'ms/frame':>9}{'ratio':>8}{'MB/frame':>10}{'depth error':>20}{'other ids':>11}")
    notes, moving = [], [number + 1 for number, _, motion, *_ in film.bodies if motion != "static"]
    for row in rows:
        ours = next(other for other in rows if other.passes == row.passes)
        ratio = statistics.median(theirs / mine for theirs, mine in zip(costs[row], costs[ours]))
        size = sum(map(os.path.getsize, glob.glob(folders[row] + "/*_[0-9]*"))) / frames
        accuracy = ""
        if not row.title.startswith("Cradle"):
            found = differences(row, ours, folders, frames, moving)
            accuracy = f"{np.median(found['depth']):10.1e}{found['depth'].max():10.1e}{100 * found['ids'].mean():10.3f}%"
            notes += remarks(row, found)
        print(f"{row.passes:45}{row.title:18}{1e3 * statistics.median(costs[row]):9.2f}{ratio:8.2f}{1e-6 * size:10.2f}{accuracy}")
    print("\n".join(dict.fromkeys(notes)))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter,
                                     epilog="example:\n  ground_truth_peers.py build/release/bin/cradle build/release/bin/mujoco_ground_truth")
    parser.add_argument("program", help="cradle")
    parser.add_argument("mujoco_program", nargs="?", help="mujoco_ground_truth (CMake: CRADLE_BENCHMARKS and CRADLE_PEERS); default: beside cradle")
    parser.add_argument("--runs", type=int, default=3, help="in turn (default: %(default)s)")
    parser.add_argument("--frames", type=int, default=100, help="2 to 200 (default: %(default)s)")
    options = parser.parse_args()
    if not 2 <= options.frames <= FRAMES:
        parser.error(f"--frames {options.frames} is not 2 to {FRAMES}")
    program = os.path.abspath(options.program)
    mujoco_program = shutil.which(os.path.abspath(options.mujoco_program or os.path.join(os.path.dirname(program), "mujoco_ground_truth")))
    if shutil.which("blender") is None:
        print("Blender is left out: it is Debian's package blender")
    if mujoco_program is None:
        print("MuJoCo is left out: install Debian's packages libmujoco-dev, libegl-dev and libgl1-mesa-dri, and build mujoco_ground_truth")
    with tempfile.TemporaryDirectory() as folder:
        film = Film(program, folder)
        subprocess.run([program, "export", film.trajectory, "-o", film.glb], check=True)
        rows, folders, costs = measure(film, mujoco_program, options.runs, options.frames)
        show(film, rows, folders, costs, options.frames)


if __name__ == "__main__":
    main()
