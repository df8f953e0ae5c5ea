#!/usr/bin/env python3
"""Writes scenes/orientation_drift.json: one turn, added up in small steps by three ways to keep an orientation.

    make_orientation_drift.py SOURCE_FOLDER      # plain Python 3; prints the numbers that the captions state

The angular velocity w (world's frame) is constant; a step h turns by the angle a = |w| h about the unit axis u. R takes
points of the body to the world, its columns x, y, z are the axes of the body; [w] is the matrix of the product w x.

    Euler          R <- R + h [w] R = (1 + a [u]) R. As det(1 + a [u]) = 1 + a^2, n steps make the volume (1 + a^2)^n
                   times as large: by the root of that in both directions across u, by 1 along u
    Gram-Schmidt   the same, then x <- x / |x|,  y <- y - (x.y) x,  y <- y / |y|,  z <- x cross y
    quaternion     q <- q + h/2 (0, w) q = (1, a/2 u) q,  q <- q / |q|: turns by 2 atan(a/2) in place of a

The exact turn is by n a about u: the white marks. Bodies of Cradle are rigid, so the cube of the first way is eight
balls that are led by key frames, one a step, each at R times its place in the body; the telescopes between them show
the edges and have no effect. The other two are one rigid body each, welded to a needle that is led by key frames.
Between key frames Cradle moves smoothly.
"""
import json, math, os, sys

STEP, DEGREES_A_STEP, STEPS = 1 / 15, 6, 120  # s; two turns in 8 s
BEGIN, DURATION = 1.0, 11.5                   # s
EDGE, BALL, BAR = 0.4, 0.052, 0.013           # m
TUBE, ROD, REACH = 0.02, 0.0125, 0.37          # m, of the telescopes that are the edges of what grows
HEIGHT = 0.62                                 # m, of the cubes' centres
A = math.radians(DEGREES_A_STEP)
X, Y, Z = [1, 0, 0], [0, 1, 0], [0, 0, 1]
CORNERS = [(i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1)]
EDGES = [(c, c[:i] + (1,) + c[i + 1:], i) for c in CORNERS for i in range(3) if c[i] == 0]


# --- vectors, matrices as lists of columns, quaternions (w, x, y, z) -------------------------------------------------
def dot(a, b): return sum(p * q for p, q in zip(a, b))
def scaled(s, a): return [s * p for p in a]
def plus(a, b): return [p + q for p, q in zip(a, b)]
def cross(a, b): return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
def unit(a): return scaled(1 / math.sqrt(dot(a, a)), a)
def applied(m, v): return [sum(m[j][i] * v[j] for j in range(3)) for i in range(3)]
def product(m, n): return [applied(m, column) for column in n]
def transposed(m): return [[m[j][i] for j in range(3)] for i in range(3)]


def quaternion_product(p, q):
    v = plus(plus(scaled(p[0], q[1:]), scaled(q[0], p[1:])), cross(p[1:], q[1:]))
    return [p[0] * q[0] - dot(p[1:], q[1:])] + v


