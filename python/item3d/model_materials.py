"""Evaluates the materials of a model at visible points. Not public."""
from __future__ import annotations

from typing import NamedTuple

import torch

from . import _functions, operations
from ._checks import check, choice
from .model import Model
from .model_geometry import Surface
from .shading import srgb_to_linear

_FACTORS = {'base_color_factor': (4,), 'emissive_factor': (3,), 'roughness_factor': (), 'metallic_factor': (),
            'occlusion_strength': (), 'normal_scale': ()}
_WRAPS = {'repeat': 0, 'mirrored_repeat': 1, 'clamp_to_edge': 2}


class MaterialSample(NamedTuple):
    """Linear material values at P points."""

    base_color: torch.Tensor
    """[P, 3] in [0, 1]."""
    orm: torch.Tensor
    """[P, 3] occlusion, roughness, metallic, in [0, 1]."""
    normal: torch.Tensor | None
    """[P, 3] unit normals in tangent space; None: no material has a normal texture."""
    emissive: torch.Tensor | None
    """[P, 3] emitted radiance; None: no material emits light."""
    alpha: torch.Tensor | None
    """[P, 1] opacity; None: all materials are opaque."""


class _Texture(NamedTuple):
    linear: torch.Tensor
    """[1, H, W, C]"""
    mips: tuple[torch.Tensor, ...]
    """Levels 1, 2, ..., made without gradients."""
    boundary: int
    uvs: int

    def at(self, surface: Surface) -> torch.Tensor:
        """Returns the texture's values at the surface's points, [P, C]."""
        if self.uvs >= len(surface.uvs):
            raise ValueError(f'render: a texture takes UV map {self.uvs}, which no primitive has')
        uv, footprint = surface.uvs[self.uvs], surface.footprints[self.uvs]
        return _functions.texture(self.linear, self.mips, uv[None, None], footprint[None, None], None, 4,
                                  self.boundary, own_mips=True)[0, 0]


