"""Rasterisation, interpolation, textures and antialiasing as PyTorch operations with gradients.

Images are [N, H, W, C] with row 0 at the top. N views are rendered at once. Positions of vertices are in clip space as
in OpenGL: x to the right, y up, z/w from -1 at the near plane to 1 at the far plane. Values are
float32, indices are int32. Only first-order gradients are supported.

All tensors of a call are on the CPU, or on one CUDA device (`ranges` may be on the CPU). On the CPU, the operations run on PyTorch's threads
(torch.set_num_threads) and give the same bytes for any number of threads. On a device, they run on PyTorch's current
stream, and the last bits of gradients that many pixels add to depend on the order of the device's threads, whatever
torch.use_deterministic_algorithms says. Checks of values wait for the device.

Errors: TypeError for an argument that is not a tensor or has a wrong dtype, ValueError for a wrong shape,
another kind of device or an unknown choice, RuntimeError for invalid values (NaN, an index without a vertex) and for
tensors on different devices.
"""
from __future__ import annotations

from typing import NamedTuple, Sequence

import torch

from . import _functions
from ._checks import check, check_size, choice
from ._library import ops

FILTERS = {'nearest': 0, 'linear': 1, 'linear-mipmap-nearest': 2, 'linear-mipmap-linear': 3,
           'anisotropic': 4}
BOUNDARIES = {'wrap': 0, 'clamp': 1, 'zero': 2, 'cube': 3}


class Raster(NamedTuple):
    """The visible triangle at each pixel's centre, as `rasterize` returns it."""

    pixels: torch.Tensor
    """[N, H, W, 4]: the weights of the triangle's vertices 0 and 1, the depth, and the triangle's index + 1 as a
    float. Empty pixels are zero. Only the weights carry gradients to the positions."""
    derivatives: torch.Tensor | None = None
    """[N, H, W, 4]: derivatives of weight 0 with respect to x and y in pixels, then those of weight 1; or None."""

    @property
    def barycentrics(self) -> torch.Tensor:
        """[N, H, W, 2] weights of vertices 0 and 1. The weight of vertex 2 is one minus their sum."""
        return self.pixels[..., :2]

    @property
    def depth(self) -> torch.Tensor:
        """[N, H, W] depth, 0 in empty pixels."""
        return self.pixels[..., 2]

    @property
    def triangle(self) -> torch.Tensor:
        """[N, H, W] int64 index of the triangle, -1 in empty pixels."""
        return self.pixels[..., 3].detach().long() - 1

    @property
    def covered(self) -> torch.Tensor:
        """[N, H, W] bool, True if a triangle covers the pixel."""
        return self.pixels[..., 3].detach() > 0


def rasterize(positions: torch.Tensor, triangles: torch.Tensor, size: Sequence[int], *,
              ranges: torch.Tensor | None = None, behind: torch.Tensor | None = None,
              depth: str = 'z', derivatives: bool = False) -> Raster:
    """Finds the visible triangle at each pixel's centre.

    Args:
        positions: [N, V, 4] clip-space (x, y, z, w), or [V, 4] with `ranges`. Must be finite, otherwise
            RuntimeError. May require gradients: weights and their derivatives have gradients with respect to x, y
            and w.
        triangles: [T, 3] int32, indices of vertices; T is at most 16777215. Both sides of a triangle are visible.
        size: (height, width) in pixels, each in [1, 16384].
        ranges: [N, 2] int32, the first triangle and the number of triangles of each view. With it, the views of a
            batch can show different meshes.
        behind: [N, H, W] depths. Each pixel then has the nearest surface behind this depth. The next layer of a
            transparent model has `behind=torch.where(raster.covered, raster.depth, 2)`.
        depth: 'z': depth is z/w, and surfaces before the near plane or beyond the far plane are clipped. 'w': depth
            is w, the distance along a perspective camera's axis, and there is no far plane; `item3d render` uses
            this.
        derivatives: True to return the derivatives of the weights too.

    Adjacent triangles leave no gaps and cover no pixel twice. A pixel centre on an edge belongs to the triangle on the
    right of the edge, or above it if the edge is horizontal. Of triangles at equal depth, the first one is visible.
    """
    check('rasterize', 'positions', positions, torch.float32,
          (None, None, 4) if ranges is None else (None, 4))
    check('rasterize', 'triangles', triangles, torch.int32, (None, 3))
    height, width = check_size('rasterize', 'size', size)
    if ranges is not None:
        check('rasterize', 'ranges', ranges, torch.int32, (None, 2))
    if behind is not None:
        views = positions.shape[0] if ranges is None else ranges.shape[0]
        check('rasterize', 'behind', behind, torch.float32, (views, height, width))
    if not isinstance(derivatives, bool):
        raise TypeError(f'rasterize: derivatives must be True or False, found {derivatives!r}')
    by_w = choice('rasterize', 'depth', depth, {'z': False, 'w': True})
    pixels, by_pixel = _functions.rasterize(positions, triangles, ranges, behind, height, width,
                                            by_w, False, derivatives, True)
    return Raster(pixels, by_pixel if derivatives else None)


