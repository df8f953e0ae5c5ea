#!/usr/bin/env python3
"""Looks for inputs that crash a reader, hang it, fill memory, or are accepted for what they are not.

    fuzz.py PROGRAMS SOURCE_FOLDER OUT_FOLDER [SECONDS] [--keep]

Each program PROGRAMS/fuzz_NAME runs for its share of SECONDS (600), as many at once as there are cores: half of it with short
inputs that begin with nothing, half with tests/fuzz/corpora/NAME, with what former runs left in OUT_FOLDER/NAME, and with files
of the field: scenes, 3ds and other models, PNG files of every kind. An input that shows a fault stays in OUT_FOLDER/faults, and the run ends with 1. --keep
writes tests/fuzz/corpora anew: a small set of inputs that reaches all that was reached, and those that are named in words.
"""
import argparse, glob, hashlib, os, re, shutil, struct, subprocess, sys, tempfile, time, zlib

from concurrent.futures import ThreadPoolExecutor

MODELS = "/usr/share/assimp/models"
FORMATS = ["obj", "ply", "stl", "gltf", "glb", "off", "dae", "3ds", "x", "ac", "lwo", "raw"]  # of fuzz_import_formats.cpp
LARGEST = 4096  # bytes of an input: larger ones take the time of many, and show hardly more
SHORT = 256     # bytes: of these a second tries ten times as many
# A fault is an input that takes longer (s), or more memory (MB), than what a reader may take before it refuses.
LIMITS = ["-timeout=20", "-malloc_limit_mb=1024", "-rss_limit_mb=2048"]
HASH = re.compile("[0-9a-f]{40}")  # names that libFuzzer gives; inputs that once showed a fault are named in words
REPORT = 10           # s between two lines of progress


def content(path):
    with open(path, "rb") as file:
        return file.read()


def files_of(folder, endings, largest=LARGEST):
    for place, _, names in sorted(os.walk(folder)):
        for name in sorted(names):
            path = os.path.join(place, name)
            if name.lower().endswith(tuple(endings)) and os.path.isfile(path) and os.path.getsize(path) <= largest:
                yield path


def png(kind, depth, interlaced):
    """A PNG file of 5 x 3 pixels: kind 0 grey, 2 RGB, 3 palette, 4 grey and alpha, 6 RGBA."""
    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    def rows(width, height):
        size = (width * depth * {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}[kind] + 7) // 8
        return b"".join(bytes([row % 5]) + bytes(row & 1 for _ in range(size)) for row in range(height if width else 0))

    passes = [(1, 1), (1, 1), (2, 1), (1, 1), (3, 1), (2, 2), (5, 1)] if interlaced else [(5, 3)]  # Adam7
    palette = chunk(b"PLTE", bytes(range(6))) if kind == 3 else b""
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 5, 3, depth, kind, 0, 0, interlaced)) + palette
            + chunk(b"IDAT", zlib.compress(b"".join(rows(*size) for size in passes))) + chunk(b"IEND", b""))


def surface(*faces):
    """Triangles of corners in quarters, as fuzz_surface.cpp reads them."""
    return b"".join(struct.pack("9b", *(number for corner in face for number in corner)) for face in faces)


def closed_surfaces():
    a, b, c, d = (0, 0, 0), (8, 0, 0), (0, 8, 0), (0, 0, 8)
    tetrahedron = [(a, c, b), (a, b, d), (a, d, c), (b, c, d)]
    corners = [(x, y, z) for x in (-4, 4) for y in (-4, 4) for z in (-4, 4)]
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    box = [tuple(corners[quad[i]] for i in half) for quad in quads for half in ((0, 1, 2), (0, 2, 3))]
    moved = [tuple((x + 20, y, z) for x, y, z in face) for face in tetrahedron]
    turned = [face[::-1] for face in moved]
    return [surface(*faces) for faces in (tetrahedron, box, tetrahedron + moved, tetrahedron + turned, box + tetrahedron)]


def seeds(name, source):
    """Inputs of the field, for a program without a corpus."""
    if name in ("json", "scene"):
        return [content(path) for folder in ("scenes", "tests/scene") for path in files_of(os.path.join(source, folder), [".json"])]
    if name in ("check_3ds", "import_3ds"):
        return [content(path) for folder in (os.path.join(source, "assets"), MODELS) for path in files_of(folder, [".3ds"])]
    if name == "import_formats":
        return [bytes([number]) + content(path) for number, ending in enumerate(FORMATS)
                for path in files_of(MODELS, ["." + ending])]
    if name == "png":
        return [png(kind, depth, interlaced) for kind, depths in ((0, (1, 2, 4, 8, 16)), (2, (8, 16)), (3, (1, 2, 4, 8)),
                                                                  (4, (8, 16)), (6, (8, 16)))
                for depth in depths for interlaced in (0, 1)]
    return closed_surfaces() if name == "surface" else []


