#!/usr/bin/env python3
"""Checks the order of the house: every #include of ours is a path of the tree, no room includes one
that cmake/layers.txt does not allow it, each header has the name of its source, no two headers declare
a type of one name in the same namespace, and no file has more than 450 lines. Prints each violation as FILE:LINE and fails.
usage: scripts/layers.py [--graph]    --graph prints the includes between rooms instead"""
import collections
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
SOURCES = ROOT / "src"
MOST_LINES = 450
INCLUDE = re.compile(r'\s*#\s*include\s+"([^"]+)"')
NAMESPACE = re.compile(r"namespace ([A-Za-z_0-9:]+) \{")
# A definition or an alias, not a declaration ahead.
TYPE = re.compile(r"(?:(?:struct|class|union|enum(?: class)?) (\w+)(?: final)?(?: :[^;]*)?(?: \{.*)?$|using (\w+) =)")
# Written by the build, not in the tree.
GENERATED = {"bsdf_table_values.inc"}


def read_layers():
    """Room -> rooms that it may include, in the order of the table."""
    layers = {}
    for line in (ROOT / "cmake/layers.txt").read_text().splitlines():
        line = line.split("#")[0].strip()
        if not line:
            continue
        room, allowed = line.split(":")
        allowed = allowed.split()
        for other in allowed:
            if other not in layers:
                sys.exit(f"cmake/layers.txt: {room} names {other}, which does not stand above it")
        layers[room] = allowed
    return layers


def room_of(path, layers):
    """The deepest room that a path such as item3d/prior/data/captions.h lies in."""
    folders = path.parts[1:-1]
    for length in range(len(folders), 0, -1):
        room = "/".join(folders[:length])
        if room in layers:
            return room
    return None


def code_files():
    for folder in ("src", "apps", "bench", "python", "tests", "tools"):
        for path in sorted((ROOT / folder).rglob("*")):
            if path.suffix in (".h", ".cpp", ".cu"):
                yield path


def check_includes(path, lines, layers, arrows):
    own = path.relative_to(SOURCES) if path.is_relative_to(SOURCES) else None
    room = room_of(own, layers) if own else None
    if own and room is None:
        yield f"{path.relative_to(ROOT)}:1 lies in no room of cmake/layers.txt"
        return
    for number, line in enumerate(lines, 1):
        match = INCLUDE.match(line)
        if not match or match[1] in GENERATED:
            continue
        place = f"{path.relative_to(ROOT)}:{number}"
        included = pathlib.PurePosixPath(match[1])
        if (SOURCES / included).exists():
            other = room_of(included, layers)
            if room is None or other == room:
                continue
            arrows[room][other] += 1
            if other not in layers[room]:
                yield (f"{place} may not include {'/'.join(included.parts[1:])}: "
                       f"{room} sees {', '.join(layers[room]) or 'nothing'}")
        elif own or not (ROOT / included).exists():
            yield f"{place} includes {included}, which is no path of the tree"


def check_names(layers):
    """A header without a source of its name, whose neighbours' sources have no header."""
    for path in sorted(SOURCES.rglob("*.cpp")):
        if not path.with_suffix(".h").exists():
            yield f"{path.relative_to(ROOT)}:1 has no header of its name"


def check_types():
    """A class of one name in two headers: a program that links both may run the one for the other."""
    places = {}
    for path in sorted(SOURCES.rglob("*.h")):
        namespace = []
        for number, line in enumerate(path.read_text().splitlines(), 1):
            if match := NAMESPACE.match(line):
                namespace.append(match[1])
            elif line.startswith("}  // namespace") and namespace:
                namespace.pop()
            elif (match := TYPE.match(line)) and namespace:
                name = "::".join([*namespace, match[1] or match[2]])
                place = f"{path.relative_to(ROOT)}:{number}"
                if name in places and places[name].split(":")[0] != place.split(":")[0]:
                    yield f"{place} declares {name}, as {places[name]} does: call it otherwise"
                places.setdefault(name, place)


def main():
    layers = read_layers()
    arrows = collections.defaultdict(collections.Counter)
    problems = []
    for path in code_files():
        lines = path.read_text().splitlines()
        problems += check_includes(path, lines, layers, arrows)
        if len(lines) > MOST_LINES:
            problems.append(f"{path.relative_to(ROOT)}:{len(lines)} is longer than {MOST_LINES} lines")
    problems += check_names(layers)
    problems += check_types()
    for room, allowed in layers.items():
        for other in allowed:
            if not arrows[room][other]:
                problems.append(f"cmake/layers.txt: {room} does not include {other}: take it out")
    if "--graph" in sys.argv[1:]:
        for room in layers:
            print(f"{room}:", ", ".join(f"{o} {n}" for o, n in arrows[room].most_common()))
        return
    for problem in problems:
        print(problem, file=sys.stderr)
    if problems:
        sys.exit(1)
    print(f"layers: {len(layers)} rooms, {sum(len(a) for a in arrows.values())} arrows, all as cmake/layers.txt says")


if __name__ == "__main__":
    main()
