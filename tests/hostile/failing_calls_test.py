#!/usr/bin/env python3
"""Each call of the system that a run makes fails once: nothing is half-made, nothing is lost, and the message is one.

    failing_calls_test.py PROGRAM SOURCE_FOLDER LIBRARY [WORDS]

WORDS: only tests whose name contains them. LIBRARY is failing_calls.cpp, preloaded. Small runs that simulate, draw, film
and export are made unharmed first, which counts their calls; then again for each call, which fails: with nothing where the
output comes, or with an earlier one, in turns, and both ways if there are FEW calls. Of requests for memory, which are
thousands, 20 fail: half of them at numbers that grow by a factor (the start is where most different code asks), half evenly
spread. The same for 12 where calls are many and fail in a second way, or by close: FAILURES.

After each run the output is that of the unharmed one, or absent, or the earlier one. Nothing else is there, save FILE.part
of a `simulate` that names it, with the frames so far. The exit code is 0 only if the output is whole; else docs/commands.md's for
what failed: 2, 3 and 4 where an input cannot be read (2 trajectory, 3 scene, 4 mesh), 5 for outputs, 6 for ffmpeg, 8 for
memory, and standard error has one line that says so.
"""
import errno, json, os, shutil, sqlite3, struct, sys, tempfile, unittest

from running import Ended, everything, read, write

PROGRAM, SOURCE, LIBRARY = (os.path.abspath(path) for path in sys.argv[1:4])
WANTED = sys.argv[4] if len(sys.argv) > 4 else ""
FOREVER = 1 << 40  # number of a call that no run makes
KINDS = ["write", "sync", "truncate", "rename", "unlink", "close", "open", "memory"]  # in the library's order
FEW = 3            # calls that fail both with an earlier output and without; more do in turns
MOST_FAULTS = 12   # that a test shows

COMMANDS = {"simulate": ["simulate", "in/scene.json", "-o", "out/a.sqlite"],
            "render": ["render", "in/scene.json", "-o", "out/frames", "--overwrite"],
            "video": ["video", "in/scene_seen.json", "-o", "out/a.mp4"],
            "export_csv": ["export", "in/a.sqlite", "-o", "out/a.csv"],
            "export_glb": ["export", "in/a.sqlite", "-o", "out/a.glb"]}

# What fails, how, how many calls from the chosen one on, and how many are chosen at most.
FAILURES = {"write_to_a_full_disk": ("write", errno.ENOSPC, FOREVER, 12), "write": ("write", errno.EIO, 1, FOREVER),
            "half_a_write": ("write", 0, 1, 12), "flush": ("sync", errno.EIO, 1, FOREVER),
            "truncate": ("truncate", errno.EIO, 1, FOREVER), "rename": ("rename", errno.EACCES, 1, FOREVER),
            "unlink": ("unlink", errno.EACCES, 1, FOREVER), "close": ("close", errno.EIO, 1, 12),
            "open_without_right": ("open", errno.EACCES, 1, 12), "open_one_too_many": ("open", errno.EMFILE, 1, FOREVER),
            "memory": ("memory", errno.ENOMEM, 1, 20)}

# Exit code by what a failed call was for; else it does not matter.
CODES = {"in/scene": 3, "in/ball.3ds": 4, "in/a.sqlite": 2, "out": 5, "tmp/": 5, "tmpfile": 6, "pipe:": 6, "memory": 8}
CODE_OF_CHILD = 4  # it parses a mesh


def scene(**changes):
    document = {"schema": "cradle-scene/1", "name": "test", "duration": 0.05,
                "output": {"framesPerSecond": 40, "width": 32, "height": 32},
                "bodies": [{"name": "ball", "shape": {"mesh": "ball.3ds", "scale": 0.1}, "position": [0, 0.101, 0]},
                           {"name": "floor", "shape": {"plane": {"normal": [0, 1, 0]}}, "motion": "static"}],
                "springs": [{"bodyA": "ball", "anchorA": [0, 0.1, 0], "anchorB": [0, 1, 0], "stiffness": 100}]}
    return json.dumps({**document, **changes})


