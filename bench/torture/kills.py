"""Kills a command with SIGKILL at random moments, resumes it, and compares it with an undisturbed run."""
import dataclasses
import random
import shutil
import signal
import time

import check
import process


@dataclasses.dataclass
class Round:
    """Result of one round: a run that was killed once or twice and then resumed to its end."""

    command: str
    seed: int
    moments: list  # times of the kills, in seconds after the start
    resumed: int   # number of kills after which a checkpoint existed
    faults: list
    seconds: float


class Killer:
    """Runs the rounds of one command. patience: seconds after which a run counts as hung."""

    def __init__(self, command, shims, folder, patience):
        self.command, self.shims, self.folder, self.patience = command, shims, folder, patience
        self.quiet = None
        self.seconds = 0.0

    def environment(self, output):
        added = self.command.environment(output)
        if self.command.rate > 1:
            added = added | self.shims.faults(rate=self.command.rate)
        return added

    def begin(self, output, resume):
        return process.Run(self.command.arguments(output, resume), self.folder / "log",
                           environment=self.environment(output))

    def go_on(self, output):
        """Resumes the command in `output` and waits for its end."""
        if self.command.has_ended(output):
            return process.Outcome(min(self.command.done), b"", b"item3d: it had ended", 0)
        return self.begin(output, True).wait(self.patience)

    def undisturbed(self):
        """Runs the command without faults and stores its products, which all rounds must reproduce."""
        output = self.folder / "out"
        process.clear(output)
        outcome = self.begin(output, False).wait(self.patience)
        faults = process.faults_of(outcome, self.command.done)
        if faults:
            raise SystemExit(f"torture: {self.command.name}, undisturbed: {faults}\n"
                             f"{outcome.error.decode(errors='replace')[-2000:]}")
        self.quiet = self.command.products(output)
        self.seconds = outcome.seconds
        # The timeout is generous, because other programs on the machine may slow the command.
        self.patience = max(self.patience, 40 * self.seconds)

    def round(self, seed):
        """Kills a run at a random moment and resumes it; in every third round, kills the resumed run too."""
        draw = random.Random(f"{self.command.name} {seed}")
        output = self.folder / "out"
        process.clear(output)
        begin = time.monotonic()
        result = Round(self.command.name, seed, [], 0, [], 0)
        kills = 2 if seed % 3 == 2 else 1
        longest = self.seconds
        while len(result.moments) < kills:
            if result.moments and self.command.has_ended(output):
                break  # the run had written its last file before the kill
            run = self.begin(output, bool(result.moments))
            moment = draw.uniform(0.02, 1.0) * longest
            time.sleep(moment)
            if run.process.poll() is not None:  # the command has ended before the kill
                run.end()
                run.wait(self.patience)
                if result.moments:
                    break
                longest *= 0.7
                process.clear(output)
                continue
            members = run.members()
            if len(members) > 1 and draw.random() < 0.3:
                # First kill only one of several processes, as the kernel does when memory is exhausted.
                run.signal_one(draw.choice(sorted(members)), signal.SIGKILL)
                time.sleep(draw.uniform(0, 1))
            run.end()
            run.wait(self.patience)
            result.moments.append(round(moment, 3))
            result.resumed += any(output.rglob("*checkpoint*")) if output.exists() else 0
            result.faults += check.broken_files(output) if output.exists() else []
        outcome = self.go_on(output)
        result.faults += process.faults_of(outcome, self.command.done)
        if not result.faults:
            different = check.differences(self.quiet, self.command.products(output))
            if different:
                result.faults.append(f"{len(different)} products differ: {different[:3]}")
        if result.faults:
            result.faults.append(outcome.error.decode(errors="replace")[-300:])
            kept = self.folder / f"kept-{seed}"
            shutil.rmtree(kept, ignore_errors=True)
            shutil.copytree(output, kept, symlinks=True)
        result.seconds = time.monotonic() - begin
        return result


def torture(command, shims, folder, count, first_seed=0, until=None, patience=300, tell=print):
    """Runs `count` rounds, or fewer if the monotonic clock reaches `until`. tell: prints faults."""
    killer = Killer(command, shims, folder, patience)
    killer.undisturbed()
    rounds = []
    for seed in range(first_seed, first_seed + count):
        if until and time.monotonic() > until:
            break
        rounds.append(killer.round(seed))
        if rounds[-1].faults:
            tell(f"  kill {command.name} {seed}: {rounds[-1].faults}")
    inputs = command.fixtures.changes()
    if inputs:
        tell(f"  kill {command.name}: inputs have changed: {inputs}")
        rounds[-1].faults.append(f"inputs have changed: {inputs}")
    return {"undisturbed_seconds": round(killer.seconds, 2), "products": len(killer.quiet),
            "rounds": [dataclasses.asdict(each) for each in rounds]}
