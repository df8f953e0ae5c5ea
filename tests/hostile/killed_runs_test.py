#!/usr/bin/env python3
"""Runs that are killed or told to end at any moment: results are whole or not there, and the next run is as if alone.

    killed_runs_test.py PROGRAM SOURCE_FOLDER [SEED]

Each command runs unharmed first, which gives its result and how long it takes; then three times with SIGKILL, and once each with
SIGTERM, SIGINT and SIGHUP, at a random moment of each third of that time (the same with each SEED), with and
without an earlier result. After a kill, and where something is kept for the next run, the same command runs once more, at
once. A run that ends before its signal takes effect is unharmed; at most half of the runs are.

After a kill there may be files named .part, and journals beside them; after a signal only those that the message names. A
signal ends a run with 130, 143 or 129 within MOST_SECONDS, and nothing of it is left: no temporary file, no process.
"""
import csv, json, os, random, shutil, signal, sqlite3, subprocess, sys, tempfile, time, unittest

from running import PATIENCE, everything, read, write

PROGRAM, SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
SEED = int(sys.argv[3]) if len(sys.argv) > 3 else 1
MOMENTS = 3         # a signal
KILLS = 20          # of one run that goes on after each
MOST_SECONDS = 5    # s from a signal to the end of the run
MOST_FAULTS = 12    # that a test shows
COST = "cpu_seconds_per_simulated_second"

COMMANDS = {"simulate": ["simulate", "in/long.json", "-o", "out/a.sqlite"],
            "render": ["render", "in/film.json", "-o", "out", "--overwrite"],
            "video": ["video", "in/film.json", "-o", "out/a.mp4"],
            "export": ["export", "in/crowd.sqlite", "-o", "out/a.csv"],
            "study": ["study", "in/short.json", "-o", "out", "--methods", "rk4"],
            "sample": ["sample", "in/drawn.json", "-n", "12", "--simulate", "--chains", "3", "-o", "out"],
            "render again": ["render", "in/film.json", "-o", "out", "--skip-existing"]}
# Begins at once, and ends when a file is there, or after some 20 s.
SLOW_ENCODER = """#!/bin/sh
(cat; for k in $(seq 400); do [ -e '%s' ] && break; sleep 0.05; done) | %s "$@"
"""
EARLIER = {"render": "frame_000001.png", "video": "a.mp4", "export": "a.csv", "study": "study.csv"}


def scene(duration, **changes):
    spring = {"bodyA": "ball", "anchorA": [0, 0.1, 0], "anchorB": [0, 1, 0], "stiffness": 200, "restLength": 0.5}
    mesh = {"mesh": os.path.join(SOURCE, "assets", "ball.3ds"), "scale": 0.1}
    document = {"schema": "cradle-scene/1", "name": "test", "duration": duration, "springs": [spring],
                "output": {"framesPerSecond": 60, "width": 64, "height": 36}, "bodies": [{"name": "ball", "shape": mesh}]}
    return json.dumps({**document, **changes})


def processes_with(text):
    """Processes whose environment has it."""
    found = []
    for number in filter(str.isdigit, os.listdir("/proc")):
        try:
            if text.encode() in read("/proc/%s/environ" % number):
                found.append(int(number))
        except OSError:  # it has ended, or is another user's
            pass
    return found


def trajectory_rows(path):
    """Those of all frames, and none if it is damaged."""
    database = sqlite3.connect(path)
    try:
        if database.execute("pragma integrity_check").fetchone() != ("ok",):
            return []
        return [database.execute("select * from %s order by 1, 2" % table).fetchall() for table in ("frame", "state", "energy")]
    except sqlite3.DatabaseError:
        return []
    finally:
        database.close()


def result(path):
    """What a file says, without what depends on the machine."""
    name = os.path.basename(path)
    if name.endswith(".sqlite"):
        return trajectory_rows(path)
    if name == "study.csv":
        with open(path, newline="") as file:
            return [{**row, COST: None} for row in csv.DictReader(file)]
    return None if name.startswith("work_precision_") else read(path)


