"""How methods look in charts: a colour an engine, a mark a method."""
from collections import namedtuple

Look = namedtuple("Look", "title color mark width dash filled size")

# M. Okabe, K. Ito, "Color Universal Design", 2008: told apart by all eyes.
COLORS = {"cradle": "#0072B2", "bullet": "#000000", "ode": "#CC79A7", "mujoco": "#009E73", "simbody": "#E69F00"}
PLAIN = "#56B4E9"  # our textbook methods, beside what cradle chooses

MARKS = {  # around 0, 0; as large as a circle of radius 4 looks
    "circle": "M-4,0a4,4 0 1,0 8,0a4,4 0 1,0 -8,0z", "square": "M-3.5,-3.5h7v7h-7z", "up": "M0,-4.7L4.2,3.2H-4.2z",
    "down": "M0,4.7L4.2,-3.2H-4.2z", "diamond": "M0,-4.9L4.4,0L0,4.9L-4.4,0z", "cross": "M-4,-4L4,4M-4,4L4,-4"}

CHOSEN = "what it chooses"
OWN = {"explicitEuler": ("explicit Euler", "up"), "semiImplicitEuler": ("semi-implicit Euler", "square"), "rk4": ("RK4", "diamond"),
       "dop853FixedStep": ("DOP853, fixed step", "down"), "dop853": ("DOP853, adaptive", "circle")}
PEERS = {
    "bullet": ("defaults", "circle"), "bullet100": ("100 iterations", "square"), "bulletTuned": ("tuned", "up"),
    "bulletTuned100": ("tuned, 100 iterations", "diamond"), "ode": ("step", "circle"), "odeQuick": ("quick step", "square"),
    "odeTuned": ("step, ERP 0.8", "up"), "odeQuick100": ("quick step, 100 iterations", "diamond"), "mujoco": ("defaults", "circle"),
    "mujocoRk4": ("RK4", "square"), "mujocoTuned": ("implicit, stiff", "up"), "mujocoRk4Tuned": ("RK4, stiff", "diamond"),
    "simbody": ("Runge-Kutta-Merson", "circle"), "simbodyFehlberg": ("Runge-Kutta-Fehlberg", "square")}
DASHES = {"circle": "", "square": "6 3", "up": "2 3", "diamond": "8 3 2 3"}


def look_of(engine, method):
    if method == "plan":
        return Look(CHOSEN, COLORS["cradle"], "circle", 3, "", False, 1.6)
    if method in OWN:
        title, mark = OWN[method]
        return Look(title, PLAIN, mark, 1.2, "", True, 0.85)
    title, mark = PEERS.get(method, (method, "circle"))
    return Look(title, COLORS.get(engine, "#808080"), mark, 1.2, DASHES.get(mark, ""), False, 1)


def in_drawing_order(methods):
    """(engine, method) pairs, what cradle chooses last, on top of the others."""
    return sorted(methods, key=lambda pair: (pair[1] == "plan", pair[0] == "cradle", pair))


def in_reading_order(methods):
    """(engine, method) pairs as legends list them: what cradle chooses first."""
    known = ["plan", *OWN, *PEERS]
    return sorted(methods, key=lambda pair: known.index(pair[1]) if pair[1] in known else len(known))
