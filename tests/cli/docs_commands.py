"""Tests the command lines in README.md, CONTRIBUTING.md and docs/**/*.md.

usage: tests/cli/docs_commands.py BUILD [PAGE...]     PAGE: test only these pages

A command line is a line of a fenced block that begins with item3d, build/item3d, scripts/ or make. The command, its
options and the files of the repository that it names must exist. Cheap commands are run, except those of the how-to
pages, because these pages name files that do not exist yet. ITEM3D_SHOW_TIMES=1 prints the times of the commands.
"""
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))
import reference  # noqa: E402

# Timeout of a command in seconds; about two are usual. A timeout is no failure, because the machine may be busy.
LONGEST_RUN = 60
# Folders of the repository. A word that begins with one of them names a file that must exist.
OWN_FOLDERS = ("apps/", "assets/", "blender/", "cmake/", "docs/", "python/", "scripts/", "src/", "tests/", "tools/", "web/")
RESULTS = ("-o", "--output", "--progress-file", "--live", "--work")  # options whose value is an output file
CHEAP = {"item3d light", "item3d provenance", "item3d prior list", "item3d prior info"}
CHEAP_OF_MODELS = {"item3d render", "item3d provenance"}  # cheap for one image; turntables and traced light take longer
EXAMPLES = ("mug.glb", "chair.glb", "model.glb")  # placeholders for a model, run with the demo's mug


def pages(arguments):
    return [pathlib.Path(page).resolve() for page in arguments] or [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]


def command_lines(text):
    """Yields (line number, command line) for each command line in fenced blocks, with continuation lines joined."""
    in_block, block_language, start, pending = False, "", 0, ""
    for number, line in enumerate(text.split("\n"), 1):
        fence = re.match(r"\s*```(\w*)", line)
        if fence:
            in_block, block_language, pending = not in_block, fence[1], ""
            continue
        if not in_block or block_language not in ("", "sh", "bash", "shell", "console"):
            continue
        line = line.strip().removeprefix("$ ")
        if not pending:
            start = number
            if not re.match(r"(\w+=\S* )*((build/)?item3d\s|scripts/\S|make\b)", line):
                continue
        pending += line.removesuffix("\\")
        if not line.endswith("\\"):
            yield start, pending
            pending = ""


def words_of(line):
    """Returns the words of a line's first command, without comments, redirections and text after ; & or |."""
    lexer = shlex.shlex(line, posix=True, punctuation_chars=";&|<>")
    lexer.whitespace_split, lexer.commenters = True, "#"
    words = []
    for word in lexer:
        if re.fullmatch(r"[;&|<>]+", word):
            break
        if words or not re.match(r"\w+=", word):  # assignments of environment variables are left out
            words.append(word)
    return words