def matrix_of(q):
    w, x, y, z = q
    return [[1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
            [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
            [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)]]


def quaternion_of(m):
    """Of a rotation matrix; by its largest component."""
    t = [m[0][0] + m[1][1] + m[2][2], m[0][0], m[1][1], m[2][2]]
    i = t.index(max(t))
    if i == 0:
        q = [1 + t[0], m[1][2] - m[2][1], m[2][0] - m[0][2], m[0][1] - m[1][0]]
    else:
        i -= 1
        j, k = (i + 1) % 3, (i + 2) % 3
        q = [m[j][k] - m[k][j], 0, 0, 0]
        q[1 + i], q[1 + j], q[1 + k] = 1 + 2 * m[i][i] - t[0], m[i][j] + m[j][i], m[i][k] + m[k][i]
    return unit(q)


def angle_between(m, n):
    """The angle (degrees) of the rotation from m to n."""
    q = quaternion_of(product(n, transposed(m)))
    return math.degrees(2 * math.atan2(math.sqrt(dot(q[1:], q[1:])), abs(q[0])))


def determinant(m): return dot(m[0], cross(m[1], m[2]))


# --- the three ways --------------------------------------------------------------------------------------------------
AXIS = Y  # the cube stands on a corner: its diagonal, (1, 1, 1) of the body, is the axis of its turn


def at_start():
    across = [[math.cos(2 * math.pi * j / 3), 0, -math.sin(2 * math.pi * j / 3)] for j in range(3)]
    return [plus(scaled(math.sqrt(2 / 3), c), scaled(math.sqrt(1 / 3), Y)) for c in across]


def euler_step(m): return [plus(c, scaled(A, cross(AXIS, c))) for c in m]


def gram_schmidt_step(m):
    x, y, _ = euler_step(m)
    x = unit(x)
    y = unit(plus(y, scaled(-dot(x, y), x)))
    return [x, y, cross(x, y)]


def quaternion_step(q): return unit(quaternion_product([1] + scaled(A / 2, AXIS), q))


def history(step, first):
    states = [first]
    for _ in range(STEPS):
        states.append(step(states[-1]))
    return states


START = at_start()
EULER = history(euler_step, START)
GRAM_SCHMIDT = history(gram_schmidt_step, START)
TURNS = history(quaternion_step, [1.0, 0.0, 0.0, 0.0])  # from the start's orientation
EXACT_END = product(matrix_of([math.cos(STEPS * A / 2)] + scaled(math.sin(STEPS * A / 2), AXIS)), START)

volume = determinant(EULER[-1])
tilt = math.degrees(math.acos(dot(unit(applied(GRAM_SCHMIDT[-1], [1, 1, 1])), AXIS)))
slanted = math.degrees(math.acos(dot(unit(GRAM_SCHMIDT[-1][0]), AXIS)))
wrong = angle_between(EXACT_END, GRAM_SCHMIDT[-1])
behind = angle_between(EXACT_END, product(matrix_of(TURNS[-1]), START))
corner = math.degrees(math.acos(dot(unit(EULER[-1][0]), unit(EULER[-1][1]))))
assert abs(volume - (1 + A * A) ** STEPS) < 1e-12
assert abs(math.radians(behind) - STEPS * (A - 2 * math.atan(A / 2))) < 1e-12
print(f"a = {A:.10f} rad, n = {STEPS}, h = {STEP:.10f} s")
print(f"Euler: volume {volume:.10f} = (1 + a^2)^n, width {math.sqrt(volume):.10f}, angle of two edges {corner:.6f} "
      f"degrees, behind by n (a - atan a) = {math.degrees(STEPS * (A - math.atan(A))):.6f} degrees")
print(f"Gram-Schmidt: {wrong:.6f} degrees from the exact orientation, diagonal tilted by {tilt:.6f}, "
      f"first axis at {slanted:.6f} (should be {math.degrees(math.acos(math.sqrt(1 / 3))):.6f}) degrees to the axis")
print(f"quaternion: behind by {behind:.6f} degrees, with norm - 1 = {math.sqrt(dot(TURNS[-1], TURNS[-1])) - 1:.1e}")


# --- the scene -------------------------------------------------------------------------------------------------------
def rounded(v): return [round(p, 9) + 0.0 for p in v]
def time_of(k): return round(BEGIN + k * STEP, 9)


def spin(q):
    return dict(zip("wxyz", (round(p, 9) + 0.0 for p in q)))


def place(center, m, c):
    """Of a corner, or of another point of the body, counted in edges."""
    return plus(center, scaled(EDGE, applied(m, [p - 0.5 for p in c])))


def name_of(c): return "".join(map(str, c))
def paint(c, other): return "red" if c == (1, 0, 0) else other


def axis_marks(name, center):
    """A pin below and one above, circles of dots on which the corners should go, and where the red one should end."""
    bodies = []
    half, pin = math.sqrt(3) / 2 * EDGE, 0.1
    still = {"motion": "static", "collision": "none", "material": "mark"}
    for end, y in (("below", -half - BALL - pin / 2 - 0.012), ("above", half + BALL + pin / 2 + 0.012)):
        bodies.append({"name": f"{name} {end}", "shape": {"cylinder": {"radius": 0.009, "length": pin}}, **still,
                       "position": rounded(plus(center, scaled(y, Y)))})
    radius = math.sqrt(2 / 3) * EDGE
    low = plus(center, scaled(-EDGE / (2 * math.sqrt(3)), Y))
    bodies.append({"name": f"{name} circle", "shape": {"sphere": {"radius": 0.009}}, **still,
                   "position": rounded(plus(low, scaled(radius, X))),
                   "copies": {"ring": {"count": 36, "center": rounded(low), "axis": AXIS}}})
    bodies.append({"name": f"{name} goal", "shape": {"cylinder": {"radius": 0.012, "length": 0.08}}, **still,
                   "position": rounded(plus(low, scaled(radius + BALL + 0.055, X))),
                   "orientation": {"axis": Z, "angleDegrees": 90}})
    return bodies


def upright_to(direction):
    return {"axis": rounded(unit(cross(Y, direction))), "angleDegrees": round(math.degrees(math.acos(direction[1])), 9)}


def drifting_cube(name, center, color):
    """Balls at the corners, each on a way of its own, and telescopes: two tubes on a slider, each held by a ball."""
    bodies, joints, sliders = [], [], []
    at = {c: rounded(place(center, START, c)) for c in CORNERS}
    for c in CORNERS:
        ways = [rounded(place(center, m, c)) for m in EULER]
        ball = {"name": f"{name} {name_of(c)}", "shape": {"sphere": {"radius": BALL}}, "collision": "none",
                "material": paint(c, color), "motion": "driven", "position": at[c]}
        if all(w == ways[0] for w in ways):
            ball["motion"] = "static"  # on the axis, along which nothing grows
        else:
            ball["keyFrames"] = [{"time": time_of(k), "position": w} for k, w in enumerate(ways)]
        bodies.append(ball)
    for a, b, i in EDGES:
        edge = f"{name} {name_of(a)}-{name_of(b)}"
        outer = "red" if b == (1, 0, 0) else color
        for part, end, toward, radius, paint_of in (("outer", a, 1, TUBE, outer), ("inner", b, -1, ROD, "tube")):
            bodies.append({"name": f"{edge} {part}", "shape": {"cylinder": {"radius": radius, "length": REACH}},
                           "collision": "none", "material": paint_of,
                           "position": rounded(plus(at[end], scaled(toward * REACH / 2, START[i]))),
                           "orientation": upright_to(START[i])})
            joints.append({"bodyA": f"{edge} {part}", "anchorA": [0, -toward * REACH / 2, 0],
                           "bodyB": f"{name} {name_of(end)}", "anchorB": [0, 0, 0]})
        # Stops that are never reached: pictures show the rail between them, and then it is inside of the outer tube.
        sliders.append({"bodyA": f"{edge} inner", "anchorA": [0, -REACH / 2, 0],
                        "bodyB": f"{edge} outer", "anchorB": [0, round(EDGE - 1.5 * REACH, 9), 0],
                        "axis": Y, "limits": {"lower": -0.005, "upper": 0.275}})
    return {"bodies": bodies, "ballJoints": joints, "sliders": sliders}


def rigid_cube(name, center, turns, color):
    """A needle along the diagonal that is led, and all else welded to it."""
    half = math.sqrt(3) / 2 * EDGE
    needle = f"{name} needle"
    bodies = [{"name": needle, "shape": {"cylinder": {"radius": BAR, "length": round(2 * half, 9)}},
               "motion": "driven", "collision": "none", "material": "needle", "position": center,
               "keyFrames": [{"time": time_of(k), "orientation": spin(q)} for k, q in enumerate(turns)]}]
    welds = []
    at = {c: rounded(place(center, START, c)) for c in CORNERS}
    for c in CORNERS:
        bodies.append({"name": f"{name} {name_of(c)}", "shape": {"sphere": {"radius": BALL}}, "collision": "none",
                       "material": paint(c, color), "position": at[c]})
    for a, b, i in EDGES:
        bodies.append({"name": f"{name} {name_of(a)}-{name_of(b)}", "collision": "none",
                       "shape": {"cylinder": {"radius": BAR, "length": EDGE}},
                       "material": paint(b, color) if a == (0, 0, 0) else color,
                       "position": rounded(scaled(0.5, plus(at[a], at[b]))), "orientation": upright_to(START[i])})
    tied = {(0, 0, 0)}
    welds.append({"bodyA": f"{name} 000", "bodyB": needle, "anchorB": rounded([0, -half, 0])})
    for a, b, _ in EDGES:  # each bar to its lower corner; each corner but the lowest to the first bar that comes to it
        bar, lower = f"{name} {name_of(a)}-{name_of(b)}", f"{name} {name_of(a)}"
        welds.append({"bodyA": bar, "anchorA": [0, -EDGE / 2, 0], "bodyB": lower, "anchorB": [0, 0, 0]})
        if b not in tied:
            tied.add(b)
            welds.append({"bodyA": f"{name} {name_of(b)}", "bodyB": bar, "anchorB": [0, EDGE / 2, 0]})
    return {"bodies": bodies, "welds": welds}


centers = {"euler": [-0.70, HEIGHT, 0], "gramSchmidt": [0.43, HEIGHT, 0], "quaternion": [1.29, HEIGHT, 0]}
turns = [quaternion_of(product(m, transposed(START))) for m in GRAM_SCHMIDT]
parts = [drifting_cube("euler", centers["euler"], "orange"),
         rigid_cube("gramSchmidt", centers["gramSchmidt"], turns, "blue"),
         rigid_cube("quaternion", centers["quaternion"], TURNS, "green")]
end = BEGIN + STEPS * STEP
scene = {
    "schema": "cradle-scene/1",
    "name": "Drift of an orientation",
    "description": f"A cube turns about its diagonal, by {DEGREES_A_STEP} degrees a step and {STEPS} steps. "
                   f"Explicit Euler makes its matrix grow: {volume:.2f} times the volume. Gram-Schmidt keeps it "
                   f"rigid and turns it wrongly, by {wrong:.1f} degrees. A unit quaternion is {behind:.1f} degrees "
                   "behind. Made by docs/make_orientation_drift.py.",
    "duration": DURATION,
    "gravity": [0, 0, 0],
    "camera": {"position": [0.2, 1.5, 4.85], "target": [0.2, 0.52, 0], "verticalFieldOfViewDegrees": 23},
    "look": "dark",
    "titleCard": {"title": "Drift of an orientation",
                  "subtitle": "A matrix, a matrix made orthogonal, a unit quaternion"},
    "captions": [
        {"text": "explicit Euler", "body": "euler above", "to": end},
        {"text": "Gram-Schmidt", "body": "gramSchmidt above", "to": end},
        {"text": "unit quaternion", "body": "quaternion above", "to": end},
        {"text": f"volume \u00d7 {volume:.2f}", "body": "euler above", "from": end},
        {"text": f"{wrong:.1f}\u00b0 off", "body": "gramSchmidt above", "from": end},
        {"text": f"{behind:.1f}\u00b0 behind", "body": "quaternion above", "from": end},
        {"text": f"A step of 1/{round(1 / STEP)} s turns by a = {A:.3f} rad, {DEGREES_A_STEP}\u00b0, about the upright "
                 "axis. White dots: the exact way of the red corner", "to": 3.5},
        {"text": "Explicit Euler of the matrix, R += h [w] R: each step makes the volume "
                 f"1 + a\u00b2 = {1 + A * A:.3f} times as large", "from": 3.5, "to": 6.25},
        {"text": "Gram-Schmidt keeps the direction of the red edge and fits the others to it: rigid, but the diagonal "
                 "leaves the axis", "from": 6.25, "to": end},
        {"text": f"After two turns, {STEPS} steps: (1 + a\u00b2)^{STEPS} = {volume:.2f}. The unit quaternion stays "
                 "rigid and on the axis", "from": end},
    ],
    "materials": {
        "orange": {"baseColor": "#e0a23c", "metallic": 0.3, "roughness": 0.35},
        "red": {"baseColor": "#e0402c", "roughness": 0.35},
        "blue": {"baseColor": "#3b82d0", "metallic": 0.3, "roughness": 0.35},
        "green": {"baseColor": "#3fae5a", "metallic": 0.3, "roughness": 0.35},
        "needle": {"baseColor": "#f4e6b8", "roughness": 0.4},
        "tube": {"baseColor": "#f0e2c0", "metallic": 0.3, "roughness": 0.35},
        "mark": {"baseColor": "#f4f4f4", "roughness": 0.6},
        "ground": {"baseColor": "#8a8d92", "roughness": 0.8},
    },
    "bodies": [{"name": "ground", "shape": {"plane": {}}, "motion": "static", "collision": "none",
                "material": "ground"}]
    + [b for n, c in centers.items() for b in axis_marks(n, c)] + [b for p in parts for b in p["bodies"]],
    "ballJoints": parts[0]["ballJoints"],
    "sliders": parts[0]["sliders"],
    "welds": parts[1]["welds"] + parts[2]["welds"],
}


def written(value, indent=0):
    """JSON with one body, key frame, link to a line."""
    pad = "\n" + " " * (indent + 2)
    flat = json.dumps(value, ensure_ascii=False)
    if isinstance(value, list) and value and isinstance(value[0], dict):
        return "[" + ",".join(pad + written(v, indent + 2) for v in value) + "\n" + " " * indent + "]"
    if isinstance(value, dict) and (indent == 0 or "keyFrames" in value):
        return "{" + ",".join((pad if indent == 0 else " ") + json.dumps(k) + ": " + written(v, indent + 2)
                              for k, v in value.items()).lstrip(" ") + ("\n" if indent == 0 else "") + "}"
    return flat


with open(os.path.join(sys.argv[1], "scenes/orientation_drift.json"), "w", encoding="utf-8") as file:
    file.write(written(scene) + "\n")
