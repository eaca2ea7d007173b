"""`nvdiffrast.torch` on the CPU and on CUDA devices, with the same functions, arguments and conventions.

    import item3d.nvdiffrast as dr      # was: import nvdiffrast.torch as dr

The module was written from nvdiffrast's documentation, not from its code. As in nvdiffrast, positions are in clip
space, row 0 is at the bottom, and a pixel of a raster is (u, v, z/w, triangle + 1). On a
machine without a GPU, a program must create on 'cpu' what it creates on 'cuda'. docs/python.md lists differences in
results.
"""
from __future__ import annotations

import logging

import torch

from . import _functions
from ._checks import check, check_size, choice
from ._library import ops
from .operations import BOUNDARIES, mipmaps

__all__ = ['RasterizeCudaContext', 'RasterizeGLContext', 'DepthPeeler', 'rasterize', 'interpolate',
           'texture', 'texture_construct_mip', 'antialias', 'antialias_construct_topology_hash',
           'get_log_level', 'set_log_level']

_FILTERS = {'auto': None, 'nearest': 0, 'linear': 1, 'linear-mipmap-nearest': 2,
            'linear-mipmap-linear': 3}
_log = logging.getLogger('item3d.nvdiffrast')
_LEVELS = (logging.INFO, logging.WARNING, logging.ERROR, logging.CRITICAL)
_level = 1


def get_log_level() -> int:
    """Returns the log level: 0 information, 1 warnings (the default), 2 errors, 3 fatal errors."""
    return _level


def set_log_level(level: int) -> None:
    """Sets the level of the logger `item3d.nvdiffrast`; get_log_level() lists the levels."""
    global _level
    if level not in (0, 1, 2, 3):
        raise ValueError(f'set_log_level: level must be 0, 1, 2 or 3, found {level!r}')
    _level = level
    _log.setLevel(_LEVELS[level])


class _Context:
    """Base of the contexts. It has no state; `device` is ignored, because tensors have theirs."""

    def __init__(self, device=None, output_db: bool = True):
        self.device = device
        self.output_db = output_db


class RasterizeCudaContext(_Context):
    """A context for rasterize(). `device` is ignored: rasterize() runs on the device of its tensors."""

    def __init__(self, device=None):
        super().__init__(device)


class RasterizeGLContext(_Context):
    """A context for rasterize().

    output_db: True if rasterize() must return derivatives. mode: 'automatic' or 'manual'. Only in manual mode may
    set_context() and release_context() be called. device: ignored.
    """

    def __init__(self, output_db: bool = True, mode: str = 'automatic', device=None):
        super().__init__(device, output_db)
        self.mode = choice('RasterizeGLContext', 'mode', mode,
                           {'automatic': 'automatic', 'manual': 'manual'})

    def set_context(self) -> None:
        """Does nothing in manual mode. Raises RuntimeError in automatic mode."""
        self._manual('set_context')

    def release_context(self) -> None:
        """Does nothing in manual mode. Raises RuntimeError in automatic mode."""
        self._manual('release_context')

    def _manual(self, name: str) -> None:
        if self.mode != 'manual':
            raise RuntimeError(f"{name}: the context is in automatic mode (RasterizeGLContext(mode='manual'))")


def _check_raster_arguments(glctx, pos, tri, resolution, ranges):
    if not isinstance(glctx, _Context):
        raise TypeError('rasterize: glctx must be a RasterizeCudaContext or RasterizeGLContext of '
                        f'item3d.nvdiffrast, found {type(glctx).__name__}')
    check('rasterize', 'pos', pos, torch.float32, (None, None, 4), (None, 4))
    check('rasterize', 'tri', tri, torch.int32, (None, 3))
    if pos.dim() == 3:
        ranges = None
    elif ranges is None:
        raise ValueError('rasterize: pos of shape [*, 4] (range mode) needs ranges; one mesh for all views '
                         'is pos of shape [minibatch, vertices, 4]')
    else:
        check('rasterize', 'ranges', ranges, torch.int32, (None, 2))
    return check_size('rasterize', 'resolution', resolution), ranges


