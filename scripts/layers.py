#!/usr/bin/env python3
"""Checks the structure of the sources.

usage: scripts/layers.py [--graph]    --graph prints the number of includes between rooms instead

A room is a folder of src/item3d that cmake/layers.txt names (docs/architecture.md).

The script prints each violation of these rules as FILE:LINE, and fails if there is one:
- Each #include "..." names an existing path of the source tree.
- A room includes headers of all rooms that cmake/layers.txt allows it to include, and of no others.
- Each source of src has a header with the same name.
- Two headers do not declare types with the same name in the same namespace.
- A file has at most 450 lines."""
import collections
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
SOURCES = ROOT / "src"
MOST_LINES = 450
INCLUDE = re.compile(r'\s*#\s*include\s+"([^"]+)"')
NAMESPACE = re.compile(r"namespace ([A-Za-z_0-9:]+) \{")
# Matches definitions and aliases of types, but no forward declarations.
TYPE = re.compile(r"(?:(?:struct|class|union|enum(?: class)?) (\w+)(?: final)?(?: :[^;]*)?(?: \{.*)?$|using (\w+) =)")
# Files that the build generates.
GENERATED = {"bsdf_table_values.inc"}


def read_layers():
    """Returns a dictionary from each room to the rooms that it may include, in the order of cmake/layers.txt."""
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
    """Returns the innermost room that contains a path such as item3d/prior/data/captions.h, or None."""
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
    """Yields a violation for each source that has no header with the same name."""
    for path in sorted(SOURCES.rglob("*.cpp")):
        if not path.with_suffix(".h").exists():
            yield f"{path.relative_to(ROOT)}:1 has no header of its name"


def check_types():
    """Yields a violation for each type that two headers declare. A program that links both could mix them up."""
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
