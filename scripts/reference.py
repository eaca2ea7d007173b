#!/usr/bin/env python3
"""Generates man pages, shell completions and docs/reference/commands.md from the programs' own command descriptions.

usage: scripts/reference.py BUILD share FOLDER     write man/man1/*.1 and completions of bash, zsh and fish to FOLDER
       scripts/reference.py BUILD docs [--check]   write docs/reference/commands.md; --check: fail if it would change

BUILD is the folder of the programs.
"""
import json
import pathlib
import re
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from reference_shells import completions  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs/reference/commands.md"
FAMILIES = ("edit", "reconstruct", "compare", "study", "studio", "train", "bench")


def all_commands(build):
    """Returns the top-level commands in the order of commands.h, without those that only programs use."""
    listed = re.findall(r'CommandEntry\{"(\w+)"', (ROOT / "apps/item3d/commands.h").read_text())
    found = {}
    for family in FAMILIES:
        text = subprocess.run([f"{build}/item3d-{family}", "--describe-commands"], capture_output=True, text=True, check=True).stdout
        found.update({command["name"].split()[-1]: command for command in json.loads(text)})
    return [found[name] for name in listed]


def with_own_commands(commands):
    for command in commands:
        yield command
        yield from with_own_commands(command["commands"])


def groups(command):
    names = list(dict.fromkeys(option["group"] for option in command["options"]))
    names.sort(key=lambda name: (name == "Common options", name != "Options"))
    return {name: [option for option in command["options"] if option["group"] == name] for name in names}


def signature(option):
    text = option["names"] + (" " + option["value"] if option["value"] else "")
    return text + ("..." if option["repeated"] else "")


# The reference. ---------------------------------------------------------------------------------------------------------

def cell(text):
    return text.replace("|", "\\|").replace("<", "&lt;")


def section(command):
    lines = [f"## {command['name']}", "", command["description"] + ".", "", "```", command["usage"], "```", ""]
    for name, options in groups(command).items():
        if name == "Common options":
            continue
        lines += [f"| {name} | |", "|---|---|"]
        lines += [f"| `{cell(signature(option))}` | {cell(option['description'])}{' **Required.**' if option['required'] else ''} |" for option in options]
        lines.append("")
    if command["notes"].strip():
        lines += ["```", command["notes"].strip("\n"), "```", ""]
    if command["examples"]:
        lines.append("```")
        for example in command["examples"]:
            lines += [f"# {example['purpose']}", example["command"]]
        lines += ["```", ""]
    return "\n".join(lines)


def reference(commands):
    common = [option for option in groups(commands[0])["Common options"] if "help" not in option["names"]]
    lines = ["# Commands", "", "<!-- Written by scripts/reference.py build docs, from what the programs say of themselves. -->", "",
             "Every command takes these:", "", "| Common options | |", "|---|---|"]
    lines += [f"| `{cell(signature(option))}` | {cell(option['description'])} |" for option in common]
    lines += ["", "Exit codes: 0 done, 1 a bug of item3d, 2 wrong usage, 3 an input that cannot be used, 4 no memory, disk or device, "
              "130 interrupted.", ""]
    return "\n".join(lines) + "\n" + "\n".join(section(command) for command in with_own_commands(commands))


# Man pages. -------------------------------------------------------------------------------------------------------------

def roff(text):
    text = text.replace("\\", "\\e").replace("-", "\\-")
    return "\n".join("\\&" + line if line[:1] in (".", "'") else line for line in text.split("\n"))


def man_page(command, version):
    title = command["name"].replace(" ", "-")
    lines = [f'.TH "{title.upper()}" 1 "" "item3d {version}" "item3d"', ".SH NAME", f"{roff(title)} \\- {roff(command['description'])}",
             ".SH SYNOPSIS", ".B " + roff(command["usage"])]
    for name, options in groups(command).items():
        lines.append(f".SH {roff(name).upper()}")
        for option in options:
            lines += [".TP", ".B " + roff(signature(option)), roff(option["description"])]
    if command["notes"].strip():
        lines += [".SH NOTES", ".nf", roff(command["notes"].strip("\n")), ".fi"]
    if command["commands"]:
        lines.append(".SH COMMANDS")
        for sub in command["commands"]:
            lines += [".TP", ".B " + roff(sub["name"].split()[-1]), roff(sub["description"])]
    if command["examples"]:
        lines.append(".SH EXAMPLES")
        for example in command["examples"]:
            lines += [".PP", roff(example["purpose"]) + ":", ".PP", ".nf", ".RS", roff(example["command"]), ".RE", ".fi"]
    lines += [".SH SEE ALSO", ".BR item3d (1)"]
    return "\n".join(lines) + "\n"


def program_page(commands, version):
    lines = [f'.TH "ITEM3D" 1 "" "item3d {version}" "item3d"', ".SH NAME", "item3d \\- edits the look of textured 3D models from two sentences",
             ".SH SYNOPSIS", ".B item3d", "COMMAND [OPTIONS]", ".SH COMMANDS"]
    for command in commands:
        lines += [".TP", f".BR {roff(command['name']).replace(' ', chr(92) + '-')} (1)", roff(command["description"])]
    lines += [".SH EXIT STATUS"]
    for code, meaning in ((0, "done"), (1, "a bug of item3d"), (2, "wrong usage"), (3, "an input that cannot be used"),
                          (4, "no memory, disk or device"), (130, "interrupted")):
        lines += [".TP", str(code), meaning]
    return "\n".join(lines) + "\n"


def write_share(build, folder):
    version = subprocess.run([f"{build}/item3d", "--version"], capture_output=True, text=True, check=True).stdout.split()[-1]
    commands = all_commands(build)
    pages = pathlib.Path(folder) / "man/man1"
    pages.mkdir(parents=True, exist_ok=True)
    (pages / "item3d.1").write_text(program_page(commands, version))
    for command in with_own_commands(commands):
        (pages / (command["name"].replace(" ", "-") + ".1")).write_text(man_page(command, version))
    for name, text in completions(commands).items():
        path = pathlib.Path(folder) / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


def main(arguments):
    if len(arguments) == 3 and arguments[1] == "share":
        write_share(arguments[0], arguments[2])
    elif arguments[1:2] == ["docs"]:
        text = reference(all_commands(arguments[0]))
        if arguments[2:] == ["--check"]:
            if not PAGE.exists() or PAGE.read_text() != text:
                sys.exit(f"{PAGE.relative_to(ROOT)} is not what the programs say; run: scripts/reference.py build docs")
        else:
            PAGE.write_text(text)
    else:
        sys.exit(__doc__)


if __name__ == "__main__":
    main(sys.argv[1:])
