#!/usr/bin/env python3
"""The command line as its users meet it: exit codes, messages, what is left behind.

    command_line_test.py PROGRAM SOURCE_FOLDER
"""
import ast, base64, contextlib, csv, json, math, os, pty, re, resource, shutil, signal, sqlite3, struct, subprocess, sys, tempfile, time, unittest
from xml.etree import ElementTree

PROGRAM, SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
BALL = os.path.join(SOURCE, "assets", "ball.3ds")


def cradle(*arguments, **options):
    return subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, timeout=300, **options)


def content(path):
    with open(path, "rb") as file:
        return file.read()


def scene(**changes):
    document = {"schema": "cradle-scene/1", "name": "test", "duration": 0.1,
                "output": {"framesPerSecond": 60, "width": 64, "height": 36},
                "bodies": [{"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "mass": 1}]}
    document.update(changes)
    return {key: value for key, value in document.items() if value is not None}


class InTemporaryFolder(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, content):
        mode = "wb" if isinstance(content, bytes) else "w"
        with open(self.path(name), mode) as file:
            file.write(json.dumps(content, indent=1) if isinstance(content, dict) else content)
        return self.path(name)

    def listing(self):
        return sorted(os.listdir(self.folder))

    def refuses(self, exit_code, words, *arguments, leaves=None):
        """The command ends with exit_code and one clear message that has the words in it; nothing new is left."""
        before = self.listing() if leaves is None else leaves
        result = cradle(*arguments)
        self.assertEqual(result.returncode, exit_code, result.stderr)
        for word in words:
            self.assertIn(word, result.stderr)
        self.assertEqual(self.listing(), before)
        return result


class Submitted(InTemporaryFolder):
    def submit(self, *words):
        return cradle("submit", *words)

    def script(self, name):
        with open(self.path(name), encoding="utf-8") as file:
            return file.read()

    def test_a_film_in_parts_is_that_of_the_command(self):
        film = scene(duration=2.1)
        path = self.write("it's.json", film)
        self.assertEqual(cradle("video", path, "-o", self.path("one.mp4")).returncode, 0)
        result = self.submit("local", "--run", "video", path, "-o", self.path("a film's.mp4"))
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertEqual(result.stdout.split("\n")[:4], ["simulate: 1 task", "render: 3 tasks", "check: 1 task", "encode: 1 task"])
        self.assertEqual(content(self.path("a film's.mp4")), content(self.path("one.mp4")))

    def test_jobs_go_on_where_they_were_and_others_begin_anew(self):
        path = self.write("a.json", scene(duration=0.2))
        jobs = lambda: self.submit("local", "--run", "render", path, "-o", self.path("frames"))
        self.assertEqual(jobs().returncode, 0)
        os.remove(self.path("frames/frame_000007.png"))
        stamps = [os.stat(self.path(name)).st_mtime_ns for name in ("frames/frame_000003.png", "frames.jobs/trajectory.sqlite")]
        self.assertEqual(jobs().returncode, 0)
        self.assertTrue(os.path.exists(self.path("frames/frame_000007.png")))
        self.assertEqual([os.stat(self.path(name)).st_mtime_ns for name in ("frames/frame_000003.png", "frames.jobs/trajectory.sqlite")],
                         stamps)
        self.write("a.json", scene(duration=0.1))
        shutil.rmtree(self.path("frames"))
        self.assertEqual(jobs().returncode, 0)
        self.assertNotEqual(os.stat(self.path("frames.jobs/trajectory.sqlite")).st_mtime_ns, stamps[1])
        self.assertEqual(len(os.listdir(self.path("frames"))), 6)

    def test_what_is_missing_is_named(self):
        path = self.write("a.json", scene(duration=0.2))
        self.submit("local", "--run", "render", path, "-o", self.path("frames"))
        os.remove(self.path("frames/frame_000007.png"))
        check = subprocess.run(["sh", self.path("frames.jobs/3_check.sh")], timeout=60)
        self.assertEqual(check.returncode, 5)
        self.assertIn("frame_000007.png is missing", self.script("frames.jobs/3_check_1.log"))
        self.write("a.json", scene(duration="long"))  # what fails ends the jobs, and is in the log
        os.remove(self.path("frames.jobs/trajectory.sqlite"))
        ended = subprocess.run(["sh", self.path("frames.jobs/run.sh")], capture_output=True, text=True, timeout=60)
        self.assertEqual(ended.returncode, 5)
        self.assertIn("simulate has not come to its end", ended.stderr)
        self.assertIn("/duration", self.script("frames.jobs/1_simulate_1.log"))

    def test_other_options_are_other_jobs(self):
        path = self.write("a.json", scene(duration=0.2))
        film = lambda size: self.submit("local", "--run", "video", path, "-o", self.path("a.mp4"), "--size", size)
        self.assertEqual(film("64x36").returncode, 0)
        first = content(self.path("a.mp4"))
        self.assertEqual(film("128x72").returncode, 0)
        self.assertNotEqual(content(self.path("a.mp4")), first)
        render = ("submit", "local", "--run", "render", path, "-o", self.path("frames"), "--size")
        self.assertEqual(cradle(*render, "64x36").returncode, 0)
        self.assertEqual(cradle(*render, "64x36").returncode, 0)
        self.refuses(5, ["frames", "holds pictures"], *render, "128x72")

    def test_passes_without_pictures_are_whole(self):
        path = self.write("a.json", scene(duration=0.1))
        for more in (("--passes", "depth,normal"), ("--passes", "depth", "--pass-format", "exr")):
            folder = self.path(more[1] + more[-1])
            result = self.submit("local", "--run", "render", path, "-o" + folder, *more)
            self.assertEqual(result.returncode, 0, result.stderr)

    def test_jobs_of_parallel_are_done_again_where_their_results_are_gone(self):
        bin = self.path("bin")  # runs each task, but those that its log has
        os.mkdir(bin)
        with open(os.path.join(bin, "parallel"), "w", encoding="utf-8") as file:
            file.write('#!/bin/sh\nfor log; do case $log in *.joblog.log) break;; esac; done\nfor call; do :; done\n'
                       'while read -r n; do grep -qx "$n" "$log" 2>/dev/null || '
                       '{ sh -c "$(echo "$call" | sed "s/{}/$n/")" && echo "$n" >> "$log"; } || exit 1; done\n')
        os.chmod(os.path.join(bin, "parallel"), 0o755)
        environment = {**os.environ, "PATH": bin + ":" + os.environ["PATH"], "SLURM_ARRAY_TASK_ID": "2"}  # as in another job
        path = self.write("a.json", scene(duration=2.1))
        run = lambda: cradle("submit", "parallel", "--run", "render", path, "-o", self.path("frames"), env=environment).returncode
        self.assertEqual(run(), 0)
        shutil.rmtree(self.path("frames"))
        self.assertEqual(run(), 5)  # what is missing is told, and made the next time
        self.assertEqual(run(), 0)
        self.assertEqual(len(os.listdir(self.path("frames"))), 126)

    def test_files_of_others_stay(self):
        path = self.write("a.json", scene())
        os.mkdir(self.path("f.jobs"))
        self.write("f.jobs/notes.log", "mine")
        self.refuses(5, ["notes.log"], "submit", "local", "render", path, "-o", self.path("f"))
        os.rename(self.path("f.jobs/notes.log"), self.path("f.jobs/trajectory.sqlite"))
        self.refuses(5, ["other origin"], "submit", "local", "render", path, "-o", self.path("f"))
        self.assertEqual(content(self.path("f.jobs/trajectory.sqlite")), b"mine")

    def test_slurm_has_arrays_that_wait_for_each_other(self):
        path = self.write("a.json", scene(duration=3))
        bin = self.path("bin")  # a cluster's commands, as far as they are used
        os.mkdir(bin)
        for name, text in (("scontrol", "echo 'MaxArraySize            = 3'"),
                           ("sbatch", 'n=$(cat n 2>/dev/null || echo 40); echo $((n + 1)) | tee n; echo "$@" >> calls')):
            with open(os.path.join(bin, name), "w", encoding="utf-8") as file:
                file.write(f"#!/bin/sh\n{text}\n")
            os.chmod(os.path.join(bin, name), 0o755)
        environment = {**os.environ, "PATH": bin + ":" + os.environ["PATH"]}
        result = cradle("submit", "slurm", "--run", "video", path, "-o", self.path("film.mp4"), env=environment)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertIn("#SBATCH --array=1-2\n", self.script("film.mp4.jobs/2_render.sh"))  # as the cluster allows
        calls = self.script("film.mp4.jobs/calls").splitlines()
        self.assertEqual([call.split()[-1] for call in calls], ["./1_simulate.sh", "./2_render.sh", "./3_check.sh", "./4_encode.sh"])
        self.assertNotIn("dependency", calls[0])
        for call, before in zip(calls[1:], (41, 42, 43)):
            self.assertIn(f"--dependency=afterok:{before} --kill-on-invalid-dep=yes", call)

    def test_samples_in_parts_are_those_of_the_command(self):
        path = self.write("drawn.json", scene(bodies=[Samples.GROUND, Samples.DROPPED]))
        cradle("sample", path, "-n", "5", "--seed", "7", "--simulate", "-o", self.path("one"))
        result = self.submit("local", "--run", "sample", path, "-n", "5", "--seed=7", "--simulate", "-o", self.path("many"))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(Samples.index(self, "many"), Samples.index(self, "one"))
        self.assertEqual(sorted(os.listdir(self.path("many.jobs"))), ["1_sample.sh", "1_sample_1.log", "2_check.sh", "2_check_1.log", "run.sh"])

    def test_what_cannot_be_submitted_is_told_before_anything_is_written(self):
        path = self.write("a.json", scene())
        self.refuses(2, ["slurm, parallel (GNU parallel) and local"], "submit", "condor", "render", path, "-o", self.path("f"))
        self.refuses(2, ["plan", "simulate, render, video, sample"], "submit", "local", "plan", path)
        self.refuses(2, ["before all options"], "submit", "local", "render", "-o", self.path("f"), path)
        self.refuses(2, ["--output is required"], "submit", "local", "render", path)
        self.refuses(2, ["--frames", "all pictures"], "submit", "local", "render", path, "--frames", "0:3", "-o", self.path("f"))
        self.refuses(3, ["/duration"], "submit", "local", "render", self.write("b.json", scene(duration=-1)), "-o", self.path("f"))
        for code, words, command in (
                (2, ["--bogus", "unknown option", "--size"], ("render", path, "--bogus", "-o", self.path("f"))),
                (2, ["--overlay"], ("render", path, "--overlay", "nonsense", "-o", self.path("f"))),
                (2, ["foo", "depth"], ("render", path, "--passes", "foo", "-o", self.path("f"))),
                (2, ["--size", "16384"], ("render", path, "--size", "0x0", "-o", self.path("f"))),
                (2, [".mp4"], ("video", path, "-o", self.path("f"))),
                (2, ["-o"], ("render", path, "-o", self.path("f"), "-o", self.path("g"))),
                (2, ["1 to 3"], ("sample", path, "-n", "3", "--chains", "4", "-o", self.path("f"))),
                (2, ["no values to draw"], ("sample", path, "-n", "3", "--chains", "2", "-o", self.path("f")))):
            self.refuses(code, words, "submit", "local", *command)
        help = self.submit("local", "render", "--help")
        self.assertEqual((help.returncode, help.stderr), (0, ""))
        self.assertIn("cradle render", help.stdout)
        self.assertFalse(os.path.exists(self.path("f.jobs")))


class Samples(InTemporaryFolder):
    DROPPED = {"name": "box", "shape": {"box": {"size": [0.2, 0.1, 0.3]}},
               "position": {"draw": {"uniform": [[-1, 0.5, -1], [1, 1, 1]]}}, "orientation": {"draw": "rotation"},
               "linearVelocity": [{"draw": {"normal": [0, 1]}}, 0, 0]}
    GROUND = {"name": "ground", "shape": {"plane": {}}, "motion": "static"}

    def drawn(self, **changes):
        return self.write("drawn.json", scene(**{"bodies": [self.GROUND, self.DROPPED], **changes}))

    def index(self, folder):
        return json.loads(content(os.path.join(self.path(folder), "index.json")))["samples"]

    def test_a_scene_with_draws_is_none_without_the_sampler(self):
        self.refuses(3, ["/bodies/1/position", "cradle sample"], "simulate", self.drawn(), "-o", self.path("a.sqlite"))

    def test_samples_are_ordinary_scenes_with_the_bits_of_their_trajectories(self):
        result = cradle("sample", self.drawn(), "-n", "3", "--seed", "5", "-o", self.path("set"), "--simulate", "-q")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        for sample in self.index("set"):
            folder = os.path.join(self.path("set"), sample["folder"])
            again = self.path("again.sqlite")
            self.assertEqual(cradle("simulate", os.path.join(folder, "scene.json"), "-o", again).returncode, 0)
            self.assertEqual(cradle("compare", os.path.join(folder, "trajectory.sqlite"), again).returncode, 0)
            database = sqlite3.connect(again)
            (state_hash,) = database.execute("select value from meta where key = 'stateHash'").fetchone()
            database.close()
            self.assertEqual(sample["stateHash"], state_hash)

    def test_shards_and_processes_give_the_samples_of_one_run(self):
        cradle("sample", self.drawn(), "-n", "5", "-o", self.path("one"), "--simulate")
        for shard in ("2/2", "1/2"):
            result = cradle("sample", self.drawn(), "-n", "5", "-o", self.path("parts"), "--simulate", "--shard", shard, "-j", "2")
            self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(self.index("one"), self.index("parts"))
        self.assertEqual([sample["sample"] for sample in self.index("one")], list(range(5)))

    def test_whole_samples_stay_and_unfinished_ones_are_made_again(self):
        arguments = ("sample", self.drawn(), "-o", self.path("set"), "--simulate", "-n")
        cradle(*arguments, "2")
        before = self.index("set")
        kept = os.path.join(self.path("set"), "sample_000000", "trajectory.sqlite")
        os.remove(os.path.join(self.path("set"), "sample_000001", "sample.json"))  # as a kill leaves it
        os.remove(os.path.join(self.path("set"), "sample_000001", "trajectory.sqlite"))
        stamp = os.stat(kept).st_mtime_ns
        cradle(*arguments, "3")
        self.assertEqual(self.index("set")[:2], before)
        self.assertEqual(os.stat(kept).st_mtime_ns, stamp)

    def test_a_sample_without_its_record_is_made_again_with_its_warnings(self):
        arguments = ("sample", self.drawn(method={"name": "explicitEuler", "timeStep": 0.05}), "-n", "1", "--simulate", "-qq",
                     "-o", self.path("set"))
        record = self.path("set/sample_000000/sample.json")
        cradle(*arguments)
        before = content(record)
        self.assertTrue(json.loads(before)["warnings"])
        os.remove(record)  # as a kill behind the trajectory leaves it
        cradle(*arguments)
        self.assertEqual(content(record), before)

    def test_whole_samples_are_not_replaced_by_others(self):
        arguments = ("sample", self.drawn(), "-o", self.path("set"), "-n", "2")
        cradle(*arguments, "--seed", "1", "--render", "--frames", "0:1", "--size", "64x36")
        before = content(self.path("set/sample_000001/scene.json"))
        self.refuses(5, ["sample_000000", "another scene or seed (1)"], *arguments, "--seed", "2")
        self.refuses(5, ["sample_000000", "size 64x36"], *arguments, "--render", "--frames", "0:1", "--size", "32x18")
        self.assertEqual(content(self.path("set/sample_000001/scene.json")), before)

    def wished(self, **changes):
        """A box that falls and is wished to end on a face that it falls on in 1 of 6 samples."""
        wish = {"body": "box", "up": [1, 0, 0], "deviation": 0.5}
        return self.drawn(**{"duration": 1.2, "accuracy": "visual", "wishes": [wish], **changes})

    def test_samples_tell_how_many_meet_the_wishes(self):
        arguments = ("sample", self.wished(), "-n", "30", "-q", "-o")
        simulated, told = cradle(*arguments, self.path("a"), "--simulate"), cradle(*arguments, self.path("b"))
        wishes = [sample["wishes"] for sample in self.index("a")]
        met = sum(outcomes[0]["met"] for outcomes in wishes)
        self.assertIn(met, range(1, 30))
        self.assertEqual(told.stdout, f"{met} of 30 samples meet all wishes\n")
        self.assertEqual(simulated.stdout, told.stdout)
        self.assertEqual([sample["wishes"] for sample in self.index("b")], wishes)

    def test_chains_meet_wishes_more_often_and_go_on_with_the_same_bits(self):
        arguments = ("sample", self.wished(), "-n", "180", "--chains", "3", "-q", "-o")
        result = cradle(*arguments, self.path("whole"), "--simulate")
        self.assertEqual(result.returncode, 0, result.stderr)
        whole = self.index("whole")
        self.assertGreater(sum(sample["wishes"][0]["met"] for sample in whole), 90)  # of 180; 30 without chains
        for sample in whole:
            folder = self.path(os.path.join("whole", sample["folder"]))
            self.assertEqual(os.path.exists(os.path.join(folder, "trajectory.sqlite")), sample["chain"]["accepted"])
            self.assertEqual(sample["stateHash"], whole[sample["chain"]["sameAs"]]["stateHash"])
        cradle(*arguments, self.path("parts"), "--shard", "1/2", "-j", "2")
        for number in range(20, 60):  # as a kill leaves the first chain
            shutil.rmtree(self.path(f"parts/sample_{number:06}"))
        for shard in ("1/2", "2/2"):
            self.assertEqual(cradle(*arguments, self.path("parts"), "--shard", shard).returncode, 0)
        keys = ("sample", "sceneHash", "draws", "wishes", "chain")
        self.assertEqual([[sample[key] for key in keys] for sample in self.index("parts")],
                         [[sample[key] for key in keys] for sample in whole])
        self.refuses(5, ["sample_000060", "another number of samples or chains"], "sample", self.wished(), "-n", "180", "--chains",
                     "2", "-o", self.path("parts"))
        self.refuses(5, ["sample_000000", "is of another chain"], "sample", self.wished(), "-n", "180", "-o", self.path("parts"))

    def bumpy(self, **changes):
        """Nothing is drawn but bumps: a ball that bounces is wished to go aside, which it does in 1 of 10 samples."""
        ball = {"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "position": [0, 1, 0], "material": "rubber"}
        rubber = {"rubber": {"restitution": 0.8, "staticFriction": 0, "dynamicFriction": 0}}
        wish = {"body": "ball", "inside": {"min": [0.5, -9, -9], "max": [9, 9, 9]}, "deviation": 0.1}
        return self.drawn(**{"bodies": [{**self.GROUND, "material": "rubber"}, ball], "materials": rubber, "duration": 2,
                             "bumps": {"deviationDegrees": 5}, "wishes": [wish], **changes})

    def test_samples_have_bumps_of_their_own(self):
        cradle("sample", self.bumpy(), "-n", "4", "--simulate", "-q", "-o", self.path("set"))
        samples = self.index("set")
        self.assertEqual(len({sample["stateHash"] for sample in samples}), 4)
        for sample in samples:
            drawn = json.loads(content(self.path(f"set/{sample['folder']}/scene.json")))
            self.assertEqual(drawn["bumps"]["seed"], sample["draws"]["/bumps/seed"])
        given = self.bumpy(bumps={"deviationDegrees": 5, "seed": 3})
        cradle("sample", given, "-n", "2", "--simulate", "-q", "-o", self.path("given"))
        self.assertEqual(len({sample["stateHash"] for sample in self.index("given")}), 1)

    def test_chains_change_bumps_and_go_on_with_the_same_bits(self):
        arguments = ("sample", self.bumpy(), "-n", "120", "--chains", "2", "--simulate", "-q", "-o")
        for folder in ("whole", "parts"):
            result = cradle(*arguments, self.path(folder))
            self.assertEqual(result.returncode, 0, result.stderr)
        whole = self.index("whole")
        self.assertGreater(sum(sample["wishes"][0]["met"] for sample in whole), 40)
        changed = [sample["folder"] for sample in whole
                   if "changes" in json.loads(content(self.path(f"whole/{sample['folder']}/scene.json")))["bumps"]]
        self.assertGreater(len(changed), 40)
        again = self.path("again.sqlite")
        last = max(folder for folder in changed if os.path.exists(self.path(f"whole/{folder}/trajectory.sqlite")))
        self.assertEqual(cradle("simulate", self.path(f"whole/{last}/scene.json"), "-o", again).returncode, 0)
        self.assertEqual(cradle("compare", self.path(f"whole/{last}/trajectory.sqlite"), again).returncode, 0)
        for number in range(30, 60):
            shutil.rmtree(self.path(f"parts/sample_{number:06}"))
        self.assertEqual(cradle(*arguments, self.path("parts")).returncode, 0)
        self.assertEqual(self.index("parts"), whole)

    def test_samples_and_their_trajectories_have_the_horizon_of_their_motion(self):
        arguments = ("sample", self.wished(), "-n", "2", "-q", "-o", self.path("set"))
        cradle(*arguments, "--simulate")
        self.assertNotIn("horizon", self.index("set")[0])
        self.assertEqual(cradle(*arguments, "--check-accuracy").returncode, 0)
        for sample in self.index("set"):
            database = sqlite3.connect(self.path(f"set/{sample['folder']}/trajectory.sqlite"))
            (horizon,) = database.execute("select value from meta where key = 'horizon'").fetchone()
            database.close()
            self.assertEqual(str(sample["horizon"]), horizon)
            self.assertTrue(horizon == "none" or 0 < int(horizon) <= 72)

    def test_motions_that_cannot_be_meet_no_wish(self):
        unstable = {"bodies": [self.GROUND, {**self.DROPPED, "angularVelocity": [0, 0, {"draw": {"uniform": [1, 2]}}]}],
                    "method": {"name": "explicitEuler", "timeStep": 0.1},
                    "springs": [{"bodyA": "box", "anchorB": [0, 9, 0], "stiffness": 1e9, "restLength": 1}], "duration": 2}
        path = self.wished(**unstable)
        self.assertEqual(cradle("sample", path, "-n", "4", "-o", self.path("a")).stdout, "0 of 4 samples meet all wishes\n")
        result = cradle("sample", path, "-n", "4", "-o", self.path("b"), "--simulate")
        self.assertEqual((result.returncode, result.stdout), (7, "0 of 4 samples meet all wishes\n"))
        chain = cradle("sample", path, "-n", "6", "--chains", "2", "-o", self.path("c"), "--simulate")
        self.assertEqual(chain.returncode, 7)
        self.assertEqual([line.split()[2:] for line in chain.stdout.splitlines()[1:]], [["0.0", "%", "3.0", "1.0", "0"]] * 2)
        self.assertTrue(all("failure" in sample for sample in self.index("c")))

    def test_samples_are_packed_once(self):
        arguments = ("sample", self.drawn(), "-n", "4", "--format", "tar", "-o", self.path("set"))
        for shard in ("1/2", "2/2"):
            cradle(*arguments, "--shard", shard)
        for shard in ("1/3", "1/1"):
            self.refuses(5, ["_of_2.tar", "other parts"], *arguments, "--shard", shard)
        self.refuses(5, ["samples_1_of_2.tar", "holds these samples"], *arguments, "--shard", "1/2")
        self.assertEqual([sample["tar"] for sample in self.index("set")], ["samples_1_of_2.tar"] * 2 + ["samples_2_of_2.tar"] * 2)

    def test_a_run_that_was_ended_behind_its_tar_file_goes_on(self):
        arguments = ("sample", self.drawn(), "-n", "2", "-o", self.path("set"))
        cradle(*arguments)
        folders = [os.path.join(self.path("set"), sample["folder"]) for sample in self.index("set")]
        for folder in folders:
            shutil.copytree(folder, self.path("kept_" + os.path.basename(folder)))
        cradle(*arguments, "--format", "tar")
        packed = content(self.path("set/samples.tar"))
        for folder in folders:
            shutil.move(self.path("kept_" + os.path.basename(folder)), folder)
        os.remove(self.path("set/index.json"))
        result = cradle(*arguments, "--format", "tar")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(content(self.path("set/samples.tar")), packed)
        self.assertEqual([sample["tar"] for sample in self.index("set")], ["samples.tar"] * 2)
        self.assertEqual(sorted(os.listdir(self.path("set"))), ["index.json", "samples.tar"])

    def test_what_was_known_of_a_sample_stays_known(self):
        arguments = ("sample", self.drawn(), "-n", "1", "-o", self.path("set"), "--size", "64x36")
        cradle(*arguments, "--render")
        cradle(*arguments, "--check-accuracy")
        (sample,) = self.index("set")
        self.assertIn("horizon", sample)
        self.refuses(5, [sample["pictures"]], *arguments, "--passes", "depth")

    def test_chains_need_wishes_and_draws(self):
        self.refuses(2, ["no wishes"], "sample", self.drawn(), "-n", "9", "--chains", "3", "-o", self.path("a"))
        self.refuses(2, ["no values to draw"], "sample", self.write("plain.json", scene()), "-n", "9", "--chains", "3",
                     "-o", self.path("a"))
        self.refuses(2, ["--chains", "1 to 9"], "sample", self.wished(), "-n", "9", "--chains", "10", "-o", self.path("a"))

    def test_pictures_of_an_ended_run_with_other_options_do_not_stay(self):
        arguments = ("sample", self.drawn(), "-o", self.path("set"), "--render", "--frames")
        cradle(*arguments, "0:3")
        (before,) = self.index("set")
        os.remove(self.path("set/sample_000000/sample.json"))  # as a kill leaves it
        self.assertEqual(cradle(*arguments, "0:1", "--size", "32x18").returncode, 0)
        self.assertEqual([name for name in os.listdir(self.path("set/sample_000000")) if name.startswith("frame")], ["frame_000000.png"])
        (after,) = self.index("set")
        self.assertEqual(after["stateHash"], before["stateHash"])

    def test_a_killed_data_set_goes_on_with_the_same_bits_and_leaves_no_process(self):
        arguments = ("sample", self.drawn(), "-n", "6", "--render", "--frames", "0:4", "-o")
        self.assertEqual(cradle(*arguments, self.path("one")).returncode, 0)
        with subprocess.Popen([PROGRAM, *arguments, self.path("set"), "-j", "2"], stderr=subprocess.PIPE) as run:
            while not os.path.exists(self.path("set/sample_000001")):
                time.sleep(0.01)
            run.kill()
            run.stderr.read()  # ends when its processes have
        self.assertFalse(os.path.exists(self.path("set/index.json")))
        self.assertEqual(cradle(*arguments, self.path("set"), "-j", "2").returncode, 0)
        self.assertEqual(self.index("set"), self.index("one"))
        for number in range(6):
            for frame in range(4):
                name = f"sample_{number:06}/frame_{frame:06}.png"
                self.assertEqual(content(self.path("set/" + name)), content(self.path("one/" + name)))

    def test_pictures_and_passes_of_samples_verify(self):
        result = cradle("sample", self.drawn(), "-o", self.path("set"), "--passes", "all", "--frames", "0:2")
        self.assertEqual(result.returncode, 0, result.stderr)
        folder = os.path.join(self.path("set"), "sample_000000")
        self.assertIn("frame_000001.png", os.listdir(folder))
        self.assertEqual(cradle("verify", folder).returncode, 0)

    def test_tar_files_have_frames_of_one_key_together(self):
        import tarfile
        for name in ("set", "again"):
            result = cradle("sample", self.drawn(), "-n", "2", "-o", self.path(name), "--passes", "rgb,depth", "--frames", "0:2", "--format", "tar")
            self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(sorted(os.listdir(self.path("set"))), ["index.json", "samples.tar"])
        self.assertEqual([sample["tar"] for sample in self.index("set")], ["samples.tar"] * 2)
        with tarfile.open(self.path("set/samples.tar")) as tar, tarfile.open(self.path("again/samples.tar")) as again:
            names = tar.getnames()
            self.assertEqual(again.getnames(), names)
            for name in names:
                if not name.endswith(".sqlite"):  # which tells its CPU time
                    self.assertEqual(tar.extractfile(name).read(), again.extractfile(name).read(), name)
        self.assertIn("sample_000001_000000.rgb.png", names)
        self.assertIn("sample_000001_000001.depth.npy", names)
        self.assertIn("sample_000000.scene.json", names)
        keys = [name.split(".")[0] for name in names]
        self.assertEqual(len(set(keys)), sum(a != b for a, b in zip(keys, [None, *keys])))  # each stands in one place
        self.refuses(5, ["samples.tar"], "sample", self.drawn(), "-n", "2", "-o", self.path("set"), "--format", "tar")

    def test_a_sample_that_becomes_unstable_costs_none_of_the_others(self):
        stiff = {"bodies": [{"name": "bob", "shape": {"sphere": {"radius": 0.1}}, "mass": 1}], "duration": 2,
                 "method": {"name": "explicitEuler", "timeStep": 0.01},
                 "springs": [{"bodyA": "bob", "anchorB": [0, 1, 0], "restLength": 0.5,
                              "stiffness": {"draw": {"choice": [1, 1e8]}}}]}
        result = cradle("sample", self.drawn(**stiff), "-n", "8", "-o", self.path("set"), "--simulate")
        self.assertEqual(result.returncode, 7, result.stderr)
        samples = self.index("set")
        self.assertEqual(len(samples), 8)
        for sample in samples:
            self.assertEqual("failure" in sample, sample["draws"]["/springs/0/stiffness"] == 1e8)
            self.assertEqual("stateHash" in sample, sample["draws"]["/springs/0/stiffness"] == 1)

    def test_others_files_and_numbers_out_of_range_are_refused(self):
        path = self.drawn()
        os.mkdir(self.path("theirs"))
        self.write("theirs/notes.txt", "theirs")
        self.refuses(5, ["notes.txt"], "sample", path, "-o", self.path("theirs"))
        self.refuses(2, ["-n", "1 to 1000000"], "sample", path, "-n", "0", "-o", self.path("set"))
        self.refuses(2, ["--shard", "PART/PARTS"], "sample", path, "--shard", "3/2", "-o", self.path("set"))
        self.refuses(2, ["--format", "folder and tar"], "sample", path, "--format", "zip", "-o", self.path("set"))
        self.refuses(2, ["-j"], "sample", path, "-j", "0", "-o", self.path("set"))


class Usage(InTemporaryFolder):
    def test_help_of_every_command_has_an_example(self):
        for command in ("simulate", "render", "verify", "encode", "video", "inspect", "check", "compare", "export", "plot", "study", "stability", "sample"):
            result = cradle(command, "--help")
            self.assertEqual(result.returncode, 0)
            self.assertIn("Example:\n  cradle " + command, result.stdout)

    def test_version_is_said(self):
        self.assertRegex(cradle("--version").stdout, r"^cradle \d+\.\d+\.\d+\n$")

    def test_wrong_usage_ends_with_2(self):
        for arguments in ((), ("fly",), ("simulate",), ("simulate", "a.json"), ("simulate", "a.json", "-o", "b", "--fast"),
                          ("inspect", BALL, "--scale", "x")):
            self.assertEqual(cradle(*arguments).returncode, 2, arguments)

    def test_a_command_that_is_none_is_named(self):
        self.refuses(2, ["simulat: is no command", 'did you mean "simulate"?'], "simulat", "a.json", "-o", "a.sqlite")
        self.refuses(2, ["is required"], "simulate", "a.json")

    def test_options_come_in_any_order(self):
        path = self.write("s.json", scene())
        self.assertEqual(cradle("simulate", "-o", self.path("a.sqlite"), "--quiet", path).returncode, 0)
        self.assertEqual(cradle("--quiet", "simulate", path, "-o", self.path("b.sqlite")).returncode, 0)

    def test_bad_overrides_are_named(self):
        path = self.write("s.json", scene())
        for option, value in (("--accuracy", "1"), ("--accuracy", "fine"), ("--accuracy", "1e-6x"), ("--duration", "-1"), ("--duration", "nan"), ("--method", "euler")):
            self.refuses(2, [option, value], "simulate", path, "-o", self.path("x.sqlite"), option, value)
        self.refuses(2, ["--time-step", "--method"], "simulate", path, "-o", self.path("x.sqlite"), "--time-step", "0.1")
        self.refuses(2, ["--duration", "6000000000 frames", "1000000000"], "simulate", path, "-o", self.path("x.sqlite"), "--duration", "1e8")
        self.refuses(2, ["--time-step", "1e+11 steps", "1e+10"], "simulate", path, "-o", self.path("x.sqlite"), "--method", "rk4",
                     "--time-step", "1e-12")

    def test_accuracies_have_names(self):
        path = self.write("s.json", scene())
        for name, number in (("visual", "0.001"), ("default", "1e-06"), ("reference", "1e-10")):
            self.assertIn(f"accuracy {number} asked", cradle("plan", path, "--accuracy", name).stdout)


class Scenes(InTemporaryFolder):
    def test_every_fault_is_told_with_its_place(self):
        text = '{"schema": "cradle-scene/1", "name": "t", "duration": -1,\n "bodys": []}'
        result = self.refuses(3, [":1:55 /duration: ", ":2:2 /bodys: ", "bodies"], "simulate", self.write("s.json", text), "-o",
                              self.path("x.sqlite"), leaves=["s.json"])
        self.assertGreaterEqual(len(result.stderr.splitlines()), 2)

    def test_broken_texts_end_with_3(self):
        for text in ("", "[", "[" * 100000, '{"a": 1, "a": 2}', "nonsense", '{"duration": 1e999}', '{"duration": NaN}'):
            path = self.write("s.json", text)
            self.refuses(3, ["s.json:"], "check", path)

    def test_sizes_out_of_range_end_with_3(self):
        path = self.write("s.json", scene(output={"width": 1000000000, "height": 2}))
        self.refuses(3, ["/output/width"], "simulate", path, "-o", self.path("x.sqlite"))

    def test_a_plan_says_what_was_chosen_and_what_was_left_out(self):
        path = self.write("s.json", scene(accuracy=1e-8))
        result = cradle("plan", path)
        self.assertEqual(result.returncode, 0)
        for text in ("1e-08", "closed form", "parabola", "left out"):
            self.assertIn(text, result.stdout)
        self.assertIn("RK4, step 0.01 s", cradle("plan", path, "--method", "rk4", "--time-step", "0.01").stdout)

    def test_bodies_that_overlap_at_the_start_are_refused_with_depth_and_leave_nothing(self):
        ball = {"shape": {"sphere": {"radius": 0.1}}, "mass": 1}
        ground = {"name": "ground", "shape": {"plane": {}}, "motion": "static", "position": [0, -0.03, 0]}
        path = self.write("s.json", scene(bodies=[{"name": "a", **ball}, {"name": "b", "position": [0.13, 0, 0], **ball}, ground]))
        words = ["s.json:", "/bodies/1: ", '"a" and "b" overlap by 70 mm', '"a" is 70 mm deep in the plane "ground"']
        self.refuses(3, words, "simulate", path, "-o", self.path("x.sqlite"))
        self.refuses(3, words, "check", path)

    def test_what_is_in_order_is_counted(self):
        rods = [{"bodyA": "ball", "anchorA": [0, 0, 0], "anchorB": [0, y, 0]} for y in (1, 2)]
        result = cradle("check", self.write("s.json", scene(rods=rods, ropes=rods[:1])))
        self.assertIn("1 body (1 dynamic), 2 rods, 1 rope;", result.stdout)

    def test_driven_bodies_are_counted(self):
        hand = {"name": "hand", "shape": {"sphere": {"radius": 0.1}}, "motion": "driven", "linearVelocity": [1, 0, 0], "position": [0, 5, 0]}
        ball = {"name": "ball", "shape": {"sphere": {"radius": 0.1}}}
        path = self.write("s.json", scene(bodies=[hand, ball]))
        self.assertIn("2 bodies (1 dynamic, 1 driven);", cradle("check", path).stdout)
        self.assertIn("2 bodies in 1 island, 1 driven\n", cradle("plan", path).stdout)
        plan = json.loads(cradle("plan", path, "--json").stdout)
        self.assertEqual((plan["bodies"], plan["fixed"], plan["driven"]), (2, 0, 1))

    def test_a_ray_that_misses_is_warned_about_even_if_quiet(self):
        push = {"body": "ball", "ray": {"origin": [0, 9, 5], "direction": [0, 0, -1]}, "force": [0, 0, -3], "start": 0.05, "duration": 0.02}
        result = cradle("simulate", self.write("s.json", scene(pushes=[push])), "-o", self.path("x.sqlite"), "--quiet")
        self.assertEqual(result.returncode, 0)
        self.assertRegex(result.stderr, r'^warning: .*s\.json:\d+:\d+ /pushes/0: the ray misses "ball" at 0\.05 s.*\n$')

    def test_warnings_are_silenced_by_quiet_given_twice(self):
        fall = [{"name": "floor", "shape": {"box": {"size": [9, 1, 9]}}, "motion": "static", "position": [0, -0.5, 0]}]
        fall += [{"name": f"box{i}", "shape": {"box": {"size": [0.3, 0.1, 0.3]}}, "position": [0, 0.06 + 0.11 * i, 0]} for i in range(6)]
        missed = {"body": "box0", "ray": {"origin": [0, 9, 5], "direction": [0, 0, -1]}, "force": [0, 0, -3], "start": 0.05, "duration": 0.02}
        path, target = self.write("s.json", scene(bodies=fall, pushes=[missed], accuracy="visual")), self.path("x.sqlite")
        self.assertIn("warning: ", cradle("simulate", path, "-o", target, "-q").stderr)
        for words in (["-qq"], ["-q", "-q"], ["--quiet", "--quiet"]):
            result = cradle("simulate", path, "-o", target, *words)
            self.assertEqual((result.returncode, result.stderr), (0, ""), words)
            result = cradle(*words, "render", path, "-o", self.path("f"), "--frames", "0:5", "--size", "32x32", "--overwrite")
            self.assertEqual((result.returncode, result.stderr), (0, ""), words)
        self.assertIn("no such file", cradle("simulate", self.path("none.json"), "-o", target, "-qq").stderr)

    def test_words_that_cannot_be_shown_are_told_with_their_place(self):
        captions = [{"text": "fine"}, {"text": "not \u6f22"}]
        path = self.write("s.json", scene(captions=captions, titleCard={"title": "Title", "subtitle": "\U0001f680"}))
        for command in (["check", path], ["simulate", path, "-o", self.path("x.sqlite")], ["video", path, "-o", self.path("x.mp4")]):
            result = self.refuses(3, ["/captions/1/text: found the character \"\u6f22\" (U+6F22)", "/titleCard/subtitle: found the character"], *command)
            self.assertRegex(result.stderr, r"s\.json:\d+:\d+ /captions/1/text")
        many = self.write("m.json", scene(captions=[{"text": f"caption {i}"} for i in range(40)]))
        self.refuses(3, ["captions are shown at 0 s", "allowed is the height that there is"], "check", many)
        wide = self.write("w.json", scene(captions=[{"text": "w" * 250}], output={"width": 640, "height": 360}))
        self.assertEqual(cradle("check", wide).returncode, 0)
        self.refuses(3, ["of a picture of 30x360"], "render", wide, "-o", self.path("f"), "--size", "30x360")

    def test_links_and_planes_that_cannot_be_are_told_with_their_place(self):
        rope = {"bodyA": "ball", "anchorA": [0, 0, 0], "anchorB": [0, 2, 0], "maxLength": 1.5}
        self.refuses(3, ["/ropes/0/maxLength: ", "1.5 m", "2 m apart"], "check", self.write("s.json", scene(ropes=[rope])))
        model = {"name": "model", "shape": {"mesh": BALL}}
        rope = {"bodyA": "model", "anchorA": {"vertex": 100000}, "anchorB": [0, 9, 0]}
        self.refuses(3, ["/ropes/0/anchorA: ", "100000", "allowed is a whole number in 0.."], "check",
                     self.write("s.json", scene(bodies=[model], ropes=[rope])))
        self.refuses(3, ["/bodies/0: ", "plane", "static"], "check",
                     self.write("s.json", scene(bodies=[{"name": "p", "shape": {"plane": {}}}])))

    def test_missing_scene_is_named(self):
        self.refuses(3, ["nowhere.json"], "simulate", self.path("nowhere.json"), "-o", self.path("x.sqlite"))


class Meshes(InTemporaryFolder):
    def check_mesh(self, name, content, words):
        self.write(name, content)
        body = {"name": "b", "shape": {"mesh": name}}
        path = self.write("s.json", scene(bodies=[body]))
        return self.refuses(4, [name, *words], "simulate", path, "-o", self.path("x.sqlite"))

    def test_unusable_files_end_with_4(self):
        ball = content(BALL)
        self.check_mesh("empty.3ds", b"", [])
        self.check_mesh("cut.3ds", ball[:len(ball) // 2], [])
        self.check_mesh("noise.3ds", bytes(range(256)) * 20, [])
        self.refuses(4, ["nowhere.3ds"], "inspect", self.path("nowhere.3ds"))

    def test_open_flat_and_single_polygons_say_what_is_open(self):
        self.check_mesh("single.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", ["open"])
        corners = "".join(f"v {x} {y} {z}\n" for x in (0, 1) for y in (0, 1) for z in (0, 1))
        faces = ["1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3"]
        self.check_mesh("missing_face.obj", corners + "".join(f"f {f}\n" for f in faces), ["4", "open"])
        flat = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 3 2\n"
        self.check_mesh("flat.obj", flat, ["volume"])

    def test_check_says_what_bodies_there_are(self):
        ball = {"shape": {"sphere": {"radius": 0.1}}, "mass": 2, "copies": {"count": [3, 1, 1]}}
        path = self.write("s.json", scene(bodies=[
            {"name": "ground", "shape": {"plane": {}}, "motion": "static"}, {"name": "ball", **ball, "position": [0, 1, 0]},
            {"name": "lid", "shape": {"box": {"size": [1, 0.02, 0.5]}}, "mass": 7, "position": [0, 5, 0]}]))
        self.assertEqual(cradle("check", path).stdout.splitlines()[1:], [
            "  ground: plane, static", "  ball_0 and 2 more, each: sphere, 0.2 m, 2 kg",
            "  lid: box, 1 x 0.02 x 0.5 m, 7 kg"])

    def test_scene_faults_win_over_mesh_faults(self):
        path = self.write("s.json", scene(duration=0, bodies=[{"name": "b", "shape": {"mesh": "nowhere.3ds"}}]))
        self.refuses(3, ["/duration"], "check", path)

    def test_inspect_prints_the_contracted_json(self):
        result = cradle("inspect", BALL, "--json", "--scale", "0.5")
        self.assertEqual(result.returncode, 0, result.stderr)
        (ball,) = json.loads(result.stdout)["objects"]
        self.assertEqual(list(ball), ["name", "vertices", "triangles", "solid", "problems", "volume", "centerOfMass",
                                      "inertiaTensor", "shape", "size"])
        self.assertEqual((ball["solid"], ball["shape"], ball["problems"]), (True, "sphere", []))
        self.assertAlmostEqual(ball["volume"], 4 / 3 * 3.14159265 * 0.125, delta=0.005 * 0.5236)  # facets cut below 0.5 %
        self.assertEqual([round(edge, 6) for edge in ball["size"]], [1, 1, 1])


class Trajectories(InTemporaryFolder):
    def test_a_file_of_another_kind_is_not_replaced(self):
        path = self.write("s.json", scene())
        self.refuses(5, ["s.json: ", "no trajectory"], "simulate", path, "-o", path)
        with open(path) as file:
            self.assertEqual(json.load(file), scene())
        others = self.path("others.sqlite")
        database = sqlite3.connect(others)
        database.executescript("CREATE TABLE thesis (chapter TEXT); INSERT INTO thesis VALUES ('one');")
        database.close()
        self.refuses(5, ["others.sqlite: ", "no trajectory"], "simulate", path, "-o", others)
        self.assertEqual(sqlite3.connect(others).execute("SELECT chapter FROM thesis").fetchall(), [("one",)])
        for _ in range(2):
            self.assertEqual(cradle("simulate", path, "-o", self.path("a.sqlite")).returncode, 0)

    def simulate(self, name, *options, **changes):
        path = self.write(name + ".json", scene(**changes))
        result = cradle("simulate", path, "-o", self.path(name + ".sqlite"), *options)
        self.assertEqual(result.returncode, 0, result.stderr)
        return self.path(name + ".sqlite")

    def test_frames_are_0_to_n_and_free_fall_is_right(self):
        database = sqlite3.connect(self.simulate("fall", "--method", "rk4", "--time-step", "0.01", duration=0.5))
        frames = database.execute("select id, time from frame order by id").fetchall()
        self.assertEqual(len(frames), 31)
        self.assertEqual(frames[30], (30, 0.5))
        (height,) = database.execute("select py from state where frame = 30").fetchone()
        self.assertAlmostEqual(height, -9.81 * 0.25 / 2, delta=1e-13)
        keys = {key for key, in database.execute("select key from meta")}
        self.assertLessEqual({"scene", "sceneHash", "scenePath", "version", "plan", "accuracy", "method", "cpuSeconds",
                              "evaluations", "stateHash"}, keys)

    def test_equal_runs_compare_equal_and_different_ones_exit_9(self):
        a, b = self.simulate("a"), self.simulate("b")
        c = self.simulate("c", bodies=[{"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "mass": 1, "position": [0, 0, 0.01]}])
        self.assertEqual(cradle("compare", a, b).returncode, 0)
        self.assertEqual(cradle("compare", a, c).returncode, 9)
        self.assertEqual(cradle("compare", a, c, "--tolerance", "0.02").returncode, 0)

    def test_accuracy_is_checked_for_every_body(self):
        run = cradle("simulate", self.write("a.json", scene()), "-o", self.path("a.sqlite"), "--check-accuracy")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("Checked by a run at accuracy 1e-08", run.stdout)
        self.assertIn("not chaotic", run.stdout)

    def test_a_duration_a_little_short_of_its_last_frame_ends_with_that_frame(self):
        ball = {"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "mass": 1, "position": [0, 1, 0]}
        spring = {"bodyA": "ball", "anchorB": [0, 2, 0], "stiffness": 100}
        short = self.write("short.json", scene(duration=0.16666666666, bodies=[ball], springs=[spring]))
        run = cradle("simulate", short, "-o", self.path("short.sqlite"), "--check-accuracy")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(cradle("export", self.path("short.sqlite"), "-o", self.path("short.csv")).returncode, 0)
        with open(self.path("short.csv")) as table:
            rows = list(csv.DictReader(table))
        self.assertEqual(len(rows), 11)
        self.assertEqual(float(rows[-1]["time_s"]), 0.16666666666)
        self.assertEqual(cradle("export", self.path("short.sqlite"), "-o", self.path("short.glb")).returncode, 0)
        film = cradle("video", short, "-o", self.path("short.mp4"))
        self.assertEqual(film.returncode, 0, film.stderr)

    def test_export_writes_a_row_for_every_frame_and_body(self):
        trajectory = self.simulate("a")
        self.assertEqual(cradle("export", trajectory, "-o", self.path("a.csv")).returncode, 0)
        with open(self.path("a.csv")) as table:
            self.assertEqual(len(list(csv.DictReader(table))), 7)
        self.assertEqual(cradle("export", trajectory, "-o", self.path("a.xyz")).returncode, 2)

    def test_outputs_that_cannot_be_written_end_with_5(self):
        path = self.write("s.json", scene())
        self.refuses(5, ["/dev/full"], "simulate", path, "-o", "/dev/full")
        self.refuses(5, [self.folder], "simulate", path, "-o", self.folder)
        self.refuses(5, ["nowhere"], "simulate", path, "-o", self.path("nowhere/x.sqlite"))
        self.refuses(5, ["/dev/full"], "video", path, "-o", "/dev/full")

    def test_a_too_stiff_spring_ends_with_7_and_keeps_the_part(self):
        spring = {"name": "stiff", "bodyA": "ball", "anchorA": [0, 0.1, 0], "anchorB": [0, 1, 0], "stiffness": 1e7, "restLength": 0.5}
        path = self.write("s.json", scene(springs=[spring], duration=2, method={"name": "rk4"}))
        checked = cradle("check", path)  # the warning comes before the run
        self.assertEqual(checked.returncode, 0)
        self.assertIn('warning: ' + path + ': spring "stiff" has step x omega', checked.stderr)
        self.refuses(7, ["warning: ", "unstable at", '"ball"', '"stiff"', "step x omega", "is safe", "x.sqlite.part"], "simulate", path, "-o",
                     self.path("x.sqlite"), leaves=["s.json", "x.sqlite.part"])
        database = sqlite3.connect(self.path("x.sqlite.part"))
        self.assertGreaterEqual(database.execute("select count(*) from frame").fetchone()[0], 1)

    def test_a_failure_can_be_kept_whole_and_filmed(self):
        spring = {"name": "stiff", "bodyA": "ball", "anchorA": [0, 0.1, 0], "anchorB": [0, 1, 0], "stiffness": 1e5, "restLength": 0.5}
        path = self.write("s.json", scene(springs=[spring], duration=20, method={"name": "explicitEuler"},
                                          camera={"position": [0, 0, 5], "target": [0, 0, 0]}))
        run = self.path("x.sqlite")
        result = cradle("simulate", path, "-o", run, "--until-it-fails")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("unstable at", result.stderr)
        self.assertIn("x.sqlite has the frames up to then, whole", result.stderr)
        self.assertEqual(sorted(os.listdir(self.folder)), ["s.json", "x.sqlite"])
        database = sqlite3.connect(run)
        frames = database.execute("select count(*) from frame").fetchone()[0]
        self.assertGreaterEqual(frames, 2)
        self.assertIn("the run failed", database.execute("select value from meta where key = 'promise'").fetchone()[0])
        drawn = cradle("render", run, "-o", self.path("f"), "--size", "64x48")
        self.assertEqual(drawn.returncode, 0, drawn.stderr)
        self.assertGreaterEqual(len(os.listdir(self.path("f"))), frames - 1)
        self.refuses(2, ["--strict", "--until-it-fails"], "simulate", path, "-o", self.path("y.sqlite"), "--strict",
                     "--until-it-fails", leaves=["f", "s.json", "x.sqlite"])

    def test_small_holes_are_filled_for_what_needs_a_volume(self):
        """A fine grid over a box, one square of its top left out: a body of 1 m^3, and a vessel with an opening."""
        n, vertices, faces = 30, {}, []
        number = lambda point: vertices.setdefault(point, len(vertices) + 1)
        for axis in range(3):
            for side in (0, n):
                for i in range(n):
                    for j in range(n):
                        if (axis, side, i, j) == (1, n, 15, 15):
                            continue
                        place = lambda u, v: tuple(side if k == axis else (u if k == (axis + 1) % 3 else v) for k in range(3))
                        corners = [number(place(i, j)), number(place(i + 1, j)), number(place(i + 1, j + 1)), number(place(i, j + 1))]
                        faces.append(corners if side else corners[::-1])
        self.write("box.obj", "".join("v %r %r %r\n" % tuple(c / n for c in point) for point in vertices) +
                   "".join("f %d %d %d %d\n" % tuple(face) for face in faces))
        body = {"name": "box", "shape": {"mesh": "box.obj"}, "position": [0, 5, 0]}
        path = self.write("s.json", scene(bodies=[body, {**body, "name": "vessel", "motion": "static", "position": [3, 0, 0]}]))
        run = self.path("run.sqlite")
        result = cradle("simulate", path, "-o", run)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stderr.count("1 hole filled"), 1, result.stderr)
        database = sqlite3.connect(run)
        mass = database.execute("select mass from body where name = 'box'").fetchone()[0]
        self.assertAlmostEqual(mass, 1000, places=3)
        for name, squares in (("box", 6 * n * n), ("vessel", 6 * n * n - 1)):
            count = database.execute("select length(triangles) from mesh where id = (select mesh from body where name = ?)", (name,)).fetchone()[0]
            self.assertEqual(count, 12 * 2 * squares)
        self.assertEqual(cradle("render", run, "-o", self.path("f"), "--frames", "1").returncode, 0)

    def test_plot_shows_methods_and_a_failure_in_one_chart(self):
        spring = {"name": "stiff", "bodyA": "ball", "anchorA": [0, 0.1, 0], "anchorB": [0, 1, 0], "stiffness": 1e5, "restLength": 0.5}
        path = self.write("s.json", scene(springs=[spring], duration=2))
        chart = self.path("chart.svg")
        result = cradle("plot", path, "-o", chart, "--methods", "explicitEuler,plan", "--time-step", "0.01",
                        "--quantity", "energy,height:ball,error", "--reference", path)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("the frames up to then are taken", result.stderr)
        self.assertEqual(self.listing(), ["chart.svg", "s.json"])
        text = content(chart).decode()
        for word in ("explicitEuler (unstable after", "plan", "height of ball (m)", "greatest error (m)"):
            self.assertIn(word, text)
        run = self.path("run.sqlite")
        self.assertEqual(cradle("simulate", path, "-o", run).returncode, 0)
        self.assertEqual(cradle("plot", run, "-o", self.path("chart.png")).returncode, 0)
        there = self.listing()
        for words, arguments in ((["chart.pdf", "FILE.svg"], ["-o", self.path("chart.pdf")]),
                                 (["hight:ball", "height:BODY"], ["-o", chart, "--quantity", "hight:ball"]),
                                 (['"bal"', "there are ball"], ["-o", chart, "--quantity", "height:bal"]),
                                 (["error needs --reference"], ["-o", chart, "--quantity", "error"]),
                                 (["--reference", "without"], ["-o", chart, "--reference", path]),
                                 (["--methods", "trajectories"], ["-o", chart, "--methods", "rk4"])):
            self.refuses(2, words, "plot", run, *arguments, leaves=there)
        other = self.path("other.svg")
        shutil.copy(run, other)
        for arguments in ([other, "-o", other], [run, "-o", other, "--quantity", "error", "--reference", other]):
            self.refuses(5, ["other.svg"], "plot", *arguments)
            self.assertEqual(content(other), content(run))

    def test_plot_takes_names_with_commas_and_several_quantities(self):
        ball = {"name": "ball, red", "shape": {"sphere": {"radius": 0.1}}}
        path = self.write("s.json", scene(bodies=[ball]))
        chart = self.path("chart.svg")
        result = cradle("plot", path, "-o", chart, "--quantity", "height:ball, red", "--quantity", "energy,energyError")
        self.assertEqual(result.returncode, 0, result.stderr)
        text = content(chart).decode()
        for word in ("height of ball, red (m)", "energy (J)", "energy error (J)"):
            self.assertIn(word, text)
        self.refuses(2, ['"ball"', "there are ball, red"], "plot", path, "-o", chart, "--quantity", "height:ball,energy", leaves=self.listing())

    def test_plot_says_what_it_shows(self):
        spring = {"name": "stiff", "bodyA": "ball", "anchorA": [0, 0.1, 0], "anchorB": [0, 1, 0], "stiffness": 1e5, "restLength": 0.5}
        stiff = self.write("stiff.json", scene(name="A stiff spring", springs=[spring], duration=2, method={"name": "explicitEuler", "timeStep": 0.01}))
        soft = self.write("soft.json", scene(name="A ball that falls"))
        chart = self.path("chart.svg")
        self.assertEqual(cradle("plot", stiff, "-o", chart, "--quantity", "height:ball").returncode, 0)
        self.assertRegex(content(chart).decode(), r"A stiff spring \(unstable after [0-9.]+ s\)")
        self.assertEqual(cradle("plot", stiff, soft, "-o", chart).returncode, 0)
        self.assertIn("A stiff spring, A ball that falls", content(chart).decode())
        for methods in ([], ["--methods", "plan"]):
            self.refuses(2, ["--time-step: found without --methods"], "plot", soft, "-o", self.path("x.svg"), "--time-step", "0.01", *methods)

    def test_interruption_keeps_a_valid_part(self):
        path = self.write("s.json", scene(duration=100000))
        for number, exit_code in ((signal.SIGINT, 130), (signal.SIGTERM, 143)):
            process = subprocess.Popen([PROGRAM, "simulate", path, "-o", self.path("x.sqlite")], stderr=subprocess.PIPE, text=True)
            for _ in range(200):
                time.sleep(0.05)
                if os.path.exists(self.path("x.sqlite.part")):
                    break
            time.sleep(0.5)
            process.send_signal(number)
            _, stderr = process.communicate(timeout=20)
            self.assertEqual(process.returncode, exit_code, stderr)
            self.assertIn("x.sqlite.part", stderr)
            self.assertEqual(self.listing(), ["s.json", "x.sqlite.part"])
            database = sqlite3.connect(self.path("x.sqlite.part"))
            self.assertEqual(database.execute("pragma integrity_check").fetchone(), ("ok",))
            self.assertGreater(database.execute("select count(*) from frame").fetchone()[0], 1)
            database.close()


    def test_a_frame_that_takes_seconds_shows_the_time_that_it_has_come_to(self):
        """On a terminal. The only frame after the start takes a minute; each run is ended at its second sign of life."""
        seen = {"position": [0, 0, 5], "target": [0, 0, 0]}
        for command, camera, task in (("simulate x.sqlite", None, "Simulating: 1/2 frames"), ("video x.mp4", None, "Simulating: 1/2 frames"),
                                      ("render x", None, "Simulating: 1/2 frames"), ("video x.mp4", seen, "Drawing: 1/1 pictures")):
            path = self.write("s.json", scene(duration=60, method={"name": "rk4", "timeStep": 1e-6}, camera=camera,
                                              output={"framesPerSecond": 1 / 60, "width": 64, "height": 36}))
            command, output = command.split()
            ours, terminal = pty.openpty()
            process = subprocess.Popen([PROGRAM, command, path, "-o", self.path(output)], stderr=terminal)
            os.close(terminal)
            begin, text = time.monotonic(), b""
            try:
                while text.count(b"s simulated") < 2 and time.monotonic() < begin + 30:
                    text += os.read(ours, 4096)
            finally:
                process.send_signal(signal.SIGINT)
                os.close(ours)  # what cannot be told any more is lost
                process.wait(20)
            lines = re.findall(r"\r\x1b\[K([^\r]*)", text.decode())
            times = [float(found[1]) for found in (re.match(task + r", (\S+) s simulated(, \S+ left)?$", line) for line in lines) if found]
            self.assertEqual(len(times), 2, (command, text))
            self.assertTrue(0 < times[0] < times[1] < 60, times)
            self.assertEqual(process.returncode, 130)
            if os.path.exists(self.path("x.sqlite.part")):
                os.remove(self.path("x.sqlite.part"))


class Studies(InTemporaryFolder):
    COLUMNS = ["scene", "engine", "method", "setting", "error", "cpu_seconds_per_simulated_second", "evaluations",
               "energy_drift", "constraint_drift", "penetration", "status"]

    def spring_scene(self, **changes):
        spring = {"bodyA": "ball", "anchorA": [0, 0.1, 0], "anchorB": [0, 1, 0], "stiffness": 200, "restLength": 0.5}
        return self.write("hung.json", scene(springs=[spring], **changes))

    def rows(self, name):
        with open(self.path(name)) as table:
            reader = csv.DictReader(table)
            self.assertEqual(reader.fieldnames, self.COLUMNS)
            return list(reader)

    def test_a_study_has_a_row_a_run_and_charts(self):
        result = cradle("study", self.spring_scene(duration=0.5), "-o", self.path("s"), "--methods", "rk4")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(sorted(os.listdir(self.path("s"))), ["references.csv", "study.csv", "work_precision_hung.png", "work_precision_hung.svg"])
        self.assertRegex(content(self.path("s/references.csv")).decode(), r"\nhung,\d")
        rows = self.rows("s/study.csv")
        self.assertEqual({(row["scene"], row["engine"], row["method"]) for row in rows}, {("hung", "cradle", "rk4")})
        steps, errors = [float(row["setting"]) for row in rows], [float(row["error"]) for row in rows]
        self.assertTrue(all(abs(b - a / 2) < 1e-15 for a, b in zip(steps, steps[1:])), steps)
        self.assertLess(errors[-1], 1e-9)
        self.assertEqual(png_size(self.path("s/work_precision_hung.png")), (1600, 1195))
        self.assertIn("hung: reference ", result.stdout)
        again = cradle("study", self.path("hung.json"), "-o", self.path("s"), "--methods", "rk4")
        self.assertEqual(again.returncode, 0, again.stderr)
        lines = content(self.path("s/study.csv")).decode().splitlines(keepends=True)
        os.rename(self.path("s/references.csv"), self.path("s/references.csv.part"))
        os.remove(self.path("s/study.csv"))
        with open(self.path("s/study.csv.part"), "w") as part:  # as if it had been ended in the last row but one
            part.write("".join(lines[:-2]) + lines[-2][:9])
        gone_on = cradle("study", self.path("hung.json"), "-o", self.path("s"), "--methods", "rk4")
        self.assertIn(f"going on after the {len(lines) - 3} rows", gone_on.stderr)
        after = content(self.path("s/study.csv")).decode().splitlines(keepends=True)
        without_cost = lambda table: [row[:5] + row[6:] for row in (line.split(",") for line in table)]
        self.assertEqual(without_cost(after), without_cost(lines))
        cost, kept = ([float(line.split(",")[5]) for line in table if line.endswith(",ok\n")] for table in (after, lines))
        self.assertGreater(len(kept), 3)
        self.assertTrue(all(a <= b for a, b in zip(cost[:-2], kept)), (cost, kept))  # timed once more

    def test_without_gnuplot_there_is_a_table_and_exit_5(self):
        os.mkdir(self.path("bin"))
        result = cradle("study", self.spring_scene(), "-o", self.path("s"), "--methods", "rk4", env={**os.environ, "PATH": self.path("bin")})
        self.assertEqual(result.returncode, 5, result.stderr)
        self.assertIn("gnuplot-nox", result.stderr)
        self.assertEqual(sorted(os.listdir(self.path("s"))), ["references.csv", "study.csv"])
        self.assertGreater(len(self.rows("s/study.csv")), 3)

    def test_faults_are_told_before_anything_is_made(self):
        path = self.spring_scene()
        self.refuses(2, ["--methods", "rk5", "rk4"], "study", path, "-o", self.path("s"), "--methods", "rk4,rk5")
        self.refuses(2, ["hung.json", "second"], "study", path, path, "-o", self.path("s"))
        self.refuses(3, ["nowhere.json"], "study", path, self.path("nowhere.json"), "-o", self.path("s"))
        self.refuses(5, ["hung.json"], "study", path, "-o", self.folder)

    def test_a_study_that_cannot_write_leaves_rows_or_nothing(self):
        """Files of 0 bytes at most have no columns; those of 130 have these, but the reference is longer."""
        path = self.spring_scene(duration=0.1)
        for size in (0, 1, 130):
            limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))
            for is_there in (False, True):
                if is_there:
                    os.mkdir(self.path("s"))
                result = cradle("study", path, "-o", self.path("s"), "--methods", "rk4", preexec_fn=limit)
                self.assertEqual((result.returncode, result.stderr.count("File too large")), (5, 1), result.stderr)
                self.assertNotIn("the rows up to then", result.stderr)
                self.assertEqual(self.listing(), ["hung.json", "s"] if is_there else ["hung.json"])
                if is_there:
                    os.rmdir(self.path("s"))  # which is empty

    def test_interruption_keeps_the_rows_so_far(self):
        path = self.spring_scene(duration=2)
        process = subprocess.Popen([PROGRAM, "study", path, "-o", self.path("s"), "--methods", "explicitEuler"],
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        part = self.path("s/study.csv.part")
        for _ in range(400):
            time.sleep(0.05)
            if os.path.exists(part) and len(content(part).splitlines()) > 3:
                break
        process.send_signal(signal.SIGINT)
        _, stderr = process.communicate(timeout=20)
        self.assertEqual(process.returncode, 130, stderr)
        self.assertIn("study.csv.part", stderr)
        self.assertEqual(sorted(os.listdir(self.path("s"))), ["references.csv.part", "study.csv.part"])
        self.assertGreater(len(self.rows("s/study.csv.part")), 2)
        self.refuses(5, ["study.csv.part", "another study"], "study", path, "-o", self.path("s"), "--methods", "rk4")


class Stability(InTemporaryFolder):
    def test_a_map_is_a_table_and_two_pictures(self):
        result = cradle("stability", "-o", self.path("m"), "--maps", "logistic")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(sorted(os.listdir(self.path("m"))), ["logistic.csv", "logistic.png", "logistic.svg"])
        lines = content(self.path("m/logistic.csv")).decode().splitlines()
        self.assertTrue(all(line.startswith("# ") for line in lines[:3]), lines[:3])
        self.assertEqual(lines[3], "panel,kind,name,time (s),y")
        self.assertEqual(png_size(self.path("m/logistic.png")), (1600, 900))
        again = cradle("stability", "-o", self.path("m"), "--maps", "logistic")
        self.assertEqual(again.returncode, 0, again.stderr)

    def test_faults_are_told_before_anything_is_made(self):
        self.refuses(2, ["--maps", "logistics", "step_stiffness"], "stability", "-o", self.path("m"), "--maps", "logistics")
        self.write("mine.json", scene())
        self.refuses(5, ["mine.json"], "stability", "-o", self.folder)

    def test_without_gnuplot_there_is_a_table_and_exit_5(self):
        os.mkdir(self.path("bin"))
        result = cradle("stability", "-o", self.path("m"), "--maps", "logistic", env={**os.environ, "PATH": self.path("bin")})
        self.assertEqual(result.returncode, 5, result.stderr)
        self.assertEqual(os.listdir(self.path("m")), ["logistic.csv"])

    def test_charts_that_were_cut_off_are_told(self):
        # A gnuplot that is cut off: a picture without an end.
        os.mkdir(self.path("bin"))
        with open(self.path("bin/gnuplot"), "w") as file:
            file.write("#!/bin/sh\ncat >/dev/null; echo '<svg>'\n")
        os.chmod(self.path("bin/gnuplot"), 0o755)
        path = self.path("bin") + os.pathsep + os.environ["PATH"]
        result = cradle("stability", "-o", self.path("m"), "--maps", "logistic", env={**os.environ, "PATH": path})
        self.assertEqual(result.returncode, 5, result.stdout)
        self.assertIn("logistic.svg: could not be written to its end", result.stderr)
        self.assertNotIn("logistic.svg", os.listdir(self.path("m")))


def png_size(path):
    with open(path, "rb") as file:
        header = file.read(24)
    assert header[:8] == b"\x89PNG\r\n\x1a\n"
    return struct.unpack(">II", header[16:24])


def film_frames(path):
    counted = subprocess.run(["ffprobe", "-v", "error", "-count_frames", "-select_streams", "v:0", "-show_entries",
                              "stream=nb_read_frames,width,height", "-of", "csv=p=0", path], capture_output=True, text=True)
    return counted.stdout.strip()


class Pictures(InTemporaryFolder):
    def setUp(self):
        super().setUp()
        self.scene = self.write("s.json", scene())

    def test_a_temporary_folder_that_is_none_is_named(self):
        result = cradle("render", self.scene, "-o", self.path("f"), env={**os.environ, "TMPDIR": self.path("none")})
        self.assertEqual(result.returncode, 5, result.stderr)
        self.assertIn("TMPDIR: ", result.stderr)

    def test_render_writes_frames_0_to_n_minus_1(self):
        self.assertEqual(cradle("render", self.scene, "-o", self.path("all")).returncode, 0)
        self.assertEqual(sorted(os.listdir(self.path("all"))), [f"frame_{i:06}.png" for i in range(6)])
        self.assertEqual(png_size(self.path("all/frame_000000.png")), (64, 36))

    def test_a_range_may_name_the_last_frame_and_gives_the_same_files(self):
        cradle("render", self.scene, "-o", self.path("all"))
        self.assertEqual(cradle("render", self.scene, "-o", self.path("some"), "--frames", "4:7").returncode, 0)
        self.assertEqual(sorted(os.listdir(self.path("some"))), [f"frame_{i:06}.png" for i in (4, 5, 6)])
        for name in ("frame_000004.png", "frame_000005.png"):
            self.assertEqual(content(self.path("all/" + name)), content(self.path("some/" + name)))

    def test_a_trajectory_draws_as_its_scene_does_wherever_it_lies(self):
        body = {"name": "b", "shape": {"mesh": BALL, "scale": 0.1}}
        path = self.write("m.json", scene(bodies=[body], springs=[{"bodyA": "b", "anchorA": {"vertex": 5}, "anchorB": [0, 1, 0], "stiffness": 100}]))
        cradle("simulate", path, "-o", self.path("m.sqlite"))
        os.mkdir(self.path("elsewhere"))
        shutil.move(self.path("m.sqlite"), self.path("elsewhere/m.sqlite"))
        os.remove(path)
        self.assertEqual(cradle("render", self.path("elsewhere/m.sqlite"), "-o", self.path("a"), "--frames", "3:4").returncode, 0)
        self.write("m.json", scene(bodies=[body], springs=[{"bodyA": "b", "anchorA": {"vertex": 5}, "anchorB": [0, 1, 0], "stiffness": 100}]))
        cradle("render", path, "-o", self.path("b"), "--frames", "3:4")
        self.assertEqual(content(self.path("a/frame_000003.png")), content(self.path("b/frame_000003.png")))

    def test_size_is_taken_from_the_command_line(self):
        self.assertEqual(cradle("render", self.scene, "-o", self.path("f"), "--frames", "0:1", "--size", "50x40").returncode, 0)
        self.assertEqual(png_size(self.path("f/frame_000000.png")), (50, 40))

    def test_ranges_of_frames_may_be_open_or_one_frame(self):
        for frames, names in (("1", [1]), ("2:", [2, 3]), (":2", [0, 1]), ("4", [4])):  # 5 frames, 4 pictures
            folder = self.path("frames" + frames.replace(":", "_"))
            path = self.write("short.json", scene(duration=4 / 60))
            self.assertEqual(cradle("render", path, "-o", folder, "--frames", frames, "--size", "50x40").returncode, 0)
            self.assertEqual(sorted(os.listdir(folder)), [f"frame_{name:06}.png" for name in names])

    def test_help_is_a_command_and_the_answer_to_none(self):
        asked = cradle("help", "video")
        self.assertEqual((asked.returncode, asked.stdout), (0, cradle("video", "--help").stdout))
        none = cradle()
        self.assertEqual((none.returncode, none.stdout), (2, ""))
        self.assertIn("cradle video scenes/newtons_cradle.json", none.stderr)

    def test_methods_with_spaces_between_them_are_told_from_scenes(self):
        self.refuses(2, ["dop853", "commas"], "study", self.scene, "-o", self.path("s"), "--methods", "rk4", "dop853")

    def test_bad_ranges_and_sizes_are_refused(self):
        for frames in ("5:4", ":", ":0", "99", "99:", "0:99", "-1:3", "a:b"):
            self.refuses(2, ["--frames", frames], "render", self.scene, "-o", self.path("f"), "--frames=" + frames)
        self.refuses(2, ["--size"], "render", self.scene, "-o", self.path("f"), "--size", "1000000000x2")
        self.refuses(2, ["--size"], "render", self.scene, "-o", self.path("f"), "--size", "64")

    def test_a_folder_with_other_files_is_refused(self):
        os.mkdir(self.path("f"))
        open(self.path("f/thesis.txt"), "w").close()
        self.refuses(5, ["thesis.txt"], "render", self.scene, "-o", self.path("f"))
        self.assertEqual(os.listdir(self.path("f")), ["thesis.txt"])

    def test_a_folder_with_frames_is_refused_unless_they_may_be_replaced(self):
        cradle("render", self.scene, "-o", self.path("f"), "--frames", "2:6")
        before = content(self.path("f/frame_000002.png"))
        self.refuses(5, ["holds 4 of the frames to be drawn, frame_000002.png to frame_000005.png", "--overwrite"], "render",
                     self.scene, "-o", self.path("f"))
        self.refuses(5, ["holds 1 of the frames", "frame_000002.png"], "render", self.scene, "-o", self.path("f"), "--frames", "0:3")
        # The rest of the film may go beside them.
        self.assertEqual(cradle("render", self.scene, "-o", self.path("f"), "--frames", "0:2").returncode, 0)
        self.assertEqual(sorted(os.listdir(self.path("f"))), [f"frame_{i:06}.png" for i in range(6)])
        other = self.write("o.json", scene(camera={"position": [0, 0, 2], "target": [0, 0, 0]}))
        self.assertEqual(cradle("render", other, "-o", self.path("f"), "--overwrite", "--frames", "2:3").returncode, 0)
        self.assertNotEqual(content(self.path("f/frame_000002.png")), before)
        self.assertEqual(cradle("render", self.scene, "-o", self.path("f"), "--overwrite").returncode, 0)
        self.assertEqual(content(self.path("f/frame_000002.png")), before)
        # Never what is not its own: other files, and frames of a longer film.
        short = self.write("t.json", scene(duration=0.05))
        self.refuses(5, ["frame_000004.png to frame_000005.png, which are of another film", "4 frames"], "render", short, "-o",
                     self.path("f"), "--overwrite")
        open(self.path("f/thesis.txt"), "w").close()
        self.refuses(5, ["thesis.txt"], "render", self.scene, "-o", self.path("f"), "--overwrite")
        self.assertEqual(len(os.listdir(self.path("f"))), 7)

    def test_parts_of_a_film_are_those_of_the_whole_with_a_camera_that_follows_and_overlays(self):
        path = self.write("f.json", scene(duration=0.3, output={"width": 160, "height": 90},
                                          bodies=[{"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "linearVelocity": [2, 3, 0]},
                                                  {"name": "ground", "shape": {"plane": {}}, "motion": "static", "position": [0, -0.1, 0]}],
                                          camera={"position": [0, 1, 3], "follow": {"body": "ball"}, "orbit": {"period": 4}}))
        self.assertEqual(cradle("simulate", path, "-o", self.path("f.sqlite")).returncode, 0)
        overlay = ["--overlay", "time,contacts,velocities,trails,plot=height:ball"]
        self.assertEqual(cradle("render", self.path("f.sqlite"), "-o", self.path("whole"), *overlay).returncode, 0)
        command = [PROGRAM, "render", self.path("f.sqlite"), "-o", self.path("parts"), *overlay]
        beside_each_other = [subprocess.Popen([*command, "--frames", frames], stderr=subprocess.PIPE, text=True)
                             for frames in ("11:18", "0:1", "1:11")]
        for process in beside_each_other:
            _, stderr = process.communicate(timeout=60)
            self.assertEqual(process.returncode, 0, stderr)
        names = sorted(os.listdir(self.path("whole")))
        self.assertEqual(sorted(os.listdir(self.path("parts"))), names)
        for name in names:
            self.assertEqual(content(self.path("parts/" + name)), content(self.path("whole/" + name)), name)
        self.assertEqual(len({content(self.path("whole/" + name)) for name in names}), 18)

    def passes(self, path):
        """Shape and numbers of a NumPy file."""
        bytes_ = content(path)
        self.assertEqual(bytes_[:8], b"\x93NUMPY\x01\x00")
        length = struct.unpack("<H", bytes_[8:10])[0]
        header = ast.literal_eval(bytes_[10:10 + length].decode())
        self.assertFalse(header["fortran_order"])
        code = {"<f4": "f", "<u2": "H", "|u1": "B"}[header["descr"]]
        return header["shape"], [value for value, in struct.iter_unpack("<" + code, bytes_[10 + length:])]

    def test_passes_go_beside_pictures_or_without_them(self):
        kinds = ("backwardFlow", "depth", "flow", "hidden", "normal", "objectCoordinates", "segmentation")
        self.assertEqual(cradle("render", self.scene, "-o", self.path("all"), "--passes", "all").returncode, 0)
        names = [f"{kind}_{i:06}.npy" for kind in kinds for i in range(6)] + [f"instances_{i:06}.json" for i in range(6)]
        self.assertEqual(sorted(os.listdir(self.path("all"))),
                         sorted(names + ["camera.json", "events.json", "trajectory.sqlite", "truth.json"] + [f"frame_{i:06}.png" for i in range(6)]))
        self.assertEqual(cradle("encode", self.path("all"), "-o", self.path("f.mp4")).returncode, 0)
        self.assertEqual(film_frames(self.path("f.mp4")), "64,36,6")
        cradle("simulate", self.scene, "-o", self.path("t.sqlite"))
        command = [PROGRAM, "render", self.path("t.sqlite"), "-o", self.path("parts"), "--passes", ",".join(kinds).replace("hidden,", "")]
        runs = [subprocess.Popen([*command, "--frames", frames], stderr=subprocess.PIPE, text=True) for frames in ("4:", "0:1", "1:4")]
        for process in runs:
            _, stderr = process.communicate(timeout=60)
            self.assertEqual(process.returncode, 0, stderr)
        self.assertEqual(sorted(os.listdir(self.path("parts"))), sorted(names + ["camera.json", "events.json", "truth.json"]))
        origins = [json.loads(content(self.path(name + "/truth.json"))) for name in ("all", "parts")]
        self.assertEqual([origin["trajectory"] for origin in origins], ["trajectory.sqlite", self.path("t.sqlite")])
        self.assertEqual(origins[0]["stateHash"], origins[1]["stateHash"])
        for name in names + ["camera.json", "events.json"]:
            self.assertEqual(content(self.path("parts/" + name)), content(self.path("all/" + name)), name)

    def test_a_trajectory_has_the_cameras_of_its_pictures(self):
        ball = {"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "linearVelocity": [2, 3, 0]}
        cameras = {"chosen": {}, "pushed": {"pushes": [{"body": "ball", "point": [0, 0, 0], "force": [0, 40, 9], "start": 0.1, "duration": 0.05}]},
                   "sideways": {"gravity": [0, 0, -9.81]},
                   "named": {"camera": {"position": [0, 1, 3], "target": [0, 0, 0]}, "gravity": [-9.81, 0, 0]},
                   "follows": {"camera": {"position": [0, 1, 3], "follow": {"body": "ball"}, "orbit": {"period": 4}}}}
        for name, members in cameras.items():
            path = self.write(name + ".json", scene(**{"duration": 0.3, "output": {"width": 96, "height": 54}, "bodies": [ball]} | members))
            self.assertEqual(cradle("simulate", path, "-o", self.path(name + ".sqlite")).returncode, 0)
            result = cradle("render", self.path(name + ".sqlite"), "-o", self.path(name), "--passes", "depth")
            self.assertEqual(result.returncode, 0, result.stderr)
            with contextlib.closing(sqlite3.connect(self.path(name + ".sqlite"))) as database:
                rows = database.execute("SELECT frame, px, py, pz, qw, qx, qy, qz, verticalFieldOfView FROM camera ORDER BY frame").fetchall()
            frames = json.loads(content(self.path(name + "/camera.json")))["frames"]
            self.assertEqual([row[0] for row in rows], [frame["frame"] for frame in frames])
            for (_, *place, w, x, y, z, field), frame in zip(rows, frames):
                turn = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
                for row in range(3):
                    for column, value in enumerate([*turn[row], place[row]]):
                        self.assertAlmostEqual(value, frame["worldFromCamera"][row][column], delta=1e-12, msg=name)
                self.assertAlmostEqual(27 / math.tan(field / 2), frame["K"][0][0], delta=1e-9)

    def test_contacts_are_exported_as_a_table_of_their_own(self):
        path = self.write("c.json", scene(duration=0.1, bodies=[
            {"name": "box, \"old\"", "shape": {"box": {"size": [1, 1, 1]}}, "mass": 2, "position": [0, 0.5, 0]},
            {"name": "ground", "shape": {"plane": {}}, "motion": "static"}]))
        self.assertEqual(cradle("simulate", path, "-o", self.path("c.sqlite")).returncode, 0)
        self.assertEqual(cradle("export", self.path("c.sqlite"), "-o", self.path("c.csv"), "--contacts").returncode, 0)
        with open(self.path("c.csv"), newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([int(row["frame"]) for row in rows], list(range(len(rows))))
        self.assertGreater(len(rows), 1)
        for row in rows:
            self.assertEqual((row["a"], row["b"], row["begin_s"], float(row["end_s"])), ('box, "old"', "ground", "0", 0.1))
            self.assertAlmostEqual(float(row["fy_N"]), -2 * 9.81, delta=1e-9)
            self.assertAlmostEqual(float(row["normaly_N"]), -2 * 9.81, delta=1e-9)
            self.assertAlmostEqual(float(row["frictionx_N"]), 0, delta=1e-9)
        result = cradle("export", self.path("c.sqlite"), "-o", self.path("c.glb"), "--contacts")
        self.assertEqual((result.returncode, os.path.exists(self.path("c.glb"))), (2, False))
        self.assertIn("FILE.csv", result.stderr)

    def test_passes_have_their_shapes_and_the_state_at_the_end_no_next_one(self):
        self.assertEqual(cradle("render", self.scene, "-o", self.path("f"), "--passes", "all", "--frames", "5:7").returncode, 0)
        for kind, shape in (("depth", (36, 64)), ("normal", (36, 64, 3)), ("segmentation", (36, 64)), ("flow", (36, 64, 2)),
                            ("hidden", (36, 64)), ("backwardFlow", (36, 64, 2)), ("objectCoordinates", (36, 64, 3))):
            self.assertEqual(self.passes(self.path(f"f/{kind}_000005.npy"))[0], shape)
        isnan = lambda kind, frame: {value != value for value in self.passes(self.path(f"f/{kind}_{frame:06}.npy"))[1]}
        self.assertEqual((isnan("flow", 5), isnan("flow", 6), isnan("backwardFlow", 6)), ({False}, {True}, {False}))
        self.assertEqual(set(self.passes(self.path("f/segmentation_000005.npy"))[1]), {0, 1})
        self.assertEqual(len(json.loads(content(self.path("f/camera.json")))["frames"]), 7)

    def test_parts_of_a_film_are_named_by_their_number(self):
        cradle("simulate", self.scene, "-o", self.path("t.sqlite"))
        command = [PROGRAM, "render", self.path("t.sqlite"), "-o", self.path("f"), "--passes", "rgb,depth"]
        runs = [subprocess.Popen([*command, "--shard", f"{i}/4"], stderr=subprocess.PIPE, text=True) for i in (3, 1, 4, 2)]
        for process in runs:
            _, stderr = process.communicate(timeout=60)
            self.assertEqual(process.returncode, 0, stderr)
        names = [f"{kind}_{i:06}.{ending}" for i in range(6) for kind, ending in (("frame", "png"), ("depth", "npy"), ("instances", "json"))]
        self.assertEqual(sorted(os.listdir(self.path("f"))), sorted(names + ["camera.json", "events.json", "truth.json"]))
        # Parts differ by a frame at most, and more of them than frames leave some without any.
        for parts, sizes in ((4, [1, 1, 2, 2]), (8, [0, 0, 1, 1, 1, 1, 1, 1])):
            found = []
            for part in range(1, parts + 1):
                folder = self.path(f"part{parts}_{part}")
                self.assertEqual(cradle("render", self.path("t.sqlite"), "-o", folder, "--shard", f"{part}/{parts}").returncode, 0)
                found.append(sorted(os.listdir(folder)) if os.path.isdir(folder) else [])
            self.assertEqual(sorted(map(len, found)), sizes)
            self.assertEqual(sum(found, []), [f"frame_{i:06}.png" for i in range(6)])
        for shard in ("0/2", "3/2", "1", "a/b", "1/0"):
            self.refuses(2, ["--shard", shard, "PART/PARTS"], "render", self.path("t.sqlite"), "-o", self.path("g"), "--shard", shard)
        self.refuses(5, ["frame_000000.png"], "render", self.path("t.sqlite"), "-o", self.path("f"), "--shard", "1/2")

    def test_passes_of_a_frame_may_be_one_openexr_file(self):
        self.assertEqual(cradle("render", self.scene, "-o", self.path("f"), "--passes", "all", "--pass-format", "exr").returncode, 0)
        names = [f"{kind}_{i:06}.{ending}" for i in range(6) for kind, ending in (("frame", "png"), ("passes", "exr"), ("instances", "json"))]
        self.assertEqual(sorted(os.listdir(self.path("f"))),
                         sorted(names + ["camera.json", "events.json", "trajectory.sqlite", "truth.json"]))
        self.assertEqual(content(self.path("f/passes_000000.exr"))[:4], b"\x76\x2f\x31\x01")
        self.refuses(2, ["--pass-format", "npy and exr"], "render", self.scene, "-o", self.path("g"), "--passes", "all", "--pass-format", "tiff")
        self.refuses(5, ["passes_000005.exr"], "render", self.scene, "-o", self.path("f"), "--passes", "depth", "--pass-format", "exr")

    def test_frames_that_are_there_may_be_skipped(self):
        command = ["render", self.scene, "-o", self.path("f"), "--passes", "rgb,depth"]
        self.assertEqual(cradle(*command, "--frames", "0:3").returncode, 0)
        os.remove(self.path("f/depth_000001.npy"))
        old = {name: os.stat(self.path("f/" + name)).st_mtime_ns for name in os.listdir(self.path("f"))}
        self.assertEqual(cradle(*command, "--skip-existing").returncode, 0)
        self.assertEqual(len(os.listdir(self.path("f"))), 6 * 3 + 4)
        again = {name for name, time_ in old.items() if os.stat(self.path("f/" + name)).st_mtime_ns != time_}
        self.assertEqual(again, {"frame_000001.png", "instances_000001.json"})
        self.assertEqual(cradle(*command, "--skip-existing").returncode, 0)  # nothing is left to do
        self.refuses(2, ["--skip-existing", "--overwrite"], *command, "--skip-existing", "--overwrite")

    def test_passes_that_are_there_are_refused_by_kind(self):
        self.assertEqual(cradle("render", self.scene, "-o", self.path("f"), "--passes", "depth").returncode, 0)
        self.assertEqual(cradle("render", self.scene, "-o", self.path("f")).returncode, 0)  # pictures are others
        self.refuses(5, ["holds 12 of the frames", "depth_000000.npy"], "render", self.scene, "-o", self.path("f"), "--passes", "depth")
        self.refuses(2, ["--passes", "found \"dept\"", "segmentation"], "render", self.scene, "-o", self.path("g"), "--passes", "dept")
        open(self.path("f/depth_1.npy"), "w").close()
        self.refuses(5, ["depth_1.npy"], "render", self.scene, "-o", self.path("f"), "--passes", "normal")

    def test_the_reader_of_ground_truth_in_the_documents_runs(self):
        document = content(os.path.join(SOURCE, "docs", "ground_truth.md")).decode()
        reader = self.write("read_truth.py", re.search(r"```python\n(.*?)```", document, re.S).group(1))
        turned = {"name": "box", "shape": {"box": {"size": [0.3, 0.2, 0.1]}}, "position": [0, 0, 0], "linearVelocity": [1, 2, 0],
                  "angularVelocity": [1, 2, 3], "category": "crate"}
        ground = {"name": "ground", "shape": {"plane": {"normal": [1, 0, 0]}}, "motion": "static", "position": [-1, 0, 0]}
        path = self.write("g.json", scene(gravity=[-9.81, 0, 0], bodies=[turned, ground], output={"framesPerSecond": 60, "width": 160, "height": 120}))
        self.assertEqual(cradle("render", path, "-o", self.path("f"), "--passes", "all", "--frames", "3").returncode, 0)
        result = subprocess.run([sys.executable, reader, self.path("f"), "3"], capture_output=True, text=True)
        self.assertEqual(result.returncode, 0, result.stderr)
        lines = re.findall(r"(\w+): (\d+) pixels, mean flow (\S+) pixels, points agree to (\S+) of", result.stdout)
        self.assertEqual({name for name, *_ in lines}, {"box", "ground"})
        for name, pixels, flow, error in lines:
            self.assertGreater(int(pixels), 300)
            self.assertLess(float(error), 1e-6)  # of single precision
            self.assertEqual(float(flow) > 0.1, name == "box")

    def test_pick_says_what_the_segmentation_has_and_what_it_prints_is_hit(self):
        balls = [{"name": f"ball {i}", "shape": {"sphere": {"radius": 0.2}}, "position": [0.5 * i, 0, 0]} for i in range(3)]
        path = self.write("p.json", scene(bodies=balls, springs=[{"bodyA": "ball 0", "anchorA": [0, 0, 0]}]))
        self.assertEqual(cradle("render", path, "-o", self.path("f"), "--passes", "segmentation,depth", "--frames", "2").returncode, 0)
        (height, width), ids = self.passes(self.path("f/segmentation_000002.npy"))
        depths = self.passes(self.path("f/depth_000002.npy"))[1]
        found = set()
        for row in range(4, height, 5):
            for column in range(2, width, 5):
                text = cradle("pick", path, "--frame", "2", f"{column},{row}").stdout
                name = re.search(r": (?:body \"(.*?)\"|an? (\w+)|the sky)\n", text)
                expected = ids[row * width + column]
                self.assertEqual({0: (None, None), 1: ("ball 0", None), 2: ("ball 1", None), 3: ("ball 2", None),
                                  60000: (None, "spring")}[expected], name.groups(), text)
                found.add(expected)
                if name.group(1):
                    depth = float(re.search(r"depth along the view +(\S+) m", text).group(1))
                    self.assertAlmostEqual(depth / depths[row * width + column], 1, delta=1e-6)
                    push = json.loads(re.search(r"^  (\{.*\})$", text, re.M).group(1))
                    self.assertEqual(push["body"], name.group(1))
                    self.assertAlmostEqual(sum(x * x for x in push["point"]), 0.04, delta=1e-12)
        self.assertTrue({0, 1, 2, 3} <= found, found)
        again = self.write("again.json", scene(bodies=balls, pushes=[{**push, "start": 0, "duration": 0.05}]))
        self.assertEqual(cradle("check", again).returncode, 0)
        self.refuses(2, ["99,0", "0,0 to 63,35"], "pick", path, "99,0")
        self.refuses(2, ["found \"5\""], "pick", path, "5")
        self.refuses(2, ["--frame", "0 to 6"], "pick", path, "1,1", "--frame", "7")

    def test_inspect_lists_vertices_by_the_numbers_of_anchors(self):
        prism = os.path.join(SOURCE, "assets", "l_prism.3ds")
        listed = json.loads(cradle("inspect", prism, "--vertices", "--json").stdout)["vertices"][0]["list"]
        self.assertEqual([entry["vertex"] for entry in listed], list(range(12)))
        near = re.findall(r"vertex (\d+) .*  (\S+) away", cradle("inspect", prism, "--vertices", "--near", "-1,0,2").stdout)
        distances = [sum((a - b) ** 2 for a, b in zip(entry["point"], (-1, 0, 2))) ** 0.5 for entry in listed]
        self.assertEqual(len(near), 10)
        self.assertEqual([int(number) for number, _ in near], sorted(range(12), key=lambda number: distances[number])[:10])
        for number in (3, 8):  # a rod that is as long as its ends are apart says so
            x, y, z = listed[number]["point"]
            path = self.write("v.json", scene(bodies=[{"name": "b", "shape": {"mesh": prism}}],
                                              rods=[{"bodyA": "b", "anchorA": {"vertex": number}, "anchorB": [x, y, z + 2], "length": 2}]))
            self.assertIn("1 rod", cradle("check", path).stdout)
        self.refuses(2, ["--near"], "inspect", prism, "--vertices", "--near", "1,2")
        self.refuses(2, ["--vertices"], "inspect", prism, "--near", "1,2,3")

    def test_a_film_drawn_beside_its_simulation_is_that_of_the_trajectory_and_of_frames_drawn_apart(self):
        bodies = [{"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "position": [0, 0.4, 0], "linearVelocity": [3, 0, 0]},
                  {"name": "ground", "shape": {"plane": {}}, "motion": "static"}]
        keys = [{"time": 0, "position": [0, 1, 3]}, {"time": 0.4, "position": [0.5, 1, 2], "target": [1, 0, 0]}]
        # The arrow of the second is shown from the first picture on; the first misses.
        pushes = [{"body": "ball", "ray": {"origin": [0, 5, 0], "direction": [0, 1, 0]}, "force": [0, 9, 0], "start": 0.1, "duration": 0.1},
                  {"body": "ball", "point": [0, 0, 0.1], "force": [2, 0, -3], "start": 0.2, "duration": 0.05},
                  {"body": "ball", "ray": {"origin": [0, 0.1, 0], "direction": [1, 0, 0]}, "force": [-5, 0, 0], "start": 0.3, "duration": 0.1}]
        for kind, pushed in (({"orbit": {"period": 2}}, []), ({"keyFrames": keys}, []), ({"follow": {"body": "ball"}}, pushes), ({"target": "ball"}, []),
                             ({}, pushes)):
            path = self.write("s.json", scene(duration=0.5, output={"width": 128, "height": 72}, bodies=bodies, pushes=pushed,
                                              camera={"position": [0, 1, 3], "target": [0, 0.3, 0], **kind}))
            overlay = ["--overlay", "time,trails"]
            no_folder = {**os.environ, "TMPDIR": self.path("none")}  # for a trajectory
            result = cradle("video", path, "-o", self.path("beside.mp4"), *overlay, env=no_folder)
            self.assertEqual(result.returncode, 0, result.stderr)
            for name, *command in (("run.sqlite", "simulate", path),
                                   ("after.mp4", "video", self.path("run.sqlite"), *overlay),
                                   ("frames", "render", self.path("run.sqlite"), "--overwrite", "--frames", "17:30", *overlay),
                                   ("frames", "render", self.path("run.sqlite"), "--overwrite", "--frames", "0:17", *overlay),
                                   ("frames.mp4", "encode", self.path("frames"))):
                result = cradle(*command, "-o", self.path(name))
                self.assertEqual(result.returncode, 0, result.stderr)
            self.assertEqual(content(self.path("beside.mp4")), content(self.path("after.mp4")), kind)
            self.assertEqual(content(self.path("beside.mp4")), content(self.path("frames.mp4")), kind)

    def test_frames_before_a_late_push_wait_on_the_disk(self):
        push = {"body": "ball", "point": [0, 0, 0], "force": [1, 0, 0], "start": 1e5, "duration": 1}
        path = self.write("s.json", scene(duration=2e5, pushes=[push], camera={"position": [0, 1, 3], "target": [0, 0, 0]}))
        kept = self.path("f.mp4.sqlite.part")
        with subprocess.Popen([PROGRAM, "video", path, "-o", self.path("f.mp4")], stderr=subprocess.DEVNULL) as run:
            while run.poll() is None and not (os.path.exists(kept) and os.path.getsize(kept) > 1e6):
                time.sleep(0.05)
            run.send_signal(signal.SIGINT)
        self.assertEqual(run.returncode, 130)
        self.assertEqual(self.listing(), ["s.json"])

    def test_overlays_that_are_not_there_are_refused(self):
        self.refuses(2, ["--overlay", '"tme"', "allowed are time, contacts"], "render", self.scene, "-o", self.path("f"), "--overlay", "tme")
        self.refuses(2, ["plot=height:bal", "no body", '"ball"'], "video", self.scene, "-o", self.path("f.mp4"), "--overlay", "plot=height:bal")

    def test_what_is_wrong_with_pictures_is_told_before_a_long_simulation(self):
        path = self.write("s.json", scene(duration=1e6))  # minutes
        for exit_code, words, arguments in ((2, ["--overlay", "no body", '"ball"'], ["--overlay", "plot=height:bal"]),
                                            (2, ["--size"], ["--size", "0x9"]),
                                            (2, ["--frames", "60000001"], ["--frames", "5:60000009"])):
            command = ["render", path, "-o", self.path("f"), *arguments]
            self.assertLess(self.seconds_until_refused(exit_code, words, command), 5)
        self.assertLess(self.seconds_until_refused(2, [".mp4"], ["video", path, "-o", self.path("f.avi")]), 5)

    def test_pictures_of_an_unstable_scene_end_with_7_and_leave_nothing(self):
        spring = {"name": "stiff", "bodyA": "ball", "anchorA": [0, 0.1, 0], "anchorB": [0, 1, 0], "stiffness": 1e7, "restLength": 0.5}
        path = self.write("s.json", scene(springs=[spring], duration=2, method={"name": "rk4"}, camera={"position": [0, 0, 5], "target": [0, 0, 0]}))
        self.refuses(7, ["unstable at"], "video", path, "-o", self.path("f.mp4"))
        self.refuses(7, ["unstable at"], "render", path, "-o", self.path("f"))

    def test_an_interrupted_film_leaves_nothing_and_ends_at_once(self):
        while_simulating = scene(duration=1e6)
        while_drawing = scene(duration=100, output={"framesPerSecond": 60, "width": 640, "height": 360})
        beside = scene(duration=1e6, camera={"position": [0, 0, 5], "target": [0, 0, 0]})
        for document, number, exit_code in ((while_simulating, signal.SIGINT, 130), (while_drawing, signal.SIGTERM, 143),
                                            (beside, signal.SIGINT, 130)):
            self.write("s.json", document)
            os.makedirs(self.path("tmp"), exist_ok=True)
            process = subprocess.Popen([PROGRAM, "video", self.scene, "-o", self.path("f.mp4")], stderr=subprocess.PIPE, text=True,
                                       env={**os.environ, "TMPDIR": self.path("tmp")})
            time.sleep(1.5)  # all take minutes
            start = time.monotonic()
            process.send_signal(number)
            _, stderr = process.communicate(timeout=20)
            self.assertEqual(process.returncode, exit_code, stderr)
            self.assertRegex(stderr.splitlines()[-1], "^(interrupted|terminated)$")
            self.assertLess(time.monotonic() - start, 10)
            self.assertEqual(self.listing(), ["s.json", "tmp"])
            self.assertEqual(os.listdir(self.path("tmp")), [])

    def seconds_until_refused(self, exit_code, words, command):
        start = time.monotonic()
        self.refuses(exit_code, words, *command)
        return time.monotonic() - start

    def test_cameras_that_cannot_be_are_refused_before_anything_moves(self):
        for camera, words in (({"position": [0, 0.05, 0], "target": [0, 0, 5]}, ["/camera: ", 'inside body "ball"', "outside all bodies"]),
                              ({"position": [0, 5, 0], "target": [0, 0, 0]}, ["/camera: ", "along its up vector", '"up"']),
                              ({"position": [0, 5, 0], "target": "ball"}, ["/camera: ", "along its up vector"]),
                              ({"position": [1, 1, 1], "target": [1, 1, 1]}, ["/camera: ", "position is its target"]),
                              ({"target": "bal"}, ["/camera/target: ", 'no body "bal"', 'did you mean "ball"?'])):
            path = self.write("s.json", scene(camera=camera))
            for arguments in (["check", path], ["video", path, "-o", self.path("f.mp4")]):
                result = self.refuses(3, words, *arguments)
                self.assertEqual(len(result.stderr.splitlines()), 1)
        # One that a body comes upon: the ball falls onto it.
        path = self.write("s.json", scene(duration=0.5, camera={"position": [0, -0.5, 0], "target": [0, -0.5, 5]}))
        self.assertEqual(cradle("check", path).returncode, 0)
        self.refuses(3, ["/camera: at 0.3", 'inside body "ball"'], "render", path, "-o", self.path("f"))
        self.refuses(3, ["/camera: at 0.3", 'inside body "ball"'], "video", path, "-o", self.path("f.mp4"))

    def test_report_of_pictures_holds_what_it_was_made_of(self):
        path = self.write("s.json", scene(duration=0.05))
        for name, frames in (("a", "0:3"), ("b", "0:2")):
            cradle("render", path, "-o", self.path(name), "--frames", frames)
        os.replace(self.path("b/frame_000000.png"), self.path("b/frame_000001.png"))
        result = cradle("compare", self.path("a"), self.path("b"), "--report", self.path("r.html"))
        self.assertEqual(result.returncode, 9)
        self.assertIn(f"cp -- '{self.path('b/frame_000001.png')}' '{self.path('a')}'\n", result.stdout)
        page = content(self.path("r.html")).decode()
        self.assertIn("3 of 3 pictures fail", page)
        self.assertNotIn("http", page)
        pictures = [base64.b64decode(code) for code in re.findall("data:image/png;base64,([^\"]*)", page)]
        self.assertEqual(len(pictures), 3)
        self.assertEqual(pictures[0], content(self.path("a/frame_000001.png")))
        self.assertEqual(pictures[1], content(self.path("b/frame_000001.png")))

    def test_comparisons_for_continuous_integration(self):
        path = self.write("s.json", scene(duration=0.4))
        cradle("render", path, "-o", self.path("a"), "--frames", "0:15")
        shutil.copytree(self.path("a"), self.path("b"))
        for number in range(12):
            shutil.copy(self.path("a/frame_000014.png"), self.path(f"b/frame_{number:06}.png"))
        os.remove(self.path("b/frame_000012.png"))
        os.rename(self.path("b/frame_000013.png"), self.path("b/<frame>&.png"))
        arguments = ("compare", self.path("a"), self.path("b"), "--junit", self.path("r.xml"))
        result = cradle(*arguments)
        self.assertEqual(result.returncode, 9)
        lines = result.stdout.splitlines()
        missing = [self.path(f"a/frame_{number:06}.png") for number in (12, 13)]
        self.assertEqual(lines[10:], ["and 5 more", "15 of 16 pictures differ; 2 missing; 1 not expected",
                                      "To accept what you have looked at and found right:",
                                      f"  cp -- '{self.path('b')}'/*.png '{self.path('a')}'",
                                      "To expect what is missing no longer:", f"  rm -- '{missing[0]}' '{missing[1]}'"])
        suites = ElementTree.parse(self.path("r.xml")).getroot()
        (suite,) = suites
        self.assertEqual((suites.tag, suite.get("tests"), suite.get("failures")), ("testsuites", "16", "15"))
        failures = {test.get("name"): test.find("failure") for test in suite}
        self.assertEqual([name for name, failure in failures.items() if failure is None], ["frame_000014.png"])
        self.assertEqual(failures["frame_000012.png"].get("message"), "missing")
        self.assertEqual(failures["<frame>&.png"].get("message"), "not expected")

        document = json.loads(cradle(*arguments, "--json").stdout)
        self.assertEqual((document["passes"], len(document["pictures"])), (False, 16))
        pictures = {picture["name"]: picture for picture in document["pictures"]}
        self.assertIsNone(pictures["frame_000012.png"]["actual"])
        self.assertGreater(pictures["frame_000000.png"]["visiblePixels"], 0)
        self.assertTrue(pictures["frame_000014.png"]["same"])

        os.mkdir(self.path("none"))
        result = cradle("compare", self.path("a"), self.path("none"), "--junit", self.path("r.xml"))
        self.assertEqual(result.returncode, 9)
        self.assertEqual(result.stdout, f"{self.path('none')}: nothing was drawn, 15 pictures are expected\n")
        (suite,) = ElementTree.parse(self.path("r.xml")).getroot()
        self.assertEqual(suite.get("failures"), "15")
        self.refuses(2, ["--junit", "--report"], *arguments[:3], "--junit", self.path("x"), "--report", self.path("./x"))
        self.refuses(5, ["s.json", "no report of a comparison"], "compare", self.path("a"), self.path("b"), "--junit", path)

    def test_comparisons_of_trajectories_for_continuous_integration(self):
        for name, speed in (("a", 1), ("b", 1.25)):
            body = {"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "linearVelocity": [speed, 0, 0]}
            cradle("simulate", self.write(name + ".json", scene(bodies=[body], duration=0.5)), "-o", self.path(name + ".sqlite"))
        a, b, report = self.path("a.sqlite"), self.path("b.sqlite"), self.path("r.xml")
        result = cradle("compare", a, b, "--json", "--junit", report)
        self.assertEqual(result.returncode, 9)
        document = json.loads(result.stdout)
        (body,) = document["bodies"]
        self.assertAlmostEqual(body["position"], 0.125 / 1.5, places=12)  # |x - x_ref| / (1 + |x_ref|), largest at the end
        self.assertAlmostEqual(body["linearVelocity"], 0.25 / 2, places=12)
        self.assertEqual(document["worst"]["quantity"], "linear velocity")
        (failure,) = ElementTree.parse(report).getroot().iter("failure")
        self.assertIn("largest difference", failure.text)
        same = json.loads(cradle("compare", a, a, "--json", "--junit", report).stdout)
        self.assertTrue(same["passes"] and same["sameStateHash"])
        self.assertEqual(ElementTree.parse(report).getroot().find("testsuite").get("failures"), "0")

    def test_check_for_programs(self):
        plate = {"name": "plate", "shape": {"box": {"size": [2, 1, 4]}}, "mass": 12}
        document = json.loads(cradle("check", self.write("a.json", scene(bodies=[plate])), "--json").stdout)
        (body,) = document["bodies"]
        self.assertTrue(document["inOrder"])
        self.assertEqual((body["motion"], body["shape"], body["size"], body["mass"]), ("dynamic", "box", [2, 1, 4], 12))
        for row, moment in zip(range(3), (17, 20, 5)):  # m (b^2 + c^2) / 12
            self.assertAlmostEqual(body["inertiaTensor"][row][row], moment, places=12)
        path = self.write("b.json", scene(bodies=[{**plate, "mass": -1}, {**plate, "shape": {"cube": {}}}]))
        result = self.refuses(3, ["/bodies/0/mass", "/bodies/1/name", "/bodies/1/shape"], "check", path, "--json")
        faults = json.loads(result.stdout)["faults"]
        lines = [f"{path}:{fault['line']}:{fault['column']} {fault['pointer']}: {fault['message']}" for fault in faults]
        self.assertEqual(result.stderr.splitlines(), lines)
        missing = cradle("check", self.path("nowhere.json"), "--json")
        self.assertEqual(missing.returncode, 3)
        self.assertIn("nowhere.json", json.loads(missing.stdout)["faults"][0]["message"])

    def test_thresholds_of_pictures(self):
        path = self.write("s.json", scene(duration=0.05))
        cradle("render", path, "-o", self.path("a"), "--frames", "0:3")
        first, last = self.path("a/frame_000000.png"), self.path("a/frame_000002.png")
        self.assertEqual(cradle("compare", first, last).returncode, 9)
        self.assertEqual(cradle("compare", first, last, "--visible", "255:0", "--striking", "255:0").returncode, 0)
        self.assertEqual(cradle("compare", first, last, "--visible", "0:100", "--striking", "0:100").returncode, 0)
        self.assertEqual(cradle("compare", first, first, "--visible", "0:0", "--striking", "0:0").returncode, 0)
        for value in ("2", "2:", ":1", "256:1", "-1:1", "2:101", "2:1x", "2:nan"):
            self.refuses(2, ["--visible", value, "LEVEL:PERCENT"], "compare", first, last, f"--visible={value}")

    def test_compare_of_pictures(self):
        cradle("render", self.scene, "-o", self.path("a"))
        cradle("render", self.scene, "-o", self.path("b"))
        self.assertEqual(cradle("compare", self.path("a"), self.path("b")).returncode, 0)
        os.replace(self.path("b/frame_000005.png"), self.path("b/frame_000000.png"))
        result = cradle("compare", self.path("a"), self.path("b"))
        self.assertEqual(result.returncode, 9)
        self.assertIn("frame_000005.png: missing", result.stdout)

    def test_gif_and_title_card(self):
        path = self.write("t.json", scene(titleCard={"title": "Balls", "seconds": 0.5}))
        for name, frames in (("f.mp4", 36), ("f.gif", 18)):  # 60 pictures a second are too many for a .gif
            self.assertEqual(cradle("video", path, "-o", self.path(name)).returncode, 0)
            self.assertEqual(film_frames(self.path(name)), f"64,36,{frames}")
        again = self.path("again.gif")
        self.assertEqual(cradle("video", path, "-o", again).returncode, 0)
        self.assertEqual(content(again), content(self.path("f.gif")))

    def test_the_axis_against_gravity_is_up(self):
        """A scene that is turned as a whole, gravity too, has the same pictures, heights and models."""
        turns = {"y": lambda x, y, z: [x, y, z], "z": lambda x, y, z: [x, -z, y], "-x": lambda x, y, z: [-y, x, z]}
        heights = {}
        for name, turn in turns.items():
            path = self.write(name + ".json", scene(
                gravity=turn(0, -9.81, 0), duration=0.2, output={"framesPerSecond": 10, "width": 160, "height": 120},
                bodies=[{"name": "floor", "shape": {"plane": {"normal": turn(0, 1, 0)}}, "motion": "static"},
                        {"name": "ball", "shape": {"sphere": {"radius": 0.2}}, "position": turn(0, 1, 0), "linearVelocity": turn(1, 0, 0.5)},
                        {"name": "left", "shape": {"sphere": {"radius": 0.1}}, "position": turn(-1, 0.1, 0)}],
                rods=[{"bodyA": "left", "anchorA": [0, 0, 0], "anchorB": turn(-1, 1, 0)}],
                pushes=[{"body": "ball", "ray": {"origin": turn(0, 1, 3), "direction": turn(0, 0, -1)}, "force": turn(0, 0, -3), "start": 0.1, "duration": 0.1}]))
            self.assertEqual(cradle("render", path, "-o", self.path(name), "--overlay", "velocities,plot=height:ball").returncode, 0)
            run = self.path(name + ".sqlite")
            self.assertEqual(cradle("simulate", path, "-o", run).returncode, 0)
            self.assertEqual(cradle("export", run, "-o", self.path(name + ".glb")).returncode, 0)
            model = json.loads(content(self.path(name + ".glb"))[20:].split(b"\0")[0].decode(errors="ignore").rsplit("}", 1)[0] + "}")
            heights[name] = [node["translation"] for node in model["nodes"] if node.get("name") == "ball"][0]
        for name in ("z", "-x"):
            result = cradle("compare", self.path("y"), self.path(name))
            self.assertEqual(result.returncode, 0, result.stdout)
            for a, b in zip(heights["y"], heights[name]):
                self.assertAlmostEqual(a, b, places=6)

    def test_films_side_by_side(self):
        slow = self.write("slow.json", scene(duration=0.05, method={"name": "rk4", "timeStep": 0.01}))
        film = self.path("f.mp4")
        result = cradle("video", self.scene, slow, "--side-by-side", "-o", film, "--size", "64x40")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(film_frames(film), "128,44,6")  # a strip of a tenth above each
        there = self.listing()
        other = self.write("other.json", scene(output={"framesPerSecond": 30, "width": 64, "height": 36}))
        there = self.listing()
        for words, arguments in (([other, "30 frames a second", "need the same"], [self.scene, other, "--side-by-side"]),
                                 (["--side-by-side", "found 1"], [self.scene, "--side-by-side"]),
                                 ([slow, "--side-by-side"], [self.scene, slow])):
            self.refuses(2, words, "video", *arguments, "-o", self.path("x.mp4"), leaves=there)

    def test_video_has_all_frames(self):
        self.assertEqual(cradle("video", self.scene, "-o", self.path("f.mp4")).returncode, 0)
        self.assertEqual(film_frames(self.path("f.mp4")), "64,36,6")
        self.assertEqual(self.listing(), ["f.mp4", "s.json"])

    def test_slow_motion_and_time_lapse_change_the_number_of_pictures(self):
        for speed, pictures in ((0.5, 12), (3, 2)):
            path = self.write("s.json", scene(output={"width": 64, "height": 36, "playbackSpeed": speed}))
            self.assertEqual(cradle("video", path, "-o", self.path("f.mp4")).returncode, 0)
            self.assertEqual(film_frames(self.path("f.mp4")), f"64,36,{pictures}")
            self.assertEqual(cradle("simulate", path, "-o", self.path("f.sqlite")).returncode, 0)
            times = sqlite3.connect(self.path("f.sqlite")).execute("select time from frame order by id").fetchall()
            self.assertEqual(len(times), pictures + 1)
            for number, (time_,) in enumerate(times):
                self.assertAlmostEqual(time_, number * speed / 60, delta=1e-15)

    def test_encode_of_a_rendered_folder_has_all_frames(self):
        cradle("render", self.scene, "-o", self.path("frames"))
        self.assertEqual(cradle("encode", self.path("frames"), "-o", self.path("f.mp4")).returncode, 0)
        self.assertEqual(film_frames(self.path("f.mp4")), "64,36,6")

    def test_opengl_is_needed_by_pictures_alone(self):
        self.write("libOSMesa.so.8", b"no library")
        environment = {**os.environ, "LD_LIBRARY_PATH": self.folder}
        self.assertEqual(cradle("simulate", self.scene, "-o", self.path("a.sqlite"), env=environment).returncode, 0)
        result = cradle("render", self.scene, "-o", self.path("frames"), env=environment)
        self.assertEqual((result.returncode, result.stderr.count("\n")), (8, 1), result.stderr)
        self.assertRegex(result.stderr, "OpenGL: .*libOSMesa.so.8.*install libosmesa6")
        self.assertEqual(self.listing(), ["a.sqlite", "libOSMesa.so.8", "s.json"])

    def test_a_missing_or_dying_encoder_ends_with_6_and_leaves_nothing(self):
        os.mkdir(self.path("bin"))
        environment = {**os.environ, "PATH": self.path("bin")}
        for script in (None, "#!/bin/sh\nexit 3\n", "#!/bin/sh\nhead -c 100 >/dev/null\necho no more >&2\nexit 1\n"):
            if script:
                with open(self.path("bin/ffmpeg"), "w") as file:
                    file.write(script)
                os.chmod(self.path("bin/ffmpeg"), 0o755)
            result = cradle("video", self.scene, "-o", self.path("f.mp4"), env=environment)
            self.assertEqual(result.returncode, 6, result.stderr)
            self.assertIn("ffmpeg", result.stderr)
            self.assertEqual(self.listing(), ["bin", "s.json"])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