class Checker:
    def __init__(self, build):
        self.build = pathlib.Path(build).resolve()
        commands = reference.with_own_commands(reference.all_commands(build))
        self.commands = {command["name"]: command for command in commands}
        self.targets = set(re.findall(r"^([\w-]+):", (ROOT / "Makefile").read_text(), re.M))
        self.checked, self.ran, self.faults = 0, 0, []

    def find(self, words):
        for count in (3, 2):
            name = " ".join(["item3d", *words[1:count]])
            if len(words) >= count and name in self.commands:
                return self.commands[name], words[count:]
        return None, words[1:]

    def check_files(self, words):
        for previous, word in zip(["", *words], words):
            path = re.split(r"[#@]", word)[0]
            if previous in RESULTS or not path.startswith(OWN_FOLDERS) or re.search(r"[*{<]|\.\.\.|[A-Z]{3,}", path):
                continue
            if not (ROOT / path).exists():
                yield f"there is no {path}"

    def check_options(self, command, words):
        options = {name: option for option in command["options"] for name in re.findall(r"--?[\w-]+", option["names"])}
        for word in words:
            name = word.split("=")[0]
            if re.match(r"--?[a-zA-Z]", word) and name not in options and name not in ("-h", "--help", "--help-all"):
                yield f"{command['name']} has no {name}"

    def check(self, words):
        yield from self.check_files(words)
        if words[0] == "make":
            yield from (f"the Makefile has no {word}" for word in words[1:] if re.fullmatch(r"[a-z][\w-]*", word) and word not in self.targets)
            return
        if not words[0].endswith("item3d"):
            if (ROOT / words[0]).exists() and not os.access(ROOT / words[0], os.X_OK):
                yield f"{words[0]} is not a program"
            return
        command, rest = self.find(words)
        if command is None:
            if rest and rest[0] in ("--help", "--version", "COMMAND"):
                return
            yield f"there is no command {' '.join(words[:2])}"
            return
        yield from self.check_options(command, rest)

    def is_cheap(self, words):
        """Returns True if the command needs only the repository and ends soon."""
        if not words[0].endswith("item3d") or any(re.search(r"[A-Z]{3,}|[*{<]|\.\.\.", word) for word in words):
            return False
        if {"--help", "--help-all", "help", "--version"} & set(words[1:]):
            return True
        command, rest = self.find(words)
        inputs = [word for previous, word in zip(["", *rest], rest) if previous not in RESULTS and re.search(r"\.\w{2,4}$", word)]
        if any(not word.startswith("assets/demo/") and word not in EXAMPLES for word in inputs):
            return False
        if {"--views", "--indirect", "--variant", "--occlusion", "--occlusion=light"} & set(rest):
            return False
        return command["name"] in CHEAP or (command["name"] in CHEAP_OF_MODELS and bool(inputs))

    def run(self, words):
        """Runs a command. Returns its exit code and error message if it fails, otherwise None."""
        with tempfile.TemporaryDirectory() as folder:
            os.symlink(ROOT / "assets", f"{folder}/assets")
            for name in EXAMPLES:
                os.symlink(ROOT / "assets/demo/mug.glb", f"{folder}/{name}")
            began = time.monotonic()
            try:
                done = subprocess.run([self.build / "item3d", *words[1:]], cwd=folder, capture_output=True, text=True, timeout=LONGEST_RUN,
                                      env={**os.environ, "ITEM3D_ASSETS": os.environ.get("ITEM3D_ASSETS", str(ROOT / "assets"))})
            except subprocess.TimeoutExpired:
                print(f"not run to its end within {LONGEST_RUN} s: {shlex.join(words)}", file=sys.stderr)
                return None
            self.ran += 1
            if os.environ.get("ITEM3D_SHOW_TIMES"):
                print(f"{time.monotonic() - began:5.2f} s  {shlex.join(words)}")
            return None if done.returncode == 0 else f"exit code {done.returncode}: {done.stderr.strip()}"

    def check_page(self, page, done={}):
        text = page.read_text()
        for number, line in command_lines(text):
            try:
                words = words_of(line)
            except ValueError as error:
                self.faults.append(f"{page}:{number}: {line}: {error}")
                continue
            found = list(self.check(words))
            self.checked += 1
            if not found and "how-to" not in page.parts and self.is_cheap(words):
                key = tuple(words)
                if key not in done:
                    done[key] = self.run(words)
                found += [done[key]] if done[key] else []
            self.faults += [f"{page.relative_to(ROOT) if page.is_relative_to(ROOT) else page}:{number}: {fault}" for fault in found]


def check_that_faults_are_found(checker):
    for line in ("item3d edit a.glb --form x", "item3d edti a.glb", "item3d render assets/demo/cup.glb -o a.png", "scripts/nothing.sh", "make coffee"):
        if not list(checker.check(words_of(line))):
            sys.exit(f"docs_commands.py: took {line!r} for right")


def main(build, *arguments):
    checker = Checker(build)
    check_that_faults_are_found(checker)
    for page in pages(arguments):
        checker.check_page(page)
    for fault in checker.faults:
        print(fault, file=sys.stderr)
    if not checker.checked:
        sys.exit("docs_commands.py: no command line was found")
    print(f"{checker.checked} command lines, {checker.ran} of them run")
    if checker.faults:
        sys.exit(f"docs_commands.py: {len(checker.faults)} faults")


if __name__ == "__main__":
    main(*sys.argv[1:])