def tables(path):
    """All that a trajectory says, save what depends on the machine; None if it is none."""
    database = sqlite3.connect("file:%s?mode=ro" % path, uri=True)
    try:
        if database.execute("pragma integrity_check").fetchone() != ("ok",):
            return None
        names = [name for name, in database.execute("select name from sqlite_master where type = 'table' order by name")]
        found = {name: database.execute("select * from " + name).fetchall() for name in names}
        found["meta"] = [row for row in found["meta"] if row[0] not in ("cpuSeconds", "scenePath")]
        return found
    except sqlite3.DatabaseError:
        return None
    finally:
        database.close()


def is_beginning_of(part, whole):
    """Whether a trajectory has the first frames of another, one at least, and nothing else."""
    if part is None or part.keys() != whole.keys() or not part["frame"]:
        return False
    # meta is in the order of its keys, and gets more at the end.
    return all(set(rows) <= set(whole[name]) if name == "meta" else rows == whole[name][:len(rows)]
               for name, rows in part.items())


def samples(count, most):
    """Numbers of calls up to `count`, some `most` of them at the most, the same in each run."""
    if count <= most:
        return range(1, count + 1)
    half = most // 2
    growing = {round(count ** (k / (half - 1))) for k in range(half)}
    return sorted(growing | {1 + count * (2 * k + 1) // (2 * half) for k in range(half)})


class Run(Ended):
    """A run in a folder with its inputs, and, if wanted, an earlier output. `settings` are those of the library."""
    def __init__(self, command, given, earlier, **settings):
        self.command = command
        with tempfile.TemporaryDirectory() as root:
            root = os.path.realpath(root)
            self.folder, report = os.path.join(root, "work"), os.path.join(root, "report")
            shutil.copytree(given, self.folder)
            for name, content in earlier.items():
                write(os.path.join(self.folder, name), content)
            before = everything(self.folder)
            settings = {"FAILING_" + name: str(value) for name, value in settings.items()}
            settings.update(FAILING_FOLDER=self.folder + "/", FAILING_REPORT=report, LD_PRELOAD=LIBRARY,
                            TMPDIR=os.path.join(self.folder, "tmp"))
            arguments = [os.path.join(self.folder, word) if "/" in word else word for word in COMMANDS[command]]
            super().__init__(PROGRAM, ["-q", *arguments], self.folder, settings)
            *calls, self.process, call = struct.unpack("9q952s", read(report))
            self.calls = dict(zip(KINDS, calls))
            self.call = call.rstrip(b"\0").decode().replace(self.folder + "/", "")
            after = everything(self.folder)
            self.lost = {name for name in before if name not in after}
            self.changed = {name: content for name, content in after.items() if before.get(name, ...) != content}
            self.trajectories = {name: tables(os.path.join(self.folder, name)) for name in self.changed if ".sqlite" in name}

    def output_faults(self, whole):
        """What is there that should not be. `whole`: the unharmed run."""
        for name in self.lost:
            yield "lost " + name
        for name, content in self.changed.items():
            if name == "out/frames" or self.call in ("unlink " + name, "remove " + name):
                continue
            if name.endswith(".sqlite.part") and "are in " + os.path.join(self.folder, name) in self.error:
                if not is_beginning_of(self.trajectories[name], whole.trajectories[name[:-len(".part")]]):
                    yield "not the first frames: " + name
            elif name not in whole.changed:
                yield "left behind " + name
            elif not self.has_whole(name, whole):
                yield "not whole: " + name
        if self.code == 0:
            yield from ("exit code 0 without " + name for name in whole.changed if name not in self.changed)

    def has_whole(self, name, whole):
        if name in whole.trajectories:
            return self.trajectories[name] == whole.trajectories[name]
        return self.changed[name] == whole.changed[name]

    def expected_codes(self):
        if not self.call:  # threads may ask for memory a few times less often
            return {0}
        if self.process != self.pid:
            return {CODE_OF_CHILD}
        subject = self.call.split(" ")[0 if self.call.startswith(("tmpfile", "memory")) else 1]
        code = next((code for start, code in CODES.items() if subject.startswith(start)), 0)
        # Where all calls fail from one on, a film meets them in two threads: one writes states, one pictures.
        return {5, 6} if self.command == "video" and code in (5, 6) else {code}

    def message_faults(self):
        lines = [line for line in self.error.splitlines() if not line.startswith(("warning: ", "note: "))]
        if self.code not in {0} | self.expected_codes():
            yield "exit code %d, not %s: %s" % (self.code, self.expected_codes(), self.error.strip())
        if len(lines) != (0 if self.code == 0 else 1) or "This is a bug" in self.error:
            yield "exit code %d, with the message %r" % (self.code, self.error)
        if self.code == 8 and "memory" not in self.error:
            yield "does not speak of memory: %r" % self.error


class FailingCalls(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.given = tempfile.mkdtemp()
        cls.addClassCleanup(shutil.rmtree, cls.given)
        path = lambda name: os.path.join(cls.given, name)
        for name in ("in", "out", "tmp"):
            os.mkdir(path(name))
        write(path("in/scene.json"), scene())
        write(path("in/scene_seen.json"), scene(camera={"position": [0, 1, 3], "target": [0, 0.5, 0]}))
        write(path("in/ball.3ds"), read(os.path.join(SOURCE, "assets", "ball.3ds")))
        longer = write(path("in/longer.json"), scene(duration=0.1))
        for document, name in ((path("in/scene.json"), "in/a.sqlite"), (longer, "longer.sqlite")):
            assert Ended(PROGRAM, ["-q", "simulate", document, "-o", path(name)], cls.given).code == 0
        cls.earlier = {"simulate": {"out/a.sqlite": read(path("longer.sqlite"))}, "video": {"out/a.mp4": b"earlier"},
                       "render": {"out/frames/frame_000000.png": b"earlier"}, "export_csv": {"out/a.csv": b"earlier"},
                       "export_glb": {"out/a.glb": b"earlier"}}
        os.remove(path("longer.sqlite"))
        cls.unharmed = {}

    def unharmed_run(self, command, earlier):
        key = command, len(earlier)
        if key not in self.unharmed:
            run = self.unharmed[key] = Run(command, self.given, earlier)
            self.assertEqual((run.code, run.error, run.lost), (0, "", set()))
        return self.unharmed[key]

    def check(self, command, failure):
        kind, error, count, most = FAILURES[failure]
        faults = []
        numbers = samples(self.unharmed_run(command, {}).calls[kind], most)
        turns = [number % 2 for number in numbers] if len(numbers) > FEW else [0] * len(numbers) + [1] * len(numbers)
        for number, turn in zip([*numbers, *numbers], turns):
            earlier = self.earlier[command] if turn else {}
            whole = self.unharmed_run(command, earlier)
            run = Run(command, self.given, earlier, KIND=kind, ERROR=error, FIRST=number, LAST=number + count - 1)
            for fault in (*run.output_faults(whole), *run.message_faults()):
                faults.append("call %d%s, %s: %s" % (number, ", over an earlier output" if earlier else "", run.call, fault))
        shown = "\n  ".join(faults[:MOST_FAULTS])
        self.assertEqual(len(faults), 0, "%d faults:\n  %s" % (len(faults), shown))


def add_tests():
    for command in COMMANDS:
        for failure in FAILURES:
            name = "test_%s_%s" % (command, failure)
            if WANTED in name:
                setattr(FailingCalls, name, lambda self, command=command, failure=failure: self.check(command, failure))


if __name__ == "__main__":
    add_tests()
    unittest.main(argv=sys.argv[:1], verbosity=1)
