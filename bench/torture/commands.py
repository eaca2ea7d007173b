"""Commands under test: how to start and resume each command, and which of its products to compare."""
import hashlib
import json
import pathlib
import struct
import sys

import batch
import check
import hub

HERE = pathlib.Path(__file__).resolve().parent
# Members of JSON files that may differ between equal runs, such as times, memory sizes and the command line.
VARYING = {"seconds", "seconds_per_iteration", "peak_memory_bytes", "command", "threads", "unet_rows"}


def digest(data):
    return hashlib.sha256(data).hexdigest()


class Command:
    """A command that writes its results to one folder."""

    name = ""
    varying = "times, memory and the command's words in the .json; report.html; preview.png"
    left_out = ("report.html", "preview.png", "checkpoint.safetensors")
    # The speed of the monotonic clock relative to real time. A fast clock shortens the 12 seconds between checkpoints.
    rate = 30
    done = {0}      # exit codes of a completed run
    durable = True  # True: all products are synced to disk when the command ends
    prints = True   # True: the command prints to stdout
    may_fail = set()  # further exit codes that are allowed if a resource is missing

    def __init__(self, program, fixtures):
        self.program, self.fixtures = str(program), fixtures

    def environment(self, output):
        return {}

    def arguments(self, output, resume=False):
        raise NotImplementedError

    def has_ended(self, output):
        """Returns True if the run is complete, so that resuming it would do more work than it was asked to do."""
        return False

    def close(self):
        pass

    def products(self, output):
        """Returns digests of the results that must not depend on the injected faults, by name."""
        found = {}
        for path in sorted(output.rglob("*")):
            name = str(path.relative_to(output))
            if not path.is_file() or path.name in self.left_out or check.UNFINISHED.search(name):
                continue
            data = path.read_bytes()
            if path.suffix == ".json":
                data = json.dumps(check.without(json.loads(data), VARYING), sort_keys=True).encode()
                data = data.replace(str(output).encode(), b"OUT")
            found[name] = digest(data)
        return found


class Edit(Command):
    name = "edit"

    def arguments(self, output, resume=False):
        inputs = self.fixtures
        return [self.program, "edit", inputs.cube, "--from", "a red cube", "--to", "a blue cube",
                "--light", inputs.light, "--iterations", "6", "--texture-size", "64",
                "--image-size", "32", "--threads", "1", "-o", output, *["--resume"] * resume]


class Relight(Command):
    name = "relight"

    def arguments(self, output, resume=False):
        return [self.program, "relight", self.fixtures.cube, "--from", "a red cube", "--to",
                "a red cube at sunset", "--iterations", "8", "--views", "1", "--frames", "2",
                "--size", "32", "--no-shadows", "--threads", "1", "-o", output,
                *["--resume"] * resume]


class Reconstruct(Command):
    name = "reconstruct"

    def arguments(self, output, resume=False):
        return [self.program, "reconstruct", self.fixtures.photographs, "--cells", "16",
                "--shape-iterations", "8", "--iterations", "8", "--triangles", "400",
                "--texture-size", "32", "--poses", "keep", "--no-shadows", "--threads", "1", "-o", output,
                *["--resume"] * resume]


class Render(Command):
    """A command without a checkpoint. The same command is run again after a kill, as for Generate, Tensors and Study."""

    name = "render"

    def arguments(self, output, resume=False):
        return [self.program, "render", self.fixtures.cube, "--views", "6", "--light", self.fixtures.light,
                "--size", "256x256", "--occlusion", "--threads", "1", "-o", output / "views"]


class Generate(Command):
    name = "generate"

    def arguments(self, output, resume=False):
        return [self.program, "generate", "a golden vase", "--count", "3", "--steps", "4", "--size", "64x64",
                "--like", "none", "--threads", "1", "-o", output / "vase.png"]


class Tensors(Command):
    name = "tensors"

    def arguments(self, output, resume=False):
        return [self.program, "tensors", self.fixtures.cube, "--json", "-o", output / "cube.safetensors"]


class Study(Command):
    name = "study make"

    def arguments(self, output, resume=False):
        return [self.program, "study", "make", self.fixtures.comparison, "-o", output / "study"]


