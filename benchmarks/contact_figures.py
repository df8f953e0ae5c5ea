#!/usr/bin/env python3
"""Contact beside Bullet: error, energy, drift at rest, penetration and cost of the scenes in benchmarks/scenes.

    contact_figures.py PROGRAM [SCENE ...]      SCENE: a name without folder and ending; all of them if none is given

PROGRAM is cradle; Bullet runs by bullet_trajectory beside it, if that was built (CMake: CRADLE_PEERS), in turn with cradle.
error        m, at the worst frame, unless the scene's line says otherwise
energy       largest drift of kinetic + potential + dissipated in parts of the largest kinetic energy; of Bullet only where
             nothing dissipates
drift        m: how far a body that should lie still goes
penetration  m: deepest overlap in the frames looked at
ms/s         CPU milliseconds per simulated second, steps alone: the median of at least three runs (of one, if it is long)
ratio        to the first row of the scene
"""
import math, os, sqlite3, statistics, subprocess, sys, tempfile

from scene_figures import Run, norm, sub

GRAVITY = 9.81
SCENES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "scenes")
ACCURACIES = ("1e-6", "1e-10")
BULLET = (("bullet", 60), ("bulletTuned", 60), ("bulletTuned", 1000), ("bulletTuned100", 1000))  # method, steps a second
LEAST_RUNS, LONG_RUN = 3, 2.0  # CPU s
LONGEST_RUN = 60  # s
SETTLED = 5  # s: by then, what is dropped should lie still
ROCKED = 20  # s: by then, a struck stack should; rocking as one block, it would take a few seconds more to lose its energy
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
    """How far an event of some kinds, the last one if not said otherwise, is from where it should be; Bullet has none."""
    events = [event for event in result.events if event[1] in kinds]
    return f"{events[number][1]} off by {abs(events[number][0] - expected):.1e} s" if events else ""

def cradle(arm_inertia):
    """Five balls at 0.5 m; a ball that is rigid with its arm has inertia 2/5 r^2 about itself."""
    lift, length, radius = math.pi / 4, 0.5, 0.05
    frequency = math.sqrt(GRAVITY * length / (length ** 2 + arm_inertia * 0.4 * radius ** 2))

    def ideal(t):  # what is left of the middle swings as the first ball, what is right of it as the last
        angle, rate = swing(t, lift, frequency)
        return [(min(angle, 0.0), rate if angle < 0 else 0.0), *[(0.0, 0.0)] * 3, (max(angle, 0.0), rate if angle > 0 else 0.0)]

    def figures(result):
        worst = resting = 0.0
        start = math.sqrt(2 * GRAVITY * length * (1 - math.cos(lift)) / (1 + arm_inertia * 0.4 * (radius / length) ** 2))
        after = next(i for i, row in enumerate(result.states["ball1"]) if ideal(row[0] - 0.05)[4][0] > 0)
        rates = [rate for _, rate in ideal(result.states["ball1"][after][0])]
        angles = [angle for angle, _ in ideal(result.states["ball1"][after][0])]
        missed = [math.dist(result.states[f"ball{i + 1}"][after][2], [length * rate * math.cos(angle), length * rate * math.sin(angle), 0])
                  for i, (angle, rate) in enumerate(zip(angles, rates))]
        for frame in range(len(result.states["ball1"])):
            expected = ideal(result.states["ball1"][frame][0])
            for i, (angle, _) in enumerate(expected):
                position = result.states[f"ball{i + 1}"][frame][1]
                away = math.dist(position, [0.1 * i + length * math.sin(angle), -length * math.cos(angle), 0])
                worst = max(worst, away)
                if 0 < i < 4:
                    resting = max(resting, away)
        return worst, resting, f"{math.sqrt(sum(m * m for m in missed) / 5) / start:.1e} of v0 after the first impact"
    return figures


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


