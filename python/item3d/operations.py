"""Rasterisation, interpolation, textures and antialiasing as PyTorch operations with gradients.

Images are [N, H, W, C] with row 0 at the top; N views are rendered at once. Vertices are in clip space, x to the
right, y up, z/w from -1 at the near plane to 1 at the far plane, as in OpenGL. All tensors are float32 on the CPU,
indices int32; the operations run on PyTorch's threads (torch.set_num_threads) and give the same bytes for any
number of threads. Only first-order gradients are supported.

Errors: TypeError (not a tensor, or a wrong dtype), ValueError (wrong shape or device, unknown choice), and
RuntimeError for invalid values (an index without a vertex, NaN).
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
    """What is seen at each pixel's centre, of `rasterize`."""

    pixels: torch.Tensor
    """[N, H, W, 4]: the weights of the triangle's vertices 0 and 1, depth, and the triangle's index + 1 as a
    float; zeros where nothing is seen. The weights carry gradients to the positions, the others none."""
    derivatives: torch.Tensor | None = None
    """[N, H, W, 4]: d weight 0 by a pixel in x, in y, then the same of weight 1; or None."""

    @property
    def barycentrics(self) -> torch.Tensor:
        """[N, H, W, 2] weights of vertices 0 and 1; that of vertex 2 is what is missing from 1."""
        return self.pixels[..., :2]

    @property
    def depth(self) -> torch.Tensor:
        """[N, H, W], 0 where nothing is seen."""
        return self.pixels[..., 2]

    @property
    def triangle(self) -> torch.Tensor:
        """[N, H, W] int64, index into the triangles, -1 where nothing is seen."""
        return self.pixels[..., 3].detach().long() - 1

    @property
    def covered(self) -> torch.Tensor:
        """[N, H, W] bool, whether anything is seen."""
        return self.pixels[..., 3].detach() > 0


def rasterize(positions: torch.Tensor, triangles: torch.Tensor, size: Sequence[int], *,
              ranges: torch.Tensor | None = None, behind: torch.Tensor | None = None,
              depth: str = 'z', derivatives: bool = False) -> Raster:
    """Finds the triangle that is seen at each pixel's centre.

    Args:
        positions: [N, V, 4] clip-space (x, y, z, w), or [V, 4] with `ranges`. Not finite: RuntimeError. May
            require gradients: of the weights and their derivatives, by x, y and w.
        triangles: [T, 3] int32, indices of vertices; at most 16777215. Both sides are seen.
        size: (height, width) in pixels, each in [1, 16384].
        ranges: [N, 2] int32, the first triangle and the number of triangles of each view: different meshes in
            one batch.
        behind: [N, H, W] depths; a pixel sees the nearest surface that is farther. The next layer of a
            transparent model is found with `torch.where(raster.covered, raster.depth, 2)`.
        depth: 'z': the nearest has the least z/w, which is the raster's depth, and what lies before the near or
            beyond the far plane is not seen. 'w': the least w, the distance along a perspective camera's
            axis, without a far plane; the program's own order.
        derivatives: whether to return how the weights change from a pixel to the next.

    Edges between triangles leave no gaps and no pixel twice; a centre on an edge belongs to the triangle on its
    right, or above a horizontal one. At equal depth the first triangle is seen.
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
    by_w = choice('rasterize', 'depth', depth, {'z': False, 'w': True})
    pixels, by_pixel = _functions.rasterize(positions, triangles, ranges, behind, height, width,
                                            by_w, False, derivatives, True)
    return Raster(pixels, by_pixel if derivatives else None)


def interpolate(attributes: torch.Tensor, raster: Raster, triangles: torch.Tensor, *,
                derivatives: bool | Sequence[int] = False):
    """Interpolates attributes of vertices with perspective.

    Args:
        attributes: [N, V, A], or one for all views [1, V, A] or [V, A]. May require gradients.
        raster: of `rasterize`.
        triangles: [T, 3] int32, those of the raster or others as many (of UVs with seams of their own).
        derivatives: True, or the channels whose change from a pixel to the next is wanted; the raster must
            have its own.

    Returns [N, H, W, A], zeros where nothing is seen; with derivatives a pair with [N, H, W, 2 D]: by x and by
    y of the first channel, and so on.
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
    channels = list(range(attributes.shape[-1])) if derivatives is True else list(derivatives)
    return _functions.interpolate(attributes, raster.pixels, triangles, raster.derivatives, channels)


