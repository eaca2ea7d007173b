"""Settings of the commands. Each field is one option; None means the program's default.

A test checks that the fields are the options of `item3d COMMAND --help`.
"""
from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True)
class EditSettings:
    """Options of `item3d edit`; see `item3d edit --help`."""

    prior: str | None = None
    clip: str | None = None
    captioner: str | None = None
    inpainting: str | None = None
    instruct: str | None = None
    teacher: str | None = None
    segmenter: str | None = None
    resume: bool | None = None
    textures: str | list[str] | None = None
    sign_key: str | None = None
    allow_missing_textures: bool | None = None
    precision: str | None = None
    memory: str | None = None
    image_size: int | None = None
    method: str | None = None
    guidance: str | None = None
    adjust: str | None = None
    adjust_every: int | None = None
    adjust_strength: float | None = None
    settle: float | None = None
    anchor: float | None = None
    cfg: float | None = None
    negative_prompt: str | None = None
    iterations: int | None = None
    batch: int | None = None
    resolution: int | None = None
    learning_rate: float | None = None
    evenness: float | None = None
    timesteps: tuple[float, float] | None = field(default=None, metadata={'joined': True})
    timestep_schedule: str | None = None
    weighting: str | None = None
    steps: int | None = None
    views: int | None = None
    clip_loss: str | None = None
    instruction: str | None = None
    image_cfg: float | None = None
    light: str | None = None
    optimize: str | None = None
    light_model: str | None = None
    light_augment: str | None = None
    background: str | None = None
    texture_size: int | None = None
    uv: str | None = None
    texture_format: str | None = None
    keep: str | list[str] | None = field(default=None, metadata={'joined': True})
    metallic: str | None = None
    detail: str | None = None
    material: str | list[str] | None = None
    variant: str | list[str] | None = None
    provenance: str | None = None
    seed: int | None = None
    region: str | list[str] | None = None
    exclude: str | list[str] | None = None
    feather: float | None = None
    lora: str | list[str] | None = None
    embedding: str | list[str] | None = None
    controlnet: str | None = None
    controlnet_scale: float | None = None
    vae: str | None = None
    live: str | None = None
    threads: int | None = None
    device: str | None = None


@dataclass(frozen=True)
class RelightSettings:
    """Options of `item3d relight`; see `item3d relight --help`."""

    textures: str | list[str] | None = None
    light: str | None = None
    sky: float | None = None
    from_light: str | None = None
    sign_key: str | None = None
    punctual: bool | None = None
    image_based: bool | None = None
    no_shadows: bool | None = None
    views: int | None = None
    frames: int | None = None
    size: int | None = None
    threads: int | None = None
    device: str | None = None
    layout: str | None = None
    rotate: float | None = None
    tilt: float | None = None
    sun: str | None = None
    lit: str | list[str] | None = None
    strength: float | None = None
    sun_width: float | None = None
    tint: str | None = None
    exposure: float | None = None
    source: str | None = field(default=None, metadata={'option': 'from'})
    target: str | None = field(default=None, metadata={'option': 'to'})
    prior: str | None = None
    light_model: str | None = None
    guidance: str | None = None
    iterations: int | None = None
    seed: int | None = None
    precision: str | None = None
    resume: bool | None = None


@dataclass(frozen=True)
class ReconstructSettings:
    """Options of `item3d reconstruct`; see `item3d reconstruct --help`."""

    from_images: str | None = None
    resume: bool | None = None
    images: str | None = None
    masks: str | None = None
    background: str | None = None
    longest_side: int | None = None
    linear: bool | None = None
    hold_out: int | None = None
    views: int | None = None
    up: str | list[str] | None = None
    mesh: str | None = None
    move_vertices: bool | None = None
    place_mesh: bool | None = None
    extraction: str | None = None
    cells: int | None = None
    shape_iterations: int | None = None
    iterations: int | None = None
    triangles: int | None = None
    texture_size: int | None = None
    no_normal_map: bool | None = None
    no_shadows: bool | None = None
    poses: str | None = None
    keep_exposure: bool | None = None
    reference: str | None = None
    relit: str | list[str] | None = None
    relit_light: str | list[str] | None = None
    relit_exposure: float | None = None
    truth: str | None = None
    provenance: str | None = None
    sign_key: str | None = None
    seed: int | None = None
    threads: int | None = None
    device: str | None = None


@dataclass(frozen=True)
class GuidanceSettings:
    """Options of `item3d guidance`; see `item3d guidance --help`."""

    precision: str | None = None
    guidance: str | None = None
    adjust: str | None = None
    anchor: float | None = None
    cfg: float | None = None
    negative_prompt: str | None = None
    iterations: int | None = None
    timesteps: tuple[float, float] | None = field(default=None, metadata={'joined': True})
    seed: int | None = None
    lora: str | list[str] | None = None
    embedding: str | list[str] | None = None
    controlnet: str | None = None
    controlnet_scale: float | None = None
    vae: str | None = None
    threads: int | None = None
    device: str | None = None


@dataclass(frozen=True)
class ScoreSettings:
    """Options of `item3d score`; see `item3d score --help`."""

    textures: str | list[str] | None = None
    clip: str | None = None
    views: int | None = None
    precision: str | None = None
    light: str | None = None
    threads: int | None = None
    device: str | None = None


@dataclass(frozen=True)
class CaptionSettings:
    """Options of `item3d caption`; see `item3d caption --help`."""

    textures: str | list[str] | None = None
    captioner: str | None = None
    prefix: str | None = None
    beams: int | None = None
    max_tokens: int | None = None
    views: int | None = None
    light: str | None = None
    precision: str | None = None
    threads: int | None = None
    device: str | None = None


@dataclass(frozen=True)
class RegionSettings:
    """Options of `item3d region`; see `item3d region --help`."""

    region: str | list[str] | None = None
    exclude: str | list[str] | None = None
    feather: float | None = None
    material: str | list[str] | None = None
    segmenter: str | None = None
    prior: str | None = None
    source: str | None = field(default=None, metadata={'option': 'from'})
    target: str | None = field(default=None, metadata={'option': 'to'})
    textures: str | list[str] | None = None
    size: int | None = None
    texture_size: int | None = None
    threads: int | None = None
    device: str | None = None


@dataclass(frozen=True)
class LayersSettings:
    """Options of `item3d layers`; see `item3d layers --help`."""

    textures: str | list[str] | None = None
    sign_key: str | None = None
    texture_format: str | None = None
    texture_size: int | None = None
    threads: int | None = None
    device: str | None = None