def interpolate(attributes: torch.Tensor, raster: Raster, triangles: torch.Tensor, *,
                derivatives: bool | Sequence[int] = False):
    """Interpolates vertex attributes with perspective correction.

    Args:
        attributes: [N, V, A], or [1, V, A] or [V, A] for all views. May require gradients.
        raster: the result of `rasterize`.
        triangles: [T, 3] int32, the triangles of the raster, or as many triangles with other indices, for example
            those of UV coordinates.
        derivatives: True to return the derivatives of all channels too, or a list of D channels. The raster must have
            derivatives.

    Returns the attributes [N, H, W, A], zero in empty pixels. With `derivatives`, returns a pair of the attributes and
    their derivatives [N, H, W, 2 D]: with respect to x and y of the first channel, then of the second, and so on.
    """
    if not isinstance(raster, Raster):
        raise TypeError('interpolate: raster must be what rasterize() returned, found '
                        f'{type(raster).__name__}')
    views = raster.pixels.shape[0]
    check('interpolate', 'attributes', attributes, torch.float32, (views, None, None),
          (1, None, None), (None, None))
    check('interpolate', 'triangles', triangles, torch.int32, (None, 3))
    if derivatives is False:
        return _functions.interpolate(attributes, raster.pixels, triangles, None, [])[0]
    if raster.derivatives is None:
        raise ValueError('interpolate: derivatives need a raster that has them '
                         '(rasterize(..., derivatives=True))')
    channels = list(range(attributes.shape[-1])) if derivatives is True else derivatives
    if not isinstance(channels, (list, tuple)) or not all(type(channel) is int for channel in channels):
        raise TypeError(f'interpolate: derivatives must be True, False or a list of channels, found {derivatives!r}')
    return _functions.interpolate(attributes, raster.pixels, triangles, raster.derivatives, list(channels))


def mipmaps(texture: torch.Tensor, *, max_level: int | None = None,
            cube: bool = False) -> list[torch.Tensor]:
    """Returns the mip levels 1, 2, ... of a texture, with gradients.

    A texel of a level is the mean of 2 x 2 texels of the previous level. An odd side is halved and rounded down, and
    each texel is then the mean of all texels that it overlaps.

    Args:
        texture: [B, H, W, C], or a cube map [B, 6, H, H, C].
        max_level: the last level; None: the level of one texel, or level 15.
        cube: True if the texture is a cube map.
    """
    check('mipmaps', 'texture', texture, torch.float32,
          (None, 6, None, None, None) if cube else (None, None, None, None))
    _check_level('mipmaps', max_level)
    levels, fine = [], texture.flatten(0, 1) if cube else texture
    while max(fine.shape[1:3]) > 1 and len(levels) < (15 if max_level is None else min(max_level, 15)):
        fine = _coarser(fine)
        levels.append(fine.unflatten(0, (-1, 6)) if cube else fine)
    return levels


def _check_level(operation: str, max_level) -> None:
    if max_level is not None and (type(max_level) is not int or max_level < 0):
        raise ValueError(f'{operation}: max_level must be None or a whole number, 0 or more, found {max_level!r}')


_make_mipmaps = mipmaps  # in texture(), a parameter hides the name `mipmaps`


