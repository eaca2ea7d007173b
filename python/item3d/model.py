"""Loads models as tensors. The program reads the files: glTF with all compressions, OBJ, and all texture formats.

    model = item3d.load('mug.glb')
    primitive = model.primitives[0]
    camera = item3d.camera((0, 0.1, 0.3), size=(512, 512))
    raster = item3d.rasterize(camera.project(primitive.positions), primitive.triangles, (512, 512))
"""
from __future__ import annotations

import json
import os
import struct
import tempfile
from dataclasses import dataclass, field, fields, replace

import torch

from .program import InternalError, run_command

_DTYPES = {'F32': torch.float32, 'I32': torch.int32}


@dataclass(frozen=True, kw_only=True)
class Primitive:
    """Triangles with one material. Positions, normals and tangents are in world space."""

    positions: torch.Tensor
    """[V, 3] float32."""
    normals: torch.Tensor
    """[V, 3] float32, unit length."""
    triangles: torch.Tensor
    """[T, 3] int32; the vertices are in counter-clockwise order, seen from the front."""
    uvs: torch.Tensor | None = None
    """[V, 2] float32; (0, 0) is the top left corner of a texture. None: the file has no UVs."""
    further_uvs: dict[int, torch.Tensor] = field(default_factory=dict)
    """UV maps [V, 2] by their indices 1, 2, ..., to which members `..._uvs` of materials refer."""
    tangents: torch.Tensor | None = None
    """[V, 4] float32, the last component is the handedness. None: render() computes them for normal textures."""
    colors: torch.Tensor | None = None
    """[V, 4] float32 linear vertex colours, which multiply the base colour."""
    material: int = 0
    """Index into Model.materials."""
    name: str = ''


@dataclass(frozen=True, kw_only=True)
class Material:
    """Metallic-roughness material of glTF, with glTF's defaults.

    Textures are indices into Model.textures, or -1 for none. A texture's values are multiplied by the factors. Factors
    are linear and may be tensors. The base colour and emissive textures are in sRGB, all others are linear.
    """

    name: str = ''
    base_color_factor: tuple[float, float, float, float] | torch.Tensor = (1.0, 1.0, 1.0, 1.0)
    base_color_texture: int = -1
    metallic_factor: float | torch.Tensor = 1.0
    roughness_factor: float | torch.Tensor = 1.0
    metallic_roughness_texture: int = -1
    """Channel G is roughness, B is metallic."""
    metallic_roughness_uvs: int = 0
    occlusion_texture: int = -1
    """Channel R is occlusion."""
    occlusion_uvs: int = 0
    occlusion_strength: float | torch.Tensor = 1.0
    normal_texture: int = -1
    """Normals in tangent space, +Y up."""
    normal_uvs: int = 0
    normal_scale: float | torch.Tensor = 1.0
    emissive_factor: tuple[float, float, float] | torch.Tensor = (0.0, 0.0, 0.0)
    emissive_texture: int = -1
    emissive_uvs: int = 0
    alpha: str = 'opaque'
    """Alpha mode: 'opaque', 'mask' or 'blend'."""
    alpha_cutoff: float = 0.5
    double_sided: bool = False
    unlit: bool = False


@dataclass(frozen=True, kw_only=True)
class Model:
    """A model, as load() returns it or built from tensors for render()."""

    primitives: list[Primitive]
    materials: list[Material] = field(default_factory=lambda: [Material()])
    textures: list[torch.Tensor] = field(default_factory=list)
    """[H, W, C] float32 in [0, 1], row 0 at the top. Values are as in the file: sRGB is not decoded."""
    wraps: list[tuple[str, str]] = field(default_factory=list)
    """Wrap modes of each texture along u and v: 'repeat', 'mirrored_repeat' or 'clamp_to_edge'. A texture without an
    entry repeats."""
    name: str = ''
    _topology: list = field(default_factory=list, init=False, repr=False, compare=False)
    """What render() keeps of the mesh for the next image: (triangles, positions, topology), or nothing."""

    def to(self, device) -> Model:
        """Returns the model with all tensors on a device, with gradients."""
        def moved(value):
            if isinstance(value, torch.Tensor):
                return value.to(device)
            if isinstance(value, dict):
                return {key: moved(part) for key, part in value.items()}
            return value

        def moved_members(one):
            return replace(one, **{member.name: moved(getattr(one, member.name)) for member in fields(one)})

        return replace(self, primitives=[moved_members(one) for one in self.primitives],
                       materials=[moved_members(one) for one in self.materials],
                       textures=[moved(texture) for texture in self.textures])


def load(path, *, variant: str | None = None, textures=()) -> Model:
    """Loads a .glb, .gltf, .vrm or .obj file.

    variant: name of the material variant to load. textures: a folder, or several, in which textures are looked for
    besides the model's own folder. Raises InputError for a file that cannot be read.
    """
    with tempfile.TemporaryDirectory(prefix='item3d-') as folder:
        file = os.path.join(folder, 'model.safetensors')
        folders = [textures] if isinstance(textures, (str, os.PathLike)) else textures
        options = [part for one in folders for part in ('--textures', one)]
        if variant is not None:
            options += ['--variant', variant]
        read = run_command(['tensors', path, '-o', file, *options])
        tensors = _read_safetensors(file)
    primitives = [_primitive(tensors, i, entry) for i, entry in enumerate(read['primitives'])]
    materials = [Material(**{name: tuple(value) if isinstance(value, list) else value
                             for name, value in entry.items()}) for entry in read['materials']]
    return Model(name=read['name'], primitives=primitives, materials=materials,
                 textures=[tensors[f'textures.{i}'] for i in range(len(read['textures']))],
                 wraps=[(entry['wrap_u'], entry['wrap_v']) for entry in read['textures']])


def _primitive(tensors, index, entry) -> Primitive:
    prefix = f'primitives.{index}.'
    own = {name[len(prefix):]: tensor for name, tensor in tensors.items() if name.startswith(prefix)}
    further = {int(name[4:]): own.pop(name) for name in sorted(own) if name.startswith('uvs_')}
    return Primitive(name=entry['name'], material=entry['material'], further_uvs=further, **own)


def _read_safetensors(path) -> dict[str, torch.Tensor]:
    with open(path, 'rb') as file:
        content = bytearray(file.read())
    try:
        start = 8 + struct.unpack_from('<Q', content)[0]
        header = json.loads(content[8:start])
        return {name: torch.frombuffer(content, dtype=_DTYPES[entry['dtype']],
                                       count=(entry['data_offsets'][1] - entry['data_offsets'][0]) // 4,
                                       offset=start + entry['data_offsets'][0]).reshape(entry['shape'])
                for name, entry in header.items() if name != '__metadata__'}
    except (KeyError, ValueError, struct.error):
        raise InternalError('item3d wrote tensors that cannot be read: is it too old?', 1) from None
