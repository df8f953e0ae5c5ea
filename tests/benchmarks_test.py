#!/usr/bin/env python3
"""Benchmarks are correct C++. To see that, the compiler need not optimise them, in half of the time: no test runs them.

    benchmarks_test.py COMPILE_COMMANDS_JSON
"""
import json, subprocess, sys


def main():
    with open(sys.argv[1]) as file:
        commands = [command for command in json.load(file) if "/benchmarks/" in command["file"]]
    assert len(commands) > 10, f"{sys.argv[1]} has {len(commands)} benchmarks"
    wrong = [command["file"] for command in commands
             if subprocess.run(command["command"] + " -fsyntax-only", shell=True, cwd=command["directory"]).returncode]
    print("\n".join(wrong) or f"{len(commands)} files are correct")
    sys.exit(bool(wrong))


main()
