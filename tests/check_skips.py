#!/usr/bin/env python3
"""Fails if a test was skipped that tests/expected_skips.txt does not list.

usage: tests/check_skips.py RESULTS     RESULTS: folder of GoogleTest's JSON files
"""
import fnmatch
import json
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent


def expected():
    for line in (HERE / "expected_skips.txt").read_text().splitlines():
        if line and not line.startswith("#"):
            _, program, pattern = line.split()
            yield program, pattern


def skipped(file):
    for suite in json.loads(file.read_text())["testsuites"]:
        for test in suite["testsuite"]:
            if test.get("result") == "SKIPPED":
                yield f"{suite['name']}.{test['name']}"


def main(results):
    files = sorted(pathlib.Path(results).glob("*.json"))
    if not files:
        sys.exit(f"check_skips.py: {results} has no results; run the tests by ctest")
    listed, wrong, count = list(expected()), [], 0
    for file in files:
        program = file.stem
        for name in skipped(file):
            count += 1
            if not any(program == of and fnmatch.fnmatchcase(name, pattern) for of, pattern in listed):
                wrong.append(f"{program}: {name}")
    if wrong:
        sys.exit("check_skips.py: tests skipped that may not (tests/expected_skips.txt):\n  " + "\n  ".join(wrong))
    print(f"{count} tests skipped, all as tests/expected_skips.txt says")


if __name__ == "__main__":
    main(sys.argv[1])
