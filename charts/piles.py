"""Heaps beside Bullet and ODE, by benchmark_pile: figures instead of curves, for the motion of a heap is chaotic and has no error."""
import os, re, subprocess, sys

from markup import boxed, table

KINDS = {"spheres": "1000 spheres", "boxes": "1000 boxes", "turned": "1000 boxes, turned"}
TEXT = """A thousand bodies of 0.2 m drop into a tray, at a step of 1/60 s, one thread. A heap is chaotic: no program is near
another’s end, so that there is no error to draw. What counts is what a step costs, how deep bodies overlap (found from the poses
alone), and when all of them lie still: what rests costs little or nothing. Falling is the first 1.5 s, in which contacts change all
the time. Bullet has its defaults, and a tray of boxes where bodies are boxes; ODE takes dWorldQuickStep with 20 iterations, and
disables bodies that lie still."""
BODIES, SECONDS = "1000", "10"
HEADS = ["", "", "falling, ms a step", "until rest", "ten seconds", "deepest while falling, mm", "later", "at the end", "at rest after, s"]
NUMBER = r"(-?[\d.]+|nan|inf)"
FIGURES = re.compile(rf"  (\w+) +falling +{NUMBER} ms .*?until rest +{NUMBER} ms, all +{NUMBER} ms .*?\n +deepest falling +{NUMBER} mm, "
                     rf"later +{NUMBER} mm, at the end +{NUMBER} mm; rest at {NUMBER} s")


def measure(program, folder):
    """Runs what has no figures yet, or older ones than the program."""
    for place, kind in enumerate(KINDS):
        path = os.path.join(folder, f"pile_{kind}.txt")
        if os.path.exists(path) and os.path.getmtime(path) > os.path.getmtime(program):
            continue
        print(f"Heaps: {KINDS[kind]}, {len(KINDS) - place} of {len(KINDS)} left", file=sys.stderr)
        text = subprocess.run([program, BODIES, kind, SECONDS], capture_output=True, text=True, check=True).stdout
        with open(path + ".part", "w") as file:
            file.write(text)
        os.rename(path + ".part", path)


def read(folder):
    """{kind: {engine: figures as floats, in the order of HEADS}}"""
    found = {}
    for kind in KINDS:
        with open(os.path.join(folder, f"pile_{kind}.txt")) as file:
            found[kind] = {line[0]: [float(number) for number in line[1:]] for line in FIGURES.findall(file.read())}
    return found


def rest(seconds):
    return f"{seconds:.2f}" if seconds >= 0 else "never"


def sentence(kind, ours, name, theirs):
    """What the figures say of a heap beside another engine, losses too."""
    falling, all_of_it = ours[0] / theirs[0], ours[2] / theirs[2]
    text = (f"{KINDS[kind]} beside {name}: while they fall, Cradle costs {falling:.2f} of it, over ten seconds {all_of_it:.2f}; it overlaps by "
            f"{max(ours[3:5]):.1f} mm at the most, {name} by {max(theirs[3:5]):.1f} mm.")
    behind = [when for when, factor in (("while they fall", falling), ("over ten seconds", all_of_it)) if factor > 1]
    if behind:
        text += f" Cradle loses: {' and '.join(behind)} it is dearer."
    if max(ours[3:5]) > max(theirs[3:5]):
        text += " Cradle loses: it overlaps more deeply."
    return text


def section(found):
    """HTML."""
    lines, sentences = [], []
    for kind, engines in found.items():
        for engine, numbers in engines.items():
            cells = [f"{x:.2f}" for x in numbers[:3]] + [f"{x:.1f}" for x in numbers[3:6]] + [rest(numbers[6])]
            lines.append([KINDS[kind], "Cradle" if engine == "cradle" else engine] + cells)
        sentences += [sentence(kind, engines["cradle"], engine, numbers) for engine, numbers in engines.items() if engine != "cradle"]
    said = "".join(boxed(kind, [text for text in sentences if ("loses" in text) == (kind == "lost")]) for kind in ("won", "lost"))
    return (f'<section id="piles"><h2>Heaps<small>S7 · benchmark_pile</small></h2><p>{TEXT}</p>{table(HEADS, lines)}{said}</section>')
