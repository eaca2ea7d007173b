"""Settings of an edit and of a relighting, and the command lines that they become."""
from __future__ import annotations

import shlex
from dataclasses import dataclass, field
from pathlib import Path

from .errors import Item3dError

# Vertex attribute of the evaluated mesh that holds the region. glTF requires capitals in its name.
REGION_ATTRIBUTE = "_ITEM3D_REGION"


@dataclass
class Machine:
    """The threads and the device that compute."""

    threads: int = 0  # 0: one thread for each core
    device: str = "auto"


@dataclass
class EditSettings:
    """Settings of an edit, as the panel has them. A value of "" or 0 stands for the prior's default."""

    source: str = ""
    target: str = ""
    prior: str = ""
    iterations: int = 0
    seed: int = 0
    detail: str = "auto"
    metallic: str = "auto"
    texture_size: int = 0
    light: str = "studio"
    regions: list[str] = field(default_factory=list)  # selectors in the form of `item3d region --help`
    materials: list[str] = field(default_factory=list)
    feather: float = 0.0
    more: str = ""  # further options of the command line


@dataclass
class RelightSettings:
    """Settings of a relighting. `kind`: preset, sky, lit (a direction in words) or words (found by the prior)."""

    kind: str = "preset"
    preset: str = "sunset"
    hour: float = 18.0
    lit: str = ""
    source: str = ""
    target: str = ""
    prior: str = ""
    more: str = ""


def more_options(text: str) -> list[str]:
    """Splits further options as a shell does. Raises Item3dError if a quotation mark is not closed."""
    try:
        return shlex.split(text)
    except ValueError as error:
        raise Item3dError(f"Options: {error}; close the quotation mark") from error


def check_sentences(source: str, target: str) -> None:
    """Raises Item3dError if a sentence is missing or both sentences are equal."""
    if not source.strip():
        raise Item3dError('From: empty; describe what the object looks like now, as in "a red mug"')
    if not target.strip():
        raise Item3dError('To: empty; describe what it should look like, as in "a golden mug"')
    if source.strip().lower() == target.strip().lower():
        raise Item3dError("From and To are the same; describe in To what should change")


def common_options(folder: Path, machine: Machine) -> list[str]:
    """Returns options of all commands, such as a progress file and the result as JSON."""
    options = ["-o", str(folder / "out"), "--json", "--progress-file", str(folder / "progress.json")]
    options += ["--device", machine.device]
    if machine.threads > 0:
        options += ["--threads", str(machine.threads)]
    return options


def edit_arguments(settings: EditSettings, model: Path, folder: Path, machine: Machine) -> list[str]:
    """Returns the arguments of the program for an edit whose job has this folder."""
    check_sentences(settings.source, settings.target)
    # The export gave a UV map to objects without a usable one, so the program must keep it.
    options = ["edit", str(model), f"--from={settings.source.strip()}", f"--to={settings.target.strip()}"]
    options += ["--uv", "keep", "--live", str(folder / "live"), "--seed", str(settings.seed)]
    options += common_options(folder, machine)
    if settings.prior:
        options += ["--prior", settings.prior]
    if settings.iterations > 0:
        options += ["--iterations", str(settings.iterations)]
    if settings.texture_size > 0:
        options += ["--texture-size", str(settings.texture_size)]
    for name in ("detail", "metallic", "light"):
        value = getattr(settings, name)
        if value != getattr(EditSettings, name):
            options += [f"--{name}", value]
    for selector in settings.regions:
        options += ["--region", selector]
    for material in settings.materials:
        options += ["--material", material]
    if settings.feather > 0:
        options += ["--feather", f"{settings.feather:g}"]
    return options + more_options(settings.more)


def relight_arguments(settings: RelightSettings, model: Path, folder: Path, machine: Machine) -> list[str]:
    """Returns the arguments of the program for a relighting whose job has this folder."""
    options = ["relight", str(model), "--views", "1", "--frames", "1", *common_options(folder, machine)]
    if settings.kind == "preset":
        options += ["--light", settings.preset]
    elif settings.kind == "sky":
        options += ["--sky", f"{settings.hour:g}"]
    elif settings.kind == "lit":
        if not settings.lit.strip():
            raise Item3dError('Direction: empty; describe where the light comes from, as in "low in the west"')
        options += [f"--lit={settings.lit.strip()}"]
    else:
        check_sentences(settings.source, settings.target)
        options += [f"--from={settings.source.strip()}", f"--to={settings.target.strip()}"]
        if settings.prior:
            options += ["--prior", settings.prior]
    return options + more_options(settings.more)
