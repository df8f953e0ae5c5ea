#!/usr/bin/env python3
"""Bad inputs, more than 250: each is refused with its exit code and one clear message, in little time and memory, and nothing changes.

    bad_inputs_test.py PROGRAM SOURCE_FOLDER [WORDS]

WORDS: only cases whose name contains them. Each table below is a kind of input, a row a case: its name, what makes the
input, where the message says that the fault is, and fragments of what it says: what was found, what is allowed, what to do.
Exit codes are those of docs/commands.md: 2 command line, trajectories and pictures, 3 scene text, 4 meshes, 5 outputs.

A case runs in a folder of its own with good files beside the bad one (`good_files`), among them outputs of earlier runs.
"""
import base64, concurrent.futures, contextlib, itertools, json, os, random, re, shlex, shutil, sqlite3, struct, sys, tempfile
import unittest, zlib

from running import Ended, MOST_MEMORY, MOST_SECONDS, everything, read, write

PROGRAM, SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
WANTED = sys.argv[3] if len(sys.argv) > 3 else ""
PROCESSES = 2  # at once
HINT = "Run with --help for more information."  # a line of its own
CASES = []


class Case:
    """A bad input: `files` to write (name: content, or what makes the file at a path), a command line, and its refusal."""
    def __init__(self, name, files, command, code, begins, words, lines=1):
        self.name, self.files, self.code, self.begins, self.words, self.lines = name, files, code, begins, words, lines
        self.arguments = shlex.split(command)

    def faults(self, good):
        """What is not as it should be."""
        with tempfile.TemporaryDirectory() as folder:
            shutil.copytree(good, folder, dirs_exist_ok=True)
            for name, content in self.files.items():
                path = os.path.join(folder, name)
                content(path) if callable(content) else write(path, content)
            before = everything(folder)
            ended = Ended(PROGRAM, self.arguments, folder)
            return list(self.faults_of(ended, before, everything(folder)))

    def faults_of(self, ended, before, after):
        lines = [line for line in ended.error.splitlines() if line != HINT and not line.startswith("warning: ")]
        message = "\n".join(lines)
        shown = message if len(message) < 1000 else message[:1000] + " ..."
        if ended.code != self.code:
            yield "exit code %d, not %d: %s" % (ended.code, self.code, shown)
        if not re.match(self.begins, message):
            yield "does not begin with %s: %s" % (self.begins, shown)
        for word in self.words:
            if word not in message:
                yield "does not say %s: %s" % (word, shown)
        if len(lines) != self.lines or not ended.error.endswith("\n"):
            yield "%d lines, not %d: %s" % (len(lines), self.lines, shown)
        if any(not (c == "\n" or c.isprintable()) for c in ended.error):
            yield "control characters in %r" % shown
        if ended.out:
            yield "says on standard output %s" % ended.out[:300]
        child = re.search(r"takes longer than (\d+) s", message)  # than the child that parses meshes is given
        if ended.seconds > MOST_SECONDS + (int(child[1]) if child else 0):
            yield "%.1f s of CPU time" % ended.seconds
        if ended.memory > MOST_MEMORY:
            yield "%d MB of memory" % (ended.memory >> 20)
        for name in sorted(before.keys() | after.keys()):
            if name not in before or name not in after or before[name] != after[name]:
                yield "%s is %s" % (name, "new" if name not in before else "gone" if name not in after else "changed")


