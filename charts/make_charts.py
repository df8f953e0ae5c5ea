#!/usr/bin/env python3
"""Runs all studies and writes the page that shows them: charts.html, and its picture charts.png; and what docs/engines.md shows of it.

    make_charts.py BUILD_FOLDER SOURCE_FOLDER OUTPUT_FOLDER [--scenes NAME,...] [--methods NAME,...]

What is measured stays in OUTPUT_FOLDER/charts. Interrupted, the same command goes on where it stopped; what is newer than the
program and its scenes is not measured again. With --scenes or --methods, only a part is measured.
"""
import argparse, os, shutil, subprocess, sys, time

import browser, engine_table, machine, maps, piles
from page import page
from scenes import SCENES
from study_file import read_references, read_rows

SHOWN = ("cradle_on_joints", "chain_on_joints")  # by docs/engines.md: docs/charts/NAME.png


def arguments():
    parser = argparse.ArgumentParser()
    parser.add_argument("build"), parser.add_argument("source"), parser.add_argument("output")
    parser.add_argument("--scenes", default=",".join(SCENES)), parser.add_argument("--methods", default="")
    return parser.parse_args()


def study(program, scenes, methods, folder):
    """study.csv and references.csv; what an older program, or one that was asked for something else, has left is begun anew."""
    place = os.path.join(folder, "study")
    done, part, asked = os.path.join(place, "study.csv"), os.path.join(place, "study.csv.part"), os.path.join(folder, "study_asked")
    os.makedirs(place, exist_ok=True)
    command = [program, "study", *scenes, "-o", place] + (["--methods", methods] if methods else [])
    since = max(os.path.getmtime(path) for path in [program, *scenes])
    for path in (done, part):
        if os.path.exists(path) and (os.path.getmtime(path) < since or text_of(asked) != " ".join(command)):
            print(f"{path} is of an older program or scene, or of others: measured again", file=sys.stderr)
            os.remove(path)
    if os.path.exists(done) and not os.path.exists(part):
        print(f"{done} is newer than the program and the scenes: not measured again", file=sys.stderr)
        return
    with open(asked, "w") as file:
        file.write(" ".join(command))
    subprocess.run(command, check=True)


def text_of(path):
    if not os.path.exists(path):
        return ""
    with open(path) as file:
        return file.read()


def by_scene(rows):
    found = {}
    for row in rows:
        found.setdefault(row.scene, []).append(row)
    return found


def read_studies(folder):
    """Rows and references, each by scene."""
    place = os.path.join(folder, "study")
    return by_scene(read_rows(os.path.join(place, "study.csv"))), read_references(os.path.join(place, "references.csv"))


def write_page(options, folder, studies, references, path):
    facts = machine.machine(options.build, options.source, time.strftime("%Y-%m-%d"))
    text = page(studies, references, piles.section(piles.read(folder)), maps.section(maps.read(folder)), facts)
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
    scenes = [os.path.join(options.source, "benchmarks", "scenes", name + ".json") for name in options.scenes.split(",")]
    program = os.path.join(options.build, "bin", "cradle")
    study(program, scenes, options.methods, folder)
    piles.measure(os.path.join(options.build, "benchmarks", "benchmark_pile"), folder)
    maps.measure(program, folder)
    studies, references = read_studies(folder)
    write_page(options, folder, studies, references, html)
    browser.take_picture(html, browser.check(html), html[:-5] + ".png")
    if options.scenes == ",".join(SCENES) and not options.methods:
        show_in_docs(folder, os.path.join(options.source, "docs", "charts"))
        engine_table.update(os.path.join(options.source, "docs", "engines.md"), studies, references)
    print(f"{html}\n{html[:-5]}.png")


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        print("interrupted; the same command goes on from here", file=sys.stderr)
        sys.exit(130)
    except subprocess.CalledProcessError as error:
        print(f"charts: {os.path.basename(error.cmd[0])} ended with {error.returncode}", file=sys.stderr)
        sys.exit(error.returncode)
    except (browser.PageError, engine_table.MarkError) as error:
        sys.exit(f"charts: {error}")
