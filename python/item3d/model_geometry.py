"""Geometry of a model for rendering, and its attributes at visible points. Not public."""
from __future__ import annotations

from typing import NamedTuple

import torch
from torch.nn.functional import normalize

from . import operations
from ._checks import check
from ._library import ops
from .model import Model


class Surface(NamedTuple):
    """Surface attributes at the P pixels that the model covers."""

    pixel: torch.Tensor
    """[P] int64 index of the pixel among all N * H * W pixels."""
    material: torch.Tensor
    """[P] int64 index into Model.materials."""
    normal: torch.Tensor
    """[P, 3] unit normals on the viewer's side."""
    view: torch.Tensor
    """[P, 3] unit directions from the surface to the camera."""
    tangent: torch.Tensor | None
    """[P, 4] tangents, the last component is the handedness. None: not wanted."""
    uvs: list[torch.Tensor]
    """For each UV map, its coordinates [P, 2]."""
    footprints: list[torch.Tensor]
    """For each UV map, its derivatives [P, 4]: du/dx, du/dy, dv/dx, dv/dy, per pixel."""
    colors: torch.Tensor | None
    """[P, 4] linear vertex colours. None: no primitive has any."""


class Geometry:
    """All primitives of a model as one mesh."""

    def __init__(self, model: Model):
        if not model.primitives:
            raise ValueError('render: model must have a primitive')
        _check(model)
        parts, first, triangles = model.primitives, 0, []
        for part in parts:
            triangles.append(part.triangles + first)
            first += len(part.positions)
        self.triangles = torch.cat(triangles)
        self.positions = torch.cat([part.positions for part in parts])
        self.material = torch.cat([torch.full((len(part.triangles),), part.material, device=part.positions.device)
                                    for part in parts])
        self.topology = self._topology_of(model)
        maps = 1 + max(max(part.further_uvs, default=0) for part in parts)
        columns = [self.positions, torch.cat([part.normals for part in parts])]
        columns += [torch.cat([_uvs(part, k) for part in parts]) for k in range(maps)]
        self._maps = maps
        self._has_colors = any(part.colors is not None for part in parts)
        if self._has_colors:
            columns.append(torch.cat([part.positions.new_ones(len(part.positions), 4)
                                      if part.colors is None else part.colors for part in parts]))
        self._attributes = torch.cat(columns, 1)
        self._model = model

    def _topology_of(self, model: Model) -> torch.Tensor:
        """Returns the topology of the model's last image if its mesh has not changed since, or makes it."""
        positions = self.positions.detach()
        for triangles, at, topology in model._topology:
            if at.device == positions.device and torch.equal(triangles, self.triangles) and torch.equal(at, positions):
                return topology
        topology = operations.topology(self.triangles, positions)
        if not torch.is_inference_mode_enabled():  # autograd could not use what was made there
            model._topology[:] = [(self.triangles, positions, topology)]
        return topology

    def surface(self, raster: operations.Raster, eyes: torch.Tensor, *, tangents: bool) -> Surface:
        """Returns the surface at the covered pixels.

        raster: raster of this geometry's triangles. eyes: [N, 3] positions of the cameras. tangents: True to compute
        tangents.
        """
        uv_channels = list(range(6, 6 + 2 * self._maps))
        values, slopes = operations.interpolate(self._attributes, raster, self.triangles, derivatives=uv_channels)
        triangle = raster.triangle.flatten()
        pixel = (triangle >= 0).nonzero().squeeze(1)
        triangle = triangle[pixel]

        def rows(picture):
            return picture.flatten(0, 2).index_select(0, pixel)

        values, slopes = rows(values), rows(slopes.detach())
        view_index = pixel // (raster.pixels.shape[1] * raster.pixels.shape[2])
        view = normalize(eyes.index_select(0, view_index) - values[:, :3], dim=1)
        corners = self.positions[self.triangles.long()]
        faces = torch.linalg.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        face = faces.index_select(0, triangle)
        normal = values[:, 3:6]
        normal = normalize(torch.where(normal.square().sum(1, True) > 1e-20, normal, face), dim=1, eps=1e-15)
        # A point is on the back if the viewer and the normal are on different sides of the triangle's plane. The normal
        # alone would be wrong near outlines, where it turns away from the viewer. The winding alone would be wrong for
        # meshes with wrong winding. As in glTF, the whole tangent frame of a back is negated.
        is_back = ((normal * face).sum(1, True) * (view * face).sum(1, True)).detach() < 0
        sign = 1 - 2 * is_back.to(torch.float32)
        tangent = None
        if tangents:
            tangent = self._tangents(raster, rows) * sign
        uvs = [values[:, 6 + 2 * k:8 + 2 * k] for k in range(self._maps)]
        footprints = [slopes[:, 4 * k:4 * k + 4] for k in range(self._maps)]
        colors = values[:, 6 + 2 * self._maps:] if self._has_colors else None
        return Surface(pixel, self.material.index_select(0, triangle), normal * sign, view, tangent, uvs,
                       footprints, colors)

    def _tangents(self, raster, rows) -> torch.Tensor:
        corners = torch.cat([_corner_tangents(part, self._model.materials[part.material])
                             for part in self._model.primitives])
        indices = torch.arange(len(corners), dtype=torch.int32, device=corners.device).view(-1, 3)
        values = rows(operations.interpolate(corners, operations.Raster(raster.pixels.detach()), indices))
        # At a mirrored seam the interpolated handedness would pass through zero, so only its sign is used.
        return torch.cat([values[:, :3], values[:, 3:].sign()], 1)


def _uvs(part, index: int) -> torch.Tensor:
    uvs = part.uvs if index == 0 else part.further_uvs.get(index)
    return part.positions.new_zeros(len(part.positions), 2) if uvs is None else uvs


def _corner_tangents(part, material) -> torch.Tensor:
    """Returns the tangents of all triangle corners, [3 T, 4].

    These are the file's tangents. If the file has none, MikkTSpace computes them for the UV map of the normal texture.
    Without a normal texture or UV map they are zero.
    """
    if part.tangents is not None:
        return part.tangents.detach()[part.triangles.long()].flatten(0, 1)
    uvs = part.uvs if material.normal_uvs == 0 else part.further_uvs.get(material.normal_uvs)
    if uvs is None or material.normal_texture < 0:
        return part.positions.new_zeros(3 * len(part.triangles), 4)
    return ops.tangents(part.positions.detach(), part.normals.detach(), uvs.detach(), part.triangles).flatten(0, 1)


def _check(model: Model) -> None:
    for i, part in enumerate(model.primitives):
        name = f'primitives[{i}]'
        check('render', f'{name}.positions', part.positions, torch.float32, (None, 3))
        count = len(part.positions)
        check('render', f'{name}.normals', part.normals, torch.float32, (count, 3))
        check('render', f'{name}.triangles', part.triangles, torch.int32, (None, 3))
        maps = {'uvs': part.uvs, **{f'further_uvs[{k}]': uvs for k, uvs in part.further_uvs.items()}}
        for map_name, uvs in maps.items():
            if uvs is not None:
                check('render', f'{name}.{map_name}', uvs, torch.float32, (count, 2))
        for extra in ('tangents', 'colors'):
            if getattr(part, extra) is not None:
                check('render', f'{name}.{extra}', getattr(part, extra), torch.float32, (count, 4))
        if not 0 <= part.material < len(model.materials):
            raise ValueError(f'render: {name}.material must be in [0, {len(model.materials)}), found '
                             f'{part.material!r}')