def good_scene():
    ball = {"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "mass": 1}
    ground = {"name": "ground", "shape": {"plane": {}}, "motion": "static", "position": [0, -0.1, 0]}
    box = {"name": "box", "shape": {"mesh": "box.3ds"}, "mass": 1, "position": [0, 5, 0]}
    return {"schema": "cradle-scene/1", "name": "good", "duration": 0.1, "bodies": [ball, box, ground],
            "output": {"framesPerSecond": 60, "width": 32, "height": 32}}


def good_files(folder):
    """What stands beside each bad input."""
    path = lambda name: os.path.join(folder, name)
    shutil.copy(os.path.join(SOURCE, "assets", "box.3ds"), path("box.3ds"))
    write(path("good.json"), json.dumps(good_scene()))
    for arguments in (["simulate", "good.json", "-o", "good.sqlite"], ["render", "good.sqlite", "-o", "frames", "--frames", "0:3"]):
        ended = Ended(PROGRAM, [*arguments, "-q"], folder)
        assert ended.code == 0, ended.error
    shutil.copy(path("good.sqlite"), path("old.sqlite"))
    for ending in ("csv", "glb", "mp4", "html"):
        write(path("old." + ending), "of an earlier run")
    write(path("others/thesis.txt"), "chapter one")
    os.mkdir(path("empty"))


# Scene texts. @ marks the place of the fault, and is taken out. Each goes to the next of the commands that read scenes.

SCENE_COMMANDS = itertools.cycle(
    ("check s.json", "plan s.json", "simulate s.json -o old.sqlite", "render s.json -o frames --overwrite",
     "video s.json -o old.mp4", "study s.json -o new", "simulate s.json -o new.sqlite --strict", "render s.json -o new",
     "plan s.json --json", "video s.json -o new.mp4"))


def header(members):
    return '{"schema": "cradle-scene/1", "name": "n", "duration": 1, "bodies": [], %s}' % members


def scene(members):
    return '{"schema": "cradle-scene/1", "name": "n", "duration": 1, %s}' % members


def body(members):
    return scene('"bodies": [{"name": "a", "shape": {"sphere": {}}, %s}]' % members)


def shape(text, more=""):
    return scene('"bodies": [{"name": "a", "shape": %s%s}]' % (text, more))


def links(members):
    """Two unit spheres, a at the origin and b at (3, 4, 0), and a static plane."""
    return scene('"bodies": [{"name": "a", "shape": {"sphere": {}}}, {"name": "b", "shape": {"sphere": {}}, "position": [3, 4, 0]}, '
                 '{"name": "floor", "shape": {"plane": {}}, "motion": "static", "position": [0, -9, 0]}], ' + members)


def spheres(*places):
    """Unit spheres; @ before the last."""
    bodies = ['{"name": "s%d", "shape": {"sphere": {}}, "position": %s}' % (i, list(p)) for i, p in enumerate(places)]
    return scene('"bodies": [%s]' % ", ".join(bodies[:-1] + ["@" + bodies[-1]]))


def add_scene(name, text, pointer, *words):
    """`words` end with the number of lines if there are several."""
    lines, words = (words[-1], words[:-1]) if words and isinstance(words[-1], int) else (1, words)
    text = text if isinstance(text, bytes) else text.encode()
    before = text.partition(b"@")[0]
    row, column = before.count(b"\n") + 1, len(before) - before.rfind(b"\n")
    where = r"s\.json:%d:%d%s: " % (row, column, re.escape(" " + pointer) if pointer else "") if b"@" in text else r"s\.json:"
    CASES.append(Case("scene: " + name, {"s.json": text.replace(b"@", b"", 1)}, next(SCENE_COMMANDS), 3, where, words, lines))


END = header('"gravity": [0, 0, 0]')[:-1]  # a whole scene but for its last bracket

for row in (
    # Not JSON at all
    ("empty file", "", "", "empty"),
    ("blank file", " \n\t\n @", "", "ends too early"),
    ("line feeds before a fault", b"{" + b"\n" * 60_000_000 + b"@x", "", "no JSON"),
    ("comment of line feeds before a fault", b"/*" + b"\n" * 60_000_000 + b"*/ @x", "", "no JSON"),
    ("comment of line feeds without an end", b"{@/*" + b"\n" * 60_000_000, "", "comment has no end"),
    ("number of 60 MB", b'{"duration": ' + b"1" * 1_000_000 + b"@" + b"1" * 60_000_000, "", "a word of more than 1000000 characters"),
    ("a million keys of one name", b'{"k": 0' + b', "k": 0' * 1_000_000 + b"}", "", "duplicate key", 50),
    ("every byte", b"@" + bytes(range(256)) * 9, "", "NUL byte", "UTF-8"),
    ("random bytes without NUL", b"\x9f\xe8\x12\xff" * 99, "", "UTF-8"),
    ("UTF-16", '\ufeff{"schema": "cradle-scene/1"}'.encode("utf-16-le"), "", "UTF-8"),
    ("plain words", "@hello world", "", "no JSON", '"hello"'),
    ("YAML", "@schema: cradle-scene/1\nname: n\n", "", "no JSON", '"schema:"'),
    ("XML", '@<?xml version="1.0"?><scene/>', "", "no JSON", '"<?xml"'),
    ("array", "@[]", "", "an array", "an object"),
    ("string", '@"cradle-scene/1"', "", "string", "an object"),
    ("null", "@null", "", "null", "an object"),
    ("two documents", header('"gravity": [0, 0, 0]') + " @{}", "", "no JSON"),
    # Syntax
    ("last bracket missing", END + "\n@", "/gravity", "ends too early", "the bracket at 1:1 is not closed"),
    ("bracket of the other kind", header('"gravity": [0, 0, 0@}'), "/gravity/2", "no JSON", "}"),
    ("comma before a bracket", header('"gravity": [0, 0, 0, @]'), "/gravity/2", "comma"),
    ("comma missing", header('"gravity": [0 @0, 0]'), "/gravity/0", "no JSON", "0"),
    ("colon missing", header('"gravity" @[0, 0, 0]'), "/gravity", "no JSON", "["),
    ("single quotes", header("@'gravity': [0, 0, 0]"), "/bodies", "double quotes"),
    ("key without quotes", header("@gravity: [0, 0, 0]"), "/bodies", "no JSON", "gravity"),
    ("string without end", scene('"description": @"n'), "/description", "no JSON"),
    ("line feed in a string", scene('"description": @"a\nb"'), "/description", "no JSON"),
    ("unknown escape", scene('"description": @"\\q"'), "/description", "no JSON"),
    ("half of a surrogate pair", scene('"description": @"\\ud800"'), "/description", "no JSON"),
    ("comment without end", header('"gravity": [0, 0, 0]') + "\n @/* and so on", "", "comment"),
    ("comment with #", "@# a scene\n" + header('"gravity": [0, 0, 0]'), "", "no JSON", "#"),
    # UTF-8
    ("Latin-1 in a name", scene('"description": "caf').encode() + b'\xe9@"}', "/description", "UTF-8"),
    ("UTF-8 cut off", scene('"description": "caf').encode() + b'\xc3@', "/description", "UTF-8"),
    ("overlong UTF-8", scene('"description": "').encode() + b'@\xc0\x80"}', "/description", "UTF-8"),
    ("surrogate in UTF-8", scene('"description": "').encode() + b'\xed@\xa0\x80"}', "/description", "UTF-8"),
    ("NUL in a string", scene('"description": "').encode() + b'@\x00", "bodies": []}', "", "NUL byte"),
    ("byte order mark inside", b"{@\xef\xbb\xbf" + header("")[1:].encode(), "", "no JSON"),
    # Numbers that JSON does not have
    ("NaN", header('"gravity": [0, @NaN, 0]'), "/gravity/0", '"NaN"', "finite"),
    ("-Infinity", header('"gravity": [0, @-Infinity, 0]'), "/gravity/0", '"-Infinity"', "finite"),
    ("1e999", header('"gravity": [0, @1e999, 0]'), "/gravity/0", '"1e999"', "1.8e308"),
    ("million digits", header('"gravity": [0, @-%s, 0]' % ("9" * 999_999)), "/gravity/0", '"-999', "1.8e308"),
    ("hexadecimal number", header('"gravity": [0, @0x10, 0]'), "/gravity/1", "no JSON", '"0x10"'),
    ("octal number", header('"gravity": [0, @01, 0]'), "/gravity/1", "no JSON", '"01"'),
    ("number that starts with a point", header('"gravity": [0, @.5, 0]'), "/gravity/0", "no JSON", ".5"),
    ("number with a unit", header('"gravity": [0, @9.81m, 0]'), "/gravity/1", "no JSON", '"9.81m"'),
    ("number with a comma", body('"mass": 1,@5'), "/bodies/0/mass", "no JSON", "5"),
    # Sizes
    ("65 levels", header('"gravity": %s@[%s' % ("[" * 63, "]" * 64)), "", "deeper than 64 levels", "at most 64"),
    ("a hundred thousand brackets", "[" * 64 + "@" + "[" * 100_000, "", "deeper than 64 levels"),
    ("a million objects in one another", '{"a":' * 64 + "@" + '{"a":' * 1_000_000, "", "deeper than 64 levels"),
    ("key of a megabyte", header('@"%s": 1' % ("k" * 1_000_000)), "/%s..." % ("k" * 199), "unknown key", "allowed are schema"),
    ("a million keys of one object", header(", ".join('"k%d": 1' % i for i in range(1_000_000))), "", "an object of more than 10000 keys"),
    ("two million values for three", header('"gravity": @[%s0]' % ("0," * 1_999_999)), "/gravity", "2000000 elements", "3 elements"),
    ("more bodies than a million", body('"copies": @{"count": [1000, 1000, 2]}'), "/bodies/0/copies", "2000000", "1000000"),
    ("nine thousand keys that are none", header(", ".join('"k%d": 1' % i for i in range(9_000))), "", "unknown key", "and at least 950 more", 51),
    ("a million bodies that are none", scene('"bodies": [%s0]' % ("0," * 999_999)), "", "bodies[0] is the number 0", "and at least 950 more", 51),
    ("twenty million arrays", b"[" + b"[]," * 20_000_000 + b"[]]", "", "more than 4000000 values"),
    ("four million keys in many objects", b'{"bodies": [' + b",".join([b"{%s}" % b",".join(b'"%x":0' % i for i in range(9_000))] * 440) + b"]}", "", "unknown key", "and at least 950 more", 51),
    ("bodies with names of a megabyte", scene('"bodies": [%s]' % ", ".join('{"name": "%s%d", "shape": {"sphere": {}}}' % ("n" * 1_000_000, i) for i in range(20))), "", "at most 250 are allowed", 20),
    ("a million copies with a long name", scene('"bodies": [{"name": @"%s", "shape": {"sphere": {}}, "copies": {"count": [100, 100, 100]}}]' % ("n" * 10_000)), "/bodies/0/name", "10000 characters", "at most 250"),
    ("material with a long name", header('"materials": {"%s": @{}}' % ("m" * 300)), "/materials/%s..." % ("m" * 189), "300 characters", "at most 250"),
    ("faults by the hundred", body(", ".join('"k%d": 1' % i for i in range(100))), "", "and 50 more", 51),
    # Keys and references
    ("unknown key", header('@"gravty": [0, 0, 0]'), "/gravty", 'unknown key "gravty"', "allowed are", 'did you mean "gravity"?'),
    ("duplicate key", body('"mass": 1, @"mass": 2'), "/bodies/0/mass", "duplicate key", "the first is at"),
    ("key with an escape sequence", header('@"\\u001b[2J": 1'), r"/\x1b[2J", "unknown key", "\\x1b"),
    ("schema of another program", '{"schema": @"urdf", "name": "n", "duration": 1, "bodies": []}', "/schema", '"urdf"', '"cradle-scene/1"'),
    ("schema of the future", '{"schema": @"cradle-scene/2", "name": "n", "duration": 1, "bodies": []}', "/schema", '"cradle-scene/1"'),
    ("no bodies", '@{"schema": "cradle-scene/1", "name": "n", "duration": 1}', "", '"bodies" is missing'),
    ("material that is not there", body('"material": @"steal"')[:-1] + ', "materials": {"steel": {}}}', "/bodies/0/material", '"steal"', 'did you mean "steel"?'),
    ("bodies of one name", scene('"bodies": [{"name": "a", "shape": {"sphere": {}}}, {"name": @"a", "shape": {"sphere": {}}}]'), "/bodies/1/name", 'duplicate name "a"', "/bodies/0"),
    ("spring to a body that is not there", links('"springs": [{"bodyA": "a", "bodyB": @"c"}]'), "/springs/0/bodyB", 'no body "c"', 'did you mean "a"?'),
    ("rod from a body to itself", links('"rods": [{"bodyA": "a", "bodyB": @"a"}]'), "/rods/0/bodyB", "the same body"),
    ("rod between things that stand still", links('"rods": [@{"bodyA": "floor"}]'), "/rods/0", "neither end can move"),
    ("push on a body that is not there", links('"pushes": [{"body": @"c", "point": [0, 0, 0], "force": [1, 0, 0]}]'), "/pushes/0/body", 'no body "c"'),
    ("camera that follows nothing", links('"camera": {"follow": {"body": @"c"}}'), "/camera/follow/body", 'no body "c"'),
    ("joints in a ring that does not close", links('"ballJoints": [{"bodyA": "a", "bodyB": "b", "anchorA": [3, 0, 0], "anchorB": [0, -4, 0]}, @{"bodyA": "b", "bodyB": "a", "anchorB": [3, 4.1, 0]}]'), "/ballJoints/1", "0.1 m apart", "meet"),
    ("pair of three materials", header('"materials": {"m": {}}, "pairs": [{"materials": @["m", "m", "m"]}]'), "/pairs/0/materials", "3 elements", "2 elements"),
    # Types and units
    ("number in quotes", body('"mass": @"1"'), "/bodies/0/mass", 'the string "1"', "a number"),
    ("number with its unit in quotes", body('"mass": @"5 kg"'), "/bodies/0/mass", '"5 kg"', "a number", "(kg)"),
    ("degrees in a vector's place", body('"orientation": @[0, 0, 30]'), "/bodies/0/orientation", "an array", "an object"),
    ("angle in radians", body('"orientation": {"axis": [0, 0, 1], @"angle": 0.5}'), "/bodies/0/orientation/angle", 'unknown key "angle"', 'did you mean "angleDegrees"?'),
    ("vector of two", body('"position": @[0, 1]'), "/bodies/0/position", "2 elements", "3 elements"),
    ("vector with a word", body('"position": [0, @"up", 0]'), "/bodies/0/position/1", '"up"', "a number", "(m)"),
    ("true for a mass", body('"mass": @true'), "/bodies/0/mass", "true", "a number"),
    ("bodies by name", scene('"bodies": @{"a": {}}'), "/bodies", "an object", "an array"),
    ("half a pixel", header('"output": {"width": @10.5}'), "/output/width", "10.5", "whole number"),
    ("colour by name", header('"materials": {"m": {"baseColor": @"red"}}'), "/materials/m/baseColor", '"red"', "#rrggbb"),
    # Ranges
    ("negative mass", body('"mass": @-1'), "/bodies/0/mass", "-1", "> 0 (kg)"),
    ("mass of nothing", body('"mass": @0'), "/bodies/0/mass", "0", "> 0 (kg)"),
    ("mass beyond all stars", body('"mass": @1e300'), "/bodies/0/mass", "1e+300", "1e36"),
    ("mass that rounds to zero", body('"mass": @1e-999'), "/bodies/0/mass", "> 0 (kg)"),
    ("restitution above 1", header('"materials": {"m": {"restitution": @1.01}}'), "/materials/m/restitution", "1.01", "0..1"),
    ("negative friction", header('"materials": {"m": {"dynamicFriction": @-0.1}}'), "/materials/m/dynamicFriction", "-0.1", ">= 0"),
    ("static friction below dynamic", header('"materials": {"m": @{"staticFriction": 0.1, "dynamicFriction": 0.5}}'), "/materials/m", "0.1", "0.5"),
    ("duration zero", '{"schema": "cradle-scene/1", "name": "n", "duration": @0, "bodies": []}', "/duration", "0", "> 0 (s)"),
    ("duration beyond a billion seconds", '{"schema": "cradle-scene/1", "name": "n", "duration": @1e10, "bodies": []}', "/duration", "10000000000", "1e9"),
    ("more frames than a billion", '@{"schema": "cradle-scene/1", "name": "n", "duration": 1e9, "bodies": []}', "", "60000000000 frames", "1000000000"),
    ("more steps than allowed", header('"method": @{"name": "rk4", "timeStep": 1e-12}'), "/method", "1e+12 steps", "1e+10"),
    ("accuracy of an exact machine", header('"accuracy": @1e-16'), "/accuracy", "1e-16", "1e-12..0.01"),
    ("sizes of a picture", header('"output": {"width": @0, "height": 99999}'), "/output/width", "0", "1..16384", "/output/height", "99999", 2),
    ("playback at no speed", header('"output": {"playbackSpeed": @0}'), "/output/playbackSpeed", "0", "> 0"),
    ("quaternion that is none", body('"orientation": @{"w": 2, "x": 0, "y": 0, "z": 0}'), "/bodies/0/orientation", "length 2", "1 within 1e-6"),
    ("axis of no direction", body('"orientation": {"axis": @[0, 0, 0], "angleDegrees": 1}'), "/bodies/0/orientation/axis", "zero"),
    ("inertia of no body", body('"mass": 1, "inertiaTensor": @[[1, 0, 0], [0, 1, 0], [0, 0, 9]]'), "/bodies/0/inertiaTensor", "9", "sum"),
    ("field of view of half a turn", header('"camera": {"verticalFieldOfViewDegrees": @180}'), "/camera/verticalFieldOfViewDegrees", "180", "< 180"),
    ("camera at what it looks at", header('"camera": @{"position": [1, 1, 1], "target": [1, 1, 1]}'), "/camera", "target"),
    ("key frames that go back", header('"camera": {"keyFrames": [{"time": 1}, @{"time": 0}]}'), "/camera/keyFrames/1", "0", "1", "not after"),
    # Shapes and places
    ("two shapes", shape('{"sphere": {}, "box": @{}}'), "/bodies/0/shape/box", "both sphere and box"),
    ("ball without a radius", shape('{"sphere": {"radius": @0}}'), "/bodies/0/shape/sphere/radius", "0", "> 0 (m)"),
    ("plane that falls", scene('"bodies": [@{"name": "a", "shape": {"plane": {}}}]'), "/bodies/0", "plane", "static"),
    ("hull of a ball", body('"collision": @"hull"'), "/bodies/0/collision", '"auto"', '"none"'),
    ("two thousand cylinders in one another", scene('"bodies": [{"name": "a", "shape": {"cylinder": {"radius": 1, "length": 2}}, '
     '"copies": {"count": [2000, 1, 1], "spacing": [1e-4, 0, 0]}}]'), "", '"a_0" and "a_1" overlap', "at least 950 more", 51),
    ("three hundred thousand joints of two bodies", links('"ballJoints": [%s]' % ", ".join(
     300_000 * ['{"bodyA": "a", "bodyB": "b", "anchorA": [3, 4, 0], "anchorB": [0, 0, 0]}'])), "", '"a" is held in more than 1000', "at most 1000", 2),
    ("bodies in one another", spheres((0, 0, 0), (0.5, 0, 0)), "/bodies/1", '"s0" and "s1" overlap by 1.5 m'),
    ("a thousand bodies in one another", body('"copies": {"count": [10, 10, 10], "spacing": [0.1, 0.1, 0.1]}').replace('[{"name"', '[@{"name"'), "/bodies/0",
     '"a_0" and "a_1" overlap', "more", 51),
    ("body in the ground", links('"gravity": [0, 0, 0]').replace("[0, -9, 0]", "[0, 0.5, 0]"), "", '"a"', "deep in the plane", '"floor"'),
    ("rope shorter than its ends are apart", links('"ropes": [{"bodyA": "a", "bodyB": "b", "anchorB": [0, 0, 0], "maxLength": @4}]'), "/ropes/0/maxLength", "4", "5 m apart"),
    ("rod of another length", links('"rods": [{"bodyA": "a", "bodyB": "b", "anchorB": [0, 0, 0], "length": @4}]'), "/rods/0/length", "4", "5 m apart"),
    ("more rods than can hold a body", links('"rods": [%s@{"bodyA": "a"}]' % (1000 * '{"bodyA": "a"}, ')), "/rods/1000", '"a"', "1000", "rod"),
    ("more rods and joints than can hold a body", links('"rods": [%s{"bodyA": "a"}], "hinges": [@{"bodyA": "a", "anchorB": [0, 0, 0]}]' % (995 * '{"bodyA": "a"}, ')), "/hinges/0",
     '"a"', "1000", "hinge 5"),
    ("stiffness below zero", links('"springs": [{"bodyA": "a", "stiffness": @-1}]'), "/springs/0/stiffness", "-1", ">= 0 (N/m)"),
    ("vertex of a ball", links('"springs": [{"bodyA": "a", "anchorA": @{"vertex": 0}}]'), "/springs/0/anchorA", "mesh"),
    ("more lights than can be drawn", header('"lights": @[%s]' % ", ".join(10_000 * ['{"direction": [0, -1, 0]}'])), "/lights", "10000", "at most"),
    ("camera inside a ball", links('"camera": @{"position": [0, 0, 0], "target": [9, 0, 0]}'), "/camera", 'inside body "a"', "outside all bodies"),
):
    add_scene(*row)


# Places: files that are none, or others than those that a command takes.

def link(target):
    def make(path):
        os.makedirs(os.path.dirname(path), exist_ok=True)
        os.symlink(target, path)
    return make


def below(make):
    def make_with_folder(path):
        os.makedirs(os.path.dirname(path), exist_ok=True)
        make(path)
    return make_with_folder


def sparse(size):
    def make(path):
        write(path, "")
        os.truncate(path, size)
    return make


def add(kind, name, files, command, code, begins, *words):
    lines, words = (words[-1], words[:-1]) if words and isinstance(words[-1], int) else (1, words)
    CASES.append(Case(kind + ": " + name, files, command, code, begins, words, lines))


for row in (
    ("no scene", {}, "simulate none.json -o old.sqlite", 3, "none.json: ", "no such file"),
    ("scene without a name", {}, "check ''", 3, '""', "no such file", "path"),
    ("scene with too long a name", {}, "check %s.json" % ("a" * 300), 3, "aaa", "File name too long"),
    ("scene below a file", {}, "plan good.json/s.json", 3, "good.json/s.json: ", "no such file"),
    ("scene that is a folder", {}, "render frames/ -o new", 3, "frames/: ", "is a directory", "name a file in it"),
    ("scene that is a pipe", {"s.json": os.mkfifo}, "video s.json -o old.mp4", 3, "s.json: ", "not a regular file"),
    ("scene without end", {}, "study /dev/zero -o new", 3, "/dev/zero: ", "not a regular file"),
    ("scene that links to nothing", {"s.json": link("none.json")}, "check s.json", 3, "s.json: ", "no such file"),
    ("scene that links to itself", {"s.json": link("s.json")}, "check s.json", 3, "s.json: ", "symbolic links"),
    ("scene of 65 MB", {"s.json": sparse(65_000_000)}, "check s.json", 3, "s.json: ", "65.0 MB", "64"),
    ("trajectory for a scene", {}, "simulate good.sqlite -o new.sqlite", 3, "good.sqlite: ", "trajectory", "not a scene"),
    ("trajectory to check", {}, "check good.sqlite", 3, "good.sqlite: ", "trajectory", "not a scene"),
    ("mesh for a scene", {}, "check box.3ds", 3, "box.3ds:", "NUL byte", "UTF-8 text"),
    ("picture for a scene", {}, "render frames/frame_000000.png -o new", 3, "frames/frame_000000.png:", "NUL byte", "UTF-8 text"),
    ("second of two scenes", {}, "study good.json none.json -o new", 3, "none.json: ", "no such file"),
    ("scene for a trajectory", {}, "export good.json -o old.csv", 2, "good.json: ", "not a trajectory"),
    ("mesh for a trajectory", {}, "export box.3ds -o old.glb", 2, "box.3ds: ", "not a trajectory"),
    ("trajectory that is a folder", {}, "export frames -o new.csv", 2, "frames: ", "directory"),
    ("trajectory that is a pipe", {"t.sqlite": os.mkfifo}, "export t.sqlite -o new.csv", 2, "t.sqlite: ", "not a regular file"),
    ("trajectory that is missing", {}, "export none.sqlite -o new.csv", 2, "none.sqlite: ", "no such file"),
    ("trajectory that links to itself", {"t.sqlite": link("t.sqlite")}, "compare good.sqlite t.sqlite", 2, "t.sqlite: ", "symbolic links"),
    ("trajectory beside a scene", {}, "compare good.sqlite good.json", 2, "good.json: ", "not a trajectory"),
    ("nothing to compare with", {}, "compare good.sqlite none.sqlite", 2, "none.sqlite: ", "no such file"),
    ("nothing to compare", {}, "compare '' ''", 2, '""', "no such file"),
    ("folder beside a file", {}, "compare frames frames/frame_000000.png", 2, "frames/frame_000000.png: ", "folder"),
    ("folder without pictures", {}, "compare empty frames", 2, "empty: ", "no PNG files"),
    ("pictures in a file", {}, "encode good.json -o old.mp4", 2, "good.json: ", "irectory"),
    ("pictures in no folder", {}, "encode none -o old.mp4", 2, "none: ", "No such file or directory"),
    ("no pictures to encode", {}, "encode others -o old.mp4", 2, "others: ", "frame_000000.png"),
    ("device for a picture", {}, "compare /dev/zero frames/frame_000000.png", 2, "/dev/zero: ", "not a regular file"),
    ("pipe for a picture", {"p.png": os.mkfifo}, "compare frames/frame_000000.png p.png", 2, "p.png: ", "not a regular file"),
):
    add("place", *row)


# Meshes, by themselves and as that of a scene, in turn.

MESH_COMMANDS = itertools.cycle(
    ("inspect %s", "check m.json", "inspect %s --json", "simulate m.json -o old.sqlite", "inspect %s --scale 0.01",
     "render m.json -o frames --overwrite", "plan m.json", "video m.json -o old.mp4", "study m.json -o new"))
TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
TETRAHEDRON = TRIANGLE + "v 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"


def box():
    return read(os.path.join(SOURCE, "assets", "box.3ds"))


def changed(data, place, new):
    return data[:place] + new + data[place + len(new):]


def at_chunk(identifier, offset, new):
    """The box with other bytes at a chunk of a 3ds file, its header (6 bytes) included."""
    return changed(box(), box().index(struct.pack("<H", identifier), 6) + offset, new)


def chunk(identifier, data):
    return struct.pack("<HI", identifier, len(data) + 6) + data


def stl(count, *triangles):
    return bytes(80) + struct.pack("<I", count) + b"".join(struct.pack("<12f", 0, 0, 1, *t) + b"\0\0" for t in triangles)


def ply(vertices, faces, lines, form="ascii", more=""):
    return ("ply\nformat %s 1.0\nelement vertex %s\nproperty float x\nproperty float y\nproperty float z\n%selement face %s\n"
            "property list uchar int vertex_indices\nend_header\n%s" % (form, vertices, more, faces, lines))


def gltf(**changes):
    """A triangle."""
    points = base64.b64encode(struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)).decode()
    document = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"name": "t", "mesh": 0}],
                "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
                "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
                "bufferViews": [{"buffer": 0, "byteLength": 36}],
                "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64," + points}]}
    document.update(changes)
    return json.dumps(document)


