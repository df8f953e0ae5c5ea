#!/usr/bin/env python3
"""Contact beside other engines: error, energy, drift at rest, penetration and cost of scenes of contact, as a table.

    contact_figures.py PROGRAM [NAME ...]      NAME: a scene of benchmarks/scenes without folder and ending, or one of
                                               cradle_N_K, tray_of_balls, balls_49, balls_216, piles; all if none is given

PROGRAM is cradle; other engines run by peer_trajectory beside it, if that was built (CMake: CRADLE_PEERS), in turn with cradle.
Progress goes to stderr.
error        m, at the worst frame, unless the scene's line says otherwise
energy       largest drift of kinetic + potential + dissipated - work in parts of the largest kinetic energy; of others only
             where nothing dissipates
drift        m: how far a body that should lie still goes
penetration  m: deepest overlap in the frames looked at
ms/s         CPU milliseconds per simulated second, steps alone: the median of at least three runs (of one, if it is long)
ratio        to the first row of the scene
cradle_N_K   N touching balls on rods, K of them lifted by 45 degrees
piles        is what benchmark_pile says of 1000 bodies in 10 s
"""
import json, math, os, sqlite3, statistics, subprocess, sys, tempfile, time

import hard_sphere_gas
from scene_figures import Run, norm, sub

GRAVITY = 9.81
SCENES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "scenes")
ACCURACIES = ("1e-6", "1e-10")
PEERS = (("bullet", 60), ("bulletTuned", 60), ("bulletTuned", 1000), ("bulletTuned100", 1000), ("ode", 60), ("ode", 1000),
         ("odeQuick100", 60), ("odeQuick100", 1000), ("mujoco", 60), ("mujocoTuned", 60), ("mujocoTuned", 1000))  # steps a second
LEAST_RUNS, LONG_RUN = 3, 2.0  # CPU s
LONGEST_RUN = 60  # s
SETTLED = 5  # s: by then, what is dropped should lie still
ROCKED = 22  # s: by then the struck stack rests
FAR = 0.5  # m: a stack that has moved that far has collapsed


class Result:
    """One run of one program; states[name] is a list of (time, position, velocity), by frame."""
    def __init__(self, path):
        self.run = Run(path)
        database = sqlite3.connect(path)
        query = ("select b.name, f.time, s.px, s.py, s.pz, s.vx, s.vy, s.vz from state s join frame f on f.id = s.frame "
                 "join body b on b.id = s.body order by s.frame")
        self.states = {}
        for name, time, *numbers in database.execute(query):
            self.states.setdefault(name, []).append((time, numbers[:3], numbers[3:]))
        self.events = database.execute("select time, kind from event order by time").fetchall()
        self.cpu = float(self.run.meta["cpuSeconds"])

    def moved(self, name, since=0.0):
        rows = [row for row in self.states[name] if row[0] >= since]
        return max(norm(sub(row[1], rows[0][1])) for row in rows)


# Closed forms.

def elliptic(u, k):
    """sn, cn, dn by descending Landen transformations (Abramowitz and Stegun, 16.4)."""
    a, c, b = [1.0], [k], math.sqrt(1 - k * k)
    while abs(c[-1]) > 1e-16:
        a.append((a[-1] + b) / 2), c.append((a[-2] - b) / 2)
        b = math.sqrt(a[-2] * b)
    phi = 2 ** (len(a) - 1) * a[-1] * u
    for i in range(len(a) - 1, 0, -1):
        before, phi = phi, (phi + math.asin(c[i] / a[i] * math.sin(phi))) / 2
    sn, cn = math.sin(phi), math.cos(phi)
    return sn, cn, math.sqrt(1 - (k * sn) ** 2)


def swing(t, lift, frequency):
    """Angle and its rate of a pendulum that is let go at -lift: sin(theta/2) = -k cd(w t)."""
    k = math.sin(lift / 2)
    sn, cn, dn = elliptic(frequency * t, k)
    half = math.asin(k * cn / dn)
    rate = 2 * k * (1 - k * k) * frequency * sn / dn ** 2 / math.cos(half)
    return -2 * half, rate


def bounce(t, restitution):
    """Height and speed of a ball dropped from 1 m."""
    first = math.sqrt(2 / GRAVITY)
    if t < first:
        return 1 - GRAVITY * t * t / 2, -GRAVITY * t
    t, up = t - first, restitution * GRAVITY * first
    while up > 1e-9 and t > 2 * up / GRAVITY:
        t, up = t - 2 * up / GRAVITY, up * restitution
    return (up * t - GRAVITY * t * t / 2, up - GRAVITY * t) if up > 1e-9 else (0.0, 0.0)


