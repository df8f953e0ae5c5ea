#!/usr/bin/env python3
"""Every scene simulated once, for the tests that look at such runs: their trajectories, and what was said on the way.

    scene_runs.py PROGRAM SOURCE_FOLDER RUNS

RUNS: folder that is made anew, with NAME.sqlite and NAME.txt (standard error) of each scene.
"""
import os, shutil, subprocess, sys


def main():
    program, source, runs = map(os.path.abspath, sys.argv[1:4])
    shutil.rmtree(runs, ignore_errors=True)
    os.makedirs(runs)
    faults = 0
    for file in sorted(os.listdir(os.path.join(source, "scenes"))):
        run = os.path.join(runs, os.path.splitext(file)[0])
        with open(run + ".txt", "w") as error:
            code = subprocess.run([program, "simulate", os.path.join(source, "scenes", file), "-o", run + ".sqlite", "--quiet"],
                                  stderr=error).returncode
        if code:
            faults += 1
            with open(run + ".txt") as error:
                print(f"{file}: exit {code}\n{error.read()}")
    sys.exit(faults > 0)


main()
