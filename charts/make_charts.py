#!/usr/bin/env python3
"""Runs all studies and writes the page that shows them: charts.html, and its picture charts.png.

    make_charts.py BUILD_FOLDER SOURCE_FOLDER OUTPUT_FOLDER [--scenes NAME,...] [--methods NAME,...]

What is measured stays in OUTPUT_FOLDER/charts. Interrupted, the same command goes on where it stopped; what is newer than the
program and its scenes is not measured again. With --scenes or --methods, only a part is measured.
"""
import argparse, os, shutil, subprocess, sys, time

import browser, machine, maps, piles
from page import page
from scenes import SCENES
from study_file import read_references, read_rows

SHOWN = ("cradle_on_joints", "chain_on_joints")  # by the README: docs/charts/NAME.png


def arguments():
    parser = argparse.ArgumentParser()
    parser.add_argument("build"), parser.add_argument("source"), parser.add_argument("output")
    parser.add_argument("--scenes", default=",".join(SCENES)), parser.add_argument("--methods", default="")
    return parser.parse_args()


def newest(paths):
    return max(os.path.getmtime(path) for path in paths)


def study(program, scenes, methods, folder):
    """study.csv and references.csv; what an older program, or one with other scenes, has left is begun anew."""
    done, part = os.path.join(folder, "study.csv"), os.path.join(folder, "study.csv.part")
    since = newest([program, *scenes])
    if os.path.exists(part) and os.path.getmtime(part) < since:
        print(f"{part} is older than the program or a scene: the study starts again", file=sys.stderr)
        os.remove(part)
    if os.path.exists(done) and not os.path.exists(part) and os.path.getmtime(done) > since:
        print(f"{done} is newer than the program and the scenes: not measured again", file=sys.stderr)
        return
    command = [program, "study", *scenes, "-o", folder] + (["--methods", methods] if methods else [])
    subprocess.run(command, check=True)


def by_scene(rows):
    found = {}
    for row in rows:
        found.setdefault(row.scene, []).append(row)
    return found


def write_page(options, folder, path):
    studies, references = by_scene(read_rows(os.path.join(folder, "study", "study.csv"))), \
        read_references(os.path.join(folder, "study", "references.csv"))
    facts = machine.machine(options.build, options.source, time.strftime("%Y-%m-%d"))
    text = page(studies, references, piles.section(piles.read(folder)),
                maps.section(maps.read(os.path.join(folder, "maps"))), facts)
    with open(path + ".part", "w") as file:
        file.write(text)
    os.rename(path + ".part", path)


def show_in_docs(folder, docs):
    os.makedirs(docs, exist_ok=True)
    for name in SHOWN:
        shutil.copyfile(os.path.join(folder, "study", f"work_precision_{name}.png"), os.path.join(docs, name + ".png"))


def main():
    options = arguments()
    folder, html = os.path.join(options.output, "charts"), os.path.join(options.output, "charts.html")
    os.makedirs(os.path.join(folder, "study"), exist_ok=True)
    scenes = [os.path.join(options.source, "benchmarks", "scenes", name + ".json") for name in options.scenes.split(",")]
    program = os.path.join(options.build, "bin", "cradle")
    study(program, scenes, options.methods, os.path.join(folder, "study"))
    piles.measure(os.path.join(options.build, "benchmarks", "benchmark_pile"), folder)
    maps.measure(program, os.path.join(folder, "maps"))
    write_page(options, folder, html)
    browser.take_picture(html, browser.check(html), html[:-5] + ".png")
    if options.scenes == ",".join(SCENES) and not options.methods:
        show_in_docs(folder, os.path.join(options.source, "docs", "charts"))
    print(f"{html}\n{html[:-5]}.png")


if __name__ == "__main__":
    main()