# Figures of a scene: (error, drift, what else there is to say); error and drift may be None.

def off_by(result, kinds, expected, number=-1):
    """How far an event of some kinds, the last one if not said otherwise, is from where it should be; other engines have none."""
    events = [event for event in result.events if event[1] in kinds]
    return f"{events[number][1]} off by {abs(events[number][0] - expected):.1e} s" if events else ""

def cradle(balls, lifted, arm_inertia):
    """Balls at 0.5 m; a ball that is rigid with its arm has inertia 2/5 r^2 about itself."""
    lift, length, radius = math.pi / 4, 0.5, 0.05
    frequency = math.sqrt(GRAVITY * length / (length ** 2 + arm_inertia * 0.4 * radius ** 2))

    def ideal(t):  # what is left of the middle swings as the first balls, what is right of it as the last
        angle, rate = swing(t, lift, frequency)
        moves = [i < lifted if angle < 0 else i >= balls - lifted for i in range(balls)]
        return [(angle, rate) if moving else (0.0, 0.0) for moving in moves]

    def figures(result):
        worst = resting = 0.0
        start = math.sqrt(2 * GRAVITY * length * (1 - math.cos(lift)) / (1 + arm_inertia * 0.4 * (radius / length) ** 2))
        states = [result.states[f"ball{i + 1}"] for i in range(balls)]
        after = next(i for i, row in enumerate(states[0]) if ideal(row[0] - 0.05)[-1][0] > 0)
        missed = [math.dist(ball[after][2], [length * rate * math.cos(angle), length * rate * math.sin(angle), 0])
                  for ball, (angle, rate) in zip(states, ideal(states[0][after][0]))]
        for frame in range(len(states[0])):
            for i, (angle, _) in enumerate(ideal(states[0][frame][0])):
                away = math.dist(states[i][frame][1], [0.1 * i + length * math.sin(angle), -length * math.cos(angle), 0])
                worst = max(worst, away)
                if angle == 0:
                    resting = max(resting, away)
        return worst, resting, f"{math.sqrt(sum(m * m for m in missed) / balls) / start:.1e} of v0 after the first impact"
    return figures


def cradle_scene(balls, lifted):
    """As cradle_on_rods.json, for any number of balls."""
    lift = math.pi / 4
    places = [[0.1 * i - 0.5 * math.sin(lift), -0.5 * math.cos(lift), 0] if i < lifted else [0.1 * i, -0.5, 0]
              for i in range(balls)]
    return {"schema": "cradle-scene/1", "name": f"{balls} balls, {lifted} lifted", "duration": 10,
            "output": {"framesPerSecond": 20},
            "materials": {"steel": {"restitution": 1, "staticFriction": 0, "dynamicFriction": 0}},
            "bodies": [{"name": f"ball{i + 1}", "material": "steel", "shape": {"sphere": {"radius": 0.05}}, "mass": 0.2,
                        "position": place} for i, place in enumerate(places)],
            "rods": [{"bodyA": f"ball{i + 1}", "anchorA": [0, 0, 0], "anchorB": [0.1 * i, 0, 0]} for i in range(balls)]}


def seldom_seen(scene):
    """With a frame a second: overlaps of many balls are looked for in each."""
    scene["output"]["framesPerSecond"] = 1
    return scene


def pushed_tray(result):
    """a = (F - mu (M + n m) g) / (M + 2 n m / 7) of the box, 2/7 of it of the balls that roll on it."""
    acceleration = (150 - 0.4 * 35 * GRAVITY) / (10 + 50 / 7)
    end = {name: norm(rows[-1][2]) for name, rows in result.states.items()}
    seconds = result.states["tray"][-1][0]
    box = end.pop("tray")
    balls = max(end.values(), key=lambda speed: abs(speed - 2 / 7 * acceleration * seconds))
    error = max(abs(box - acceleration * seconds), abs(balls - 2 / 7 * acceleration * seconds))
    return error, None, f"v_box {box:.9f}, v_ball {balls:.9f} m/s"


def bouncing(restitution):
    zeno = math.sqrt(2 / GRAVITY) * (1 + restitution) / (1 - restitution) if restitution < 1 else 0
    return lambda result: (max(abs(p[1] - 0.1 - bounce(t, restitution)[0]) for t, p, _ in result.states["ball"]), None,
                           off_by(result, ["rest"], zeno))