def glb(text, magic=b"glTF", version=2, length=None):
    data = text.encode() + b" " * (-len(text) % 4)
    body = struct.pack("<I4s", len(data), b"JSON") + data
    return struct.pack("<4sII", magic, version, 12 + len(body) if length is None else length) + body


def dae(count=9, indices="0 1 2", numbers="0 0 0 1 0 0 0 1 0", head=""):
    return ('<?xml version="1.0"?>%s<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><library_geometries>'
            '<geometry id="g"><mesh><source id="p"><float_array id="a" count="%s">%s</float_array><technique_common>'
            '<accessor source="#a" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>'
            '<param name="Z" type="float"/></accessor></technique_common></source><vertices id="v"><input semantic="POSITION" '
            'source="#p"/></vertices><triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>%s</p></triangles>'
            '</mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="s"><node><instance_geometry url="#g"/>'
            '</node></visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>'
            % (head, count, numbers, indices))


def bomb():
    entities = "".join('<!ENTITY e%d "%s">' % (i + 1, ("&e%d;" % i) * 10) for i in range(12))
    return dae(head='<!DOCTYPE x [<!ENTITY e0 "0 ">%s]>' % entities, numbers="&e12;")


def add_mesh(name, content, *words, scene=False, code=4):
    """`name` with an ending; `scene`: what only a body needs."""
    mesh = "m" + os.path.splitext(name)[1]
    document = '{"schema": "cradle-scene/1", "name": "m", "duration": 1, "bodies": [{"name": "b", "shape": {"mesh": "%s"}}]}' % mesh
    command = next(MESH_COMMANDS)
    while scene and command.startswith("inspect"):
        command = next(MESH_COMMANDS)
    pointer = "/bodies/0/shape/mesh: "
    begins = re.escape(mesh) + ": " if "%s" in command else r"m\.json:1:\d+ " + pointer
    CASES.append(Case("mesh: " + name, {mesh: content, "m.json": document}, command.replace("%s", mesh), code, begins, words))