def mipmaps(texture: torch.Tensor, *, max_level: int | None = None,
            cube: bool = False) -> list[torch.Tensor]:
    """Returns levels 1, 2, ... of a texture, each the mean of 2 x 2 texels of the one before, with gradients.

    Args:
        texture: [B, H, W, C], or with `cube` [B, 6, H, H, C]. Sides that are odd are averaged over the nearest
            whole number of halves.
        max_level: the last level; None: down to one texel, at most level 15.
    """
    check('mipmaps', 'texture', texture, torch.float32,
          (None, 6, None, None, None) if cube else (None, None, None, None))
    levels, fine = [], texture.flatten(0, 1) if cube else texture
    while max(fine.shape[1:3]) > 1 and len(levels) < (15 if max_level is None else min(max_level, 15)):
        fine = _coarser(fine)
        levels.append(fine.unflatten(0, (-1, 6)) if cube else fine)
    return levels


_make_mipmaps = mipmaps  # `texture` has a parameter of that name


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
    """Looks a texture up, with gradients by texels, coordinates, derivatives and bias.

    Args:
        texture: [N or 1, h, w, C]; a cube map, with boundary='cube': [N or 1, 6, h, h, C], faces +x, -x, +y,
            -y, +z, -z as OpenGL has them.
        uv: [N, H, W, 2], (0, 0) the outer corner of texel [0, 0], u along rows; of a cube map directions
            [N, H, W, 3] of any length, where zero and NaN give zeros.
        derivatives: [N, H, W, 4] (cube 6) of `interpolate`: the footprint of a pixel.
        level_bias: [N, H, W], added to the level; without derivatives it is the level.
        mipmaps: levels 1, 2, ... of the texture, which get gradients of their own; None: made of the texture
            (`mipmaps`), which gets all gradients.
        filter: 'nearest'; 'linear' between four texels; 'linear-mipmap-nearest' and 'linear-mipmap-linear'
            (trilinear) at the level whose texels are as large as the footprint's longer axis; 'anisotropic':
            up to eight trilinear lookups along that axis, the program's own (no cube, no gradients by
            derivatives). 'auto': 'linear-mipmap-linear' with derivatives or a bias, 'linear' without.
        boundary: 'wrap' (repeats), 'clamp' (the nearest texel), 'zero' (zeros outside) or 'cube'.
        max_level: the last level that is made; None: all.

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
        mipmaps = mipmaps[:max(0, max_level)]
    return _functions.texture(texture, tuple(mipmaps), uv, derivatives, level_bias, mode,
                              BOUNDARIES[boundary], own_mips)


def topology(triangles: torch.Tensor, positions: torch.Tensor | None = None) -> torch.Tensor:
    """Finds the triangle across each edge, for `antialias`.

    Args:
        triangles: [T, 3] int32.
        positions: [V, 3] or [V, 4]: vertices at one place (x, y, z) are one, so that a seam of UVs is no
            outline. None: only vertices of one index are.

    Returns [T, 3] int32: 3 * triangle + corner of what lies across the edge that faces each corner, -1: nothing.
    """
    check('topology', 'triangles', triangles, torch.int32, (None, 3))
    if positions is not None:
        check('topology', 'positions', positions, torch.float32, (None, 3), (None, 4))
        positions = positions.detach()[:, :3].contiguous()
    return ops.neighbours(triangles, positions)


def antialias(image: torch.Tensor, raster: Raster, positions: torch.Tensor, triangles: torch.Tensor,
              *, topology: torch.Tensor | None = None) -> torch.Tensor:
    """Blends pixels across outlines by the exact position of the outline between their centres.

    This gives images gradients with respect to coverage: a vertex moves an outline, which changes the blend.

    Args:
        image: [N, H, W, C]. May require gradients.
        raster, positions, triangles: what was rasterised. Positions get gradients by x, y and w.
        topology: of `topology`, to be made once for a mesh; None: made of the triangles at each call.

    Returns [N, H, W, C].
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
