#!/usr/bin/env python3
"""No value is read beside std::move of it: not in another argument of the same call, whose order is open, not in
another initializer of the same constructor, and not in that constructor's body. Compilers say nothing of either.

    moved_from_test.py SOURCE_FOLDER
"""
import os, re, sys

MOVE = re.compile(r"std::(?:move|forward<[^<>]*>)\((\w+)\)")
CONDITION = re.compile(r"\s*(?:else\s+)?(?:if|for|while|switch)\s*(?:constexpr\s*)?(?=\()")  # comes before what it is of
PARAMETERS = re.compile(r"^.*\)\s*(?:noexcept\s*)?:(?!:)", re.S)  # of a constructor, up to its initializers


def without_texts(source):
    """Comments, strings and characters become blanks; lines stay."""
    blank = lambda match: re.sub(r"[^\n]", " ", match.group())
    return re.sub(r'//[^\n]*|/\*.*?\*/|R"\((?:.|\n)*?\)"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'', blank, source, flags=re.S)


def end_of_block(text, start):
    """Behind the bracket that closes the one at `start`."""
    depth = 0
    for at in range(start, len(text)):
        depth += {"{": 1, "}": -1, "(": 1, ")": -1}.get(text[at], 0)
        if depth == 0:
            return at + 1
    return len(text)


def statement_around(text, at):
    """The statement of a move; of a constructor's initializers all of them, and the body."""
    start = max(text.rfind(mark, 0, at) for mark in ";{}") + 1
    while condition := CONDITION.match(text, start):
        behind = end_of_block(text, condition.end())
        if behind > at:
            break
        start = behind
    end = min(position for position in (text.find(mark, at) for mark in ";{}") if position >= 0)
    statement = text[start:end]
    parameters = PARAMETERS.match(text[start:at])
    if not parameters or "?" in parameters.group():
        return start, statement
    if text[end] == "{":
        end = end_of_block(text, end)
    start += parameters.end()
    return start, text[start:end]


def faults_of(path, source):
    text = without_texts(source)
    for move in MOVE.finditer(text):
        name = move.group(1)
        start, statement = statement_around(text, move.start())
        rest = statement[: move.start() - start] + " " * len(move.group()) + statement[move.end() - start :]
        rest = re.sub(rf"\b{name}\s*=[^=]", " ", rest)  # given a new value, or a capture of that name
        if re.search(rf"(?<![\w.>:])(?<!\w ){name}\b(?!\s*\()", rest):
            line = text.count("\n", 0, move.start()) + 1
            yield f"{path}:{line}: {name} is moved from and read in one expression or constructor"


def main():
    # What the search must find, and what it must leave.
    for text, is_fault in (("void f() { g(std::move(a), a.size()); }", True), ("void f() { g(a.size(), std::move(a)); }", True),
                           ("void f() { if (a.any()) g(std::move(a)); }", False), ("void f() { if (g(std::move(a), a)) h(); }", True),
                           ("F::F(A a) : F(std::move(a), a.size()) {}", True), ("F::F(A a) : b_(std::move(a)) { c_ = a; }", True),
                           ("F::F(A a) : a_(std::move(a)), b_(a_.size()) {}", False), ("void f() { a = g(std::move(a)); }", False),
                           ("void f() { A a; g(std::move(a)); a = {}; }", False), ("void f() { g([a = std::move(a)] {}); }", False)):
        if bool(list(faults_of("", text))) != is_fault:
            sys.exit(f"the search itself is wrong about: {text}")
    faults, moves = [], 0
    for folder, _, names in os.walk(os.path.join(sys.argv[1], "src")):
        for name in names:
            if name.endswith((".h", ".cpp")):
                path = os.path.join(folder, name)
                source = open(path).read()
                moves += len(MOVE.findall(source))
                faults += faults_of(os.path.relpath(path, sys.argv[1]), source)
    print("\n".join(faults) or f"{moves} moves, and nothing read beside them")
    sys.exit(bool(faults) or moves == 0)


main()
