#!/usr/bin/env python3
"""Balls that collide without loss: cost and exactness, as a table.

    hard_sphere_gas.py PROGRAM [--collisions N]

us/collision  CPU time of the integration, for each collision (two balls, or a ball and a wall)
ms/s          CPU time for each simulated second
energy        largest drift of kinetic + potential in any frame, relative to the kinetic energy at its largest
pressure      of the gas on its walls, relative to the closed form below, less 1
error         m: of the height against the closed form, in any frame

The closed form is the second virial coefficient of N hard spheres (centres at least s apart) in a cube in which the
centres have the side a: P = kT d ln Z / dV with kT = 2 E / (3 N), ln Z = N ln a^3 - N (N - 1) / 2 I(a) / a^6, and
I(a) the integral of (a - |x|) (a - |y|) (a - |z|) over |x, y, z| < s. The third coefficient would add 10 packing^2,
so that only the dilute gas is compared.
"""
import argparse, json, math, os, random, sqlite3, subprocess, tempfile

LOSSLESS = {"restitution": 1, "staticFriction": 0, "dynamicFriction": 0}


def scene(name, duration, bodies, frames_per_second, gravity=(0, -9.81, 0)):
    return {"schema": "cradle-scene/1", "name": name, "duration": duration, "gravity": list(gravity),
            "output": {"framesPerSecond": frames_per_second}, "materials": {"elastic": LOSSLESS},
            "bodies": [{"material": "elastic", **body} for body in bodies]}


def plane(name, point, normal):
    return {"name": name, "shape": {"plane": {"normal": normal}}, "motion": "static", "position": point}


def ball(name, position, velocity=(0, 0, 0), mass=1.0, radius=0.1):
    return {"name": name, "shape": {"sphere": {"radius": radius}}, "mass": mass, "position": list(position),
            "linearVelocity": list(velocity)}


def gas(balls, packing, duration):
    """Balls on a lattice with velocities from a normal distribution, in a cube."""
    radius, source = 0.05, random.Random(1)
    side = (balls * 4 / 3 * math.pi * radius ** 3 / packing) ** (1 / 3)
    bodies = []
    for axis in range(3):
        for sign in (-1, 1):
            normal = [float(sign * (axis == i)) for i in range(3)]
            bodies.append(plane(f"wall{axis}{sign}", [-side / 2 * x for x in normal], normal))
    count = math.ceil(balls ** (1 / 3))
    for i in range(balls):
        place = [((i // count ** k % count) + 0.5) / count * side - side / 2 for k in range(3)]
        bodies.append(ball(f"b{i}", place, [source.gauss(0, 1) for _ in range(3)], radius=radius))
    return scene("gas", duration, bodies, 10 / duration, (0, 0, 0)), side, radius


def grid():
    """7 x 7 balls of 10 kg dropped 5 m onto a plane."""
    bodies = [plane("floor", [0, 0, 0], [0, 1, 0])]
    bodies += [ball(f"b{x}_{z}", [0.3 * x, 5.1, 0.3 * z], mass=10.0) for x in range(7) for z in range(7)]
    return scene("grid", 20, bodies, 60)


def cube():
    """6 x 6 x 6 balls, their places perturbed, dropped onto a plane."""
    source, bodies = random.Random(2), [plane("floor", [0, 0, 0], [0, 1, 0])]
    for i in range(216):
        place = [0.21 * (i // 6 ** k % 6) + source.uniform(-1e-3, 1e-3) for k in range(3)]
        bodies.append(ball(f"b{i}", [place[0], 1.1 + place[1], place[2]]))
    return scene("cube", 10, bodies, 60)


def bounce():
    return scene("bounce", 10, [plane("floor", [0, 0, 0], [0, 1, 0]), ball("ball", [0, 1.1, 0])], 60)


class Run:
    def __init__(self, program, document):
        with tempfile.TemporaryDirectory() as folder:
            path, file = os.path.join(folder, "scene.json"), os.path.join(folder, "run.sqlite")
            with open(path, "w") as stream:
                json.dump(document, stream)
            subprocess.run([program, "simulate", path, "-o", file, "--quiet"], check=True)
            database = sqlite3.connect(file)
            query = lambda text: database.execute(text).fetchall()
            meta = dict(query("select key, value from meta"))
            self.cpu, self.method = float(meta["cpuSeconds"]), meta["method"]
            self.duration = document["duration"]
            self.collisions, = query("select count(*) from event where kind = 'impact'")[0]
            self.wall_impulse, = query("select total(impulse) from event where b in (select id from body where motion "
                                       "= 'static')")[0]
            energies = [kinetic + potential for kinetic, potential in query("select kinetic, potential from energy")]
            self.kinetic, = query("select max(kinetic) from energy")[0]
            self.drift = max(abs(energy - energies[0]) for energy in energies) / self.kinetic
            self.heights = query("select time, py from state join frame on frame.id = state.frame where body = "
                                 "(select min(body) from state)")
            database.close()
        assert self.method == "closed form between collisions", self.method

    def figures(self):
        return (f"{self.collisions:9d} collisions  {1e6 * self.cpu / self.collisions:7.3f} us/collision  "
                f"{1e3 * self.cpu / self.duration:9.4f} ms/s  energy {self.drift:.1e}")


def virial_pressure(balls, side, radius, energy):
    a, s = side - 2 * radius, 2 * radius
    overlap = 4 / 3 * math.pi * s ** 3 * a ** 3 - 1.5 * math.pi * s ** 4 * a ** 2 + 1.6 * s ** 5 * a - s ** 6 / 6
    slope = 4 * math.pi * s ** 3 * a ** 2 - 3 * math.pi * s ** 4 * a + 1.6 * s ** 5
    pairs = balls * (balls - 1) / 2
    rate = 3 * balls / a - pairs * (slope / a ** 6 - 6 * overlap / a ** 7)
    return 2 * energy / (3 * balls) * rate / (3 * a ** 2)


def print_gas(program, balls, packing, collisions):
    document, side, radius = gas(balls, packing, 1)
    rate = Run(program, document).collisions
    document, side, radius = gas(balls, packing, collisions / rate)
    run = Run(program, document)
    # The walls stand where the centres turn.
    measured = run.wall_impulse / run.duration / (6 * (side - 2 * radius) ** 2)
    ratio = measured / virial_pressure(balls, side, radius, run.kinetic) - 1
    pressure = f"  pressure {ratio:+.1e}" if packing < 0.01 else ""
    print(f"gas {balls:4d}, packing {packing:5.3f}  {run.figures()}{pressure}", flush=True)
    return run.cpu / run.collisions


def bounce_error(run):
    first = math.sqrt(2 / 9.81)
    error = 0.0
    for time, height in run.heights:
        since = (time + first) % (2 * first) - first  # from the top
        error = max(error, abs(height - 1.1 + 9.81 * since * since / 2))
    return error


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--collisions", type=int, default=1000000)
    arguments = parser.parse_args()
    for packing in (0.005, 0.1, 0.4):
        few, many = (print_gas(arguments.program, balls, packing, arguments.collisions) for balls in (100, 1000))
        print(f"      1000 balls cost {many / few:.2f} times as much a collision as 100")
    print(f"7 x 7 dropped 5 m        {Run(arguments.program, grid()).figures()}")
    print(f"6 x 6 x 6 dropped 1 m    {Run(arguments.program, cube()).figures()}")
    run = Run(arguments.program, bounce())
    print(f"one ball dropped 1 m     {run.figures()}  error {bounce_error(run):.1e} m")


if __name__ == "__main__":
    main()
