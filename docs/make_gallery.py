#!/usr/bin/env python3
"""Draws one picture of every scene and the page that shows them: docs/gallery.md and docs/gallery/SCENE.png.

    make_gallery.py PROGRAM SOURCE_FOLDER

A scene that FRAMES does not know is shown in the middle of its film: name a moment that says what it is about.
"""
import html, json, os, re, shutil, subprocess, sys, tempfile

SIZE = "480x270"
MOST_BYTES = 4_000_000  # of all pictures: a page that loads at once
FRAMES = {
    "arch": 110, "backspin_ball": 60, "ball_tray": 60, "belt": 60, "billiard_break": 34, "bouncing_balls": 75,
    "box_tray": 60, "cart": 260, "coupled_pendulums": 400, "coupled_pendulums_rod": 150, "dominoes": 110,
    "double_pendulum": 250, "drag_and_drop": 145, "dropped_model": 30, "car": 150, "four_bar": 50, "gate": 40,
    "gears_fall": 30, "gimbal_lock": 50, "gears_on_platform": 40, "divided_gas": 300, "cars_among_pendulums": 90, "avalanche": 90,
    "chains_that_throw": 50, "dice": 20, "orientation_drift": 400, "overlap_by_mass": 300,
    "hanging_chain": 60, "hard_sphere_gas": 60, "heavy_top_stack": 120, "kapitza": 130, "lagrange_top": 150,
    "newtons_cradle": 28, "newtons_cradles": 30, "piston": 25, "platform_drop": 45, "platform_drop_rods": 40,
    "rod_pendulum": 60,
    "rolling_race": 200, "rope_bridge": 40, "rope_slack_taut": 60, "shaken_table": 150, "slack_rope": 60,
    "sliding_blocks": 120, "spinning_handle": 200, "struck_model": 35, "suspended_model": 45, "suspended_model_rod": 45,
    "top_on_ground": 350, "tray_of_balls": 120, "triple_pendulum": 75, "turntable": 24, "two_models_one_rod": 100,
    "two_models_one_spring": 100,
}


def scene_of(path):
    """A scene file's content; comments may stand between its values."""
    with open(path) as file:
        text = file.read()
    return json.loads(re.sub(r'("(?:[^"\\]|\\.)*")|//[^\n]*|/\*.*?\*/', lambda found: found[1] or "", text, flags=re.S))


def middle_frame(scene):
    output = scene.get("output", {})
    return int(scene["duration"] * output.get("framesPerSecond", 60) / output.get("playbackSpeed", 1) / 2)


def draw(program, path, frame, target):
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([program, "render", path, "-o", folder, "--frames", f"{frame}:{frame + 1}", "--size", SIZE, "--quiet"],
                       check=True)
        shutil.move(os.path.join(folder, f"frame_{frame:06}.png"), target)


def entry(name, scene):
    title, text = html.escape(scene["name"], False), html.escape(scene.get("description", ""), False)
    return (f'<td width="50%" valign="top"><img src="gallery/{name}.png" alt="{name}"><br>'
            f'<b><a href="../scenes/{name}.json">{title}</a></b><br>{text}</td>')


def main():
    program, source = [os.path.abspath(argument) for argument in sys.argv[1:3]]
    docs, folder = os.path.join(source, "docs"), os.path.join(source, "docs", "gallery")
    names = sorted(name[:-5] for name in os.listdir(os.path.join(source, "scenes")) if name.endswith(".json"))
    os.makedirs(folder, exist_ok=True)
    for old in set(os.listdir(folder)) - {name + ".png" for name in names}:
        os.remove(os.path.join(folder, old))
    entries, size = [], 0
    for name in names:
        path, picture = os.path.join(source, "scenes", name + ".json"), os.path.join(folder, name + ".png")
        scene = scene_of(path)
        draw(program, path, FRAMES.get(name, middle_frame(scene)), picture)
        entries.append(entry(name, scene))
        size += os.path.getsize(picture)
        print(f"{name}: {os.path.getsize(picture)} bytes", flush=True)
    if size > MOST_BYTES:
        sys.exit(f"the pictures have {size} bytes together; at most {MOST_BYTES} are wanted")
    rows = ["<tr>\n" + "\n".join(entries[i:i + 2]) + "\n</tr>" for i in range(0, len(entries), 2)]
    with open(os.path.join(docs, "gallery.md"), "w") as page:
        page.write("# The scenes\n\nOne picture of each, drawn by `./run gallery`; `cradle video scenes/NAME.json -o film.mp4` makes "
                   "the film.\n\n<table>\n" + "\n".join(rows) + "\n</table>\n")


main()
