#!/usr/bin/env python3
"""The physics uses no function of the C library's mathematics but those that are exact: the others give other bits on
other processors. Reads what the static libraries of the physics folders leave undefined. (Assimp, a shared library,
reads files with its own arithmetic; nothing of it runs after a mesh is loaded.)

    exact_functions_test.py FOLDER_OF_THE_LIBRARIES COMPILER
"""
import os, re, subprocess, sys

LAYERS = ["core", "math", "mesh", "scene", "dynamics", "constraints", "collision", "impact", "simulate", "trajectory"]
EXACT = {  # why its result has no choice: names
    "IEEE 754 rounds it exactly": ["sqrt"],
    "the result is a whole double or integer": ["floor", "ceil", "trunc", "round", "lround", "rint", "nearbyint"],
    "the remainder is a double": ["fmod", "remainder"],
    "bits of the argument, moved": ["fabs", "copysign", "frexp", "ldexp", "scalbn", "modf", "logb", "ilogb", "nextafter"],
    "one of the arguments": ["fmin", "fmax"],
}


def symbols(*command):
    listing = subprocess.run(["nm", *command], check=True, capture_output=True, text=True).stdout
    return {line.split()[-1].split("@")[0] for line in listing.splitlines() if re.search(r" \w \S+$", line)}


def main():
    folder, compiler = sys.argv[1:]
    library = subprocess.run([compiler, "-print-file-name=libm.so.6"], check=True, capture_output=True, text=True).stdout.strip()
    mathematics = symbols("--dynamic", "--defined-only", library)
    assert {"sin", "pow", "sqrtf"} <= mathematics, f"{library} is not the C library's mathematics"
    allowed = {name + suffix for names in EXACT.values() for name in names for suffix in ("", "f", "l")}
    faults = []
    for layer in LAYERS:
        path = os.path.join(folder, f"libcradle_{layer}.a")
        used = symbols("--undefined-only", path) & mathematics
        faults += [f"{layer} calls {name}: other bits elsewhere; see math/elementary" for name in sorted(used - allowed)]
    print("\n".join(faults) or f"{len(LAYERS)} layers call exact functions only")
    sys.exit(bool(faults))


main()
