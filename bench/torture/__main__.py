#!/usr/bin/env python3
"""Fault-injection suite of item3d's commands: kills, power cuts, starvation, extreme numbers, extreme sizes and long runs.

    bench/torture build/item3d OUT [--minutes 30] [--kills 50] [--cuts 12] [--starve 8] [--numbers models lights ...]
        [--sizes "one triangle" ...] [--edits 100] [--requests 300]

The suite writes OUT/index.html and OUT/results.json, and ends with exit code 1 if any assertion failed.
docs/reliability.md says what is asserted. The random numbers of a round depend only on the round's number, so the same
options inject the same faults, as far as the speed of the machine allows.
"""
import argparse
import datetime
import json
import pathlib
import platform
import subprocess
import sys
import time

import commands
import extreme_numbers
import fixtures
import kills
import long_runs
import page
import power_cuts
import shims
import sizes
import starvation


def machine():
    for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.partition(":")[2].strip()
    return platform.machine()


def options_of(arguments):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path, help="the item3d program")
    parser.add_argument("output", type=pathlib.Path, help="folder for all results")
    parser.add_argument("--minutes", type=float, default=30,
                        help="time limit of the whole suite; each part gets a share of it")
    parser.add_argument("--kills", type=int, default=50,
                        help="number of rounds of kills for each command (for edit: twice as many); 0: none")
    parser.add_argument("--cuts", type=int, default=12, help="number of power cuts for each command; 0: none")
    parser.add_argument("--starve", type=int, default=8,
                        help="number of cases of each kind of starvation, at most; 0: none")
    parser.add_argument("--numbers", nargs="*", metavar="PART", default=[], choices=extreme_numbers.PARTS,
                        help="kinds of input that get extreme numbers, of " + ", ".join(extreme_numbers.PARTS) +
                        "; takes minutes besides --minutes")
    parser.add_argument("--sizes", nargs="*", metavar="MODEL", default=[], choices=sizes.MODELS,
                        help="models to edit, of " + ", ".join(sizes.MODELS) +
                        "; takes minutes besides --minutes, and up to 15 GB of memory")
    parser.add_argument("--edits", type=int, default=100, help="number of edits in one worker; 0: none")
    parser.add_argument("--requests", type=int, default=300, help="number of rounds of requests to one studio; 0: none")
    parser.add_argument("--commands", nargs="*", metavar="NAME", default=[each.name for each in commands.ALL],
                        choices=[each.name for each in commands.ALL], help="commands to test")
    parser.add_argument("--kinds", nargs="*", metavar="KIND", help="kinds of starvation to test, named as on the page")
    return parser.parse_args(arguments)


class Suite:
    def __init__(self, options):
        self.options = options
        self.program, self.folder = options.program.absolute(), options.output.absolute()
        self.folder.mkdir(parents=True, exist_ok=True)
        self.fixtures = fixtures.Fixtures(self.program, self.folder / "inputs")
        self.shims = shims.Shims(self.folder / "shims")
        version = subprocess.run([self.program, "--version"], capture_output=True, text=True, check=True)
        self.results = {"machine": machine(), "date": datetime.date.today().isoformat(),
                        "version": version.stdout.split()[-1], "arguments": sys.argv[1:], "kills": {}, "cuts": {},
                        "starved": [], "numbers": [], "sizes": [], "long": []}

    def write(self):
        (self.folder / "results.json").write_text(json.dumps(self.results))
        page.write(self.folder / "index.html", self.results)

    def part(self, name, command, until):
        options, folder = self.options, self.folder / command.name.replace(" ", "_")
        folder.mkdir(exist_ok=True)
        if name == "kills":
            count = options.kills * (2 if command.name == "edit" else 1)
            self.results["kills"][command.name] = kills.torture(command, self.shims, folder, count, until=until)
        elif name == "cuts":
            self.results["cuts"][command.name] = power_cuts.torture(command, self.shims, folder, options.cuts, until)
        else:
            self.results["starved"] += starvation.torture(command, self.shims, folder, options.starve, until,
                                                          options.kinds)

    def run(self):
        options, last = self.options, time.monotonic() + 60 * self.options.minutes
        chosen = [kind for kind in commands.ALL if kind.name in options.commands]
        to_do = [(name, kind) for name, count in (("starve", options.starve), ("kills", options.kills),
                                                  ("cuts", options.cuts)) if count for kind in chosen]
        reserve = 1 if options.edits or options.requests else 0  # number of shares of the time that the long runs get
        for i, (name, kind) in enumerate(to_do):
            left = last - time.monotonic()
            if left <= 0:
                break
            command = kind(self.program, self.fixtures)
            begin = time.monotonic()
            self.part(name, command, begin + left / (len(to_do) - i + reserve))
            command.close()
            print(f"torture: {name} {command.name}: {time.monotonic() - begin:.0f} s", flush=True)
            self.write()
        if options.numbers:
            begin = time.monotonic()
            self.results["numbers"] = extreme_numbers.torture(self.program, self.fixtures, self.folder / "numbers",
                                                              options.numbers)
            print(f"torture: numbers: {time.monotonic() - begin:.0f} s", flush=True)
            self.write()
        if options.sizes:
            self.results["sizes"] = sizes.torture(self.program, self.fixtures, self.folder / "sizes", options.sizes)
            self.write()
        self.results["long"] = long_runs.torture(self.program, self.fixtures, self.folder, options.edits,
                                                 options.requests, max(last, time.monotonic() + 20))
        self.write()
        return page.faults(self.results)[1]


def main():
    suite = Suite(options_of(sys.argv[1:]))
    count = suite.run()
    print(f"torture: {count} faults; {suite.folder / 'index.html'}")
    return 1 if count else 0


if __name__ == "__main__":
    raise SystemExit(main())
