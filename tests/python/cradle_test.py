"""The package `cradle` for Python. CRADLE_PROGRAM and CRADLE_SOURCE say where the program and the sources are."""
import copy
import csv
import os
import signal
import subprocess
import sys
import threading
import time

import numpy
import pandas
import pytest

import cradle

PROGRAM, SOURCE = os.environ["CRADLE_PROGRAM"], os.environ["CRADLE_SOURCE"]
SCENE = os.path.join(SOURCE, "scenes", "newtons_cradle.json")
G = 9.81  # m/s^2

BALL = {"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "mass": 2, "position": [0, 1, 0], "linearVelocity": [3, 0, 0]}
FLOOR = {"name": "floor", "shape": {"plane": {}}, "motion": "static"}


def scene(duration=0.4, bodies=(FLOOR, BALL), **members):
    return {"schema": "cradle-scene/1", "name": "test", "duration": duration, "bodies": list(bodies), **members}


@pytest.fixture(scope="module")
def motion():
    return cradle.simulate(SCENE)


@pytest.fixture(scope="module")
def table(tmp_path_factory, motion):
    """What the program says of the same scene."""
    folder = tmp_path_factory.mktemp("program")
    path = str(folder / "a.sqlite")
    subprocess.run([PROGRAM, "-q", "simulate", SCENE, "-o", path], check=True)
    subprocess.run([PROGRAM, "-q", "export", path, "-o", str(folder / "a.csv")], check=True)
    with open(folder / "a.csv", newline="") as file:
        rows = list(csv.reader(file))
    return path, rows


def test_a_ball_falls_as_galileo_said():
    motion = cradle.simulate(scene())
    t = motion.times
    assert motion.bodies == ["ball"] and motion.positions.shape == (len(t), 1, 3)
    expected = numpy.stack([3 * t, 1 - G * t**2 / 2, 0 * t], axis=1)
    # Free flight is evaluated in closed form: rounding alone.
    assert numpy.abs(motion.positions[:, 0] - expected).max() < 1e-14
    assert numpy.abs(motion.linear_velocities[:, 0, 1] + G * t).max() < 1e-14
    assert motion.energy["kinetic"] == pytest.approx(9 + G**2 * t**2, rel=1e-14)
    assert motion.energy["momentum"].shape == (len(t), 3)


def test_states_are_those_of_the_program(motion, table):
    rows = table[1]
    names = [name.split(" ")[0] for name in rows[0]]
    bodies = len(motion.bodies)
    assert len(rows) - 1 == len(motion.times) * bodies
    frame = motion.to_pandas()
    ours = frame[["px", "py", "pz", "qw", "qx", "qy", "qz", "vx", "vy", "vz", "wx", "wy", "wz"]].to_numpy()
    first = next(i for i, name in enumerate(names) if name.startswith("px") or name.startswith("position"))
    theirs = numpy.array([[float(number) for number in row[first:first + 13]] for row in rows[1:]])
    assert (ours == theirs).all()
    assert isinstance(frame, pandas.DataFrame) and list(frame["body"][:bodies]) == motion.bodies


def test_a_saved_trajectory_is_that_of_the_program(motion, table, tmp_path):
    motion.save(tmp_path / "b.sqlite")
    compared = subprocess.run([PROGRAM, "compare", table[0], str(tmp_path / "b.sqlite"), "--tolerance", "0"])
    assert compared.returncode == 0
    again = cradle.Trajectory(tmp_path / "b.sqlite")
    assert (again.positions == motion.positions).all() and len(again.events) == len(motion.events)
    told = lambda motion: {key: text for key, text in motion.meta.items() if key not in ("cpuSeconds", "evaluations")}
    assert told(again) == told(motion) and "promised" in again.meta["promise"] and again.meta["stateHash"]


def test_saving_costs_no_other_file(motion, tmp_path):
    thesis, part = tmp_path / "thesis.txt", tmp_path / "a.sqlite.part"
    thesis.write_text("my thesis")
    part.write_text("unfinished")
    for path in (thesis, tmp_path / "a.sqlite"):
        with pytest.raises(cradle.Error) as fault:
            motion.save(path)
        assert fault.value.kind == "output"
    assert thesis.read_text() == "my thesis" and part.read_text() == "unfinished"
    with pytest.raises(TypeError):
        motion.save("a\0b.sqlite")


def test_arrays_are_views_of_one_copy(motion):
    first, second = motion.positions, motion.positions
    assert numpy.shares_memory(motion.times, motion.times) and not motion.times.flags.writeable
    assert numpy.shares_memory(first, second) and not first.flags.owndata and not first.flags.writeable
    assert numpy.shares_memory(motion.energy["kinetic"], motion.energy)
    with pytest.raises(ValueError):
        first[0, 0, 0] = 1
    kept = cradle.simulate(scene()).positions  # outlives its trajectory
    assert kept[0, 0, 1] == 1


def test_scenes_take_arrays_of_numpy():
    ball = {**BALL, "position": numpy.array([0, 1, 0]), "mass": numpy.float32(2)}
    assert cradle.simulate(scene(bodies=(FLOOR, ball))).positions[0, 0].tolist() == [0, 1, 0]
    with pytest.raises(TypeError):
        cradle.load({**scene(), "name": {1}})


def test_threads_share_a_trajectory():
    motion = cradle.simulate(SCENE)
    found = []

    def look(number):
        for _ in range(5):
            found.append((motion.positions.sum(), len(motion.events), cradle.render(motion, number, (64, 36)).sum()))

    threads = [threading.Thread(target=look, args=(number,)) for number in (3, 3, 3, 3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 20 and len(set(found)) == 1
    films = [cradle.Film(motion, (64, 36)) for _ in range(3)]
    thread = threading.Thread(target=lambda: [found.append(film.draw(3).sum()) for film in films] and films.clear())
    thread.start()
    thread.join()
    assert set(found[20:]) == {found[0][2]} and not films


def test_a_forked_child_simulates_and_says_that_it_cannot_draw():
    program = ("import cradle, os\n"
               "motion = cradle.simulate(%r)\n"
               "cradle.render(motion, 0, (64, 36))\n"
               "child = os.fork()\n"
               "if child == 0:\n"
               "    again = cradle.simulate(%r)\n"
               "    assert (again.positions == motion.positions).all()\n"
               "    try: cradle.render(again, 0, (64, 36))\n"
               "    except cradle.Error as error: assert error.kind == 'limit' and 'fork' in str(error)\n"
               "    else: os._exit(1)\n"
               "    os._exit(0)\n"  # as multiprocessing does: handlers of Mesa's wait at any other end
               "else: assert os.waitpid(child, 0)[1] == 0\n" % (scene(), scene()))
    subprocess.run([sys.executable, "-c", program], check=True, timeout=60)


def test_events_tell_what_happened():
    motion = cradle.simulate(scene(1, materials={"m": {"restitution": 0.5}},
                                   bodies=({**FLOOR, "material": "m"}, {**BALL, "material": "m", "linearVelocity": [0, 0, 0]})))
    impact = motion.events[0]
    assert impact.kind == "impact" and {motion.all_bodies[impact.body_a], motion.all_bodies[impact.body_b]} == {"floor", "ball"}
    # 0.9 m of fall; the impulse is m v (1 + e).
    assert impact.time == pytest.approx((1.8 / G) ** 0.5, abs=1e-5)
    assert impact.impulse == pytest.approx(2 * (1.8 * G) ** 0.5 * 1.5, rel=1e-4)
    assert abs(impact.normal[1]) == pytest.approx(1)


def test_contacts_carry_the_weight():
    motion = cradle.simulate(scene(bodies=(FLOOR, {**BALL, "position": [0, 0.1, 0], "linearVelocity": [0, 0, 0]})))
    (contact,) = motion.contacts(len(motion.times) - 1)
    assert abs(contact.normal_force[1]) == pytest.approx(2 * G, rel=1e-5)


def test_bodies_have_their_mass_properties():
    bodies = cradle.load(scene(bodies=(FLOOR, {"name": "box", "shape": {"box": {"size": [1, 2, 3]}}, "mass": 12}))).bodies
    assert [body.motion for body in bodies] == ["static", "dynamic"]
    assert bodies[1].inertia_tensor == pytest.approx(numpy.diag([13, 10, 5]))


def test_faults_are_exceptions_with_the_words_of_the_program(tmp_path):
    with pytest.raises(cradle.Error) as fault:
        cradle.load(scene(-1))
    assert fault.value.kind == "scene" and "/duration" in str(fault.value)
    with pytest.raises(cradle.Error) as fault:
        cradle.Trajectory(str(tmp_path / "none.sqlite"))
    assert fault.value.kind == "usage"
    with pytest.raises(cradle.Error) as fault:
        cradle.simulate(scene()).save("/proc/none.sqlite")
    assert fault.value.kind == "output"
    with pytest.raises(cradle.Error) as fault:
        cradle.simulate(scene()).contacts(99999)
    assert "frames 0 to" in str(fault.value)


def test_pictures_are_those_of_the_program(motion, table, tmp_path):
    last = len(motion.times) - 1
    subprocess.run([PROGRAM, "-q", "render", table[0], "-o", str(tmp_path), "--frames", str(last), "--size", "320x180",
                    "--overlay", "time"], check=True)
    decoded = subprocess.run(["ffmpeg", "-v", "error", "-i", str(tmp_path / ("frame_%06d.png" % last)), "-pix_fmt", "rgb24",
                              "-f", "rawvideo", "-"], check=True, capture_output=True).stdout
    expected = numpy.frombuffer(decoded, numpy.uint8).reshape(180, 320, 3)
    cradle.render(motion, 0, (320, 180), "time")
    picture = cradle.render(motion, last, (320, 180), "time")
    assert picture.dtype == numpy.uint8 and (picture == expected).all()
    assert (cradle.render(motion, last, (320, 180)) != expected).any()
    with pytest.raises(cradle.Error) as fault:
        cradle.render(motion, 0, (100000, 180))
    assert fault.value.kind == "usage" and "16384" in str(fault.value)
    for size in ((0, 5), (-1, 5), 64, (1, 2, 3), (64.0, 48.0)):
        with pytest.raises((cradle.Error, TypeError), match="size"):
            cradle.render(motion, 0, size)
    assert cradle.render(motion, 0, numpy.array([64, 48])).shape == (48, 64, 3)
    with pytest.raises(cradle.Error, match="^overlay: found"):
        cradle.render(motion, 0, (64, 48), "foo")


def test_other_threads_go_on_while_it_simulates_and_draws():
    slow = scene(60, method={"name": "rk4", "timeStep": 1e-5}, bodies=(BALL,), springs=[
        {"bodyA": "ball", "anchorB": [0, 3, 0], "stiffness": 200, "restLength": 1}])
    ended = threading.Event()
    counted = []

    def count():
        while not ended.is_set():
            counted.append(time.monotonic())
            time.sleep(0.005)

    thread = threading.Thread(target=count)
    thread.start()
    try:
        cradle.simulate({**slow, "duration": 5})
    finally:
        ended.set()
        thread.join()
    assert max(numpy.diff(counted)) < 0.5 and len(counted) > 20


def test_ctrl_c_ends_a_simulation():
    program = ("import cradle, sys; print('begun', flush=True)\n"
               "try: cradle.simulate(%r)\n"
               "except KeyboardInterrupt: sys.exit(42)" % scene(
                   10000, method={"name": "rk4", "timeStep": 1e-5}, bodies=(BALL,),
                   springs=[{"bodyA": "ball", "anchorB": [0, 3, 0], "stiffness": 200}]))
    process = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "begun\n"
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    assert process.wait(20) == 42


def test_ctrl_c_ends_what_comes_before_the_first_frame():
    body = {**BALL, "copies": {"count": [46, 46, 46], "spacing": [1, 1, 1]}}  # takes seconds to plan
    program = ("import cradle, os, signal, sys, threading, time\n"
               "told = []\n"
               "def end():\n"
               "    while time.process_time() < 2: time.sleep(0.02)\n"
               "    os.kill(os.getpid(), signal.SIGINT)\n"
               "thread = threading.Thread(target=end)\n"
               "thread.start()\n"
               "try: cradle.simulate(%r, progress=lambda *time: told.append(time))\n"
               "except KeyboardInterrupt: sys.exit(43 if told else 42)" % scene(1, bodies=(body,)))
    begin = time.monotonic()
    assert subprocess.run([sys.executable, "-c", program], timeout=60).returncode == 42
    assert time.monotonic() - begin < 20


# Islands share a frame that takes long: what ends one of them ends all.
def test_progress_ends_all_islands_of_a_frame():
    told = []

    def end(time, duration):
        told.append(time)
        if time > 0:
            raise LookupError("enough")
    balls = [{**BALL, "name": "ball%d" % k, "position": [3 * k, 1, 0]} for k in range(4)]
    springs = [{"bodyA": ball["name"], "anchorB": [3 * k, 3, 0], "stiffness": 200} for k, ball in enumerate(balls)]
    begin = time.monotonic()
    with pytest.raises(LookupError):
        cradle.simulate(scene(100, method={"name": "rk4", "timeStep": 1e-6}, bodies=balls, springs=springs,
                              output={"framesPerSecond": 0.01}), progress=end)
    assert time.monotonic() - begin < 20 and told[0] == 0 and len(told) == 2


def test_python_ends_while_threads_work():
    for work in ("cradle.simulate(slow, progress=lambda time, duration: None)", "cradle.render(motion, 0, (640, 360))"):
        program = ("import cradle, threading, time\n"
                   "motion = cradle.simulate(%r)\n"
                   "slow = %r\n"
                   "def work():\n"
                   "    while True: %s\n"
                   "threading.Thread(target=work, daemon=True).start()\n"
                   "time.sleep(0.5)\n" % (scene(), scene(1000, bodies=(BALL,), method={"name": "rk4", "timeStep": 1e-5}, springs=[
                       {"bodyA": "ball", "anchorB": [0, 3, 0], "stiffness": 200}]), work))
        assert subprocess.run([sys.executable, "-c", program], stderr=subprocess.DEVNULL, timeout=60).returncode == 0, work


def test_copies_are_the_same(motion):
    assert copy.copy(motion) is motion and copy.deepcopy(motion.events[0]).time == motion.events[0].time
    with pytest.raises(AttributeError):
        motion.position = 3


def test_progress_is_told_and_may_end_it():
    told = []
    cradle.simulate(scene(), progress=lambda time, duration: told.append((time, duration)))
    assert told[0] == (0, 0.4) and told[-1][0] == pytest.approx(0.4) and len(told) == 25

    def end(time, duration):
        if time > 0.1:
            raise LookupError("enough")
    with pytest.raises(LookupError, match="enough"):
        cradle.simulate(scene(), progress=end)


def test_warnings_are_those_of_python():
    overlapping = scene(bodies=(FLOOR, {**BALL, "position": [0, 0.05, 0]}))
    with pytest.warns(UserWarning) as warned:
        cradle.simulate(overlapping)
    assert warned[0].filename == __file__


def test_no_signal_handler_is_set():
    # Signals from 32 on are those of the C library, which threads use among themselves.
    program = ("import cradle\n"
               "caught = lambda: [int(line.split()[1], 16) & 0x7fffffff for line in open('/proc/self/status')\n"
               "                  if line.startswith(('SigCgt', 'SigIgn'))]\n"
               "before = caught()\n"
               "motion = cradle.simulate(%r); cradle.render(motion, 0, (64, 36))\n"
               "assert caught() == before, (before, caught())" % scene())
    subprocess.run([sys.executable, "-c", program], check=True)


def test_notebooks_show_the_player():
    shown = cradle.simulate(scene())._repr_html_()
    assert shown.startswith("<iframe") and len(shown) < 5e6


def test_what_is_exported_is_described():
    for name in cradle.__all__:
        assert getattr(cradle, name).__doc__, name
    stub = open(os.path.join(os.path.dirname(cradle.__file__), "_cradle.pyi")).read()
    for kind in ("Scene", "Trajectory", "Event", "ContactForce", "Body", "Film"):
        described = stub.split("class %s:" % kind)[1].split("\nclass ")[0]
        for name in vars(getattr(cradle._cradle, kind)):
            if not name.startswith("_"):
                assert "def %s(" % name in described, (kind, name)