def _rasterize(glctx, pos, tri, size, ranges, grad_db, behind):
    rast, rast_db = _functions.rasterize(pos, tri, ranges, behind, *size, False, True,
                                         glctx.output_db, False)
    return rast, rast_db if grad_db else rast_db.detach()


def rasterize(glctx, pos: torch.Tensor, tri: torch.Tensor, resolution, ranges: torch.Tensor | None = None,
              grad_db: bool = True) -> tuple[torch.Tensor, torch.Tensor]:
    """Rasterises triangles.

    Args:
        glctx: a context.
        pos: clip-space positions, float32: [minibatch, vertices, 4] (instanced mode) or [vertices, 4] (range
            mode). Triangles with a vertex that is not finite are not drawn.
        tri: [triangles, 3] int32, indices of vertices.
        resolution: (height, width) in pixels.
        ranges: [minibatch, 2] int32, the first triangle and the number of triangles of each image in range mode.
            Ignored in instanced mode.
        grad_db: True if gradients must flow from the derivatives to pos.

    Returns the raster (u, v, z/w, triangle + 1) and its derivatives (du/dX, du/dY, dv/dX, dv/dY), both
    [minibatch, height, width, 4]. The derivatives are [minibatch, height, width, 0] if the context has
    output_db=False.
    """
    size, ranges = _check_raster_arguments(glctx, pos, tri, resolution, ranges)
    return _rasterize(glctx, pos, tri, size, ranges, grad_db, None)


class DepthPeeler:
    """Rasterises one depth layer after another, from front to back. The arguments are those of rasterize().

        with DepthPeeler(glctx, pos, tri, resolution) as peeler:
            rast, rast_db = peeler.rasterize_next_layer()
    """

    def __init__(self, glctx, pos: torch.Tensor, tri: torch.Tensor, resolution,
                 ranges: torch.Tensor | None = None, grad_db: bool = True):
        self._size, self._ranges = _check_raster_arguments(glctx, pos, tri, resolution, ranges)
        self._arguments = (glctx, pos, tri)
        self._grad_db = grad_db
        self._behind = None
        self._active = False

    def __enter__(self) -> DepthPeeler:
        self._active, self._behind = True, None
        return self

    def __exit__(self, *_) -> None:
        self._active, self._behind = False, None

    def rasterize_next_layer(self) -> tuple[torch.Tensor, torch.Tensor]:
        """Returns the results of rasterize() for the next layer, the nearest surface behind the previous layer.

        Raises RuntimeError outside of the `with` block.
        """
        if not self._active:
            raise RuntimeError('rasterize_next_layer: a DepthPeeler is used inside of its with block')
        rast, rast_db = _rasterize(*self._arguments, self._size, self._ranges, self._grad_db,
                                   self._behind)
        pixels = rast.detach()
        # Where no surface was seen, a depth beyond the far plane (1) excludes all surfaces from the next layer.
        self._behind = torch.where(pixels[..., 3] > 0, pixels[..., 2], 2.0)
        return rast, rast_db


def interpolate(attr: torch.Tensor, rast: torch.Tensor, tri: torch.Tensor,
                rast_db: torch.Tensor | None = None,
                diff_attrs=None) -> tuple[torch.Tensor, torch.Tensor]:
    """Interpolates vertex attributes.

    Args:
        attr: float32 [minibatch or 1, vertices, attributes] or, in range mode, [vertices, attributes].
        rast: the raster that rasterize() returned.
        tri: [triangles, 3] int32, the triangles of the raster.
        rast_db: the derivatives that rasterize() returned, which diff_attrs needs.
        diff_attrs: indices of the attributes whose derivatives to return, or 'all'.

    Returns the attributes [minibatch, height, width, attributes], zero in empty pixels, and the derivatives with
    respect to X and Y of the attributes in diff_attrs, [minibatch, height, width, 2 * len(diff_attrs)].
    """
    check('interpolate', 'rast', rast, torch.float32, (None, None, None, 4))
    check('interpolate', 'attr', attr, torch.float32, (rast.shape[0], None, None), (1, None, None),
          (None, None))
    check('interpolate', 'tri', tri, torch.int32, (None, 3))
    if rast_db is None or diff_attrs is None:
        if diff_attrs is not None:
            raise ValueError('interpolate: diff_attrs needs rast_db')
        return _functions.interpolate(attr, rast, tri, None, [])
    check('interpolate', 'rast_db', rast_db, torch.float32, tuple(rast.shape))
    if isinstance(diff_attrs, str):
        choice('interpolate', 'diff_attrs', diff_attrs, {'all': None})
        diff_attrs = range(attr.shape[-1])
    return _functions.interpolate(attr, rast, tri, rast_db, [int(i) for i in diff_attrs])


