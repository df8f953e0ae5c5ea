#!/usr/bin/env python3
"""Whether scene.schema.json and the program agree on what a scene file is.

    schema_test.py SCHEMA CASES SCENE

CASES is scene_cases.txt, which the program's own tests read too: the schema must find the faults in it that a schema
can find, and no others. SCENE is a scene that has every key; each of its values may be drawn.
"""
import copy
import json
import sys

import jsonschema


def read_cases(path):
    """Pairs of a text and the lines that say what is expected of it."""
    kinds, cases = {}, []
    for block in open(path, encoding="utf-8").read().split("\n\n"):
        lines = [line for line in block.splitlines() if not line.startswith("#")]
        if lines and lines[0].startswith("let "):
            kinds.update(line.removeprefix("let ").split(": ", 1) for line in lines)
        elif lines:
            kind, text = lines[0].split(": ", 1)
            more = [line[1:] for line in lines[1:] if line.startswith("|")]
            cases.append((kinds[kind].replace("$", "\n".join([text, *more])), lines[1 + len(more):]))
    return cases


def refuse_duplicates(members):
    keys = [key for key, _ in members]
    if len(keys) != len(set(keys)):
        raise ValueError("duplicate key")
    return dict(members)


def is_accepted(validator, text):
    try:
        return validator.is_valid(json.loads(text, object_pairs_hook=refuse_duplicates))
    except ValueError:
        return False


def places_in(value, place=()):
    """The places of a value and of all in it, as tuples of keys and indices."""
    yield place
    children = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, child in children:
        yield from places_in(child, place + (key,))


def value_at(scene, place):
    for key in place:
        scene = scene[key]
    return scene


def with_value(scene, place, value):
    changed = copy.deepcopy(scene)
    value_at(changed, place[:-1])[place[-1]] = value
    return changed


def count_wrong_draws(validator, scene):
    """In place of each value but the scene and the materials by name, a draw must pass, and a faulty one must not."""
    places = [place for place in places_in(scene) if place not in ((), ("materials",))]
    wrong = 0
    for place in places:
        for draw, should_pass in (({"choice": [value_at(scene, place)]}, True), ({"choice": []}, False)):
            if validator.is_valid(with_value(scene, place, {"draw": draw})) != should_pass:
                wrong += 1
                print(f"the schema should {'accept' if should_pass else 'refuse'} {draw} at {place}")
    print(f"{len(places)} values, {wrong} wrong draws")
    return wrong if len(places) > 300 else wrong + 1


def main():
    schema_path, cases_path, scene_path = sys.argv[1:]
    schema = json.load(open(schema_path, encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(schema)
    validator = jsonschema.Draft202012Validator(schema)
    wrong = 0
    cases = read_cases(cases_path) + [(open(scene_path, encoding="utf-8").read(), ["valid"])]
    for text, expected in cases:
        should_pass = "valid" in expected or "beyond schema" in expected
        if is_accepted(validator, text.replace("@", "")) != should_pass:
            wrong += 1
            print(f"the schema should {'accept' if should_pass else 'refuse'}: {text}")
    print(f"{len(cases)} texts, {wrong} wrong")
    wrong += count_wrong_draws(validator, json.load(open(scene_path, encoding="utf-8")))
    return 1 if wrong or len(cases) < 100 else 0


if __name__ == "__main__":
    sys.exit(main())
