#!/usr/bin/env python3
"""The installed libraries, as programs of others link them: examples/library is built from the installed tree alone.

    library_test.py PROGRAM SOURCE_FOLDER BUILD_FOLDER CMAKE
"""
import os, shutil, subprocess, sys, tempfile, unittest

PROGRAM, SOURCE, BUILD, CMAKE = (os.path.abspath(path) for path in sys.argv[1:5])
SCENE = os.path.join(SOURCE, "scenes", "newtons_cradle.json")

# What a program with a window has: functions of OpenGL, and a GLEW, of its own. None of them may be called.
WINDOW = """
#include <cstdlib>
extern "C" {
void glClear(unsigned) { std::abort(); }
void glViewport(int, int, int, int) { std::abort(); }
void* glXGetProcAddressARB(const unsigned char*) { std::abort(); }
unsigned glewInit() { std::abort(); }
void (*__glewActiveTexture)(unsigned) = nullptr;
}
"""
# A film that goes with the last objects of a program; and one that is linked to take denormal numbers for 0.
LAST = """
#include <cradle/render.h>
#include <cradle/simulate.h>
#include <cstdio>
#include <optional>
namespace cr = cradle::v1;
std::optional<cr::Film> film;
int main(int, char** argv) {
  const cr::Trajectory motion = cr::simulate(cr::Scene::load(argv[1]));
  film.emplace(motion, cr::PictureOptions{64, 36, ""});
  film->draw(0);
  film = cr::Film(motion, {32, 18});
  cr::Film other = std::move(*film);
  try {
    film->draw(0);
  } catch (const cr::Error&) {
    std::printf("%s %d", motion.meta().at("stateHash").c_str(), other.draw(1).width);
  }
}
"""
# What functions of the caller throw comes back as it was thrown, from each of them.
THROWS = """
#include <cradle/simulate.h>
#include <cradle/watch.h>
#include <cstdio>
#include <new>
#include <system_error>
namespace cr = cradle::v1;
template <class Thrown>
void told(const char* name, const cr::Scene& scene, const cr::Callbacks& callbacks) {
  try {
    cr::simulate(scene, callbacks);
    std::printf("%s ended\\n", name);
  } catch (const Thrown&) {
    std::printf("%s\\n", name);
  }
}
int main(int, char** argv) {
  const cr::Scene scene = cr::Scene::load(argv[1]);
  told<std::bad_alloc>("frame", scene, {.frame = [](const cr::Frame&) { throw std::bad_alloc(); }});
  told<std::system_error>("event", scene, {.event = [](const cr::Event&) { throw std::system_error(std::error_code()); }});
  told<int>("frame again", scene, {.frame = [](const cr::Frame& frame) { if (frame.number == 2) throw 3; }});
  bool hasFrame = false;
  {
    const cr::Watch watch([] { throw std::logic_error("enough"); });
    told<std::logic_error>("watch", scene, {.frame = [&](const cr::Frame&) { hasFrame = true; }});
  }
  told<int>(hasFrame ? "too late" : "without a watch", scene, {});
}
"""
PROJECT = """
cmake_minimum_required(VERSION 3.25)
project(others LANGUAGES CXX)
find_package(Cradle 0.1 REQUIRED)
add_executable(window %s window.cpp)
target_link_libraries(window PRIVATE Cradle::render)
add_executable(last last.cpp)
target_link_libraries(last PRIVATE Cradle::render)
target_link_options(last PRIVATE -ffast-math)
add_executable(throws throws.cpp)
target_link_libraries(throws PRIVATE Cradle::simulate)
"""


def run(*command, **options):
    done = subprocess.run(command, capture_output=True, text=True, **options)
    if done.returncode != 0:
        raise AssertionError("%s\n%s%s" % (" ".join(command), done.stdout[-4000:], done.stderr[-4000:]))
    return done.stdout


def names(path, *options):
    return [line.split()[-1] for line in run("nm", *options, path).splitlines() if len(line.split()) >= 2]


