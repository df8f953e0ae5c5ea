#!/usr/bin/env python3
"""Files of strangers, and what a machine may do to a run: nothing leaks, nothing is overwritten, nothing hangs.

    hostile_files_test.py PROGRAM SOURCE_FOLDER

Each file is made here, in code. A refusal has an exit code, a message of one line that names the file, little memory and
little time; and every file that was there before is as it was.
"""
import glob, json, os, shutil, sqlite3, struct, subprocess, sys, tempfile, time, unittest, zlib

import running
from running import MOST_MEMORY, MOST_SECONDS, PATIENCE, read

PROGRAM, SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
BALL = os.path.join(SOURCE, "assets", "ball.3ds")


def scene(*bodies, **changes):
    document = {"schema": "cradle-scene/1", "name": "test", "duration": 0.1, "output": {"framesPerSecond": 60},
                "bodies": list(bodies) or [{"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "mass": 1}]}
    document.update(changes)
    return document


def with_mesh(path):
    return scene({"name": "b", "shape": {"mesh": path}})


def gltf(uri):
    return {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"name": "t", "mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0],
                           "max": [1, 1, 0]}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"byteLength": 36, "uri": uri}]}


def chunk(identifier, data):
    """Of a 3ds file."""
    return struct.pack("<HI", identifier, len(data) + 6) + data


def journal_naming(victim, pages):
    """A rollback journal that asks SQLite to delete the file `victim`."""
    magic, name = bytes.fromhex("d9d505f920a163d7"), os.fsencode(victim)
    header = magic + struct.pack(">5I", 0, 0, pages, 512, 4096)
    tail = struct.pack(">I", 0x40000000 // 4096 + 1) + name + struct.pack(">II", len(name), sum(name)) + magic
    return header.ljust(512, b"\0") + tail


class HostileTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)
        self.secret = self.write("users/secret.txt", "dear diary")

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, content):
        return running.write(self.path(name), json.dumps(content) if isinstance(content, dict) else content)

    def everything(self):
        return running.everything(self.folder)

    def run_cradle(self, *arguments):
        return running.Ended(PROGRAM, arguments, self.folder)

    def refuses(self, code, words, *arguments):
        before = self.everything()
        ended = self.run_cradle(*arguments)
        self.assertEqual(ended.code, code, ended.error)
        for word in words:
            self.assertIn(word, ended.error)
        self.assertTrue(ended.error.endswith("\n") and all(c == "\n" or c.isprintable() for c in ended.error), ended.error)
        self.assertLess(ended.memory, MOST_MEMORY, arguments)
        self.assertLess(ended.seconds, MOST_SECONDS, arguments)
        self.assertEqual(self.everything(), before)
        return ended

    def trajectory(self, name="a.sqlite"):
        path = self.write("scene.json", scene())
        self.assertEqual(self.run_cradle("simulate", path, "-q", "-o", self.path(name)).code, 0)
        return self.path(name)