class Run:
    """A run that gets a signal after `moment` seconds, if any, and has ended."""
    def __init__(self, command, folder, number=None, moment=0):
        self.folder, self.number = folder, number
        with tempfile.TemporaryDirectory() as temporary, tempfile.TemporaryFile("w+", errors="replace") as error:
            begin = time.monotonic()
            process = subprocess.Popen([PROGRAM, "-q", *COMMANDS[command]], cwd=folder, stdin=subprocess.DEVNULL,
                                       stdout=subprocess.DEVNULL, stderr=error, env={**os.environ, "TMPDIR": temporary})
            try:
                if number is not None:
                    self.wait(process, moment)
                    sent = time.monotonic()
                    process.send_signal(number)  # none is sent to a process that has ended
                self.code = process.wait(PATIENCE)
            except subprocess.TimeoutExpired:
                process.kill()
                self.code = process.wait()
            self.seconds = time.monotonic() - (begin if number is None else sent)
            self.processes, self.temporary_files = processes_with(temporary), os.listdir(temporary)
            error.seek(0)
            self.error = error.read()
        self.names = set(os.listdir(os.path.join(folder, "out")))

    @staticmethod
    def wait(process, seconds):
        try:
            process.wait(seconds)
        except subprocess.TimeoutExpired:
            pass


