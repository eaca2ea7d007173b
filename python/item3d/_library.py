"""Loads the operators of `_operators.so`, and gives torch.compile the shapes of their results. Not public."""
from __future__ import annotations

import os
import re

import torch

_OLDEST = (2, 10)


def _load() -> None:
    match = re.match(r'(\d+)\.(\d+)', torch.__version__)
    if match is None or (int(match[1]), int(match[2])) < _OLDEST:
        raise ImportError(
            f'item3d needs PyTorch {_OLDEST[0]}.{_OLDEST[1]} or newer, found {torch.__version__}: '
            f"pip install 'torch>={_OLDEST[0]}.{_OLDEST[1]}'")
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), '_operators.so')
    if not os.path.exists(path):
        raise ImportError(
            f'{path} is missing: item3d is installed by "pip install .", not used from its sources')
    torch.ops.load_library(path)


_load()
ops = torch.ops.item3d


# Shapes of results. ------------------------------------------------------------------------------

def _picture(like: torch.Tensor, channels) -> torch.Tensor:
    return like.new_empty([like.shape[0], like.shape[1], like.shape[2], channels])


@torch.library.register_fake('item3d::rasterize')
def _(positions, triangles, ranges, behind, height, width, by_w, bottom_up, slopes, finite):
    views = positions.shape[0] if ranges is None else ranges.shape[0]
    return (positions.new_empty([views, height, width, 4]),
            positions.new_empty([views, height, width, 4 if slopes else 0]))


@torch.library.register_fake('item3d::rasterize_backward')
def _(positions, triangles, raster, raster_gradient, slope_gradient, bottom_up):
    return positions.new_empty(positions.shape)


@torch.library.register_fake('item3d::interpolate')
def _(attributes, raster, triangles, slopes, sloped):
    return (_picture(raster, attributes.shape[-1]),
            _picture(raster, 0 if slopes is None else 2 * len(sloped)))


@torch.library.register_fake('item3d::interpolate_backward')
def _(attributes, raster, triangles, slopes, sloped, value_gradient, value_slope_gradient,
      attributes_wanted):
    return (attributes.new_empty(attributes.shape if attributes_wanted else [0]),
            raster.new_empty(raster.shape),
            raster.new_empty([0] if slopes is None else slopes.shape))


@torch.library.register_fake('item3d::texture')
def _(texture, mips, uv, slopes, bias, filter, boundary):
    return _picture(uv, texture.shape[-1])


@torch.library.register_fake('item3d::texture_backward')
def _(texture, mips, uv, slopes, bias, filter, boundary, gradient, texels_wanted, others_wanted):
    def like(tensor):
        return uv.new_empty(tensor.shape if others_wanted and tensor is not None else [0])
    texels = texture.numel() + sum(level.numel() for level in mips)
    return uv.new_empty([texels if texels_wanted else 0]), like(uv), like(slopes), like(bias)


@torch.library.register_fake('item3d::halve')
def _(texture):
    return texture.new_empty(
        [texture.shape[0], texture.shape[1] // 2, texture.shape[2] // 2, texture.shape[3]])


@torch.library.register_fake('item3d::halve_backward')
def _(gradient):
    return gradient.new_empty(
        [gradient.shape[0], 2 * gradient.shape[1], 2 * gradient.shape[2], gradient.shape[3]])


@torch.library.register_fake('item3d::add_halve_backward')
def _(gradient, finer):
    return None


@torch.library.register_fake('item3d::neighbours')
def _(triangles, positions):
    return triangles.new_empty(triangles.shape)


@torch.library.register_fake('item3d::antialias')
def _(image, raster, positions, triangles, neighbours, max_steps, bottom_up):
    return image.new_empty(image.shape)


@torch.library.register_fake('item3d::antialias_backward')
def _(image, raster, positions, triangles, neighbours, gradient, max_steps, bottom_up,
      positions_wanted):
    return (image.new_empty(image.shape),
            positions.new_empty(positions.shape if positions_wanted else [0]))


@torch.library.register_fake('item3d::equirectangular')
def _(map, size):
    return map.new_empty([6, size, size, 3])


@torch.library.register_fake('item3d::equirectangular_backward')
def _(gradient, height, width):
    return gradient.new_empty([height, width, 3])


def chain_sizes(size: int) -> list[int]:
    """Returns the face sizes of a light's specular maps. size: face size of the environment's cube map."""
    sizes = [size >> level for level in range(size.bit_length() - 4)]
    smallest = max(len(sizes) - 2, 0)
    narrow = 8 if smallest > 0 else 1
    return [sizes[i * smallest // narrow] for i in range(narrow)] + [sizes[smallest]] * 4


@torch.library.register_fake('item3d::prefilter')
def _(cube):
    sizes = [128, *chain_sizes(int(cube.shape[1]))]
    return ([cube.new_empty([6, size, size, 3]) for size in sizes],
            [cube.new_empty([size, size]) for size in sizes],
            torch.empty([len(sizes) - 1], device='cpu'), cube.new_empty([64], dtype=torch.int64))


@torch.library.register_fake('item3d::prefilter_backward')
def _(gradients, weights, bright, size):
    return weights[0].new_empty([6, size, size, 3])


@torch.library.register_fake('item3d::shade')
def _(base_color, orm, normal_map, normal, tangent, view, diffuse, specular, roughness, multiple_scattering):
    return base_color.new_empty(base_color.shape)


@torch.library.register_fake('item3d::shade_backward')
def _(base_color, orm, normal_map, normal, tangent, view, diffuse, specular, roughness, multiple_scattering,
      gradient, points_wanted, light_wanted):
    def points(wanted=True):
        return base_color.new_empty(base_color.shape if points_wanted and wanted else [0])
    texels = diffuse.numel() + sum(level.numel() for level in specular)
    return (points(), points(), points(normal_map is not None), points(),
            base_color.new_empty([texels if light_wanted else 0]))


@torch.library.register_fake('item3d::srgb_to_linear')
@torch.library.register_fake('item3d::linear_to_srgb')
def _(values):
    return values.new_empty(values.shape)


@torch.library.register_fake('item3d::srgb_to_linear_backward')
@torch.library.register_fake('item3d::linear_to_srgb_backward')
def _(values, gradient):
    return values.new_empty(values.shape)


@torch.library.register_fake('item3d::tangents')
def _(positions, normals, uvs, triangles):
    return positions.new_empty([triangles.shape[0], 3, 4])