class Trajectories(HostileTest):
    def test_a_journal_that_names_a_file_deletes_none(self):
        for suffix, code in (("", 0), (".part", 2)):
            path = self.trajectory()
            os.rename(path, path + suffix)
            path += suffix
            self.write(os.path.basename(path) + "-journal", journal_naming(self.secret, os.path.getsize(path) // 4096))
            before = self.everything()
            for arguments in (("compare", path, path), ("export", path, "-o", "/dev/null/x.csv"),
                              ("render", path, "-o", "/dev/null/frames")):
                ended = self.run_cradle(*arguments)
                if arguments[0] == "compare":
                    self.assertEqual(ended.code, code, ended.error)
                self.assertEqual(self.everything(), before, arguments)
            if suffix:
                self.refuses(5, ["a.sqlite.part-journal", "none of cradle's"], "simulate", self.path("scene.json"), "-o",
                             self.path("a.sqlite"))
            os.remove(path + "-journal")

    def test_tables_that_compute_their_columns_take_no_memory(self):
        path = self.trajectory()
        with sqlite3.connect(path) as database:
            database.execute("ALTER TABLE event ADD COLUMN more AS (zeroblob(1000000000))")
        for arguments in (("compare", path, path), ("export", path, "-o", self.path("x.csv"))):
            self.refuses(2, [path, "computes"], *arguments)

    def test_damage_is_seen_where_it_is_used(self):
        for change in ("qw = 0.0, qx = 0.0, qy = 0.0, qz = 0.0", "qw = 1e200", "px = 1e308", "vy = -1e31"):
            path = self.trajectory()
            with sqlite3.connect(path) as database:
                database.execute("UPDATE state SET %s WHERE frame = 3" % change)
            for arguments in (("compare", path, path), ("export", path, "-o", self.path("x.csv")),
                              ("export", path, "-o", self.path("x.glb"))):
                self.refuses(2, [path, "damaged"], *arguments)
            os.remove(path)
        path = self.trajectory()
        with sqlite3.connect(path) as database:
            database.execute("UPDATE body SET mass = 0.0")
        self.refuses(2, [path, '"ball"', "mass"], "compare", path, path)

    def test_states_that_are_not_those_of_the_hash_are_no_equal_ones(self):
        path = self.trajectory()
        shutil.copy(path, self.path("b.sqlite"))
        with sqlite3.connect(self.path("b.sqlite")) as database:
            database.execute("UPDATE state SET px = px + 1")
        self.refuses(2, ["b.sqlite", "stateHash"], "compare", path, self.path("b.sqlite"))


class Meshes(HostileTest):
    def test_no_file_outside_of_the_meshs_folder_is_read(self):
        os.makedirs(self.path("strangers/deep"))
        os.symlink("../users", self.path("strangers/up"))
        for uri in ("../users/secret.txt", "deep/../../users/secret.txt", "up/secret.txt"):
            mesh = self.write("strangers/t.gltf", gltf(uri))
            self.refuses(4, [mesh, "not below its folder"], "inspect", mesh)
            path = self.write("strangers/scene.json", with_mesh("t.gltf"))
            self.refuses(4, [mesh, "not below its folder"], "simulate", path, "-o", self.path("x.sqlite"))
        mesh = self.write("strangers/t.obj", "mtllib ../users/secret.txt\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        self.assertNotIn("dear", self.refuses(4, [mesh, "not below its folder"], "inspect", mesh).error)

    def test_meshes_of_a_scene_are_below_the_asset_root(self):
        shutil.copy(BALL, self.path("users/ball.3ds"))
        shutil.copy(BALL, self.write("strangers/ball.3ds", ""))
        os.symlink("../users/ball.3ds", self.path("strangers/link.3ds"))
        root = self.path("strangers")
        for mesh, code in (("ball.3ds", 0), ("../users/ball.3ds", 4), (self.path("users/ball.3ds"), 4), ("link.3ds", 4),
                           ("../users/none.3ds", 4)):
            path = self.write("strangers/scene.json", with_mesh(mesh))
            commands = {"check": (), "plan": (), "simulate": ("-o", self.path("x.sqlite")),
                        "render": ("-o", self.path("frames")), "video": ("-o", self.path("x.mp4"))}
            for command, output in commands.items():
                if code == 0 and command not in ("check", "plan"):
                    continue
                arguments = (command, path, "--asset-root", root, *output)
                if code:
                    self.refuses(code, ["not below", root], *arguments)
                else:
                    self.assertEqual(self.run_cradle(*arguments).code, 0)
        self.refuses(2, ["nowhere", "folder"], "check", path, "--asset-root", self.path("nowhere"))

    def test_3ds_files_do_not_fill_stack_or_memory(self):
        ball = read(BALL)
        name = chunk(0xB010, b"Box\0" + bytes(4) + b"\xff\xff")
        deep = ball + chunk(0xB000, chunk(0xB002, 20_000 * name))
        deep = deep[:2] + struct.pack("<I", len(deep)) + deep[6:]
        wide = {count: chunk(0x4D4D, chunk(0x3D3D, count * chunk(0xAFFF, b"m"))) for count in (100_000, 1_000_000)}
        for content in (deep, *wide.values()):
            mesh = self.write("m.3ds", content)
            self.refuses(4, [mesh], "inspect", mesh)


class Places(HostileTest):
    def test_pipes_folders_and_trajectories_are_no_scenes(self):
        os.mkfifo(self.path("pipe"))
        os.mkdir(self.path("folder"))
        texts = set()
        for name, words in (("pipe", "regular file"), ("folder", "directory"), ("none.json", "no such file"),
                            (os.path.basename(self.trajectory()), "trajectory")):
            for command in ("check", "plan"):
                ended = self.refuses(3, [self.path(name), words], command, self.path(name))
            texts.add(ended.error.replace(self.path(name), ""))
        self.assertEqual(len(texts), 4)

    def test_names_stay_on_their_line_and_turn_nothing(self):
        names = {"n\nINJECTED": 2, "\x1b[2J\u202ename": 1}
        for name in names:
            both = scene(*({"name": name + end, "shape": {"sphere": {"radius": 0.1}}, "mass": 1} for end in "ab"))
            ended = self.refuses(3, ["overlap"], "check", self.write("both.json", both))
            self.assertEqual(len(ended.error.splitlines()), 1, ended.error)
            one = self.write("one.json", scene({"name": name, "shape": {"sphere": {"radius": 0.1}}, "mass": 1}, name=name))
            trajectory = self.path("one.sqlite")
            for arguments in (("simulate", one, "-q", "--check-accuracy", "-o", trajectory), ("plan", one),
                              ("export", trajectory, "-o", self.path("one.csv")),
                              ("study", one, "--methods", "rk4", "-o", self.path("study"))):
                ended = self.run_cradle(*arguments)
                self.assertEqual(ended.code, 0, ended.error)
                for text in (ended.out, ended.error):
                    self.assertTrue(all(c == "\n" or c.isprintable() for c in text), text)
                    self.assertFalse(any(line.startswith("INJECTED") for line in text.splitlines()), text)
            rows = read(self.path("one.csv")).decode().splitlines()
            self.assertEqual({row.count(",") for row in rows}, {rows[0].count(",")})
            for ending in ("csv", "svg"):
                for file in glob.glob(self.path("study/*." + ending)):
                    text = read(file).decode()
                    self.assertFalse("\x1b" in text or "\u202e" in text, file)
            shutil.rmtree(self.path("study"))

    def test_a_report_has_no_raw_names(self):
        trajectory = self.trajectory()
        for folder, size in (("a", "32x32"), ("b", "16x16")):
            self.assertEqual(self.run_cradle("render", trajectory, "-q", "--frames", "0:1", "--size", size, "-o", self.path(folder)).code, 0)
            os.rename(self.path(folder + "/frame_000000.png"), self.path(folder + "/\x1b[2J\u202e<b>.png"))
        self.assertEqual(self.run_cradle("compare", self.path("a"), self.path("b"), "--report", self.path("r.html")).code, 9)
        report = read(self.path("r.html")).decode()
        self.assertFalse("\x1b" in report or "\u202e" in report or "<b>" in report)

    def test_a_mesh_that_links_elsewhere_tells_nothing_of_it(self):
        for ending in ("q3o", "obj", "ply", "x", "nff", "ac", "bvh"):
            os.makedirs(self.path("strangers"), exist_ok=True)
            mesh = self.path("strangers/m." + ending)
            os.symlink(self.secret, mesh)
            ended = self.refuses(4, [], "inspect", mesh)
            self.assertNotIn("dear", ended.error)

    def test_a_limit_on_files_stops_a_film_with_its_own_code(self):
        trajectory = self.trajectory()
        for blocks in (0, 1):
            ended = running.Ended("/bin/sh", ("-c", 'ulimit -f %d; exec "$0" "$@"' % blocks, PROGRAM, "video", trajectory, "-q", "--size",
                                              "64x64", "-o", self.path("x.mp4")), self.folder)
            self.assertEqual(ended.code, 5, ended.error)
            self.assertFalse(os.path.exists(self.path("x.mp4")))

    def test_links_in_the_way_are_not_followed(self):
        path = self.trajectory()
        os.mkdir(self.path("frames"))
        for name, arguments in (("x.csv", ("export", path, "-o", self.path("x.csv"))),
                                ("x.glb", ("export", path, "-o", self.path("x.glb"))),
                                ("x.mp4", ("video", path, "-q", "--size", "32x32", "-o", self.path("x.mp4"))),
                                ("frames/frame_000000.png", ("render", path, "-q", "--size", "32x32", "--frames", "0:1", "--overwrite",
                                                             "-o", self.path("frames"))),
                                ("x.sqlite", ("simulate", self.path("scene.json"), "-q", "-o", self.path("x.sqlite")))):
            part = self.path(name + ".part")
            for plant in (os.symlink, os.link):
                if name == "x.sqlite" and plant is os.link:
                    continue  # an earlier part is removed, not written into
                plant(self.secret, part)
                ended = self.run_cradle(*arguments)
                self.assertEqual(ended.code, 5, ended.error)
                self.assertIn(os.path.basename(part), ended.error)
                self.assertEqual(read(self.secret), b"dear diary")
                self.assertFalse(os.path.exists(self.path(name)))
                os.remove(part)
            self.assertEqual(self.run_cradle(*arguments).code, 0, name)

    def test_a_second_run_with_the_same_output_says_who_holds_it(self):
        path = self.write("long.json", scene(duration=60, output={"framesPerSecond": 240, "width": 320, "height": 240}))
        for name, arguments in (("x.mp4", ("video", path, "-q", "-o", self.path("x.mp4"))),
                                ("x.sqlite", ("simulate", path, "-q", "--method", "rk4", "--time-step", "1e-6", "-o",
                                              self.path("x.sqlite")))):
            first = subprocess.Popen([PROGRAM, *arguments], stderr=subprocess.DEVNULL)
            try:
                deadline = time.monotonic() + PATIENCE
                while not os.path.exists(self.path(name + ".part")) or not os.path.getsize(self.path(name + ".part")):
                    self.assertLess(time.monotonic(), deadline)
                    self.assertIsNone(first.poll())
                    time.sleep(0.01)
                ended = self.run_cradle(*arguments)
                self.assertEqual(ended.code, 5, ended.error)
                self.assertIn("process %d" % first.pid, ended.error)
            finally:
                first.terminate()
                first.wait()

    def test_a_second_run_into_the_same_folder_says_who_holds_it(self):
        path = self.write("long.json", scene(duration=60, output={"framesPerSecond": 240, "width": 320, "height": 240}))
        arguments = ("render", path, "-q", "--overwrite", "-o", self.path("frames"))
        first = subprocess.Popen([PROGRAM, *arguments], stderr=subprocess.DEVNULL)
        try:
            self.wait_for(first, lambda: os.path.isdir(self.path("frames")) and os.listdir(self.path("frames")))
            ended = self.run_cradle(*arguments)
            self.assertEqual(ended.code, 5, ended.error)
            self.assertIn("process %d" % first.pid, ended.error)
        finally:
            first.kill()
            first.wait()
        ended = self.run_cradle(*arguments, "--frames", "0:1")
        self.assertEqual(ended.code, 0, ended.error)

    def wait_for(self, process, condition):
        deadline = time.monotonic() + PATIENCE
        while not condition():
            self.assertLess(time.monotonic(), deadline)
            self.assertIsNone(process.poll())
            time.sleep(0.01)

    def test_parts_of_others_are_left_alone(self):
        path = self.write("long.json", scene(duration=60, output={"framesPerSecond": 240, "width": 320, "height": 240}))
        self.write("scene.json", scene())
        film, part = self.path("x.mp4"), self.path("x.mp4.part")
        first = subprocess.Popen([PROGRAM, "video", path, "-q", "-o", film], stderr=subprocess.DEVNULL)
        try:
            self.wait_for(first, lambda: os.path.exists(part))
            number = os.stat(part).st_ino
            ended = self.run_cradle("simulate", self.path("scene.json"), "-q", "-o", film)
            self.assertEqual(ended.code, 5, ended.error)
            self.assertIn("process %d" % first.pid, ended.error)
            self.assertEqual(os.stat(part).st_ino, number)
        finally:
            first.terminate()
            first.wait()
        source = self.trajectory()
        for arguments in (("simulate", self.path("scene.json"), "-o", self.path("b.sqlite.part")),
                          ("render", source, "-o", self.path("b.part"))):
            self.refuses(5, [arguments[-1], "unfinished"], *arguments)

    def test_shaders_are_regular_files(self):
        path = self.trajectory()
        shaders = self.path("shaders")
        shutil.copytree(os.path.join(SOURCE, "shaders"), shaders)
        shader = os.path.join(shaders, "surface.vert")
        for plant in (os.mkfifo, lambda name: os.symlink("/dev/zero", name), lambda name: running.write(name, 2_000_000 * "\n"),
                      lambda name: running.write(name, '#include "surface.vert"\n')):
            os.remove(shader)
            plant(shader)
            ended = self.run_cradle("render", path, "-q", "-o", self.path("frames"), "--shaders", shaders)
            self.assertEqual(ended.code, 2, ended.error)
            self.assertIn("surface.vert", ended.error)
            self.assertLess(ended.memory, MOST_MEMORY)

    def test_a_folder_that_is_gone_holds_no_outputs(self):
        path = self.trajectory()
        for arguments in (("simulate", self.path("scene.json"), "-q", "-o", "x.sqlite"), ("render", path, "-q", "-o", "x"),
                          ("study", self.path("scene.json"), "-q", "--methods", "rk4", "-o", "s"), ("export", path, "-o", "x.csv"),
                          ("stability", "-q", "--maps", "logistic", "-o", "s")):
            line = 'mkdir gone && cd gone && rmdir ../gone && exec "$@"'
            ended = subprocess.run(["sh", "-c", line, "sh", PROGRAM, *arguments], cwd=self.folder, stdout=subprocess.DEVNULL,
                                   stderr=subprocess.PIPE)
            self.assertEqual((ended.returncode, ended.stderr.count(b"\n")), (5, 1), (arguments, ended.stderr))

    def test_standard_files_that_are_closed_or_full(self):
        self.trajectory()
        shutil.copy(BALL, self.path("ball.3ds"))
        for code, line in ((0, "inspect ball.3ds <&- 2>&-"), (5, "inspect ball.3ds <&- >&- 2>&-"), (0, "check scene.json 2>/dev/full"),
                           (3, "check none.json 2>/dev/full"), (3, "check none.json 2>&-"), (5, "--help >/dev/full"),
                           (5, "--version >/dev/full"), (5, "simulate --help >/dev/full"), (2, "simulat 2>/dev/full"),
                           (0, "render a.sqlite --size 32x32 -o full 2>/dev/full"), (0, "render a.sqlite --size 32x32 -o closed 2>&-")):
            ended = subprocess.run('exec "%s" %s' % (PROGRAM, line), shell=True, cwd=self.folder, stdin=subprocess.DEVNULL,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=PATIENCE)
            self.assertEqual(ended.returncode, code, line)

    def test_an_empty_temporary_folder_is_none(self):
        self.write("scene.json", scene())
        ended = running.Ended(PROGRAM, ("render", "scene.json", "-q", "--size", "32x32", "-o", "frames"), self.folder, {"TMPDIR": ""})
        self.assertEqual(ended.code, 0, ended.error)

    def test_a_name_makes_no_line_of_its_own(self):
        name = "b\nscene.json: all is well\u202e"
        body = {"name": name, "shape": {"sphere": {"radius": 0.1}}, "mass": 1}
        path = self.write("scene.json", scene(body, {**body, "name": name + "2", "position": [1, 0, 0]}, name=name))
        for command in ("check", "plan"):
            ended = self.run_cradle(command, path)
            self.assertEqual(ended.code, 0, ended.error)
            for line in (ended.out + ended.error).splitlines():
                self.assertFalse(line.startswith("scene.json: all"), line)
            self.assertIn("b\\x0ascene.json", ended.out)

    def test_names_that_are_none_are_refused(self):
        path = self.trajectory()
        frames = self.path("frames")
        self.assertEqual(self.run_cradle("render", path, "-q", "--size", "32x32", "-o", frames).code, 0)
        endings = {"simulate": "", "render": "", "export": ".csv", "video": ".mp4", "encode": ".mp4"}
        for command, ending in endings.items():
            source = {"simulate": self.path("scene.json"), "encode": frames}.get(command, path)
            for name in ("", (251 - len(ending)) * "a" + ending, (300 - len(ending)) * "a" + ending, 1000 * "a/" + ending):
                ended = self.run_cradle(command, source, "-q", "-o", name)
                self.assertIn(ended.code, (2, 5), (command, name, ended.error))
        for rate in ("0", "-1", "nan", "1e300", "inf"):
            self.refuses(2, ["--frames-per-second", "allowed"], "encode", frames, "-o", self.path("x.mp4"),
                         "--frames-per-second", rate)

    def test_a_report_replaces_reports_only(self):
        path = self.trajectory()
        for folder, size in (("a", "32x32"), ("b", "32x32")):
            self.assertEqual(self.run_cradle("render", path, "-q", "--frames", "0:1", "--size", size, "-o", self.path(folder)).code, 0)
        for report in ("scene.json", "a.sqlite", "users/secret.txt", "a/frame_000000.png"):
            self.refuses(5, [report, "no report"], "compare", self.path("a"), self.path("b"), "--report", self.path(report))
        for _ in range(2):
            self.assertEqual(self.run_cradle("compare", self.path("a"), self.path("b"), "--report", self.path("r.html")).code, 0)

    def test_what_is_to_be_pasted_is_quoted(self):
        path = self.trajectory()
        evil = self.path("a'; touch 'evil")
        for folder, command in ((evil, "a"), (self.path("b"), "b")):
            self.assertEqual(self.run_cradle("render", path, "-q", "--size", "32x32", "--frames", "0:%d" % (1 + (command == "b")),
                                             "-o", folder).code, 0)
        ended = self.run_cradle("compare", evil, self.path("b"))
        self.assertEqual(ended.code, 9)
        lines = [line for line in ended.out.splitlines() if line.startswith("  cp ")]
        self.assertTrue(lines)
        subprocess.run(["sh", "-c", "\n".join(lines)], cwd=self.folder, check=True)
        self.assertFalse(os.path.exists(self.path("evil")))
        self.assertEqual(self.run_cradle("compare", evil, self.path("b")).code, 0)

    def test_a_folder_with_a_bar_runs_no_command(self):
        path = self.write("scene.json", scene())
        os.mkdir(self.path("evil"))
        ended = self.run_cradle("study", path, "-q", "--methods", "rk4", "-o", "|touch evil")
        self.assertIn(ended.code, (0, 2, 5), ended.error)
        self.assertEqual(os.listdir(self.path("evil")), [])

    def test_sizes_are_those_of_the_files(self):
        for name, code, size in (("a.json", 3, 100_000_000), ("m.stl", 4, 300_000_000)):
            path = self.write(name, "")
            os.truncate(path, size)
            self.refuses(code, [path, "%d.0 MB" % (size // 1_000_000)], "check" if code == 3 else "inspect", path)

    def test_holes_of_files_take_little_memory(self):
        path = self.write("m.stl", bytes(80) + struct.pack("<I", 4_000_000))
        os.truncate(path, 84 + 4_000_000 * 50)
        self.assertLess(self.run_cradle("inspect", path).memory, MOST_MEMORY)

    def test_a_picture_larger_than_the_others_is_refused_by_its_header(self):
        path = self.trajectory()
        self.assertEqual(self.run_cradle("render", path, "-q", "--size", "32x32", "-o", self.path("p")).code, 0)
        part = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        header = struct.pack(">2I5B", 16384, 16384, 8, 6, 0, 0, 0)
        packer = zlib.compressobj()
        rows = b"".join(packer.compress(bytes(1 + 4 * 16384)) for _ in range(16384)) + packer.flush()
        self.write("p/frame_000001.png", b"\x89PNG\r\n\x1a\n" + part(b"IHDR", header) + part(b"IDAT", rows) + part(b"IEND", b""))
        self.refuses(2, ["frame_000001.png", "16384x16384", "32x32"], "encode", self.path("p"), "-o", self.path("x.mp4"))
        shutil.copytree(self.path("p"), self.path("q"))
        os.remove(self.path("q/frame_000001.png"))
        shutil.copy(self.path("q/frame_000000.png"), self.path("q/frame_000001.png"))
        self.assertLess(self.run_cradle("compare", self.path("p"), self.path("q")).memory, MOST_MEMORY)

    def test_a_picture_of_a_million_parts_is_read_soon(self):
        part = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        header, rows = struct.pack(">2I5B", 32, 32, 8, 2, 0, 0, 0), zlib.compress(bytes(97 * 32))
        self.write("p/frame_000000.png", b"\x89PNG\r\n\x1a\n" + part(b"IHDR", header) + 1_000_000 * part(b"teXt", b"k\0v") +
                   part(b"IDAT", rows) + part(b"IEND", b""))
        ended = self.run_cradle("encode", self.path("p"), "-q", "-o", self.path("x.mp4"))
        self.assertEqual(ended.code, 0, ended.error)
        self.assertLess(ended.seconds, MOST_SECONDS)

    def test_many_values_take_little_memory(self):
        path = self.write("a.json", "[" + 31_000_000 * "0," + "0]")
        self.refuses(3, [path, "values"], "check", path)

    def test_many_bodies_are_planned_in_little_time(self):
        """One by one: in a block, each on a spring, rod or joint of its own, and in a chain that ends at the world."""
        count = 30_000
        bodies = [{"name": "b%d" % i, "shape": {"sphere": {"radius": 0.1}}, "position": [0, i, 0]} for i in range(count)]
        springs = [{"bodyA": "b%d" % i, "anchorB": [0, i + 0.3, 0], "stiffness": 1e4} for i in range(count)]
        rods = [{"bodyA": "b%d" % i, "anchorB": [0, i + 0.3, 0]} for i in range(count)]
        chain = [{"bodyA": "b%d" % i, "bodyB": "b%d" % (i + 1), "anchorB": [0, 0, 0]} for i in reversed(range(count - 1))]
        alone = [dict(body, collision="none") for body in bodies]
        block = {"name": "b", "shape": {"sphere": {"radius": 0.1}}, "copies": {"count": [50, 50, 50], "spacing": [1, 1, 1]}}
        for name, content in (("block", scene(block)), ("springs", scene(*bodies, springs=springs)),
                              ("rods", scene(*bodies, rods=rods)),
                              ("chain", scene(*alone, rods=[*chain, {"bodyA": "b0", "anchorB": [0, -1, 0]}]))):
            ended = self.run_cradle("check", self.write(name + ".json", content))
            self.assertEqual(ended.code, 0, ended.error)
            self.assertLess(ended.seconds, MOST_SECONDS, name)
            self.assertLess(ended.memory, MOST_MEMORY, name)

    def test_many_pushes_are_planned_in_little_time(self):
        count = 40_000
        bodies = [{"name": "b%d" % i, "shape": {"sphere": {"radius": 0.1}}, "position": [0, i, 0], "collision": "none"} for i in range(count)]
        pushes = [{"body": "b%d" % i, "point": [0, 0, 0], "start": 0.01} for i in range(count)]
        ended = self.run_cradle("plan", self.write("a.json", scene(*bodies, pushes=pushes)))
        self.assertEqual(ended.code, 0, ended.error)
        self.assertLess(ended.seconds, MOST_SECONDS)

    def test_many_pushes_of_a_body_take_little_time(self):
        count = 40_000
        body = {"name": "b", "shape": {"sphere": {"radius": 0.1}}}
        pushes = [{"body": "b", "point": [0, 0, 0], "force": [1, 0, 0], "start": 10 * i / count, "duration": 5 / count} for i in range(count)]
        path = self.write("a.json", scene(body, pushes=pushes, duration=10))
        ended = self.run_cradle("simulate", path, "-q", "-o", self.path("a.sqlite"))
        self.assertEqual(ended.code, 0, ended.error)
        self.assertLess(ended.seconds, MOST_SECONDS)

    def test_copies_of_a_mesh_that_touch_do_not_fill_the_memory(self):
        knot = os.path.join(SOURCE, "assets", "torus_knot.3ds")
        copies = {"name": "b", "shape": {"mesh": knot}, "mass": 1, "copies": {"count": [20, 100, 10], "spacing": [9, 9, 9]}}
        self.assertLess(self.run_cradle("check", self.write("apart.json", scene(copies))).memory, MOST_MEMORY)
        swinging = {"name": "s", "shape": {"sphere": {}}, "position": [-90, 0, 0]}  # on a spring it may reach all others
        path = self.write("a.json", scene(copies, swinging, springs=[{"bodyA": "s", "anchorB": [-90, 3, 0]}]))
        self.refuses(8, [path, "/bodies/0", "30000000 points"], "check", path)

    def test_names_are_no_addresses(self):
        path = self.write("scene.json", scene())
        for name in ("file:x.sqlite", ":memory:", "a?mode=memory.sqlite"):
            self.assertEqual(self.run_cradle("simulate", path, "-q", "-o", name).code, 0)
            self.assertTrue(os.path.isfile(self.path(name)), name)
            self.assertEqual(self.run_cradle("compare", name, name).code, 0, name)


    def test_large_pictures_are_compared_in_little_memory(self):
        part = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        header, rows = struct.pack(">2I5B", 16384, 16384, 1, 0, 0, 0, 0), bytes(2049 * 16384)  # black and white
        for name, last in (("a", b""), ("b", b"\x01")):
            pixels = zlib.compress(rows[:len(rows) - len(last)] + last, 1)
            self.write("%s/0.png" % name, b"\x89PNG\r\n\x1a\n" + part(b"IHDR", header) + part(b"IDAT", pixels) + part(b"IEND", b""))
        for names, code, words in ((("a/0.png", "a/0.png"), 0, "the same"), (("a", "b"), 0, "1 of 268435456 pixels differ, by 255 at most")):
            ended = self.run_cradle("compare", *map(self.path, names))
            self.assertEqual(ended.code, code, ended.error)
            self.assertIn(words, ended.out)
            self.assertLess(ended.memory, 1 << 28)

    def test_limits_on_memory_are_told_before_mesa_crashes(self):
        path = self.trajectory()
        for option, megabytes in (("-v", 400), ("-v", 500), ("-v", 600), ("-d", 30), ("-d", 90), ("-d", 140)):
            for output in ("frames", "x.mp4"):
                ended = running.Ended("/bin/sh", ("-c", 'ulimit %s %d; exec "$0" "$@"' % (option, 1024 * megabytes), PROGRAM,
                                                  "render" if output == "frames" else "video", path, "-q", "-o", self.path(output)), self.folder)
                self.assertEqual(ended.code, 8, ended.error)
                self.assertIn("ulimit " + option, ended.error)
                self.assertFalse(os.path.exists(self.path(output)) or os.path.exists(self.path(output + ".part")))

    def test_what_goes_wrong_is_told_in_a_message_that_can_be_read(self):
        path = self.write("a.json", with_mesh("m" * 1_000_000))
        self.assertLess(len(self.refuses(4, ["mmm"], "check", path).error), 20_000)

    def test_warnings_are_told_up_to_fifty(self):
        bodies = [{"name": "b%d" % i, "shape": {"sphere": {}}, "motion": "static", "mass": 1} for i in range(1000)]
        ended = self.run_cradle("check", self.write("a.json", scene(*bodies)))
        self.assertEqual(ended.code, 0, ended.error)
        self.assertEqual(len(ended.error.splitlines()), 51)
        self.assertIn("and 950 more warnings", ended.error)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