class KilledRuns(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.given = tempfile.mkdtemp()
        cls.addClassCleanup(shutil.rmtree, cls.given)
        path = lambda name: os.path.join(cls.given, name)
        # Long enough for some checkpoints: five balls below each other.
        spheres = [{"name": "ball%d" % k, "shape": {"sphere": {"radius": 0.1}}, "position": [0, -k, 0.01 * k]} for k in range(5)]
        springs = [{"bodyA": "ball%d" % k, **({"bodyB": "ball%d" % (k - 1)} if k else {"anchorB": [0, 1, 0]}), "stiffness": 5000}
                   for k in range(5)]
        write(path("long.json"), scene(6, bodies=spheres, springs=springs, method={"name": "rk4", "timeStep": 1.5e-5}))
        write(path("seen.json"), scene(3, bodies=spheres, springs=springs, method={"name": "rk4", "timeStep": 1.5e-5},
                                       output={"framesPerSecond": 15, "width": 64, "height": 36},
                                       camera={"position": [0, -2, 9], "target": [0, -2, 0]}))
        # Elastic balls between walls: 45 impacts a second, and more than 100,000 before a checkpoint.
        hard = {"hard": {"restitution": 1, "staticFriction": 0, "dynamicFriction": 0}}
        walls = [{"name": "wall%d" % k, "shape": {"plane": {"normal": normal}}, "motion": "static", "material": "hard",
                  "position": [-x for x in normal]}
                 for k, normal in enumerate([[1, 0, 0], [-1, 0, 0], [0, 0, 1], [0, 0, -1], [0, 1, 0]])]
        balls = {"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "material": "hard", "position": [-0.7, -0.9, -0.7],
                 "linearVelocity": [1.3, 0, 0.7], "copies": {"count": [4, 1, 4], "spacing": [0.4, 0.4, 0.4]}}
        write(path("gas.json"), scene(12000, bodies=[*walls, balls], springs=[], materials=hard, output={"framesPerSecond": 1}))
        write(path("film.json"), scene(0.5, method={"name": "rk4", "timeStep": 1e-5}))
        sphere = {"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "mass": 1}
        write(path("short.json"), scene(0.5, bodies=[sphere]))
        drawn = {**sphere, "position": [{"draw": {"uniform": [-1, 1]}}, 1, 0]}
        floor = {"name": "floor", "shape": {"plane": {}}, "motion": "static"}
        wish = {"body": "ball", "inside": {"min": [0, -9, -9], "max": [9, 9, 9]}, "deviation": 0.2}
        write(path("drawn.json"), scene(0.2, bodies=[floor, drawn], springs=[], wishes=[wish], bumps={"deviationDegrees": 3},
                                        method={"name": "rk4", "timeStep": 4e-5}))
        crowd = {**sphere, "copies": {"count": [10, 10, 5], "spacing": [1, 1, 1]}}
        for name, document in (("crowd", scene(2, bodies=[crowd], springs=[], output={"framesPerSecond": 120})),
                               ("earlier", scene(0.1))):
            write(path(name + ".json"), document)
            subprocess.run([PROGRAM, "-q", "simulate", path(name + ".json"), "-o", path(name + ".sqlite")], check=True)

    def setUp(self):
        self.faults = []

    def folder(self, command, has_earlier=False):
        folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, folder)
        os.symlink(self.given, os.path.join(folder, "in"))
        os.mkdir(os.path.join(folder, "out"))
        if has_earlier and command == "simulate":
            shutil.copy(os.path.join(folder, "in", "earlier.sqlite"), os.path.join(folder, "out", "a.sqlite"))
        elif has_earlier:
            write(os.path.join(folder, "out", EARLIER[command]), b"earlier")
        self.earlier = everything(os.path.join(folder, "out"))
        return folder

    def unharmed(self, command):
        run = Run(command, self.folder(command))
        self.assertEqual((run.code, run.error), (0, ""))
        self.whole = {name: result(os.path.join(run.folder, "out", name)) for name in run.names}
        return run

    def require_no_faults(self):
        shown = "\n  ".join(self.faults[:MOST_FAULTS])
        self.assertEqual(len(self.faults), 0, "%d faults (seed %d):\n  %s" % (len(self.faults), SEED, shown))

    def check(self, command):
        seconds = min(self.unharmed(command).seconds for _ in range(2))  # files that the first read are in memory
        chance = random.Random("%d %s" % (SEED, command))
        for numbers in ([signal.SIGKILL], [signal.SIGTERM, signal.SIGINT, signal.SIGHUP]):
            harmed = 0
            for k in range(MOMENTS):
                number, moment = numbers[k % len(numbers)], seconds * (k + chance.random()) / MOMENTS
                self.told = "%s after %.3f of %.3f s" % (number.name, moment, seconds)
                folder = self.folder(command, has_earlier=chance.random() < 0.5)
                harmed += self.harm(folder, number, Run(command, folder, number, moment))
                if number == signal.SIGKILL or (command in ("simulate", "study") and k == MOMENTS - 1):
                    self.require_same_next_time(command, folder)
            self.told = " and ".join(number.name for number in numbers)
            self.require(harmed >= MOMENTS // 2, "%d of %d runs took no notice" % (MOMENTS - harmed, MOMENTS))
        self.require_no_faults()

    def harm(self, folder, number, run):
        """Looks at what a signal did. Whether it came before the end."""
        self.told += ", which ended with %d" % run.code
        if number != signal.SIGKILL:
            self.require_good_end(run)
        self.require(self.earlier.keys() <= run.names, "an earlier result is lost")
        for name in run.names:
            if name in self.earlier or name in self.whole:
                self.require_whole(run, name)
            elif number == signal.SIGKILL:
                self.require(name.endswith((".part", ".part-journal")), "left " + name)
            else:
                named = "study.csv.part" if name == "references.csv.part" else name  # which goes with it
                is_said = name.endswith(".part") and "are in out/" + named in run.error
                self.require(is_said, "left " + name + " without saying so")
        return run.code != 0

    def require(self, condition, otherwise):
        if not condition:
            self.faults.append("%s: %s" % (self.told, otherwise))

    def require_good_end(self, run):
        """As docs/commands.md says. Before main, signals do what they do to any program."""
        self.require(run.code in (0, 128 + run.number) or (run.code == -run.number and not run.error), run.error)
        lines = [word for word in ("interrupted", "terminated", "hung up") if word in run.error]
        self.require(len(lines) == (run.code > 0) and run.error.count("\n") == (run.code > 0), "it says %r" % run.error)
        self.require(run.code != 0 or run.names == self.whole.keys(), "exit code 0 with %s" % sorted(run.names))
        self.require(run.seconds < MOST_SECONDS, "it took %.1f s" % run.seconds)
        self.require(not run.temporary_files, "temporary files %s" % run.temporary_files)
        self.require(not run.processes, "processes %s" % run.processes)

    def require_whole(self, run, name):
        path = os.path.join(run.folder, "out", name)
        is_earlier = name in self.earlier and read(path) == self.earlier[name]
        self.require(is_earlier or (name in self.whole and result(path) == self.whole[name]), name + " is not whole")

    def require_same_next_time(self, command, folder):
        self.earlier = {}
        run = Run(command, folder)
        self.told += "; then again"
        warnings = [line for line in run.error.splitlines() if not line.startswith("note: going on after")]
        self.require(run.code == 0 and not warnings, "it ended with %d: %s" % (run.code, run.error))
        self.require(run.names == self.whole.keys(), "there is %s" % sorted(run.names))
        for name in run.names & self.whole.keys():
            self.require_whole(run, name)

    def killed_behind_a_checkpoint(self, folder, command=COMMANDS["simulate"], name="a.sqlite.part"):
        """Leaves the unfinished trajectory of a run that was killed when it had come to its first checkpoint."""
        part = os.path.join(folder, "out", name)
        process = subprocess.Popen([PROGRAM, "-q", *command], cwd=folder)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)

        def has_checkpoint():
            if not os.path.exists(part):
                return False
            database = sqlite3.connect("file:%s?mode=ro" % part, uri=True)
            try:
                return database.execute("select count(*) from checkpoint").fetchone() == (1,)
            except sqlite3.DatabaseError:
                return False
            finally:
                database.close()
        self.wait_until(has_checkpoint)
        process.kill()
        self.assertEqual(process.wait(), -signal.SIGKILL)
        return part

    def rows_of_next_run(self, folder, *options):
        """What the next run says, and its rows."""
        run = subprocess.run([PROGRAM, *COMMANDS["simulate"], *options], cwd=folder, capture_output=True, text=True)
        self.assertEqual(run.returncode, 0, run.stderr)
        notes = [line for line in run.stderr.splitlines() if line.startswith("note: ")]
        return notes, trajectory_rows(os.path.join(folder, "out", "a.sqlite"))

    def test_simulate_goes_on_from_its_checkpoint(self):
        folder = self.folder("simulate")
        whole = Run("simulate", folder)
        rows = trajectory_rows(os.path.join(folder, "out", "a.sqlite"))
        self.assertEqual((whole.code, len(rows[0])), (0, 361))
        folder = self.folder("simulate")
        part = self.killed_behind_a_checkpoint(folder)
        kept = os.path.join(folder, "kept")
        shutil.copy(part, kept)
        notes, found = self.rows_of_next_run(folder)
        self.assertEqual(len(notes), 1)
        self.assertRegex(notes[0], r"^note: going on after frame \d+ of out/a.sqlite.part; --fresh begins anew$")
        self.assertEqual(found, rows)
        database = sqlite3.connect(os.path.join(folder, "out", "a.sqlite"))
        self.assertEqual(database.execute("select count(*) from checkpoint").fetchone(), (0,))
        database.close()
        damaged = ["note: out/a.sqlite.part is damaged; the run begins anew"]
        other = ["note: out/a.sqlite.part is of another scene, other options or another program; the run begins anew"]
        for options, damage, told in (
                (["--fresh"], "", []), ([], "update checkpoint set record = zeroblob(length(record))", damaged),
                ([], "update checkpoint set fingerprint = '0'", other),
                ([], "update checkpoint set stateHash = '0'", damaged), ([], "delete from frame where id = 3", damaged),
                ([], "update state set px = px + 1 where frame = 3 and body = 1", damaged),
                ([], "insert into meta values ('stateHash', '0')", damaged),
                ([], "delete from checkpoint", []), (["--strict"], "", other)):
            os.remove(os.path.join(folder, "out", "a.sqlite"))
            shutil.copy(kept, part)
            database = sqlite3.connect(part)
            database.executescript(damage)
            database.close()
            self.assertEqual(self.rows_of_next_run(folder, *options), (told, rows), (options, damage))

    def test_video_goes_on_from_its_checkpoint(self):
        command = ["video", "in/seen.json", "-o", "out/a.mp4"]
        folder = self.folder("video")
        subprocess.run([PROGRAM, "-q", *command], cwd=folder, check=True)
        whole = everything(os.path.join(folder, "out"))
        self.assertEqual(whole.keys(), {"a.mp4"})
        folder = self.folder("video")
        self.killed_behind_a_checkpoint(folder, command, "a.mp4.sqlite.part")
        run = subprocess.run([PROGRAM, *command], cwd=folder, capture_output=True, text=True)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertRegex(run.stderr, r"note: going on after frame \d+ of out/a.mp4.sqlite.part\n")
        self.assertEqual(everything(os.path.join(folder, "out")), whole)

    def test_a_run_of_another_scene_does_not_go_on(self):
        folder = self.folder("simulate")
        part = self.killed_behind_a_checkpoint(folder)
        notes, rows = self.rows_of_next_run(folder, "--duration", "1")
        self.assertEqual((len(notes), len(rows[0])), (1, 61))
        self.assertIn("is of another scene, other options or another program", notes[0])
        self.assertFalse(os.path.exists(part))

    def test_a_run_of_many_events_goes_on(self):
        folder = self.folder("simulate")
        command = ["simulate", "in/gas.json", "-o", "out/a.sqlite"]
        part = self.killed_behind_a_checkpoint(folder, command)
        database = sqlite3.connect(part)
        self.assertGreater(database.execute("select count(*) from event").fetchone()[0], 100_000)
        database.close()
        run = subprocess.run([PROGRAM, *command], cwd=folder, capture_output=True, text=True)
        self.assertRegex(run.stderr, r"note: going on after frame \d+ of out/a.sqlite.part")
        subprocess.run([PROGRAM, "-qq", "simulate", "in/gas.json", "-o", "out/b.sqlite"], cwd=folder, check=True)
        compared = subprocess.run([PROGRAM, "compare", "out/a.sqlite", "out/b.sqlite", "--tolerance", "0"], cwd=folder,
                                  capture_output=True, text=True)
        self.assertEqual(compared.returncode, 0, compared.stdout)

    def check_many_kills(self, command):
        """One run that is killed again and again, and goes on, ends as if nothing had been."""
        folder = self.folder(command)
        seconds = Run(command, folder).seconds
        whole = everything(os.path.join(folder, "out"))
        rows = {name: result(os.path.join(folder, "out", name)) for name in whole if name.endswith(".sqlite")}
        chance = random.Random("%d many kills of %s" % (SEED, command))
        folder = self.folder(command)
        codes = [Run(command, folder, signal.SIGKILL, 0.5 * seconds * chance.random()).code for _ in range(KILLS)]
        self.assertGreater(codes.count(-signal.SIGKILL), 1)
        last = Run(command, folder)
        self.assertEqual((last.code, last.error), (0, ""))
        found = everything(os.path.join(folder, "out"))
        self.assertEqual(found.keys(), whole.keys())
        for name, content in whole.items():
            is_same = result(os.path.join(folder, "out", name)) == rows[name] if name in rows else found[name] == content
            self.assertTrue(is_same, name)

    def test_simulate_many_times(self):
        self.check_many_kills("simulate")

    def test_sample_many_times(self):
        self.check_many_kills("sample")

    def test_render_many_times(self):
        self.check_many_kills("render again")

    def test_video_many_times(self):
        self.check_many_kills("video")

    def test_simulate(self):
        self.check("simulate")

    def test_render(self):
        self.check("render")

    def test_video(self):
        self.check("video")

    def test_export(self):
        self.check("export")

    def test_study(self):
        self.check("study")

    def test_a_study_between_its_last_two_renames(self):
        run = self.unharmed("study")
        self.told = "study.csv is still study.csv.part, references.csv is whole"
        table = os.path.join(run.folder, "out", "study.csv")
        os.rename(table, table + ".part")
        self.require_same_next_time("study", run.folder)
        self.require_no_faults()

    def test_planning_ends_when_told_to(self):
        folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, folder)
        ball = {"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "copies": {"count": [46, 46, 46], "spacing": [1, 1, 1]}}
        path = write(os.path.join(folder, "many.json"), scene(1, bodies=[ball], springs=[]))
        for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
            process = subprocess.Popen([PROGRAM, "check", path], stderr=subprocess.PIPE)
            self.wait_until(lambda: process.poll() is not None or self.cpu_seconds(process.pid) > 2)
            process.send_signal(number)
            begin = time.monotonic()
            error = process.communicate(timeout=PATIENCE)[1]
            self.assertEqual((process.returncode, error.count(b"\n")), (128 + number, 1), error)
            self.assertLess(time.monotonic() - begin, MOST_SECONDS)

    def test_a_mesh_that_hangs_its_importer_ends_when_told_to(self):
        """It would take 3 s of CPU time. Whoever waits for it looks sooner than work that looks at no signal is ended."""
        folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, folder)
        endless = write(os.path.join(folder, "m.ply"), "ply\nformat ascii 1.0\nelement vertex 3\n")
        path = write(os.path.join(folder, "s.json"), scene(1, bodies=[{"name": "b", "shape": {"mesh": "m.ply"}}], springs=[]))
        for number, arguments in ((signal.SIGTERM, ["inspect", endless]), (signal.SIGINT, ["check", path]), (signal.SIGHUP, ["plan", path])):
            process = subprocess.Popen([PROGRAM, *arguments], stderr=subprocess.PIPE, env={**os.environ, "HANGS": folder})
            self.wait_until(lambda: len(processes_with("HANGS=" + folder)) == 2)
            time.sleep(0.2)
            process.send_signal(number)
            begin = time.monotonic()
            error = process.communicate(timeout=PATIENCE)[1]
            self.assertEqual((process.returncode, error.count(b"\n")), (128 + number, 1), error)
            self.assertLess(time.monotonic() - begin, 2)
            self.assertEqual(processes_with("HANGS=" + folder), [])

    @staticmethod
    def cpu_seconds(process):
        fields = read("/proc/%d/stat" % process).rsplit(b") ", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def test_an_encoder_that_outlives_a_killed_film_does_not_write_into_the_next(self):
        self.unharmed("video")
        folder = self.folder("video")
        part, end = os.path.join(folder, "out", "a.mp4.part"), os.path.join(folder, "end")
        slow = write(os.path.join(folder, "slow", "ffmpeg"), SLOW_ENCODER % (end, shutil.which("ffmpeg")))
        os.chmod(slow, 0o755)
        path = os.path.dirname(slow) + ":" + os.environ["PATH"]
        process = subprocess.Popen([PROGRAM, "-q", *COMMANDS["video"]], cwd=folder, env={**os.environ, "PATH": path})
        self.wait_until(lambda: os.path.exists(part) and os.path.getsize(part) > 0)  # the encoder has begun
        process.kill()
        process.wait()
        self.told = "the encoder of a killed film lives"
        self.require_same_next_time("video", folder)
        write(end, b"")
        self.wait_until(lambda: not processes_with(path))
        self.told = "it has ended"
        self.require(result(part[:-len(".part")]) == self.whole["a.mp4"], "the next film is not whole any more")
        self.require(os.listdir(os.path.dirname(part)) == ["a.mp4"], "it left something behind")
        self.require_no_faults()

    def wait_until(self, condition):
        for _ in range(PATIENCE * 50):
            if condition():
                return
            time.sleep(0.02)
        self.fail("waited in vain")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[4:], verbosity=1)