class Materials:
    """The materials of a model, with linear textures and their mip levels. sRGB is decoded before filtering."""

    def __init__(self, model: Model):
        self._model, self._levels = model, {}
        for i, one in enumerate(model.materials):
            for member, shape in _FACTORS.items():
                found = _factor(getattr(one, member)).shape
                if found != shape:
                    raise ValueError(f'render: materials[{i}].{member} must be of shape {list(shape)}, found '
                                     f'{list(found)}')
            choice('render', f'materials[{i}].alpha', one.alpha, dict.fromkeys(('opaque', 'mask', 'blend')))
        self._textures = [{
            'base_color': self._texture(i, 'base_color_texture', 0, alpha=True, srgb=True),
            'metallic_roughness': self._texture(i, 'metallic_roughness_texture', one.metallic_roughness_uvs),
            'occlusion': self._texture(i, 'occlusion_texture', one.occlusion_uvs),
            'normal': self._texture(i, 'normal_texture', one.normal_uvs),
            'emissive': self._texture(i, 'emissive_texture', one.emissive_uvs, srgb=True),
        } for i, one in enumerate(model.materials)]
        self.any_normal = any(one['normal'] is not None for one in self._textures)
        self.any_emissive = any(one.unlit or bool((_factor(one.emissive_factor) > 0).any())
                                for one in model.materials)
        self.any_alpha = any(one.alpha != 'opaque' for one in model.materials)

    def _texture(self, material: int, member: str, uvs: int, *, alpha: bool = False, srgb: bool = False):
        index = getattr(self._model.materials[material], member)
        if index < 0:
            return None
        if index >= len(self._model.textures):
            raise ValueError(f'render: materials[{material}].{member} must be below the number of textures, '
                             f'{len(self._model.textures)}, found {index}')
        key = (index, alpha, srgb)
        if key not in self._levels:
            texture = self._model.textures[index]
            check('render', f'textures[{index}]', texture, torch.float32, *[(None, None, c) for c in (1, 2, 3, 4)])
            linear = _linear(texture, alpha, srgb)[None]
            with torch.no_grad():
                self._levels[key] = linear, tuple(operations.mipmaps(linear))
        wraps = self._model.wraps[index] if index < len(self._model.wraps) else ('repeat', 'repeat')
        try:
            boundary = 16 + _WRAPS[wraps[0]] + 3 * _WRAPS[wraps[1]]
        except KeyError as error:
            raise ValueError(f'render: wraps[{index}] must be two of {", ".join(map(repr, _WRAPS))}, found '
                             f'{error.args[0]!r}') from None
        return _Texture(*self._levels[key], boundary, uvs)

    def sample(self, surface: Surface) -> MaterialSample:
        if len(self._textures) == 1:
            return self._sample_one(0, surface)
        # Each material is evaluated at its own points, and the results are put back in order.
        parts, places = [], []
        for material in range(len(self._textures)):
            place = (surface.material == material).nonzero().squeeze(1)
            if len(place) == 0 and (parts or material + 1 < len(self._textures)):
                continue
            places.append(place)
            parts.append(self._sample_one(material, surface._replace(
                uvs=[uv.index_select(0, place) for uv in surface.uvs],
                footprints=[one.index_select(0, place) for one in surface.footprints],
                colors=None if surface.colors is None else surface.colors.index_select(0, place))))
        order = torch.cat(places).argsort()
        return MaterialSample(*(None if values[0] is None else torch.cat(values).index_select(0, order)
                                for values in zip(*parts)))

    def _sample_one(self, index: int, surface: Surface) -> MaterialSample:
        material, textures = self._model.materials[index], self._textures[index]
        count, device = surface.uvs[0].shape[0], surface.uvs[0].device
        lookups = {}

        def factor(value):
            if isinstance(value, (int, float)):
                return torch.full((), value, dtype=torch.float32, device=device)  # unlike a copy, this does not wait for the device
            return _factor(value).to(device)

        def look_up(name):
            texture = textures[name]
            key = (id(texture.linear), texture.boundary, texture.uvs)
            if key not in lookups:  # occlusion and metallic-roughness are mostly one texture
                lookups[key] = texture.at(surface)
            return lookups[key]

        base_color = factor(material.base_color_factor).expand(count, 4)
        if surface.colors is not None:
            base_color = base_color * surface.colors
        if textures['base_color'] is not None:
            texel = look_up('base_color')
            base_color = torch.cat([base_color[:, :3] * texel[:, :3],
                                    base_color[:, 3:] * texel[:, 3:] if texel.shape[1] == 4 else base_color[:, 3:]], 1)
        color, alpha = base_color[:, :3].clamp(0, 1), base_color[:, 3:]

        rough_metallic = torch.stack([factor(material.roughness_factor),
                                      factor(material.metallic_factor)]).expand(count, 2)
        if textures['metallic_roughness'] is not None:
            rough_metallic = rough_metallic * look_up('metallic_roughness')[:, 1:]
        occlusion = color.new_ones(count, 1)
        if textures['occlusion'] is not None:
            occlusion = 1 + factor(material.occlusion_strength) * (look_up('occlusion')[:, :1] - 1)
        orm = torch.cat([occlusion, rough_metallic], 1).clamp(0, 1)

        normal = emissive = None
        if self.any_normal:
            normal = color.new_tensor([0.0, 0.0, 1.0]).expand(count, 3)
            if textures['normal'] is not None:
                scale = torch.stack([*[factor(material.normal_scale)] * 2, factor(1.0)])
                normal = (2 * look_up('normal') - 1) * scale
                normal = torch.nn.functional.normalize(normal, dim=1, eps=1e-6)
        if material.unlit:
            # An unlit material emits its base colour. With an occlusion of zero it reflects no light.
            emissive, orm = color, orm * orm.new_tensor([0.0, 1.0, 1.0])
        elif self.any_emissive:
            emissive = factor(material.emissive_factor).expand(count, 3)
            if textures['emissive'] is not None:
                emissive = emissive * look_up('emissive')
        if not self.any_alpha:
            alpha = None
        elif material.alpha == 'mask':
            alpha = (alpha >= material.alpha_cutoff).to(torch.float32)
        elif material.alpha == 'blend':
            alpha = alpha.clamp(0, 1)
        else:
            alpha = torch.ones_like(alpha)
        return MaterialSample(color, orm, normal, emissive, alpha)


def _factor(value) -> torch.Tensor:
    return torch.as_tensor(value, dtype=torch.float32, device=value.device if isinstance(value, torch.Tensor) else 'cpu')


def _linear(texture: torch.Tensor, alpha: bool, srgb: bool) -> torch.Tensor:
    """Returns a linear texture [H, W, 3], or [H, W, 4] if `alpha` is true and the texture has an alpha channel. Grey
    becomes equal R, G and B."""
    found = texture.shape[2]
    color = texture if found == 3 else texture[..., :3] if found == 4 else texture[..., :1].expand(-1, -1, 3)
    color = srgb_to_linear(color) if srgb else color.contiguous()
    return torch.cat([color, texture[..., -1:]], -1) if alpha and found in (2, 4) else color