for row in (
    # 3ds
    ("empty.3ds", "", "empty"),
    ("two bytes.3ds", b"MM", "too short"),
    ("text.3ds", "hello", "too short"),
    ("all zeros.3ds", bytes(999), "does not start like a 3ds file"),
    ("cut in a header.3ds", lambda path: write(path, box()[:9]), "damaged"),
    ("cut in the middle.3ds", lambda path: write(path, box()[:200]), "only", "left", "damaged"),
    ("last byte missing.3ds", lambda path: write(path, box()[:-1]), "only", "left", "damaged"),
    ("chunk of no size.3ds", lambda path: write(path, at_chunk(0x4110, 2, bytes(4))), "4110", "impossible size 0", "damaged"),
    ("chunk larger than the file.3ds", lambda path: write(path, at_chunk(0x4110, 2, b"\xff\xff\xff\x7f")), "4110", "2147483647 bytes", "left"),
    ("no vertices for its faces.3ds", lambda path: write(path, at_chunk(0x4110, 6, bytes(2))), "names vertex", "only 0"),
    ("vertices without end.3ds", lambda path: write(path, at_chunk(0x4110, 6, b"\xff\xff")), "ends too early", "damaged"),
    ("vertex that is no number.3ds", lambda path: write(path, at_chunk(0x4110, 8, struct.pack("<f", float("nan")))), "not finite", "damaged"),
    ("vertex at infinity.3ds", lambda path: write(path, at_chunk(0x4110, 8, struct.pack("<f", float("inf")))), "not finite", "damaged"),
    ("face of vertices that are not there.3ds", lambda path: write(path, at_chunk(0x4120, 8, b"\xff\xff")), "names vertex 65535", "damaged"),
    ("no objects.3ds", chunk(0x4D4D, chunk(0x3D3D, b"")), "no mesh"),
    ("no triangles.3ds", chunk(0x4D4D, chunk(0x3D3D, chunk(0x4000, b"o\0" + chunk(0x4100, chunk(0x4110, b"\0\0") + chunk(0x4120, b"\0\0"))))), "no "),
    ("name without end.3ds", chunk(0x4D4D, chunk(0x3D3D, chunk(0x4000, b"o" * 99))), "name does not end"),
    # obj
    ("empty.obj", "", "empty"),
    ("vertices alone.obj", TRIANGLE, "no "),
    ("index of nothing.obj", TRIANGLE + "f 1 2 0\n", "cannot be read as a mesh", "check the file"),
    ("index too large.obj", TRIANGLE + "f 1 2 4\n", "m.obj"),
    ("index too far back.obj", TRIANGLE + "f -1 -2 -4\n", "m.obj"),
    ("index beyond 32 bits.obj", TRIANGLE + "f 1 2 99999999999\n", "m.obj"),
    ("vertex that is no number.obj", TRIANGLE.replace("v 1", "v nan") + "f 1 2 3\n", "not finite"),
    ("vertex beyond floats.obj", TRIANGLE.replace("v 1", "v 1e300") + "f 1 2 3\n", "m.obj"),
    ("points and lines.obj", TRIANGLE + "p 1\nl 1 2\n", "no triangles"),
    ("triangles of no area.obj", "v 0 0 0\nf 1 1 1\nf 1 1 1\n", "no triangles"),
    ("polygon of a million corners.obj", TRIANGLE + "f" + " 1 2 3" * 333_333 + "\n", "takes longer than 4 s"),
    ("binary.obj", bytes(range(256)) * 99, "m.obj"),
    # stl
    ("header alone.stl", bytes(84), "m.stl"),
    ("promised triangles.stl", stl(4_000_000_000), "m.stl"),
    ("cut.stl", stl(4, (0, 0, 0, 1, 0, 0, 0, 1, 0))[:100], "m.stl"),
    ("vertex that is no number.stl", stl(1, (0, 0, 0, float("nan"), 0, 0, 0, 1, 0)), "not finite"),
    ("no facets.stl", "solid x\nendsolid x\n", "no "),
    ("facet of two corners.stl", "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\nendfacet\nendsolid x\n", "m.stl"),
    ("words for numbers.stl", "solid x\nfacet normal 0 0 1\nouter loop\nvertex one two three\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid x\n", "m.stl"),
    # ply
    ("header without end.ply", "ply\nformat ascii 1.0\nelement vertex 3\n", "takes longer than 3 s"),
    ("index too large.ply", ply(3, 1, "0 0 0\n1 0 0\n0 1 0\n3 0 1 9\n"), "m.ply"),
    ("negative index.ply", ply(3, 1, "0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n"), "m.ply"),
    ("promised vertices.ply", ply(4_000_000_000, 1, "0 0 0\n"), "memory"),
    ("promised faces.ply", ply(3, 1_000_000_000, "", "binary_little_endian") + "x" * 99, "memory"),
    ("negative number of vertices.ply", ply(-1, 1, "3 0 1 2\n"), "m.ply"),
    ("no faces.ply", ply(3, 0, "0 0 0\n1 0 0\n0 1 0\n"), "no "),
    ("number that is none.ply", ply(3, 1, "nan 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"), "not finite"),
    # gltf and glb
    ("no JSON.gltf", "glTF", "cannot be read as a mesh"),
    ("cut.gltf", gltf()[:300], "cannot be read as a mesh"),
    ("node that is its own child.gltf", gltf(nodes=[{"mesh": 0, "children": [0]}]), "m.gltf"),
    ("nodes in a ring.gltf", gltf(nodes=[{"mesh": 0, "children": [1]}, {"children": [0]}]), "m.gltf"),
    ("node that is not there.gltf", gltf(scenes=[{"nodes": [7]}]), "m.gltf"),
    ("mesh that is not there.gltf", gltf(nodes=[{"mesh": 7}]), "m.gltf"),
    ("more vertices than bytes.gltf", gltf(accessors=[{"bufferView": 0, "componentType": 5126, "count": 1_000_000_000, "type": "VEC3"}]), "m.gltf"),
    ("view beyond its buffer.gltf", gltf(bufferViews=[{"buffer": 0, "byteOffset": 30, "byteLength": 36}]), "m.gltf"),
    ("buffer that is missing.gltf", gltf(buffers=[{"byteLength": 36, "uri": "none.bin"}]), "none.bin"),
    ("buffer that is no base64.gltf", gltf(buffers=[{"byteLength": 36, "uri": "data:application/octet-stream;base64,?"}]), "m.gltf"),
    ("brackets without end.gltf", "[" * 1_000_000, "m.gltf"),
    ("other magic.glb", glb(gltf(), magic=b"glTX"), "cannot be read as a mesh"),
    ("version 3.glb", glb(gltf(), version=3), "cannot be read as a mesh"),
    ("cut.glb", glb(gltf())[:200], "cannot be read as a mesh"),
    ("length beyond the file.glb", glb(gltf(), length=1 << 31), "cannot be read as a mesh"),
    # dae, off, and what is none of these
    ("cut.dae", dae()[:500], "cannot be read as a mesh"),
    ("entities that double.dae", bomb(), "m.dae"),
    ("index too large.dae", dae(indices="0 1 9"), "m.dae"),
    ("promised numbers.dae", dae(count=4_000_000_000), "memory"),
    ("promised vertices.off", "OFF\n1000000000 1 0\n0 0 0\n", "memory"),
    ("index too large.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 9\n", "3 edges open"),  # assimp reads vertex 2
    ("text.txt", "hello\n", "cannot be read as a mesh", "3ds", "obj"),
    ("picture.png", b"\x89PNG\r\n\x1a\n" + bytes(99), "cannot be read as a mesh"),
    ("other format than its ending says.stl", lambda path: write(path, box()), "cannot be read as a mesh"),
):
    add_mesh(*row)