class Library(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp()
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.prefix = os.path.join(cls.folder, "installed")
        run(CMAKE, "--install", BUILD, "--prefix", cls.prefix)
        cls.example = cls.build(os.path.join(SOURCE, "examples", "library"), "example")
        project = os.path.join(cls.folder, "others_project")
        os.mkdir(project)
        pictures = os.path.join(SOURCE, "examples", "library", "pictures.cpp")
        for name, text in (("CMakeLists.txt", PROJECT % pictures), ("window.cpp", WINDOW), ("last.cpp", LAST), ("throws.cpp", THROWS)):
            with open(os.path.join(project, name), "w") as file:
                file.write(text)
        cls.others = cls.build(project, "others")

    @classmethod
    def build(cls, project, name):
        folder = os.path.join(cls.folder, name)
        run(CMAKE, "-S", project, "-B", folder, "-G", "Ninja", "-DCMAKE_PREFIX_PATH=" + cls.prefix, "-DCMAKE_BUILD_TYPE=")
        run(CMAKE, "--build", folder)
        return folder

    def archive(self, name):
        found = [os.path.join(folder, name) for folder, _, files in os.walk(self.prefix) if name in files]
        self.assertEqual(len(found), 1)
        return found[0]

    # A pendulum that is let go at the height of its hinge comes up to it again. The frame next to the turn is at most
    # 1/120 s from it: -g t^2 / 2 = -3.4e-4 m. Energy is within 100 x accuracy of 0, of 20 J.
    def test_pendulum_comes_up_again(self):
        words = run(os.path.join(self.example, "pendulum")).split()
        self.assertEqual(words[:3], ["bob:", "601", "frames,"])
        self.assertGreater(float(words[6]), -4e-4)
        self.assertLess(float(words[6]), 1e-4)
        self.assertLess(abs(float(words[9])), 2e-6)

    def test_trajectory_and_picture_are_those_of_the_program(self):
        self.check_pictures(os.path.join(self.example, "pictures"))

    def check_pictures(self, program):
        folder = tempfile.mkdtemp(dir=self.folder)
        path = lambda name: os.path.join(folder, name)
        run(program, SCENE, path("a.sqlite"), path("a.ppm"))
        run(PROGRAM, "-q", "simulate", SCENE, "-o", path("b.sqlite"))
        self.assertIn("equal", run(PROGRAM, "compare", path("a.sqlite"), path("b.sqlite"), "--tolerance", "0"))
        frames = int(run("sqlite3", path("b.sqlite"), "select count(*) from frame"))
        run(PROGRAM, "-q", "render", path("b.sqlite"), "-o", path("b"), "--frames", str(frames - 1), "--overlay", "time")
        run("ffmpeg", "-v", "error", "-i", path("b/frame_%06d.png" % (frames - 1)), "-pix_fmt", "rgb24", path("b.ppm"))
        with open(path("a.ppm"), "rb") as ours, open(path("b.ppm"), "rb") as theirs:
            ours, theirs = ours.read().split(None, 4), theirs.read().split(None, 4)
        self.assertEqual(ours[:4], theirs[:4])
        self.assertEqual(ours[4], theirs[4])

    def test_a_program_with_a_window_keeps_its_functions(self):
        self.check_pictures(os.path.join(self.others, "window"))

    def test_films_end_with_the_program_and_bits_are_ours(self):
        scene = os.path.join(SOURCE, "scenes", "box_tray.json")
        found = run(os.path.join(self.others, "last"), scene).split()
        run(PROGRAM, "-qq", "simulate", scene, "-o", os.path.join(self.folder, "tray.sqlite"))
        expected = run("sqlite3", os.path.join(self.folder, "tray.sqlite"), "select value from meta where key = 'stateHash'")
        self.assertEqual(found, [expected.strip(), "32"])

    def test_simulation_needs_no_opengl(self):
        used = names(os.path.join(self.example, "pendulum"))
        self.assertTrue(any("simulate" in name for name in used))
        self.assertEqual([name for name in used if "OSMesa" in name or "glew" in name.lower() or name.startswith("glX")], [])

    def test_names_of_others_stay_inside(self):
        for archive in ("libcradle_simulate.a", "libcradle_render.a"):
            shown = names(self.archive(archive), "--extern-only", "--defined-only")
            self.assertGreater(len(shown), 100)
            self.assertEqual([name for name in shown if not name.startswith(("_Z", "DW.ref", "cradle"))], [])
            self.assertEqual([name for name in shown if "5Eigen" in name], [])

    def test_the_installed_python_package_is_whole(self):
        if not os.path.isdir(os.path.join(BUILD, "python", "cradle")):
            self.skipTest("the build has no Python package")
        package = [os.path.dirname(folder) for folder, _, names in os.walk(self.prefix) if "py.typed" in names]
        program = "import cradle; print(len(cradle.simulate(%r)))" % SCENE
        said = run("/usr/bin/python3", "-B", "-c", program, env={**os.environ, "PYTHONPATH": package[0]})
        self.assertEqual(said.strip(), "601")

    def test_what_the_caller_throws_is_left_as_it_is(self):
        self.assertEqual(run(os.path.join(self.others, "throws"), SCENE).splitlines(),
                         ["frame", "event", "frame again", "watch", "without a watch ended"])

    def test_a_fault_is_an_exception_with_the_words_of_the_program(self):
        scene = os.path.join(self.folder, "fault.json")
        with open(scene, "w") as file:
            file.write('{"schema": "cradle-scene/1", "name": "x", "duration": -1, "bodies": []}')
        ours = subprocess.run([os.path.join(self.example, "pictures"), scene, os.path.join(self.folder, "f.sqlite"),
                               os.path.join(self.folder, "f.ppm")], capture_output=True, text=True)
        theirs = subprocess.run([PROGRAM, "check", scene], capture_output=True, text=True)
        self.assertEqual((ours.returncode, ours.stderr), (3, theirs.stderr))
        self.assertIn("/duration", ours.stderr)


unittest.main(argv=sys.argv[:1])
