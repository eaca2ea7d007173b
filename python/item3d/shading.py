"""Physically based shading under an environment, as the program shades: split-sum lighting (Karis 2013) with the
metallic-roughness material of glTF.

    light = item3d.prefilter(environment)
    radiance = item3d.shade(light, normal=normal, view=view, base_color=base_color, roughness=0.4, metallic=0.0)

Colours are linear. Conventions and errors are those of operations.py.
"""
from __future__ import annotations

from typing import NamedTuple

import torch

from . import _functions
from ._checks import check

_SIZES = (16, 32, 64, 128, 256, 512, 1024)


class Light(NamedTuple):
    """A prefiltered environment, of `prefilter`. Cube faces are +x, -x, +y, -y, +z, -z as OpenGL has them."""

    diffuse: torch.Tensor
    """[6, 128, 128, 3] irradiance / pi by the normal, linear."""
    specular: tuple[torch.Tensor, ...]
    """[6, S, S, 3] radiance under a lobe of GGX by the mirrored view, one for each roughness, finest first."""
    roughness: torch.Tensor
    """[L] perceptual roughness of each level, ascending."""


def prefilter(environment: torch.Tensor, *, size: int = 256) -> Light:
    """Prefilters an environment for `shade`, once for all pictures under it. Every step is linear in it.

    Args:
        environment: [H, W, 3] equirectangular linear radiance, row 0 at the zenith (+y), the middle column
            -z and the column at three quarters +x, as .hdr and .exr files have it; or a cube map
            [6, S, S, 3], S a power of two in [16, 1024]. Not finite: RuntimeError. May require gradients:
            all maps of the light carry them.
        size: S for an equirectangular environment. The program renders with 256.
    """
    check('prefilter', 'environment', environment, torch.float32, (None, None, 3), (6, None, None, 3))
    if environment.dim() == 4:
        size = environment.shape[1]
        if environment.shape[2] != size or size not in _SIZES:
            raise ValueError('prefilter: faces of a cube must be square, of a power of two in [16, 1024] '
                             f'texels, found {size} x {environment.shape[2]}')
        cube = environment
    else:
        if size not in _SIZES:
            raise ValueError(f'prefilter: size must be a power of two in [16, 1024], found {size!r}')
        cube = _to_cube(environment, size)
    roughness, diffuse, *specular = _functions.prefilter(cube)
    return Light(diffuse, tuple(specular), roughness)


def _to_cube(map: torch.Tensor, size: int) -> torch.Tensor:
    # Halving maps much finer than the cube costs less than more samples for each texel.
    while map.shape[0] > 4 * size and map.shape[0] % 2 == 0 and map.shape[1] % 2 == 0:
        map = map.reshape(map.shape[0] // 2, 2, map.shape[1] // 2, 2, 3).mean((1, 3))
    return _functions.equirectangular(map, size)


def shade(light: Light, *, normal: torch.Tensor, view: torch.Tensor, base_color: torch.Tensor,
          roughness: torch.Tensor | float, metallic: torch.Tensor | float,
          occlusion: torch.Tensor | float = 1.0, normal_map: torch.Tensor | None = None,
          tangent: torch.Tensor | None = None, emissive: torch.Tensor | None = None,
          multiple_scattering: bool = True) -> torch.Tensor:
    """Returns the radiance that leaves points of a surface towards the viewer, linear, of base_color's shape.

        occlusion * ((1 - metallic) * base_color * irradiance(n) + specular(r, roughness) * (F0 A + B))

    with F0 = lerp(0.04, base_color, metallic), plus `emissive`.

    Args:
        light: of `prefilter`. Its maps may require gradients.
        normal: [..., 3] unit normals on the viewer's side. May require gradients, as may all below unless
            it says otherwise. Where a normal or a view is zero, as `interpolate` leaves it where nothing is
            seen, the result is zero.
        view: [..., 3] unit directions from the surface to the camera; no gradients.
        base_color: [..., 3] linear, in [0, 1].
        roughness: [..., 1] perceptual roughness in [0, 1], or a number. Below the light's first (0.08) it
            is that one.
        metallic, occlusion: [..., 1] in [0, 1], or numbers.
        normal_map: [..., 3] directions in tangent space, (0, 0, 1) the surface's own, +y up. Needs a tangent.
        tangent: [..., 4] of the vertices, handedness in the last; no gradients.
        emissive: [..., 3] linear radiance, added.
        multiple_scattering: whether light that bounces between microfacets more than once is kept
            (Turquin 2019).

    Not finite: RuntimeError.
    """
    if not isinstance(light, Light):
        raise TypeError(f'shade: light must be what prefilter() returned, found {type(light).__name__}')
    check('shade', 'base_color', base_color, torch.float32, (*[None] * (base_color.dim() - 1), 3)
          if isinstance(base_color, torch.Tensor) and base_color.dim() else (None, 3))
    points = base_color.shape[:-1]
    for name, tensor, channels in (('normal', normal, 3), ('view', view, 3), ('normal_map', normal_map, 3),
                                   ('tangent', tangent, 4), ('emissive', emissive, 3)):
        if tensor is not None or name in ('normal', 'view'):
            check('shade', name, tensor, torch.float32, (*points, channels))
    if normal_map is not None and tangent is None:
        raise ValueError('shade: normal_map needs a tangent')
    orm = torch.cat([_channel(name, value, base_color) for name, value in
                     (('occlusion', occlusion), ('roughness', roughness), ('metallic', metallic))], -1)

    def rows(tensor):
        return None if tensor is None else tensor.reshape(-1, tensor.shape[-1])

    radiance = _functions.shade(rows(base_color), rows(orm), rows(normal_map), rows(normal),
                                None if tangent is None else rows(tangent.detach()), rows(view.detach()),
                                light, multiple_scattering).reshape(base_color.shape)
    return radiance if emissive is None else radiance + emissive


def _channel(name: str, value, base_color: torch.Tensor) -> torch.Tensor:
    """Returns [..., 1] for a number or a tensor."""
    points = base_color.shape[:-1]
    if isinstance(value, (int, float)):
        return base_color.new_full((*points, 1), float(value))
    check('shade', name, value, torch.float32, (*points, 1))
    return value

def srgb_to_linear(values: torch.Tensor) -> torch.Tensor:
    """Decodes IEC 61966-2-1; the same formula outside of [0, 1]. Float32 of any shape, with gradients."""
    check('srgb_to_linear', 'values', values, torch.float32)
    return _functions.srgb_to_linear(values)


def linear_to_srgb(values: torch.Tensor) -> torch.Tensor:
    """Encodes IEC 61966-2-1; the same formula outside of [0, 1]. Float32 of any shape, with gradients."""
    check('linear_to_srgb', 'values', values, torch.float32)
    return _functions.linear_to_srgb(values)