def _coarser(fine: torch.Tensor) -> torch.Tensor:
    height, width = fine.shape[1:3]
    if height % 2 == 0 and width % 2 == 0:
        return _functions.halve(fine)
    size = (max(1, height // 2), max(1, width // 2))
    planes = torch.nn.functional.adaptive_avg_pool2d(fine.permute(0, 3, 1, 2), size)
    return planes.permute(0, 2, 3, 1).contiguous()


def texture(texture: torch.Tensor, uv: torch.Tensor, *, derivatives: torch.Tensor | None = None,
            level_bias: torch.Tensor | None = None, mipmaps: Sequence[torch.Tensor] | None = None,
            filter: str = 'auto', boundary: str = 'wrap',
            max_level: int | None = None) -> torch.Tensor:
    """Samples a texture, with gradients with respect to texels, coordinates, derivatives and bias.

    Args:
        texture: [N or 1, h, w, C], or with boundary='cube' a cube map [N or 1, 6, h, h, C], with the faces +x, -x, +y,
            -y, +z, -z of OpenGL.
        uv: [N, H, W, 2]. (0, 0) is the outer corner of texel [0, 0], and u runs along the rows. For a cube map,
            directions [N, H, W, 3] of any length; a zero or NaN direction gives zeros.
        derivatives: [N, H, W, 4] (6 for a cube map), as `interpolate` returns them: the footprint of a pixel in the
            texture.
        level_bias: [N, H, W], added to the mip level. Without derivatives it is the mip level.
        mipmaps: the mip levels 1, 2, ... of the texture, each of which gets its own gradient. None: they are computed
            from the texture, which gets all gradients.
        filter: 'nearest': the nearest texel. 'linear': bilinear. 'linear-mipmap-nearest' and 'linear-mipmap-linear'
            (trilinear): at the mip level whose texels are as large as the longer axis of the footprint.
            'anisotropic': the filter of `item3d render`, up to eight trilinear samples along this axis; not for cube
            maps, and without gradients with respect to derivatives. 'auto': 'linear-mipmap-linear' with derivatives or
            a bias, otherwise 'linear'.
        boundary: 'wrap' (the texture repeats), 'clamp' (to the nearest texel), 'zero' (zeros outside) or 'cube'.
        max_level: the last mip level that is used; None: all.

    Returns [N, H, W, C].
    """
    cube = choice('texture', 'boundary', boundary, BOUNDARIES) == 3
    if filter == 'auto':
        filter = 'linear' if derivatives is None and level_bias is None else 'linear-mipmap-linear'
    mode = choice('texture', 'filter', filter, FILTERS)
    check('texture', 'uv', uv, torch.float32, (None, None, None, 3 if cube else 2))
    size = tuple(uv.shape[:3])
    tail = (6, None, None, None) if cube else (None, None, None)
    check('texture', 'texture', texture, torch.float32, (size[0], *tail), (1, *tail))
    _check_level('texture', max_level)
    if mode < 2:
        return _functions.texture(texture, (), uv, None, None, mode, BOUNDARIES[boundary])
    if derivatives is None and level_bias is None:
        raise ValueError(f'texture: filter {filter!r} needs derivatives or level_bias')
    if derivatives is not None:
        check('texture', 'derivatives', derivatives, torch.float32, (*size, 6 if cube else 4))
    if level_bias is not None:
        check('texture', 'level_bias', level_bias, torch.float32, size)
    if mode == 4 and (derivatives is None or level_bias is not None or boundary in ('zero', 'cube')):
        raise ValueError("texture: filter 'anisotropic' needs derivatives, no level_bias, and boundary "
                         "'wrap' or 'clamp'")
    own_mips = mipmaps is None
    if own_mips:
        with torch.no_grad():
            mipmaps = _make_mipmaps(texture, max_level=max_level, cube=cube)
    for level, tensor in enumerate(mipmaps, 1):
        check('texture', f'mipmaps[{level - 1}]', tensor, torch.float32,
              (texture.shape[0], *([6] if cube else []), max(1, texture.shape[-3] >> level),
               max(1, texture.shape[-2] >> level), texture.shape[-1]))
    if max_level is not None:
        mipmaps = mipmaps[:max_level]
    return _functions.texture(texture, tuple(mipmaps), uv, derivatives, level_bias, mode,
                              BOUNDARIES[boundary], own_mips)


def topology(triangles: torch.Tensor, positions: torch.Tensor | None = None) -> torch.Tensor:
    """Finds the triangle across each edge, for `antialias`.

    Args:
        triangles: [T, 3] int32.
        positions: [V, 3] or [V, 4]. Vertices with the same (x, y, z) count as one vertex, so that a UV seam is not
            an outline. None: only equal indices count as one vertex.

    Returns [T, 3] int32. For each corner of each triangle, it has 3 * triangle + corner of the neighbour across the
    opposite edge, or -1 if there is none.
    """
    check('topology', 'triangles', triangles, torch.int32, (None, 3))
    if positions is not None:
        check('topology', 'positions', positions, torch.float32, (None, 3), (None, 4))
        positions = positions.detach()[:, :3].contiguous()
    return ops.neighbours(triangles, positions)


def antialias(image: torch.Tensor, raster: Raster, positions: torch.Tensor, triangles: torch.Tensor,
              *, topology: torch.Tensor | None = None) -> torch.Tensor:
    """Antialiases outlines: blends two neighbouring pixels by the position of the outline between their centres.

    This makes coverage differentiable: if a vertex moves, the outline moves with it and the blend changes.

    Args:
        image: [N, H, W, C]. May require gradients.
        raster: the result of `rasterize`.
        positions, triangles: the arguments of `rasterize`. Positions get gradients with respect to x, y and w.
        topology: the result of `topology`, computed once for a mesh. None: computed from the triangles at each call.

    Returns the antialiased image [N, H, W, C].
    """
    if not isinstance(raster, Raster):
        raise TypeError(f'antialias: raster must be what rasterize() returned, found {type(raster).__name__}')
    pixels = raster.pixels
    check('antialias', 'image', image, torch.float32, (*pixels.shape[:3], None))
    check('antialias', 'positions', positions, torch.float32, (pixels.shape[0], None, 4), (None, 4))
    check('antialias', 'triangles', triangles, torch.int32, (None, 3))
    if topology is None:
        topology = ops.neighbours(triangles, None)
    check('antialias', 'topology', topology, torch.int32, (triangles.shape[0], 3))
    return _functions.antialias(image, pixels.detach(), positions, triangles, topology, 256, False)