def stack(since):
    def figures(result):
        rests = [time for time, kind in result.events if kind == "rest"]
        drift = max(result.moved(f"box{i + 1}", since) for i in range(10))
        return None, drift, f"last comes to rest at {rests[-1]:.3f} s" if rests else ""
    return figures


UPHILL = [math.cos(math.pi / 6), 0.5, 0.0]


def along_slope(expected, events=(), instant=0.0):
    def figures(result):
        start = result.states["block"][0][1]
        return max(norm(sub(sub(p, start), [expected(t) * u for u in UPHILL])) for t, p, _ in result.states["block"]), None, off_by(result, events, instant)
    return figures


def slides(friction):
    return along_slope(lambda t: -GRAVITY * (0.5 - friction * UPHILL[0]) * t * t / 2)


def thrown_up(friction):
    up, down = GRAVITY * (0.5 + friction * UPHILL[0]), max(0.0, GRAVITY * (0.5 - friction * UPHILL[0]))
    stop = 3 / up
    return along_slope(lambda t: 3 * t - up * t * t / 2 if t < stop else 4.5 / up - down * (t - stop) ** 2 / 2,
                       ["rest", "stick"] if down == 0 else ["slip"], stop)


def rolling(spin):
    """Slips with friction 0.3 until v = r w."""
    slowing = 0.3 * GRAVITY
    roll = 2 * (5 - 0.1 * spin) / (7 * slowing)

    def place(t):
        slip = min(t, roll)
        return 5 * slip - slowing * slip ** 2 / 2 + (5 - slowing * roll) * max(0.0, t - roll)
    return lambda result: (max(math.dist(p, [place(t), 0.1, 0]) for t, p, _ in result.states["ball"]), None, off_by(result, ["roll"], roll))


# The lowest point of the ball and the top of the platform at some times: parabolas and cosines between impacts, their
# instants to 60 digits.
ON_PLATFORM = {0.5: (0.0314181508420121, -0.0619235616801858), 1.0: (0.0822507609302336, 0.0587034593964476),
               1.5: (-0.0201600709662881, -0.0201600709662881), 2.0: (-0.1135456828510178, -0.1135456828510178),
               3.0: (0.0464117346752099, 0.0464117346752099), 4.0: (-0.0613121945098430, -0.0613121945098430),
               5.0: (-0.0302188266595717, -0.0302188266595717)}


def on_platform(result):
    worst = 0.0
    for (t, ball, _), (_, platform, _) in zip(result.states["ball"], result.states["platform"]):
        if t in ON_PLATFORM:
            worst = max(worst, abs(ball[1] - 0.1 - ON_PLATFORM[t][0]), abs(platform[1] + 0.05 - ON_PLATFORM[t][1]))
    return worst, None, "fourth " + off_by(result, ["impact"], 1.0888006663158162, 3) if result.events else ""


class Case:
    """What is run, and how it is looked at. `scene`: a file, or what would stand in one."""
    def __init__(self, scene, figures, keeps_energy=False, meaning="", accuracies=ACCURACIES, has_peer=True):
        self.scene, self.figures, self.keeps_energy, self.meaning = scene, figures, keeps_energy, meaning
        self.accuracies, self.has_peer = accuracies, has_peer


def of_folder(name, *rest):
    return name, Case(os.path.join(SCENES, name + ".json"), *rest)


AT_REST = "drift: of the balls that hang still"
CASES = dict([
    of_folder("cradle_on_joints", cradle(5, 1, 1), True, AT_REST),
    of_folder("cradle_on_rods", cradle(5, 1, 0), True, AT_REST),
    *((f"cradle_{n}_{k}", Case(cradle_scene(n, k), cradle(n, k, 0), True, AT_REST, ("1e-10", "1e-6"), False))
      for n in range(2, 8) for k in range(1, min(4, n))),
    of_folder("bounce_elastic", bouncing(1), True),
    of_folder("bounce_fading", bouncing(0.8)),
    of_folder("stack", stack(0)),
    of_folder("stack_heavy_top", stack(0)),
    of_folder("stack_dropped", stack(SETTLED), False, f"drift: after {SETTLED} s"),
    of_folder("stack_heavy_top_dropped", stack(SETTLED), False, f"drift: after {SETTLED} s"),
    of_folder("stack_struck", stack(ROCKED), False, f"drift: after {ROCKED} s"),
    of_folder("slope_slide", slides(0.5)),
    of_folder("slope_stick", lambda result: (None, result.moved("block"), "")),
    of_folder("slope_up_and_back", thrown_up(0.2)),
    of_folder("slope_up_and_stay", thrown_up(0.7)),
    of_folder("ball_slip_to_roll", rolling(0)),
    of_folder("ball_backspin", rolling(-30)),
    of_folder("ball_on_platform", on_platform, False, "error: at seven instants"),
    ("tray_of_balls", Case(os.path.join(SCENES, "../../scenes/tray_of_balls.json"), pushed_tray, False,
                           "error: of the speeds after 4 s, m/s", ("1e-3", "1e-6"), False)),
    *((name, Case(seldom_seen(scene), lambda result: (None, None, ""), True, "", ("1e-6",), False))
      for name, scene in (("balls_49", hard_sphere_gas.grid()), ("balls_216", hard_sphere_gas.cube()))),
])