for row in (
    # What only a body needs
    ("one triangle that moves.obj", TRIANGLE + "f 1 2 3\n", "no solid", "3 edges open", '"motion": "static"'),
    ("face missing.obj", TETRAHEDRON.replace("f 3 1 4\n", ""), "no solid", "3 edges open", "mend the mesh"),
    ("two sides of a sheet.obj", TRIANGLE + "f 1 2 3\nf 1 3 2\n", "no solid", "flat", "volume"),
    ("three faces at an edge.obj", TETRAHEDRON + "v 1 1 1\nf 1 2 5\n", "no solid", "more than two triangles"),
):
    add_mesh(*row, scene=True)
for row in (
    ("larger than allowed.obj", TETRAHEDRON.replace("1", "1e20", 1), "allowed are 1e-09..1e+09 m", 'change "scale"'),
    ("smaller than allowed.obj", re.sub(r"v (\S+) (\S+) (\S+)", r"v \1e-20 \2e-20 \3e-20", TETRAHEDRON), "allowed are 1e-09..1e+09 m", 'change "scale"'),
):
    add_mesh(*row, scene=True, code=3)

for row in (
    ("that is not there", {}, "inspect none.obj", "none.obj: ", "no such file"),
    ("that is a folder", {}, "inspect frames", "frames: ", "is a directory"),
    ("that is a pipe", {"m.obj": os.mkfifo}, "inspect m.obj", "m.obj: ", "not a regular file"),
    ("without end", {}, "inspect /dev/zero", "/dev/zero: ", "not a regular file"),
    ("that links to nothing", {"m.stl": link("none.stl")}, "inspect m.stl", "m.stl: ", "no such file"),
    ("that links to itself", {"m.stl": link("m.stl")}, "inspect m.stl", "m.stl: ", "symbolic links"),
    ("of 300 MB", {"m.stl": sparse(300_000_000)}, "inspect m.stl", "m.stl: ", "300.0 MB", "256 MB"),
    ("without a name", {}, "inspect ''", '""', "no such file"),
    ("with a library outside of its folder", {"sub/m.obj": "mtllib ../secret.mtl\n" + TETRAHEDRON, "secret.mtl": "newmtl secret\n"},
     "inspect sub/m.obj", "sub/m.obj: ", "not below its folder"),
    ("that is a trajectory", {}, "inspect good.sqlite", "good.sqlite: ", "cannot be read as a mesh"),
):
    add("mesh", row[0], *row[1:3], 4, *row[3:])
for name, mesh, more, code, words in (
    ("object that is not there", "box.3ds", ', "object": "Sphere"', 4, ('"Sphere"', "it has ")),
    ("mesh of a scene that is not there", "none.3ds", "", 4, ("none.3ds: no such file",)),
    ("mesh of a scene with NUL in its name", r"none.3ds\u0000", "", 4, ("none.3ds\\x00: no such file",)),
    ("mesh of a scene with a line feed in its name", r"none\n.3ds", "", 4, ("none\\x0a.3ds: no such file",)),
    ("mesh of a scene that is the scene", "m.json", "", 4, ("m.json", "cannot be read as a mesh")),
    ("box that is to be a ball", "box.3ds", '}, "collision": "sphere"', 3, ("no sphere", '"auto"')),
    ("vertex that the mesh has not", "box.3ds", '}}], "springs": [{"bodyA": "b", "anchorA": {"vertex": 99}', 3, ("99", "0..7")),
):
    document = '{"schema": "cradle-scene/1", "name": "m", "duration": 1, "bodies": [{"name": "b", "shape": {"mesh": "%s"%s' % (mesh, more)
    document += "}]}" if "}" in more else "}}]}"
    add("mesh", name, {"m.json": document}, "check m.json", code, r"m\.json:1:\d+ /", *words)
add("mesh", "below no asset root", {"sub/s.json": shape('{"mesh": "../box.3ds"}')}, "check sub/s.json --asset-root sub", 4,
    r"sub/s\.json:1:\d+ /bodies/0/shape/mesh: ", "not below")


# Trajectories: a good one that is changed. What is wrong with a scene or a model matters to those who draw, what is wrong
# with a state to all; DRAW and READ name commands of each kind in turn.

DRAW = itertools.cycle(("render t.sqlite -o frames --overwrite", "export t.sqlite -o old.glb", "video t.sqlite -o old.mp4"))
READ = itertools.cycle(("export t.sqlite -o old.csv", "render t.sqlite -o new", "compare good.sqlite t.sqlite", "video t.sqlite -o new.mp4",
                        "compare t.sqlite good.sqlite", "export t.sqlite -o new.glb"))
MAGIC = b"SQLite format 3\0"


def text_hash(text):
    """FNV-1a, 64 bits."""
    value = 0xcbf29ce484222325
    for byte in text.encode():
        value = (value ^ byte) * 0x100000001b3 % (1 << 64)
    return "%016x" % value


def trajectory(*statements):
    """The good one, with statements run on it."""
    def make(path):
        shutil.copy(os.path.join(os.path.dirname(path), "good.sqlite"), path)
        with contextlib.closing(sqlite3.connect(path, isolation_level=None)) as database:
            for statement in statements:
                database.execute(*statement) if isinstance(statement, tuple) else database.execute(statement)
    return make


def trajectory_of(text):
    """The good one with another scene, and the hash of that."""
    return trajectory(("UPDATE meta SET value = ? WHERE key = 'scene'", (text,)),
                      ("UPDATE meta SET value = ? WHERE key = 'sceneHash'", (text_hash(text),)))


def trajectory_with(**changes):
    """The good one with other members of its bodies, by name of the body."""
    scene = good_scene()
    for body in scene["bodies"]:
        body.update(changes.get(body["name"], {}))
    return trajectory_of(json.dumps(scene))


def trajectory_bytes(change):
    """The good one with other bytes."""
    return lambda path: write(path, change(read(os.path.join(os.path.dirname(path), "good.sqlite"))))


def other_database(path):
    with contextlib.closing(sqlite3.connect(path, isolation_level=None)) as database:
        database.execute("CREATE TABLE notes (text)")


def state(change, frame=3, body=0):
    return trajectory("UPDATE state SET %s WHERE frame = %d AND body = %d" % (change, frame, body))


def add_trajectory(command, name, make, *words):
    add("trajectory", name, {"t.sqlite": make}, command, 2, r"t\.sqlite: ", *words)