def put(inputs, folder):
    os.makedirs(folder, exist_ok=True)
    for data in inputs:
        with open(os.path.join(folder, hashlib.sha1(data).hexdigest()), "wb") as file:
            file.write(data)
    return folder


class Target:
    """One program and its inputs."""
    def __init__(self, program, arguments):
        self.program, self.name = program, os.path.basename(program)[len("fuzz_"):]
        self.kept = os.path.join(arguments.source, "tests/fuzz/corpora", self.name)
        self.grown = os.path.join(arguments.out, self.name)
        self.faults = os.path.join(arguments.out, "faults", self.name + "-")
        self.log = os.path.join(arguments.out, self.name + ".log")
        self.source = arguments.source
        os.makedirs(os.path.dirname(self.faults), exist_ok=True)
        os.makedirs(self.kept, exist_ok=True)

    def run(self, options, folders, log):
        with open(log, "wb") as out:
            return subprocess.run([self.program, *LIMITS, *options, *folders], stdin=subprocess.DEVNULL, stdout=out,
                                  stderr=subprocess.STDOUT).returncode

    def look(self, seconds):
        """Executions, and whether a fault was found."""
        put(seeds(self.name, self.source), self.grown)
        short = put([], self.grown + "-short")
        total = 0
        for length, folders in ((SHORT, [short]), (LARGEST, [self.grown, short, self.kept])):
            options = ["-max_total_time=%d" % max(1, seconds // 2), "-print_final_stats=1", "-artifact_prefix=" + self.faults,
                       "-reload=0", "-max_len=%d" % length]
            code = self.run(options, folders, self.log)
            count = re.search(rb"number_of_executed_units: (\d+)", content(self.log))
            total += int(count[1]) if count else 0
            if code != 0:
                return total, True
        return total, False

    def keep(self):
        with tempfile.TemporaryDirectory() as folder:
            small = put((content(path) for path in files_of(self.grown, [""])), os.path.join(folder, "small"))
            cover = put([], os.path.join(folder, "cover"))
            self.run(["-set_cover_merge=1", "-use_counters=0"], [cover, small, self.grown + "-short", self.kept],
                     os.path.join(folder, "log"))
            if os.listdir(cover):
                for name in filter(HASH.fullmatch, os.listdir(self.kept)):
                    os.remove(os.path.join(self.kept, name))
                shutil.copytree(cover, self.kept, dirs_exist_ok=True)
        return len(os.listdir(self.kept))


def tell(start, end):
    while time.monotonic() < end:
        time.sleep(min(REPORT, max(0, end - time.monotonic())))
        print("Fuzzing: %d s, %d s left" % (time.monotonic() - start, max(0, end - time.monotonic())), file=sys.stderr)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("programs", "source", "out"):
        parser.add_argument(name)
    parser.add_argument("seconds", nargs="?", type=int, default=600)
    parser.add_argument("--keep", action="store_true")
    arguments = parser.parse_args()
    targets = [Target(program, arguments) for program in sorted(glob.glob(os.path.join(arguments.programs, "fuzz_*")))]
    cores = len(os.sched_getaffinity(0))
    rounds = -(-len(targets) // cores)
    start, total, failed = time.monotonic(), 0, []
    with ThreadPoolExecutor(cores + 1) as pool:
        pool.submit(tell, start, start + arguments.seconds)
        shares = pool.map(lambda target: target.look(max(1, arguments.seconds // rounds)), targets)
        for target, (count, fault) in zip(targets, shares):
            total += count
            failed += [target] * fault
            print("%-16s %10d executions%s" % (target.name, count, ", a FAULT: see %s" % target.log if fault else ""), flush=True)
    print("%-16s %10d executions" % ("all", total))
    if arguments.keep:
        for target in targets:
            print("%-16s %10d inputs kept" % (target.name, target.keep()), flush=True)
    for target in failed:
        print("The input of %s is in %s*; %s FILE runs it again." % (target.name, target.faults, target.program))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
