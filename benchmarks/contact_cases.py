"""The scenes of contact that contact_figures.py runs, and what closed forms say of a run: its error, its drift at rest and more."""
import math, os

import hard_sphere_gas
from scene_figures import norm, sub

GRAVITY = 9.81
SCENES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "scenes")
ACCURACIES = ("1e-6", "1e-10")
SETTLED = 5  # s: by then, what is dropped should lie still
ROCKED = 22  # s: by then the struck stack rests


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