for row in (
    # Files
    ("empty", "", "not a trajectory"),
    ("magic alone", MAGIC, "not a trajectory"),
    ("magic before 1 MB of chance", MAGIC + random.Random(1).randbytes(1_000_000), "not a trajectory", "damaged"),
    ("header cut off", trajectory_bytes(lambda data: data[:99]), "not a trajectory"),
    ("header and nothing else", trajectory_bytes(lambda data: data[:100]), "damaged"),
    ("half of it", trajectory_bytes(lambda data: data[:len(data) // 2]), "damaged"),
    ("last page missing", trajectory_bytes(lambda data: data[:-4096]), "damaged"),
    ("page of other bytes", trajectory_bytes(lambda data: changed(data, 4096, bytes([0xA5]) * 4096)), "damaged"),
    ("page size of 3", trajectory_bytes(lambda data: changed(data, 16, b"\0\3")), "damaged"),
    ("database of another program", other_database, "not a trajectory of cradle"),
    ("other application", trajectory("PRAGMA application_id = 1"), "not a trajectory of cradle"),
    ("tables of the future", trajectory("PRAGMA user_version = 2"), "version 2", "reads version 1"),
    ("log beside it", trajectory("PRAGMA journal_mode = WAL"), "log beside it", "journal_mode = DELETE"),
    # Tables
    ("no table of states", trajectory("DROP TABLE state"), "not a trajectory of cradle"),
    ("no column of times", trajectory("ALTER TABLE frame DROP COLUMN time"), "damaged", "no such column: time"),
    ("view in a table's place", trajectory("ALTER TABLE energy RENAME TO e", "CREATE VIEW energy AS SELECT * FROM e"), "not a trajectory"),
    ("column that is computed", trajectory("ALTER TABLE body ADD COLUMN m AS (mass / 0)"), "damaged", "computes its columns"),
    ("virtual table", trajectory("DROP TABLE event", "CREATE VIRTUAL TABLE event USING fts5(time, kind, a, b, x, y, z, nx, ny, nz, impulse)"),
     "damaged", "computes its columns"),
    ("no version in meta", trajectory("DELETE FROM meta WHERE key = 'version'"), "damaged", "meta has no version"),
    ("scene that is no longer that of its hash", trajectory("UPDATE meta SET value = replace(value, '9.81', '9.82') || ' ' WHERE key = 'scene'"),
     "damaged", "sceneHash"),
    # Frames
    ("no frames", trajectory("DELETE FROM frame"), "damaged", "frames are missing"),
    ("frame that is missing", trajectory("DELETE FROM frame WHERE id = 3"), "damaged", "frame 3 is missing"),
    ("frames that go back in time", trajectory("UPDATE frame SET time = 0.0 WHERE id = 3"), "damaged", "order of time"),
    ("time that is no number", trajectory("UPDATE frame SET time = 'noon' WHERE id = 3"), "damaged", "time", "a number"),
    ("time without end", trajectory("UPDATE frame SET time = 9e999 WHERE id = 6"), "damaged", "time", "not finite"),
    # Bodies
    ("body that is missing", trajectory("DELETE FROM body WHERE id = 1"), "damaged", "a body is missing"),
    ("body without a name", trajectory("UPDATE body SET name = NULL WHERE id = 0"), "damaged", "name", "text"),
    ("body that is neither", trajectory("UPDATE body SET motion = 'floating' WHERE id = 0"), "damaged", "neither dynamic nor static"),
    ("body of no mass", trajectory("UPDATE body SET mass = 0.0 WHERE id = 0"), "damaged", '"ball"', "not above 0"),
    ("body of negative inertia", trajectory("UPDATE body SET iyy = -1.0 WHERE id = 1"), "damaged", '"box"', "not above 0"),
    ("body of infinite mass", trajectory("UPDATE body SET mass = 9e999 WHERE id = 0"), "damaged", "mass", "not finite"),
    ("body of the mass of many universes", trajectory("UPDATE body SET mass = 1e308 WHERE id = 0"), "damaged", "mass", "below 1e+100"),
    ("frame after all time", trajectory("UPDATE frame SET time = 2e10 WHERE id = 6"), "damaged", "frame 6", "later"),
    ("body of a mesh that is not there", trajectory("UPDATE body SET mesh = 7 WHERE id = 1"), "damaged", "mesh that is not there"),
    # Meshes
    ("triangle of vertices that are not there", trajectory("UPDATE mesh SET triangles = x'000000000100000063000000'"), "damaged", "vertices that it does not have"),
    ("vertices that end in mid-number", trajectory("UPDATE mesh SET vertices = x'0000'"), "damaged", "mid-element"),
    ("fewer normals than vertices", trajectory("UPDATE mesh SET normals = x'000000000000000000000000'"), "damaged", "one normal a vertex"),
    ("normal as long as floats go", trajectory("UPDATE mesh SET normals = CAST(x'0000967e' || substr(normals, 5) AS BLOB)"), "damaged", "normals of no finite length"),
    ("vertices in words", trajectory("UPDATE mesh SET vertices = 'one two three'"), "damaged", "vertices", "a blob"),
    ("vertex at infinity", trajectory("UPDATE mesh SET vertices = x'000000000000f07f' || substr(vertices, 9)", "UPDATE mesh SET vertices = CAST(vertices AS BLOB)"),
     "damaged", "not finite"),
    ("colour by name", trajectory("""UPDATE mesh SET material = '[{"name": "m", "baseColor": "red", "firstTriangle": 0, "triangleCount": 12}]'"""), "damaged", "#rrggbb"),
    ("materials that end too early", trajectory("""UPDATE mesh SET material = '[{"name": "m", "baseColor": "#ffffff", "firstTriangle": 0, "triangleCount": 1}]'"""),
     "damaged", "do not cover its triangles"),
    ("materials that are no JSON", trajectory("UPDATE mesh SET material = '['"), "damaged", "JSON"),
    # States
    ("state that is missing", trajectory("DELETE FROM state WHERE frame = 3 AND body = 1"), "damaged", "states of frame 3"),
    ("state of a body that stands still", trajectory("UPDATE state SET body = 2 WHERE frame = 3 AND body = 1"), "damaged", "states of frame 3"),
    ("quaternion of no length", state("qw = 0.0, qx = 0.0, qy = 0.0, qz = 0.0"), "damaged", "frame 3", '"ball"', "no body can have"),
    ("quaternion twice as long", state("qw = 2.0"), "damaged", "frame 3", '"ball"', "no body can have"),
    ("place that is no number", state("px = NULL"), "damaged", "px", "a number"),
    ("place at infinity", state("py = 9e999"), "damaged", "py", "not finite"),
    ("place beyond all stars", state("pz = -1e31", body=1), "damaged", "frame 3", '"box"', "no body can have"),
):
    add_trajectory(next(READ), *row)

for row in (
    # Scenes, which those who draw need, and the bodies that belong to them
    ("scene that is no JSON", trajectory_of("hello"), "scene", "no JSON"),
    ("scene that is empty", trajectory_of(""), "scene", "ends too early"),
    ("scene with a fault", trajectory_of('{"schema": "cradle-scene/1", "name": "n", "duration": -1, "bodies": []}'), "scene", "/duration", "-1"),
    ("scene with many faults", trajectory_of(body(", ".join('"k%d": 1' % i for i in range(100)))), "scene", "unknown key"),
    ("scene of no bodies", trajectory_of(header('"gravity": [0, 0, 0]')), "damaged", "bodies are not those of its scene"),
    ("scene with a mesh that it has not", trajectory_with(box={"shape": {"mesh": "/etc/passwd"}}), "scene", "/etc/passwd", "not in the trajectory"),
    ("scene of bodies of other names", trajectory_with(ball={"name": "bull"}), "damaged", "bodies are not those of its scene"),
    ("scene in which a body stands still", trajectory_with(box={"motion": "static"}), "damaged", "bodies are not those of its scene"),
    ("scene in which a model is a ball", trajectory_with(box={"shape": {"sphere": {}}}), "damaged", "bodies are not those of its scene"),
    ("scene of a thousand bodies", trajectory_with(ball={"copies": {"count": [10, 10, 10]}}), "damaged", "bodies are not those of its scene"),
    ("scene with a rod to nothing", trajectory_of(links('"rods": [{"bodyA": "none"}]')), "scene", 'no body "none"'),
    ("event of a body that is not there", trajectory("INSERT INTO event SELECT 0.0, 'impact', 9, NULL, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0"), "damaged", "event", "not there"),
):
    add_trajectory(next(DRAW), *row)

for row in (
    ("energy that is missing", "export t.sqlite -o old.csv", trajectory("DELETE FROM energy WHERE frame = 3"), "damaged", "energies of frame 3"),
    ("energy beyond all", "export t.sqlite -o old.csv", trajectory("UPDATE energy SET kinetic = 1e307 WHERE frame = 3"), "damaged", "kinetic", "below 1e+100"),
    ("event of unknown kind", "render t.sqlite -o new --overlay contacts", trajectory("INSERT INTO event SELECT 0.0, 'kiss', 0, 1, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0"), "damaged", '"kiss"'),
    ("states that are not those of the hash", "compare good.sqlite t.sqlite", state("px = px + 1.0"), "stateHash"),
    ("hash that is not that of the states", "compare t.sqlite good.sqlite", trajectory("UPDATE meta SET value = '0' WHERE key = 'stateHash'"), "stateHash"),
):
    name, command, *rest = row
    add_trajectory(command, name, *rest)


# Pictures, in a folder "p" as frames of a film, and beside a good one.

def part_of_png(kind, data, checksum=None):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data) if checksum is None else checksum)


GREY = b"\0" + bytes([128]) * 96  # a row of 32 pixels


def png(width=32, height=32, depth=8, color=2, interlaced=0, rows=None, packed=None, more=b"", checksum=None, end=True):
    """A grey picture, unless other bytes are given."""
    rows = rows if rows is not None else (b"\0" + bytes([128]) * (3 * width)) * height
    return (b"\x89PNG\r\n\x1a\n" + part_of_png(b"IHDR", struct.pack(">2I5B", width, height, depth, color, 0, 0, interlaced), checksum) +
            more + part_of_png(b"IDAT", zlib.compress(rows) if packed is None else packed) + (part_of_png(b"IEND", b"") if end else b""))


PICTURE_COMMANDS = itertools.cycle(("compare frames/frame_000000.png p/frame_000001.png", "encode p -o old.mp4",
                                    "compare p p", "encode p -o new.mp4", "compare p/frame_000001.png frames/frame_000000.png"))
def add_picture(command, name, content, *words):
    add("picture", name, {"p/frame_000000.png": png(), "p/frame_000001.png": content}, command, 2, r"p/frame_000001\.png: ", *words)


UNREADABLE = "is not a picture that can be read: "

for name, content, *words in (
    ("empty", b"", UNREADABLE),
    ("text", b"hello, I am a picture of something", UNREADABLE),
    ("other format", b"\xff\xd8\xff\xe0\0\x10JFIF\0" + bytes(99), UNREADABLE),
    ("line feeds changed on the way", png().replace(b"\r\n", b"\n", 1), UNREADABLE),
    ("cut in its header", png()[:20], UNREADABLE),
    ("checksum of the header", png(checksum=1), UNREADABLE, "CRC"),
    ("no pixels wide", png(0, 32), UNREADABLE, "IHDR"),
    ("larger than allowed", png(16385, 1), "16385x1", "1..16384"),
    ("two billion pixels wide", png(2 ** 31 - 1, 1, rows=b""), "2147483647x1", "1..16384"),
    ("bits that there are not", png(depth=7), UNREADABLE, "IHDR"),
    ("interlaced in an unknown way", png(interlaced=9), UNREADABLE, "IHDR"),
    ("palette missing", png(color=3, rows=b"\0" * (33 * 32)), UNREADABLE, "PLTE"),
):
    add_picture(next(PICTURE_COMMANDS), name, content, *words)
for name, content, command, *words in (
    ("cut in its rows", png()[:60], "compare p p", UNREADABLE),
    ("checksum of the rows", png().replace(struct.pack(">I", zlib.crc32(b"IDAT" + zlib.compress(GREY * 32))), b"abcd"), "encode p -o old.mp4", UNREADABLE, "CRC"),
    ("checksum of the pixels", png(packed=zlib.compress(GREY * 32)[:-1] + b"?"), "compare p p", UNREADABLE),
    ("pixels that are not packed", png(packed=bytes(999)), "encode p -o new.mp4", UNREADABLE),
    ("rows missing", png(rows=(b"\0" + bytes(96)) * 31), "compare p p", UNREADABLE),
    ("filter that there is not", png(rows=(b"\x09" + bytes(96)) * 32), "encode p -o new.mp4", UNREADABLE, "filter"),
    ("end missing", png(end=False), "compare frames/frame_000000.png p/frame_000001.png", UNREADABLE),
    ("16384 x 16384 of nothing", png(16384, 16384, rows=b""), "compare frames/frame_000000.png p/frame_000001.png", UNREADABLE),
    ("other size than the first", png(30, 32), "encode p -o old.mp4", "is 30x32 pixels", "32x32", "one size"),
):
    add_picture(command, name, content, *words)
for name, files, command, *words in (
    ("number missing", ("frame_000000.png", "frame_000002.png"), "encode p -o old.mp4", "frame_000001.png is missing", "frame_000002.png"),
    ("numbers of other lengths", ("frame_0.png", "frame_1.png"), "encode p -o new.mp4", "frame_000000.png"),
):
    add("picture", name, {"p/" + file: png() for file in files}, command, 2, "p: ", *words)
add("picture", "folder in its place", {"p/frame_000000.png/x": ""}, "encode p -o new.mp4", 2, r"p/frame_000000\.png: ", "director")


# Command lines

SECONDS = "allowed are numbers of seconds > 0"
SIMULATE, RENDER, COMPARE = "simulate good.json -o old.sqlite ", "render good.sqlite -o new ", "compare frames frames "

for row in (
    ("unknown command", "simulat good.json -o new.sqlite", "simulat: ", "is no command", "allowed are simulate, plan", 'did you mean "simulate"?'),
    ("command without a name", "''", '"": ', "is no command", "allowed are simulate, plan"),
    ("two commands", "check plan good.json", "good.json: ", "one name too many for check"),
    ("option for a command", "--duration 3", "--duration: ", "command"),
    ("unknown option", "plan good.json --duratoin 3", "--duratoin: ", "unknown option", 'did you mean "--duration"?'),
    ("option of another command", "check good.json --duration 3", "--duration: ", "unknown option"),
    ("two scenes", "check good.json good.json", "good.json: ", "one name too many for check"),
    ("no scene", "simulate -o new.sqlite", "scene is required"),
    ("nothing to compare with", "compare good.sqlite", "actual is required"),
    ("no output", "simulate good.json", "--output is required"),
    ("output without a name", "render good.sqlite -o", "--output: "),
    ("two outputs", "export good.sqlite -o old.csv -o new.csv", "--output: "),
    ("duration in words", SIMULATE + "--duration x", "--duration: ", '"x"', "number"),
    ("duration of two lines", SIMULATE + "--duration 'x\ny'", "--duration: ", 'x\\x0ay', "number"),
    ("duration with a unit", SIMULATE + "--duration 3s", "--duration: ", '"3s"', "number"),
    ("duration of nothing", SIMULATE + "--duration ''", "--duration: ", '""', "number"),
    ("duration nan", SIMULATE + "--duration nan", "--duration: ", "nan", SECONDS),
    ("duration inf", SIMULATE + "--duration inf", "--duration: ", "inf", SECONDS),
    ("duration beyond floats", SIMULATE + "--duration 1e999", "--duration: ", "found inf", SECONDS),
    ("duration 1e18", SIMULATE + "--duration 1e18", "--duration: ", "1e+18", SECONDS),
    ("duration -1", SIMULATE + "--duration -1", "--duration: ", "-1", SECONDS),
    ("duration 0", "plan good.json --duration 0", "--duration: ", "0", SECONDS),
    ("time step of 1e-300 s", SIMULATE + "--method rk4 --time-step 1e-300", "--time-step: ", "1e-300", SECONDS, "1e-12"),
    ("time step without a method", SIMULATE + "--time-step 0.001", "--time-step: ", "without --method"),
    ("accuracy 7", SIMULATE + "--accuracy 7", "--accuracy: ", "7", "1e-12 to 0.01"),
    ("accuracy in words", "plan good.json --accuracy best", "--accuracy: ", "best", '"reference"'),
    ("method euler", SIMULATE + "--method euler", "--method: ", '"euler"', "explicitEuler", "rk4"),
    ("frames that go back", RENDER + "--frames 5:2", "--frames: ", '"5:2"', "0 <= FIRST < END <= 7"),
    ("frames beyond the end", RENDER + "--frames 0:99999", "--frames: ", '"0:99999"', "END <= 7"),
    ("frame beyond 64 bits", RENDER + "--frames 99999999999999999999:3", "--frames: ", '"99999999999999999999:3"', "END <= 7"),
    ("frame that there is not", RENDER + "--frames 99", "--frames: ", '"99"', "FIRST:END"),
    ("size by a cross", RENDER + "--size 10*10", "--size: ", '"10*10"', "WIDTHxHEIGHT"),
    ("overlay that there is not", RENDER + "--overlay time,clock", "--overlay: ", '"clock"', "time, contacts"),
    ("height of a body that is not there", RENDER + "--overlay plot=height:bal", "--overlay: ", '"plot=height:bal"', '"ball"'),
    ("report without a name", COMPARE + "--report ''", "--report: ", "is empty"),
    ("shaders that are none", RENDER + "--shaders empty", "empty/", "cannot be read", "--shaders"),
    ("no pictures a second", "encode frames -o old.mp4 --frames-per-second 0", "--frames-per-second: ", "found 0", "0.001 to 100000"),
    ("tolerance below zero", "compare good.sqlite old.sqlite --tolerance -1", "--tolerance: ", "-1", ">= 0"),
    ("tolerance nan", "compare good.sqlite old.sqlite --tolerance nan", "--tolerance: ", "nan", ">= 0"),
    ("tolerance without a value", "compare good.sqlite old.sqlite --tolerance ''", "--tolerance: ", '""', "number"),
    ("report of trajectories", "compare good.sqlite old.sqlite --report new.html", "--report: ", "pictures", "trajectories"),
    ("visible in words", COMPARE + "--visible all", "--visible: ", '"all"', "LEVEL:PERCENT"),
    ("striking beyond all pixels", COMPARE + "--striking 32:101", "--striking: ", '"32:101"', "LEVEL:PERCENT"),
    ("scale 0", "inspect box.3ds --scale 0", "--scale: ", "found 0", "> 0"),
    ("scale nan", "inspect box.3ds --scale nan", "--scale: ", "nan", "> 0"),
    ("scale 1e300", "inspect box.3ds --scale 1e300", "--scale: ", r"1e+300", "1e+18"),
    ("methods none", "study good.json -o new --methods none", "--methods: ", '"none"', "explicitEuler", "dop853"),
    ("maps of nothing", "stability -o new --maps everything", "--maps: ", '"everything"', "step_stiffness"),
    ("film of another kind", "video good.sqlite -o new.avi", r"new\.avi: ", ".mp4"),
    ("table of another kind", "export good.sqlite -o new.xlsx", r"new\.xlsx: ", "FILE.csv", "FILE.glb"),
    ("asset root that is none", "check good.json --asset-root none", "none: ", "is no folder"),
    ("asset root that is a file", "plan good.json --asset-root box.3ds", r"box\.3ds: ", "is no folder"),
    ("asset root without a name", "check good.json --asset-root ''", "--asset-root: ", "empty"),
):
    name, command, begins, *words = row
    add("command line", name, {}, command, 2, begins, *words)
for size in ("0x0", "99999x1", "32x-1"):
    add("command line", "size " + size, {}, RENDER + "--size " + size, 2, "--size: ", "1 to 16384")


# What is too much

add("limit", "a million copies at one place", {"s.json": body('"copies": {"count": [1000, 1000, 1], "spacing": [0, 0, 0]}')}, "check s.json", 8,
    r"s\.json:1:\d+ /bodies/0/copies: ", "2000000 pairs", "in one another", "move them apart")
for command in ("plan s.json", "simulate s.json -o old.sqlite"):
    add("limit", "thousands of bodies in one another, " + command,
        {"s.json": body('"copies": {"count": [15, 15, 15], "spacing": [0.1, 0.1, 0.1]}')}, command, 8, "", "2000000 pairs", "in one another")
    add("limit", "60 000 bodies at one place, " + command.split()[0],
        {"s.json": scene('"bodies": [%s]' % ", ".join('{"name": "s%d", "shape": {"sphere": {}}}' % i for i in range(60_000)))}, command, 8, "",
        "2000000 pairs", "in one another")


# Outputs

LONG = 300 * "a"

for row in (
    ("without a name", {}, "simulate good.json -o ''", "the output: ", "empty name"),
    ("with too long a name", {}, "export good.sqlite -o %s.csv" % LONG, LONG, "304 bytes", "at most 242"),
    ("with too long a path", {}, "simulate good.json -o %snew.sqlite" % (3000 * "./"), r"\./", "6010 bytes", "at most 4032"),
    ("folder for a trajectory", {}, "simulate good.json -o empty", "empty: ", "is a folder", "name of a file"),
    ("folder for a film", {"f.mp4/x": ""}, "video good.sqlite -o f.mp4", r"f\.mp4: ", "is a folder", "name of a file"),
    ("folder for a table", {"f.csv/x": ""}, "export good.sqlite -o f.csv", r"f\.csv: ", "is a folder"),
    ("folder for a report", {}, COMPARE + "--report empty", "empty: ", "is a folder"),
    ("file for a folder of frames", {}, "render good.sqlite -o old.csv", r"old\.csv: ", "is no folder"),
    ("file for a folder of a study", {}, "study good.json -o old.csv --methods rk4", r"old\.csv: ", "is no folder"),
    ("file for a folder of maps", {}, "stability -o old.csv --maps logistic", r"old\.csv: ", "is no folder"),
    ("below a folder that is not there", {}, "simulate good.json -o none/new.sqlite", r"none/new\.sqlite: ", "folder none does not exist", "make it first"),
    ("frames below a folder that is not there", {}, "render good.sqlite -o none/new", "none/new: ", "parent folder does not exist", "make it first"),
    ("film below a folder that is not there", {}, "encode frames -o none/new.mp4", r"none/new\.mp4: ", "folder none does not exist", "make it first"),
    ("below a file", {}, "export good.sqlite -o good.json/new.glb", r"good\.json/new\.glb: ", "good.json is no folder"),
    ("where no files can be made", {}, "simulate good.json -o /proc/new.sqlite", r"/proc/new\.sqlite"),
    ("film where no files can be made", {}, "video good.sqlite -o /proc/new.mp4", r"/proc/new\.mp4"),
    ("frames where no folders can be made", {}, "render good.sqlite -o /proc/new", "/proc/new: "),
    ("device", {}, "simulate good.json -o /dev/null", "/dev/null: ", "not a regular file", "another name"),
    ("report on a device", {}, COMPARE + "--report /dev/full", "/dev/full: ", "not a regular file", "another name"),
    ("pipe", {"p.csv": os.mkfifo}, "export good.sqlite -o p.csv", r"p\.csv: ", "not a regular file", "another name"),
    ("link to a device", {"p.glb": link("/dev/null")}, "export good.sqlite -o p.glb", r"p\.glb: ", "not a regular file", "another name"),
    ("link to a file", {"p.csv": link("old.csv")}, "export good.sqlite -o p.csv", r"p\.csv: ", "is a link to old.csv", "name the file itself"),
    *(("link to nothing, " + command.split()[0], {command.split()[-1]: link("none")}, command, re.escape(command.split()[-1]) + ": ",
       "is a link to none", "name the file itself")
      for command in ("export good.sqlite -o p.csv", "simulate good.json -o p.sqlite", "encode frames -o p.mp4", COMPARE + "--report p.html")),
    ("link to a trajectory", {"p.sqlite": link("old.sqlite")}, "simulate good.json -o p.sqlite", r"p\.sqlite: ", "is a link to old.sqlite"),
    ("link to a film", {"p.mp4": link("old.mp4")}, "video good.sqlite -o p.mp4", r"p\.mp4: ", "is a link to old.mp4"),
    ("link to a folder", {"p.csv": link("empty")}, "export good.sqlite -o p.csv", r"p\.csv: ", "is a folder"),
    ("part that is a link", {"new.csv.part": link("good.json")}, "export good.sqlite -o new.csv", r"new\.csv\.part: ", "link"),
    ("part that is a link to nothing", {"new.mp4.part": link("none")}, "video good.sqlite -o new.mp4", r"new\.mp4\.part: ", "link"),
    ("part of a trajectory that is a link", {"new.sqlite.part": link("good.sqlite")}, "simulate good.json -o new.sqlite", r"new\.sqlite\.part: ", "in the way"),
    ("part of a frame that is a link", {"f/frame_000000.png.part": link("../good.json")}, "render good.sqlite -o f --frames 0:1 --overwrite", r"f/frame_000000\.png\.part: ", "link"),
    ("part that is a folder", {"new.csv.part/x": ""}, "export good.sqlite -o new.csv", r"new\.csv\.part: "),
    ("part of a trajectory that is a folder", {"new.sqlite.part/x": ""}, "simulate good.json -o new.sqlite", r"new\.sqlite\.part: "),
    ("part that is a pipe", {"new.glb.part": os.mkfifo}, "export good.sqlite -o new.glb", r"new\.glb\.part: "),
    ("part of a trajectory that is a pipe", {"new.sqlite.part": os.mkfifo}, "simulate good.json -o new.sqlite", r"new\.sqlite\.part: "),
    ("scene in the trajectory's place", {}, "simulate good.json -o good.json", r"good\.json: ", "no trajectory", "not replaced"),
    ("mesh in the trajectory's place", {}, "simulate good.json -o box.3ds", r"box\.3ds: ", "no trajectory", "not replaced"),
    ("database of another program", {"new.sqlite": other_database}, "simulate good.json -o new.sqlite", r"new\.sqlite: ", "no trajectory", "not replaced"),
    ("input as output", {"t.csv": trajectory()}, "export t.csv -o t.csv", r"t\.csv: ", "input"),
    ("input as film", {"t.mp4": trajectory()}, "video t.mp4 -o ./t.mp4", r"\./t\.mp4: ", "input"),
    ("frames among other things", {}, "render good.sqlite -o others", "others: ", "holds thesis.txt", "no frame", "new or empty folder"),
    ("frames among scenes", {}, "render good.sqlite -o .", r"\.: ", "no frame", "new or empty folder"),
    ("study among frames", {}, "study good.json -o frames --methods rk4", "frames: ", "no result of a study", "new or empty folder"),
    *(("study with %s, %s" % (name, what), {"s/" + name: make}, "study good.json -o s --methods rk4", "s/" + re.escape(name) + ": ", word)
      for name in ("study.csv.part", "references.csv.part", "work_precision_good.svg.part")
      for what, make, word in (("a pipe", below(os.mkfifo), "not a regular file"), ("a link", link("/dev/zero"), ""),
                               ("a folder", below(os.mkdir), ""))),
    ("study with a large table", {"s/study.csv.part": sparse(3_000_000_000)},
     "study good.json -o s --methods rk4", r"s/study\.csv\.part: ", "3000.0 MB", "64 MB"),
    ("study with a folder for a chart", {"s/work_precision_good.png/x": ""}, "study good.json -o s --methods rk4",
     r"s/work_precision_good\.png: ", "is a folder"),
    ("map with a folder for a chart", {"s/logistic.png/x": ""}, "stability -o s --maps logistic", r"s/logistic\.png: ", "is a folder"),
    ("study with a chart of too long a name", {LONG[:235] + ".json": json.dumps(good_scene())}, "study %s.json -o new --methods rk4" % LONG[:235],
     "new/work_precision_a+", "at most 242"),
    ("maps among other things", {}, "stability -o others --maps logistic", "others: ", "holds thesis.txt", "new or empty folder"),
    ("frames that are there", {}, "render good.sqlite -o frames", "frames: ", "holds 3 of the frames", "--overwrite"),
    ("frames of a longer film", {"f/frame_000099.png": ""}, "render good.sqlite -o f --overwrite", "f: ", "frame_000099.png", "another film", "7 frames"),
    ("report in a picture's place", {}, COMPARE + "--report frames/frame_000000.png", r"frames/frame_000000\.png: ", "no report", "another name"),
    ("report in a text's place", {}, COMPARE + "--report others/thesis.txt", r"others/thesis\.txt: ", "no report", "another name"),
):
    name, files, command, begins, *words = row
    add("output", name, files, command, 5, begins, *words)


def faults_of_case(number, good):
    return CASES[number].faults(good)


class BadInputs(unittest.TestCase):
    def test_there_are_250(self):
        self.assertGreaterEqual(len(CASES), 250)
        self.assertEqual(len({case.name for case in CASES}), len(CASES))

    def test_each_is_refused(self):
        wanted = [number for number, case in enumerate(CASES) if WANTED in case.name]
        self.assertTrue(wanted, "no case is called %s" % WANTED)
        with tempfile.TemporaryDirectory() as good, concurrent.futures.ProcessPoolExecutor(PROCESSES) as pool:
            good_files(good)
            for number, faults in zip(wanted, pool.map(faults_of_case, wanted, itertools.repeat(good))):
                case = CASES[number]
                with self.subTest(case.name):
                    if faults:
                        self.fail("\n  ".join(["cradle " + shlex.join(case.arguments), *faults]))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
