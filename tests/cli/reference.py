"""Tests the descriptions of the commands: help texts, examples, man pages, completions, and docs/reference/commands.md.

usage: tests/cli/reference.py BUILD
"""
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))
import reference  # noqa: E402

COMPLETE = """
source "$1"; shift
COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); COMPREPLY=()
_item3d
printf '%s ' "${COMPREPLY[@]}"
"""

# Words of a command line, the last of which is incomplete, and the completions that bash must offer.
COMPLETIONS = [
    (["item3d", "re"], {"reconstruct", "render", "relight", "region"}),
    (["item3d", "edit", "mug.glb", "--gui"], {"--guidance"}),
    (["item3d", "edit", "mug.glb", "--uv", ""], {"auto", "keep", "new"}),
    (["item3d", "prior", "tr"], {"train"}),
    (["item3d", "prior", "train", "--rec"], {"--recipe"}),
    (["item3d", "prior", "train", "--recipe", ""], {"embedded", "embedded-xl"}),
    (["item3d", "batch", "st"], {"status"}),
]


def check(condition, what):
    if not condition:
        sys.exit(f"reference.py: {what}")


def names_of(command):
    return {name for option in command["options"] for name in re.findall(r"--?[\w-]+", option["names"])}


def check_help(command):
    known = names_of(command)
    for name in command["first_screen"]:
        check(f"--{name}" in known, f"{command['name']} has no --{name}, which its first screen names")
    for page in filter(None, command["page"].split(", ")):
        check((ROOT / page).exists(), f"{command['name']}: there is no {page}")
    for option in command["options"]:
        check(option["description"].strip(), f"{command['name']}: {option['names']} has no description")


def check_examples(command, by_name):
    for example in command["examples"]:
        words = shlex.split(example["command"])
        if "item3d" not in words:
            continue  # another program, such as openssl
        words = words[words.index("item3d"):]
        name = " ".join(words[:3]) if " ".join(words[:3]) in by_name else " ".join(words[:2])
        check(name in by_name, f"{example['command']}: there is no such command")
        for word in words:
            if re.match(r"--?[a-z]", word):
                check(word.split("=")[0] in names_of(by_name[name]), f"{example['command']}: there is no {word}")


def check_screens(build, command):
    """Checks that --help of a command with a first screen is short, and that --help-all has all options."""
    if not command["first_screen"]:
        return
    words = command["name"].split()[1:]
    few, all_of_it = (subprocess.run([f"{build}/item3d", *words, name], capture_output=True, text=True, check=True).stdout for name in ("--help", "--help-all"))
    check(few.count("\n") <= 50, f"{command['name']} --help has {few.count(chr(10))} lines")
    for name in names_of(command):
        check(f" {name}" in all_of_it, f"{command['name']} --help-all lacks {name}")


def check_share(build, commands):
    with tempfile.TemporaryDirectory() as folder:
        reference.write_share(build, folder)
        for command in reference.with_own_commands(commands):
            page = (pathlib.Path(folder) / "man/man1" / (command["name"].replace(" ", "-") + ".1")).read_text()
            check(page.startswith(".TH ") and page.count(".TP") >= len(command["options"]), f"{command['name']}: its man page lacks options")
        script = f"{folder}/bash-completion/completions/item3d"
        for words, expected in COMPLETIONS:
            said = subprocess.run(["bash", "-c", COMPLETE, "bash", script, *words], capture_output=True, text=True, check=True)
            check(set(said.stdout.split()) == expected, f"{words}: bash offers {said.stdout!r}, not {expected}")


def main(build):
    commands = reference.all_commands(build)
    by_name = {command["name"]: command for command in reference.with_own_commands(commands)}
    for command in by_name.values():
        check_help(command)
        check_examples(command, by_name)
        check_screens(build, command)
    check_share(build, commands)
    reference.main([build, "docs", "--check"])


if __name__ == "__main__":
    main(sys.argv[1])
