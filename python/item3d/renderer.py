"""Renders images of models with the package's operations, in the same way as `item3d render`.

    model = item3d.load('mug.glb')
    camera = item3d.camera((0, 0.1, 0.3), size=(512, 512), near=0.01, far=10)
    image = item3d.render(model, camera, item3d.prefilter(environment), (512, 512))

Images are linear; `linear_to_srgb` converts them to sRGB, for example for a PNG file.
"""
from __future__ import annotations

from typing import Sequence

import torch

from . import operations
from ._checks import check, check_size
from .cameras import Camera
from .model import Model
from .model_geometry import Geometry
from .model_materials import Materials, Surface
from .shading import Light, shade

_MAX_LAYERS = 8


def render(model: Model, camera: Camera, light: Light, size: Sequence[int], *, samples: int = 2,
           background: Sequence[float] | torch.Tensor | None = None,
           multiple_scattering: bool = True) -> torch.Tensor:
    """Renders one image of a model for each camera, with gradients with respect to all tensors of the arguments.

    Args:
        model: a model from `load`, or one built from tensors (Model). Positions, normals, UVs, colours, textures and
            factors may require gradients. The gradients of positions include those of outlines.
        camera: cameras from `camera`, made for the same `size`.
        light: a light from `prefilter`.
        size: (height, width) in pixels.
        samples: number of samples along each side of a pixel. Outlines are antialiased in addition.
        background: linear RGB behind the model; None: transparent.
        multiple_scattering: see `shade`.

    Model, cameras and light must be on one device (their method `to` moves them).

    Returns [N, H, W, 4]: linear radiance, premultiplied by coverage, and coverage.

    Transparent materials are rendered in up to eight layers. Shadows, occlusion by the model itself and light between
    surfaces (`item3d render --occlusion --indirect`) are not computed. All views are rendered at once, so the memory
    grows with their number.
    """
    if not isinstance(model, Model):
        raise TypeError(f'render: model must be an item3d.Model, found {type(model).__name__}')
    if not isinstance(camera, Camera):
        raise TypeError(f'render: camera must be an item3d.Camera, found {type(camera).__name__}')
    if not isinstance(light, Light):
        raise TypeError(f'render: light must be what prefilter() returned, found {type(light).__name__}')
    check('render', 'camera.world_to_camera', camera.world_to_camera, torch.float32, (None, 4, 4))
    height, width = check_size('render', 'size', size)
    if isinstance(samples, bool) or not isinstance(samples, int) or not 1 <= samples <= 16:
        raise ValueError(f'render: samples must be a whole number in [1, 16], found {samples!r}')
    fine = check_size('render', 'size * samples', (height * samples, width * samples))

    geometry, materials = Geometry(model), Materials(model)
    clip = camera.project(geometry.positions)
    eyes = camera.position

    def layer(raster):
        surface = geometry.surface(raster, eyes, tangents=materials.any_normal)
        color = _shaded(surface, materials, light, multiple_scattering)
        pixels = raster.pixels[..., 3].numel()
        return color.new_zeros(pixels, 4).index_copy(0, surface.pixel, color).view(*raster.pixels.shape[:3], 4)

    def rasterize(behind=None):
        return operations.rasterize(clip, geometry.triangles, fine, behind=behind, depth='w', derivatives=True)

    first = rasterize()
    picture = layer(first)
    if materials.any_alpha:
        seen = first
        for _ in range(_MAX_LAYERS - 1):
            is_open = (picture[..., 3].detach() < 0.999) & seen.covered
            if not is_open.any():
                break
            # For opaque and empty pixels the layer must be empty, so they ask for surfaces behind a huge depth.
            seen = rasterize(torch.where(is_open, seen.depth.detach(), 1e30))
            picture = picture + (1 - picture[..., 3:]) * layer(seen)
    if background is not None:
        picture = picture + (1 - picture[..., 3:]) * _opaque(background, picture)
    picture = operations.antialias(picture, first, clip, geometry.triangles, topology=geometry.topology)
    if samples == 1:
        return picture
    return picture.view(-1, height, samples, width, samples, 4).mean((2, 4))


def _shaded(surface: Surface, materials: Materials, light: Light, multiple_scattering: bool) -> torch.Tensor:
    """Returns the radiance, premultiplied by alpha, and alpha at the surface's points, [P, 4]."""
    sample = materials.sample(surface)
    radiance = shade(light, normal=surface.normal, view=surface.view, base_color=sample.base_color,
                     occlusion=sample.orm[:, 0:1], roughness=sample.orm[:, 1:2], metallic=sample.orm[:, 2:3],
                     normal_map=sample.normal, tangent=surface.tangent if sample.normal is not None else None,
                     emissive=sample.emissive, multiple_scattering=multiple_scattering)
    if sample.alpha is None:
        return torch.cat([radiance, radiance.new_ones(radiance.shape[0], 1)], 1)
    return torch.cat([radiance * sample.alpha, sample.alpha], 1)


def _opaque(background, picture: torch.Tensor) -> torch.Tensor:
    color = torch.as_tensor(background, dtype=torch.float32, device=picture.device)
    if color.shape != (3,):
        raise ValueError(f'render: background must be three numbers, linear RGB, found {background!r}')
    return torch.cat([color, picture.new_ones(1)])