def run_once(command, path):
    if os.path.exists(path):
        os.remove(path)
    try:
        done = subprocess.run([*command, path], capture_output=True, text=True, timeout=LONGEST_RUN)
    except subprocess.TimeoutExpired:
        return f"takes more than {LONGEST_RUN} s"
    return Result(path) if done.returncode == 0 else (done.stderr or done.stdout).strip().splitlines()[-1]


def programs(cradle_program, case, scene):
    """Name and command of each row; the path of the trajectory comes last."""
    for accuracy in case.accuracies:
        yield f"cradle {accuracy}", [cradle_program, "simulate", scene, "--quiet", "--accuracy", accuracy, "-o"]
    peer = os.path.join(os.path.dirname(cradle_program), "peer_trajectory")
    if case.has_peer and os.path.exists(peer):
        for method, steps in PEERS:
            yield f"{method} 1/{steps} s", [peer, scene, method, repr(1 / steps)]


def show(value, form=".1e"):
    return "-" if value is None else format(value, form)


def scene_file(case, folder):
    if isinstance(case.scene, str):
        return case.scene
    path = os.path.join(folder, "scene.json")
    with open(path, "w") as stream:
        json.dump(case.scene, stream)
    return path


def measure(cradle_program, name, folder):
    """The lines of a scene."""
    case, path = CASES[name], os.path.join(folder, "run.sqlite")
    commands = list(programs(cradle_program, case, scene_file(case, folder)))
    results, costs = {}, {row: [] for row, _ in commands}
    for turn in range(LEAST_RUNS):
        for row, command in commands:
            if turn > 0 and (isinstance(results[row], str) or results[row].cpu > LONG_RUN):
                continue
            results[row] = run_once(command, path)
            if not isinstance(results[row], str):
                costs[row].append(1000 * results[row].cpu / results[row].run.duration)
    yield f"{name}{': ' + case.meaning if case.meaning else ''}"
    first = None
    for row, result in results.items():
        if isinstance(result, str):
            yield f"  {row:24} failed: {result[:140]}"
            continue
        (error, drift, note), cost = case.figures(result), statistics.median(costs[row])
        first = cost if row == commands[0][0] else first
        knows_energy = case.keeps_energy or row.startswith("cradle")
        yield (f"  {row:24}{show(error):>10}{show(result.run.energy_drift() if knows_energy else None):>10}"
               f"{'collapsed' if drift is not None and drift > FAR else show(drift):>12}{show(result.run.penetration()):>13}"
               f"{cost:12.4f}{show(first and cost / first, '.3g'):>10}   {note}").rstrip()


def piles(cradle_program):
    program = os.path.join(os.path.dirname(cradle_program), "../benchmarks/benchmark_pile")
    if not os.path.exists(program):
        return ["piles: benchmark_pile was not built"]
    runs = [subprocess.run([program, "1000", kind, "10"], check=True, capture_output=True, text=True)
            for kind in ("spheres", "boxes", "turned")]
    return ["piles", *[line for run in runs for line in run.stdout.splitlines()]]


def main(program, *names):
    program, names = os.path.abspath(program), names or [*CASES, "piles"]
    lines = [f"  {'':24}{'error':>10}{'energy':>10}{'drift':>12}{'penetration':>13}{'ms/s':>12}{'ratio':>10}"]
    start = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        for done, name in enumerate(names):
            left = f", about {(time.monotonic() - start) / done * (len(names) - done):.0f} s left" if done else ""
            print(f"{done + 1} of {len(names)}: {name}{left}", file=sys.stderr)
            lines += piles(program) if name == "piles" else measure(program, name, folder)
    print("\n".join(lines))


if __name__ == "__main__":
    main(*sys.argv[1:]) if len(sys.argv) > 1 else sys.exit(__doc__)
