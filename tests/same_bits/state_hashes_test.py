#!/usr/bin/env python3
"""The scenes' states have the bits of hashes.txt: with this build, whatever its compiler and level of optimisation, and
with --without-fma also on a processor that has no fused multiply-add, for which the C library is told to use its other
variants, until the last but one of the times.

    state_hashes_test.py PROGRAM SOURCE_FOLDER SECONDS... [--without-fma] [--short] [--update]

--short: the SLOW scenes run until the first of the times only.
A scene or a method that changes its bits on purpose: ./run hashes writes hashes.txt anew.
"""
import glob, os, subprocess, sys

SLOW = ("arch", "dominoes", "gears_on_platform", "platform_drop")  # in their first second: four fifths of the time of all
WITHOUT_FMA = {**os.environ, "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-AVX512F,-FMA,-FMA4"}
SINES = "import math; print(hash(tuple(math.sin(0.001373 * i) for i in range(1, 20000))))"


def output(command, environment):
    return subprocess.run(command, check=True, capture_output=True, text=True, env=environment).stdout


def require_other_variants():
    """The setting must matter, or the comparison below would prove nothing."""
    with open("/proc/cpuinfo") as file:
        has_fma = " fma " in file.read()
    differs = output([sys.executable, "-c", SINES], os.environ) != output([sys.executable, "-c", SINES], WITHOUT_FMA)
    assert differs or not has_fma, "sin() of the C library has the same bits without FMA: is the name still right?"


def main():
    program, source, *seconds = [argument for argument in sys.argv[1:] if not argument.startswith("--")]
    golden = os.path.join(source, "tests", "same_bits", "hashes.txt")
    scenes = sorted(glob.glob(os.path.join(source, "scenes", "*.json")))

    def times_of(name, times):
        return times[:1] if "--short" in sys.argv and name in SLOW else times

    def lines(environment, times):
        groups = {}
        for scene in scenes:
            groups.setdefault(tuple(times_of(os.path.basename(scene)[:-len(".json")], times)), []).append(scene)
        return [line for until, group in groups.items() for line in output([program, *until, "--", *group], environment).splitlines()]

    found = {"this build": (seconds, lines(os.environ, seconds))}
    if "--update" in sys.argv:
        with open(golden, "w") as file:
            file.write("\n".join(found["this build"][1]) + "\n")
    if "--without-fma" in sys.argv:
        require_other_variants()
        times = seconds[:-1] or seconds
        found["without FMA"] = (times, lines(WITHOUT_FMA, times))
    with open(golden) as file:
        known = file.read().splitlines()
    faults = []
    for name, (times, hashes) in found.items():
        expected = {line for line in known if line.split()[1] in times_of(line.split()[0], times)}
        faults += [f"{name}: {line}" for line in sorted(expected ^ set(hashes))]
        print(f"{name}: {len(hashes)} hashes")
    print("\n".join(faults + ["not as in hashes.txt, or only there"] if faults else ["all are as they were"]))
    sys.exit(bool(faults))


main()