class _Mipmaps:
    """Mip levels, as texture_construct_mip() returns them."""

    def __init__(self, levels: list[torch.Tensor], cube: bool):
        self.levels = levels
        self.cube = cube


def _construct_mip(operation: str, tex: torch.Tensor, max_mip_level: int | None,
                   cube: bool) -> list[torch.Tensor]:
    height, width = tex.shape[-3], tex.shape[-2]
    level = 0
    while max(height, width) > 1 and (max_mip_level is None or level < max_mip_level):
        if any(side > 1 and side % 2 for side in (height, width)):
            raise ValueError(f'{operation}: level {level} has {height} x {width} texels, which cannot be '
                             f'halved (sides that are powers of two, or max_mip_level={level})')
        height, width, level = max(1, height // 2), max(1, width // 2), level + 1
    return mipmaps(tex, max_level=level, cube=cube)


def texture_construct_mip(tex: torch.Tensor, max_mip_level: int | None = None,
                          cube_mode: bool = False) -> _Mipmaps:
    """Computes the mip levels of a constant texture once, for the argument `mip` of texture().

    tex and max_mip_level are as in texture(). cube_mode: True if tex is a cube map.
    """
    check('texture_construct_mip', 'tex', tex, torch.float32,
          (None, 6, None, None, None) if cube_mode else (None, None, None, None))
    return _Mipmaps(_construct_mip('texture_construct_mip', tex, max_mip_level, cube_mode), cube_mode)


def texture(tex: torch.Tensor, uv: torch.Tensor, uv_da: torch.Tensor | None = None,
            mip_level_bias: torch.Tensor | None = None, mip=None, filter_mode: str = 'auto',
            boundary_mode: str = 'wrap', max_mip_level: int | None = None) -> torch.Tensor:
    """Samples a texture.

    Args:
        tex: float32 [minibatch or 1, height, width, channels]. With boundary_mode 'cube' it is a cube map,
            [minibatch or 1, 6, height, height, channels].
        uv: [minibatch, height, width, 2], or directions [minibatch, height, width, 3] for a cube map.
        uv_da: derivatives of uv with respect to X and Y, [minibatch, height, width, 4], or 6 for a cube map: for
            each coordinate first X, then Y.
        mip_level_bias: [minibatch, height, width], added to the mip level. Without uv_da it is the mip level.
        mip: the result of texture_construct_mip(), or a list of the mip levels 1, 2, ..., each of which then gets its
            own gradient.
        filter_mode: 'auto', 'nearest', 'linear', 'linear-mipmap-nearest' or 'linear-mipmap-linear'.
        boundary_mode: 'wrap', 'clamp', 'zero' or 'cube'.
        max_mip_level: the last mip level that is computed and used.

    Returns [minibatch, height, width, channels].
    """
    mode = choice('texture', 'filter_mode', filter_mode, _FILTERS)
    boundary = choice('texture', 'boundary_mode', boundary_mode, BOUNDARIES)
    cube = boundary == 3
    check('texture', 'uv', uv, torch.float32, (None, None, None, 3 if cube else 2))
    size = tuple(uv.shape[:3])
    tail = (6, None, None, None) if cube else (None, None, None)
    check('texture', 'tex', tex, torch.float32, (size[0], *tail), (1, *tail))
    if mode is None:
        mode = 1 if uv_da is None and mip_level_bias is None else 3
    if max_mip_level is not None:
        if max_mip_level < 0:
            raise ValueError(f'texture: max_mip_level must be at least 0, found {max_mip_level}')
        if max_mip_level == 0 and mode > 1:
            mode = 1
    if mode < 2:
        return _functions.texture(tex, (), uv, None, None, mode, boundary)
    if uv_da is None and mip_level_bias is None:
        raise ValueError(f'texture: filter_mode {filter_mode!r} needs uv_da or mip_level_bias')
    if uv_da is not None:
        check('texture', 'uv_da', uv_da, torch.float32, (*size, 6 if cube else 4))
    if mip_level_bias is not None:
        check('texture', 'mip_level_bias', mip_level_bias, torch.float32, size)
    own_mips = mip is None
    if own_mips:
        with torch.no_grad():
            levels = _construct_mip('texture', tex, max_mip_level, cube)
    else:
        if isinstance(mip, _Mipmaps) and mip.cube != cube:
            raise ValueError('texture: mip and tex must both be cube maps, or neither')
        levels = list(mip.levels if isinstance(mip, _Mipmaps) else mip)[:max_mip_level]
    for level, tensor in enumerate(levels, 1):
        check('texture', f'mip[{level - 1}]', tensor, torch.float32,
              (tex.shape[0], *([6] if cube else []), max(1, tex.shape[-3] >> level),
               max(1, tex.shape[-2] >> level), tex.shape[-1]))
    return _functions.texture(tex, tuple(levels), uv, uv_da, mip_level_bias, mode, boundary, own_mips)


class _Topology:
    """Neighbours of triangles, as antialias_construct_topology_hash() returns them."""

    def __init__(self, neighbours: torch.Tensor):
        self.neighbours = neighbours


def antialias_construct_topology_hash(tri: torch.Tensor) -> _Topology:
    """Finds the triangles of [triangles, 3] int32 that share edges, for the argument `topology_hash` of antialias()."""
    check('antialias_construct_topology_hash', 'tri', tri, torch.int32, (None, 3))
    return _Topology(ops.neighbours(tri, None))


def antialias(color: torch.Tensor, rast: torch.Tensor, pos: torch.Tensor, tri: torch.Tensor,
              topology_hash: _Topology | None = None, pos_gradient_boost: float = 1.0) -> torch.Tensor:
    """Antialiases outlines, with gradients with respect to pos.

    Args:
        color: [minibatch, height, width, channels].
        rast: the raster that rasterize() returned.
        pos, tri: the arguments of rasterize().
        topology_hash: the result of antialias_construct_topology_hash(); None: computed at each call.
        pos_gradient_boost: factor of the gradients with respect to pos.

    Returns the antialiased image [minibatch, height, width, channels].
    """
    check('antialias', 'rast', rast, torch.float32, (None, None, None, 4))
    check('antialias', 'color', color, torch.float32, (*rast.shape[:3], None))
    check('antialias', 'pos', pos, torch.float32, (rast.shape[0], None, 4), (None, 4))
    check('antialias', 'tri', tri, torch.int32, (None, 3))
    if topology_hash is None:
        topology_hash = antialias_construct_topology_hash(tri)
    elif not isinstance(topology_hash, _Topology):
        raise TypeError('antialias: topology_hash must be of antialias_construct_topology_hash(), found '
                        f'{type(topology_hash).__name__}')
    check('antialias', "topology_hash's triangles", topology_hash.neighbours, torch.int32,
          tuple(tri.shape))
    if pos_gradient_boost != 1.0 and pos.requires_grad:
        still = pos.detach()
        pos = still + (pos - still) * pos_gradient_boost
    return _functions.antialias(color, rast.detach(), pos, tri, topology_hash.neighbours, 1, True)


if __name__ == '__main__':
    import sys
    from ._nvdiffrast_runner import main
    sys.exit(main())
