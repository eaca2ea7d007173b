"""Runs commands that lack a resource.

Such a command must end in time, with a documented exit code and one line of error, and leave no broken file.
"""
import dataclasses
import json
import os
import random
import resource
import shutil
import signal
import time

import check
import groups
import process
import shims as counters

SPENT = {4}             # a resource is missing or exhausted
REFUSED = {3}           # an input or the output folder cannot be used
INTERRUPTED = {130}     # the command was stopped by a signal


@dataclasses.dataclass
class Case:
    """One way to take a resource away. codes: exit codes that are allowed besides those of a complete run."""

    kind: str
    what: str
    codes: set
    environment: dict = dataclasses.field(default_factory=dict)
    limits: tuple = ()
    before: tuple = ()      # command prefix: program and arguments that run the command
    signals: tuple = ()     # signals that may end the command
    act: object = None      # function that is called with the run, the starver and a random.Random during the run
    stdout: str = None
    may_end_well: bool = True  # True: exit codes of a complete run are allowed
    says: bool = True       # True: stderr is writable, so a failed run must print one line of error
    hidden: bool = False    # True: the file system of the output exists only during the run
    memory: int = 0         # limit of resident memory in bytes, set by a control group; 0: none


class Starver:
    """Runs the cases of one command. patience: seconds after which a run counts as hung."""

    def __init__(self, command, shims, folder, patience):
        self.command, self.shims, self.folder, self.patience = command, shims, folder, patience
        self.output, self.counter = folder / "out", folder / "counter"
        self.calls = self.seconds = self.memory = self.resident = 0

    def measure(self):
        """Runs the command with all resources, and measures its disk calls, time and memory.

        The limit of half the memory makes the program do without its region for tensors. This region is as large as the
        memory, and would hide the size of the address space that the command needs.
        """
        process.clear(self.output)
        run = process.Run(self.command.arguments(self.output), self.folder / "log",
                          environment=self.environment(self.shims.faults(self.counter)),
                          limits=((resource.RLIMIT_AS, total_memory() // 2),))
        while run.process.poll() is None:
            for member in run.members():
                addresses, resident = memory_of(member)
                self.memory = max(self.memory, addresses)
                self.resident = max(self.resident, resident)
            time.sleep(0.02)
        outcome = run.wait(self.patience)
        faults = process.faults_of(outcome, self.command.done)
        if faults:
            raise SystemExit(f"torture: {self.command.name}: {faults} {outcome.error[-1000:]}")
        self.calls, self.seconds = counters.count_of(self.counter), outcome.seconds
        self.quiet = self.command.products(self.output)

    def lacking(self):
        """Returns the faults of a run that ended well but has other products than an undisturbed run."""
        place = self.output if self.output.is_dir() else self.folder / "gone"
        try:
            different = check.differences(self.quiet, self.command.products(place))
        except (OSError, ValueError) as error:
            return [f"ended well without products: {error}"]
        return [f"ended well, {len(different)} products differ: {different[:3]}"] if different else []

    def can_begin(self, limits):
        """Returns True if the program reaches its main() under the limits: it refuses an unknown option three times."""
        words = [self.command.program, *self.command.name.split(), "--no-such-option"]
        return all(process.run(words, self.folder / "log", limits=limits).code == 2 for _ in range(3))

    def environment(self, added):
        base = self.command.environment(self.output)
        if "TORTURE_SERVER_PRELOAD" in base and "LD_PRELOAD" in added:
            added = added | {"TORTURE_SERVER_PRELOAD": added["LD_PRELOAD"]}
            del added["LD_PRELOAD"]
        return base | added

    def run(self, case, seed):
        draw = random.Random(f"{self.command.name} {case.kind} {case.what} {seed}")
        process.clear(self.output)
        environment = self.environment(case.environment)
        if self.counter.exists():
            self.counter.write_bytes(bytes(8))
        group = groups.MemoryGroup(case.memory) if case.memory else None
        limits = case.limits
        if limits and "TORTURE_SERVER_LIMITS" in environment:
            environment["TORTURE_SERVER_LIMITS"] = json.dumps(limits)
            limits = ()
        run = process.Run(self.command.arguments(self.output), self.folder / "log",
                          environment=environment, limits=limits, stdout=case.stdout,
                          before=group.before if group else case.before)
        if case.act:
            case.act(run, self, draw)
        outcome = run.wait(self.patience)
        if group:
            group.close()
        codes = case.codes | (self.command.done if case.may_end_well else set())
        codes = codes | (self.command.may_fail if case.codes else set())
        faults = process.faults_of(outcome, codes, case.signals, case.says)
        if self.output.exists():
            faults += check.broken_files(self.output)
        if outcome.code in self.command.done and not case.hidden and 130 not in case.codes:
            faults += self.lacking()
        faults += [f"input has changed: {name}" for name in self.command.fixtures.changes()]
        return {"command": self.command.name, "kind": case.kind, "what": case.what,
                "code": outcome.code, "seconds": round(outcome.seconds, 2), "faults": faults,
                "said": (outcome.errors() or [""])[-1][:300] if not faults
                else outcome.error.decode(errors="replace")[-600:]}


def total_memory():
    return os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGESIZE")


def memory_of(process_id):
    """Returns the size of the address space and the resident memory of a process, in bytes."""
    try:
        with open(f"/proc/{process_id}/statm") as file:
            addresses, resident = file.read().split()[:2]
        return int(addresses) * resource.getpagesize(), int(resident) * resource.getpagesize()
    except (OSError, ValueError):
        return 0, 0


def spread(count, last):
    """Returns at most `count` evenly spaced numbers from 1 to `last`."""
    count = min(count, last)
    return sorted({1 + round(i * (last - 1) / max(1, count - 1)) for i in range(count)})


def disk_cases(starver, count):
    """Yields cases in which the disk is full from the n-th call on or at this call only, or broken (EIO)."""
    for at in spread(count, starver.calls):
        yield Case("disk full", f"from call {at} of {starver.calls}", SPENT,
                   starver.shims.faults(starver.counter, fail_at=at))
    for at in spread(count // 3, starver.calls):
        yield Case("disk full once", f"at call {at} of {starver.calls}", SPENT,
                   starver.shims.faults(starver.counter, fail_at=at, fail_for=1))
    for at in spread(count // 3, starver.calls):
        yield Case("disk broken", f"EIO from call {at} of {starver.calls}", SPENT | REFUSED,
                   starver.shims.faults(starver.counter, fail_at=at, errno=5))


def limit_cases(starver, count):
    for size in [0, 1, 100, 1 << 12, 10_000, 1 << 15, 100_000, 1 << 20, 3_000_000, 1 << 23][:count]:
        yield Case("file size", f"at most {size} bytes", SPENT, limits=((resource.RLIMIT_FSIZE, size),),
                   says=size >= 1 << 12)
    for part in (75, 85, 65, 80, 25, 90, 70, 50, 95, 60)[:count]:
        size = starver.memory * part // 100
        limits = ((resource.RLIMIT_AS, size),)
        # LibTorch may abort while it is loaded, before the program's main() can report an error.
        early = () if starver.can_begin(limits) else (signal.SIGABRT, signal.SIGSEGV)
        yield Case("memory", f"{part} % of {starver.memory / 1e9:.2f} GB of addresses",
                   SPENT | {process.LOADER},
                   limits=limits, signals=early, says=not early)
    for part in (25, 50, 75, 90, 10)[:count] if groups.can_limit() else ():
        # The kernel kills processes that exceed the memory limit of their control group.
        yield Case("memory of a group", f"{part} % of {starver.resident / 1e9:.2f} GB resident", SPENT,
                   memory=starver.resident * part // 100, signals=(signal.SIGKILL,))
    for files in (3, 4, 5, 6, 8, 10, 12, 16, 20, 24)[:count]:
        yield Case("files", f"at most {files} open", SPENT | REFUSED | {process.LOADER},
                   limits=((resource.RLIMIT_NOFILE, files),))
    for threads in (0, 1, 2, 3, 4, 5, 6, 8)[:count]:
        yield Case("threads", f"{threads} more", SPENT, starver.shims.faults(threads=threads))


def folder_cases(starver):
    output = str(starver.output)
    if shutil.which("bwrap"):
        whole = ("bwrap", "--dev-bind", "/", "/", "--die-with-parent")
        yield Case("read-only folder", "the output's", REFUSED, may_end_well=False, hidden=True,
                   before=(*whole, "--tmpfs", output, "--remount-ro", output))
        yield Case("/dev/shm missing", "an empty folder that is read-only", SPENT,
                   before=(*whole, "--tmpfs", "/dev/shm", "--remount-ro", "/dev/shm"))
        for size in (4096, 65536, 1 << 20, 4 << 20, 12 << 20):
            yield Case("small file system", f"{size} bytes", SPENT, hidden=True,
                       before=(*whole, "--size", str(size), "--tmpfs", output))

    gone = starver.folder / "gone"

    def vanish(run, starver, draw):
        process.clear(gone)
        time.sleep(draw.uniform(0.05, 1) * starver.seconds)
        if starver.output.exists():
            starver.output.rename(gone)

    def replace(run, starver, draw):
        vanish(run, starver, draw)
        try:
            starver.output.write_text("a file in its place")
        except IsADirectoryError:
            pass  # the command has recreated the folder

    for turn in range(4):
        yield Case("vanished folder", f"the output's, {turn}", SPENT | REFUSED, act=vanish)
    yield Case("vanished folder", "a file in its place", SPENT | REFUSED, act=replace)


def pace_cases(starver):
    yield Case("slow disk", "2 ms a call", set(), starver.shims.faults(starver.counter, delay_us=2000))
    yield Case("clock", "of the day goes back an hour again and again", set(),
               starver.shims.faults(back_s=3600))
    yield Case("clock", "of the day goes forward an hour again and again", set(),
               starver.shims.faults(back_s=-3600))


def signal_cases(starver, count):
    def send(*numbers, pause=0.05):
        def act(run, starver, draw):
            time.sleep(draw.uniform(0.02, 1) * starver.seconds)
            for number in numbers:
                run.signal_one(run.process.pid, number)
                time.sleep(pause)
        return act

    for turn in range(count):
        yield Case("signal", f"SIGTERM, {turn}", INTERRUPTED, act=send(signal.SIGTERM),
                   signals=(signal.SIGTERM,))
        yield Case("signal", f"SIGHUP, {turn}", INTERRUPTED, act=send(signal.SIGHUP),
                   signals=(signal.SIGHUP,))
        yield Case("signal", f"Ctrl-C, {turn}", INTERRUPTED, act=send(signal.SIGINT),
                   signals=(signal.SIGINT,))
        yield Case("signal", f"Ctrl-C twice, {turn}", INTERRUPTED, act=send(signal.SIGINT, signal.SIGINT),
                   signals=(signal.SIGINT,))
        yield Case("signal", f"SIGPIPE, {turn}", set(), act=send(signal.SIGPIPE),
                   signals=(signal.SIGPIPE,))


def pipe_cases(starver):
    yield Case("stdout", "/dev/full", SPENT, stdout="/dev/full",
               may_end_well=not starver.command.prints)
    shell = 'exec "$0" "$@" '
    yield Case("stdout", "closed", SPENT, before=("bash", "-c", shell + ">&-"))
    yield Case("stdout and stderr", "closed", SPENT, says=False, before=("bash", "-c", shell + ">&- 2>&-"))
    yield Case("stdout", "a pipe that nobody reads", set(), signals=(signal.SIGPIPE,),
               before=("bash", "-c", shell + "> >(exec true)"))


def cases(starver, count):
    yield from disk_cases(starver, count)
    yield from limit_cases(starver, count)
    yield from folder_cases(starver)
    yield from pace_cases(starver)
    yield from signal_cases(starver, max(1, count // 8))
    yield from pipe_cases(starver)


def torture(command, shims, folder, count, until=None, kinds=None, tell=print, patience=120):
    starver = Starver(command, shims, folder, patience)
    starver.measure()
    starver.patience = max(60, 40 * starver.seconds)  # generous, because other programs may slow the command
    chosen = [case for case in cases(starver, count) if not kinds or case.kind in kinds]
    random.Random(0).shuffle(chosen)  # if time is short, cases of every kind run
    found = []
    for case in chosen:
        if until and time.monotonic() > until:
            break
        found.append(starver.run(case, 0))
        if found[-1]["faults"]:
            tell(f"  starve {command.name}: {case.kind}, {case.what}: {found[-1]['faults']}\n"
                 f"      {found[-1]['said']}")
    return sorted(found, key=lambda each: (each["kind"], each["what"]))