class Train(Command):
    """Training that stops after 960 images of the U-Net, which take about half of its time. The evaluation after it
    takes minutes and stores nothing."""

    name = "prior train"
    varying = "the record of seconds in the checkpoint; settings.json is compared"
    done = {130}
    prints = False
    rate = 200
    images = 960  # of the U-Net

    def arguments(self, output, resume=False):
        return [self.program, "prior", "train", "-o", output, "--part", "diffusion", "--data", "64",
                "--samples", str(2 * self.images), "--stop-after", str(self.images), "--autoencoder-samples", "64",
                "--autoencoder-data", "32", "--variants", "1", "--views", "1", "--lights", "2",
                "--widths", "16", "16", "16", "--batch", "16", "--replicas", "1", "--word-images",
                "1", "--threads", "1", *["--resume"] * resume]

    def has_ended(self, output):
        path = output / "work/checkpoint.safetensors"
        if not path.exists():
            return False
        data = path.read_bytes()
        length = struct.unpack("<Q", data[:8])[0]
        begin = 8 + length + json.loads(data[8:8 + length])["record"]["data_offsets"][0]
        return struct.unpack("<d", data[begin:begin + 8])[0] >= self.images

    def products(self, output):
        work = output / "work"
        found = {name: digest((work / name).read_bytes())
                 for name in ("autoencoder.safetensors", "data.safetensors", "settings.json")}
        data = (work / "checkpoint.safetensors").read_bytes()
        length = struct.unpack("<Q", data[:8])[0]
        for name, entry in json.loads(data[8:8 + length]).items():
            if name not in ("__metadata__", "record"):
                begin, end = entry["data_offsets"]
                found["checkpoint: " + name] = digest(data[8 + length + begin:8 + length + end])
        return found


class Batch(Command):
    name = "batch"
    varying = "model.glb and textures/ of each job are compared, and that each has one result"
    rate = 1        # a fast clock would make workers take each other for dead
    may_fail = {3}  # exit code of a batch with failed jobs
    jobs = 3

    def arguments(self, output, resume=False):
        return [self.program, "batch", "--models", self.fixtures.cube, "--from", "a red cube", "--to",
                "a blue cube", "--seeds", f"0..{self.jobs - 1}", "--workers", "2", "--deaths", "1000",
                "--with", "iterations=4", "--with", "texture-size=64", "--with", "image-size=32",
                "--with", f"light={self.fixtures.light}", "-o", output]

    def products(self, output):
        return {name: digest(data) for name, data in batch.products(output).items()}


class Pull(Command):
    name = "prior pull"
    varying = "nothing; locks are left out"
    durable = False  # symbolic links are not synced; the same command recreates lost links
    rate = 1

    def __init__(self, program, fixtures):
        super().__init__(program, fixtures)
        self.hub = hub.Hub(fixtures.prior)

    def close(self):
        self.hub.close()

    def environment(self, output):
        return {"HF_ENDPOINT": self.hub.url, "HF_HOME": str(output)}

    def arguments(self, output, resume=False):
        return [self.program, "prior", "pull", hub.NAME]


class Studio(Command):
    name = "studio"
    durable = False  # the studio's queue is synced before the results are
    prints = False   # studio.py reads the server's stdout itself
    may_fail = {3}   # exit code of studio.py if the edit fails

    def environment(self, output):
        # Only the server and its child processes load the shims and have the limits, not the Python process that runs
        # studio.py.
        return {"TORTURE_SERVER_PRELOAD": "", "TORTURE_SERVER_LIMITS": "[]"}

    varying = "model.glb and textures/ of the edit are compared"
    rate = 1

    def arguments(self, output, resume=False):
        return [sys.executable, HERE / "studio.py", self.program, self.fixtures.cube, output]

    def products(self, output):
        found = {}
        for path in sorted(output.rglob("results/*/*.glb")) + sorted(output.rglob("results/*/textures/*")):
            # The project's number is left out: a project whose model was not read when the server was killed gets
            # another number.
            name = "/".join(path.relative_to(output / "projects").parts[1:])
            found[name] = digest(path.read_bytes())
        return found


ALL = [Edit, Reconstruct, Train, Batch, Pull, Relight, Studio, Render, Generate, Tensors, Study]