FIGURES = {
    "cradle_on_joints": (cradle(1), True, "drift: of the three balls in the middle"),
    "cradle_on_rods": (cradle(0), True, "drift: of the three balls in the middle"),
    "bounce_elastic": (bouncing(1), True, ""),
    "bounce_fading": (bouncing(0.8), False, ""),
    "stack": (stack(0), False, ""),
    "stack_heavy_top": (stack(0), False, ""),
    "stack_dropped": (stack(SETTLED), False, f"drift: after {SETTLED} s"),
    "stack_heavy_top_dropped": (stack(SETTLED), False, f"drift: after {SETTLED} s"),
    "stack_struck": (stack(ROCKED), False, f"drift: after {ROCKED} s"),
    "slope_slide": (slides(0.5), False, ""),
    "slope_stick": (lambda result: (None, result.moved("block"), ""), False, ""),
    "slope_up_and_back": (thrown_up(0.2), False, ""),
    "slope_up_and_stay": (thrown_up(0.7), False, ""),
    "ball_slip_to_roll": (rolling(0), False, ""),
    "ball_backspin": (rolling(-30), False, ""),
    "ball_on_platform": (on_platform, False, "error: at seven instants"),
}


def run_once(command, path):
    if os.path.exists(path):
        os.remove(path)
    try:
        done = subprocess.run([*command, path], capture_output=True, text=True, timeout=LONGEST_RUN)
    except subprocess.TimeoutExpired:
        return f"takes more than {LONGEST_RUN} s"
    return Result(path) if done.returncode == 0 else (done.stderr or done.stdout).strip().splitlines()[-1]


def programs(cradle_program, scene):
    """Name and command of each row; the path of the trajectory comes last."""
    for accuracy in ACCURACIES:
        yield f"cradle {accuracy}", [cradle_program, "simulate", scene, "--quiet", "--accuracy", accuracy, "-o"]
    bullet = os.path.join(os.path.dirname(cradle_program), "bullet_trajectory")
    if os.path.exists(bullet):
        for method, steps in BULLET:
            yield f"{method} 1/{steps} s", [bullet, scene, method, repr(1 / steps)]


def show(value, form=".1e"):
    return "-" if value is None else format(value, form)


def measure(cradle_program, name, path):
    figures, keeps_energy, meaning = FIGURES[name]
    print(f"{name}{': ' + meaning if meaning else ''}")
    commands = list(programs(cradle_program, os.path.join(SCENES, name + ".json")))
    results, costs = {}, {row: [] for row, _ in commands}
    for turn in range(LEAST_RUNS):
        for row, command in commands:
            if turn > 0 and (isinstance(results[row], str) or results[row].cpu > LONG_RUN):
                continue
            results[row] = run_once(command, path)
            if not isinstance(results[row], str):
                costs[row].append(1000 * results[row].cpu / results[row].run.duration)
    first = None
    for row, result in results.items():
        if isinstance(result, str):
            print(f"  {row:24} failed: {result[:140]}")
            continue
        (error, drift, note), cost = figures(result), statistics.median(costs[row])
        first = cost if row == commands[0][0] else first
        knows_energy = keeps_energy or row.startswith("cradle")
        print(f"  {row:24}{show(error):>10}{show(result.run.energy_drift() if knows_energy else None):>10}"
              f"{'collapsed' if drift is not None and drift > FAR else show(drift):>12}{show(result.run.penetration()):>13}"
              f"{cost:12.4f}{show(first and cost / first, '.3g'):>10}   {note}".rstrip())


def main(program, *names):
    print(f"  {'':24}{'error':>10}{'energy':>10}{'drift':>12}{'penetration':>13}{'ms/s':>12}{'ratio':>10}")
    with tempfile.TemporaryDirectory() as folder:
        for name in names or FIGURES:
            measure(os.path.abspath(program), name, os.path.join(folder, "run.sqlite"))


if __name__ == "__main__":
    main(*sys.argv[1:]) if len(sys.argv) > 1 else sys.exit(__doc__)
