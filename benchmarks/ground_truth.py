#!/usr/bin/env python3
"""Cost of passes of ground truth: ten bodies (spheres, boxes, cylinders, cones as meshes) dropped on the ground, 320x240.

    ground_truth.py PROGRAM [RUNS]

ms/frame    CPU milliseconds a frame: the difference of 200 frames and 1 frame; the median of RUNS (5), in turn
of that     the same without what writing the files takes, as a program that writes as many bytes measures it
MB/frame    of the files
"""
import json, math, os, resource, statistics, struct, subprocess, sys, tempfile

FRAMES = 200
PASSES = ["depth", "segmentation", "depth,normal,segmentation", "flow", "depth,normal,segmentation,flow,backwardFlow,objectCoordinates", "rgb"]


def cone(path, segments=32):
    """A closed cone of radius and height 0.1 m as binary STL."""
    ring = [(0.1 * math.cos(2 * math.pi * i / segments), 0.1 * math.sin(2 * math.pi * i / segments)) for i in range(segments)]
    with open(path, "wb") as file:
        file.write(bytes(80) + struct.pack("<I", 2 * segments))
        for (x0, y0), (x1, y1) in zip(ring, ring[1:] + ring[:1]):
            for triangle in (((x0, y0, 0), (x1, y1, 0), (0, 0, 0.1)), ((x1, y1, 0), (x0, y0, 0), (0, 0, 0))):
                file.write(struct.pack("<12fH", 0, 0, 0, *sum(triangle, ()), 0))


def scene(folder):
    cone(os.path.join(folder, "cone.stl"))
    shapes = [{"sphere": {"radius": 0.1}}, {"box": {"size": [0.2, 0.15, 0.15]}}, {"cylinder": {"radius": 0.08, "length": 0.2}},
              {"mesh": "cone.stl"}]
    bodies = [{"name": "ground", "shape": {"plane": {}}, "motion": "static"}]
    for i in range(10):
        bodies.append({"name": f"body{i}", "shape": shapes[i % 4], "position": [0.35 * (i % 4) - 0.5, 0.3 + 0.1 * i, 0.35 * (i // 4) - 0.4],
                       "angularVelocity": [1, 2 + i, 3], "linearVelocity": [0.3 * math.sin(i), 0, 0.3 * math.cos(i)]})
    document = {"schema": "cradle-scene/1", "name": "drop", "duration": FRAMES / 100, "accuracy": "visual",
                "camera": {"position": [1.2, 1.2, 1.8], "target": [0, 0.2, 0]}, "output": {"framesPerSecond": 100, "width": 320, "height": 240},
                "bodies": bodies}
    path = os.path.join(folder, "drop.json")
    with open(path, "w") as file:
        json.dump(document, file)
    return path


def cpu_seconds(command, **options):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, check=True, **options)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main():
    program, runs = os.path.abspath(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 5
    with tempfile.TemporaryDirectory() as folder:
        trajectory, out = os.path.join(folder, "drop.sqlite"), os.path.join(folder, "out")
        subprocess.run([program, "simulate", scene(folder), "-o", trajectory, "-qq"], check=True)
        times, writing, sizes = {passes: [] for passes in PASSES}, {passes: [] for passes in PASSES}, {}
        for _ in range(runs):
            for passes in PASSES:
                render = [program, "render", trajectory, "-o", out, "--overwrite", "-q", "--passes", passes]
                seconds = [cpu_seconds(render + ["--frames", f"0:{count}"]) for count in (1, FRAMES)]
                times[passes].append((seconds[1] - seconds[0]) / (FRAMES - 1))
                files = [os.path.join(out, name) for name in os.listdir(out) if name not in ("camera.json", "events.json")]
                sizes[passes] = sum(map(os.path.getsize, files)) / FRAMES
                copy = cpu_seconds(["cp", "-r", out, os.path.join(folder, "copy")]) - cpu_seconds(["cp", "-r", files[0], os.path.join(folder, "one")])
                writing[passes].append(copy / FRAMES)
                subprocess.run(["rm", "-rf", out, os.path.join(folder, "copy")], check=True)
        print(f"{'passes':66}  ms/frame  of that  MB/frame")
        for passes in PASSES:
            whole, written = statistics.median(times[passes]), statistics.median(writing[passes])
            print(f"{passes:66}  {1e3 * whole:8.2f}  {1e3 * (whole - written):7.2f}  {1e-6 * sizes[passes]:8.2f}")


if __name__ == "__main__":
    main() if len(sys.argv) > 1 and not sys.argv[1].startswith("-") else sys.exit(__doc__)
