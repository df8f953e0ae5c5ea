#!/usr/bin/env python3
"""Includes run one way: each folder of src/ includes only those that stand in its row, and each third-party library
appears where it is named here.

    layering_test.py SOURCE_FOLDER
"""
import os, re, sys

MAY_INCLUDE = {
    "core": [],
    "math": ["core"],
    "mesh": ["core", "math"],
    "scene": ["core", "math", "mesh"],
    "dynamics": ["core", "math", "mesh"],
    "constraints": ["core", "math", "mesh", "dynamics"],
    "collision": ["core", "math", "mesh", "dynamics", "constraints"],
    "impact": ["core", "math", "mesh", "dynamics", "constraints", "collision"],
    "trajectory": ["core", "math", "mesh"],
    "simulate": ["core", "math", "mesh", "scene", "dynamics", "constraints", "collision", "impact", "trajectory"],
    "sampling": ["core", "math", "mesh", "scene", "dynamics", "constraints", "collision", "impact", "trajectory", "simulate"],
    "image": ["core"],
    "render": ["core", "math", "mesh", "scene", "trajectory", "image"],
    "overlay": ["core", "math", "mesh", "scene", "trajectory", "image", "render"],
    "film": ["core", "math", "mesh", "scene", "trajectory", "image", "render", "overlay"],
    "player": ["core", "math", "mesh", "scene", "trajectory", "image", "render", "overlay", "film"],
    "library": ["core", "math", "mesh", "scene", "dynamics", "constraints", "collision", "impact", "trajectory", "simulate", "image", "render", "overlay", "film", "player"],
    "truth": ["core", "math", "mesh", "scene", "trajectory", "render"],
    "verify": ["core", "math", "mesh", "scene", "trajectory"],
    "study": ["core", "math", "mesh", "scene", "dynamics", "constraints", "collision", "impact", "trajectory", "simulate", "image"],
    "commands": ["core", "math", "mesh", "scene", "dynamics", "constraints", "collision", "impact", "trajectory", "simulate", "sampling", "image", "render", "overlay", "film", "player", "truth", "verify", "study"],
}
# The one place of each library (Eigen and fmt are everywhere).
LIBRARY_UNITS = {
    "assimp/": ["mesh"],
    "libqhull_r/": ["mesh/convex_hull"],
    "nlohmann/": ["scene/json_document", "commands/inspect_mesh", "commands/glb_file", "commands/plan_scene", "commands/comparison_texts", "player/player_document", "core/json_numbers", "commands/check_scene", "truth/truth_json", "verify/truth_documents"],
    "CLI/": ["main.cpp"],
    "sqlite3.h": ["trajectory/database"],
    "stb/": ["image/png", "image/font", "mesh/texture"],
    "libdeflate.h": ["image/png", "player/packed_numbers"],
    "archive": ["commands/tar_shard"],
    "OpenEXR/": ["truth/pass_files", "verify/exr_reader"],
    "GL/": ["render"],
    "GL/osmesa.h": ["render/contexts/osmesa"],
    "EGL/": ["render/contexts/egl"],
    "Bullet": ["study/peers/bullet"],
    "bt": ["study/peers/bullet"],
    "ode/": ["study/peers/ode"],
    "mujoco/": ["study/peers/mujoco"],
    "Simbody": ["study/peers/simbody"],
    "SimTK": ["study/peers/simbody"],
}


def main():
    source = os.path.join(sys.argv[1], "src")
    faults, files = [], 0
    for folder, _, names in os.walk(source):
        for name in names:
            if not name.endswith((".h", ".cpp")):
                continue
            files += 1
            path = os.path.relpath(os.path.join(folder, name), source)
            layer = path.split(os.sep)[0] if os.sep in path else None
            text = open(os.path.join(source, path)).read()
            for target in re.findall(r'^#include "([^"]+)"', text, re.M):
                other = target.split("/")[0]
                if layer and other != layer and other not in MAY_INCLUDE.get(layer, []):
                    faults.append(f"src/{path} includes {target}: {layer} may not include {other}")
            for target in re.findall(r"^#include <([^>]+)>", text, re.M):
                for library, units in LIBRARY_UNITS.items():
                    if target.startswith(library) and not any(path.startswith(unit) for unit in units):
                        faults.append(f"src/{path} includes <{target}>: that belongs in {' and '.join(units)}")
    print("\n".join(faults) or f"{files} files include one way")
    sys.exit(bool(faults) or files == 0)


main()
