"""Cameras: matrices from world space to clip space, with the conventions of OpenGL.

    camera = item3d.camera((0, 1, 4), size=(512, 512))
    raster = item3d.rasterize(camera.project(positions), triangles, (512, 512))

World and camera space are right-handed with +y up; a camera looks along its -z, with +x to the right. Matrices
multiply column vectors: clip = projection @ world_to_camera @ (x, y, z, 1). Angles are in radians.
"""
from __future__ import annotations

import math
from typing import NamedTuple, Sequence

import torch

from ._checks import check, check_size


class Camera(NamedTuple):
    """N cameras, one for each view.

    A pose of transforms.json becomes Camera(torch.linalg.inv(pose)[None], perspective(...)).
    """

    world_to_camera: torch.Tensor
    """[N, 4, 4], may require gradients."""
    projection: torch.Tensor
    """Projection matrix of `perspective`: [4, 4] for all views, or [N, 4, 4]."""

    def to(self, device) -> Camera:
        """Returns the cameras on a device, with gradients."""
        return Camera(self.world_to_camera.to(device), self.projection.to(device))

    @property
    def world_to_clip(self) -> torch.Tensor:
        """[N, 4, 4] matrices from world space to clip space."""
        with torch.autocast(self.projection.device.type, enabled=False):  # positions need float32
            return self.projection @ self.world_to_camera

    @property
    def position(self) -> torch.Tensor:
        """[N, 3] positions of the cameras in world space."""
        return torch.linalg.inv(self.world_to_camera)[:, :3, 3]

    def project(self, positions: torch.Tensor) -> torch.Tensor:
        """Returns the clip-space positions [N, V, 4] of world-space positions [V, 3] or [N, V, 3].

        Vertices with equal positions get bitwise equal results, so UV seams show no cracks. A matrix product does not
        guarantee this.
        """
        matrix = self.world_to_clip
        check('project', 'camera', matrix, torch.float32, (None, 4, 4))
        check('project', 'positions', positions, torch.float32, (None, 3), (matrix.shape[0], None, 3))
        x, y, z = positions[..., 0:1], positions[..., 1:2], positions[..., 2:3]
        columns = matrix[:, None]
        return columns[..., 0] * x + columns[..., 1] * y + columns[..., 2] * z + columns[..., 3]


def camera(eye, target=(0.0, 0.0, 0.0), *, size: Sequence[int], field_of_view: float = 0.8,
           up=(0.0, 1.0, 0.0), near: float = 0.05, far: float = 100.0) -> Camera:
    """Returns cameras at `eye` that look at `target`.

    Args:
        eye: positions, [3] or [N, 3] (one for each view): numbers, or a tensor, which may require gradients.
        target, up: points to look at, and up directions: [3] or [N, 3].
        size: (height, width) of the images, which gives the aspect ratio.
        field_of_view: horizontal, in radians.
        near, far: distances of the clipping planes.
    """
    pose = look_at(eye, target, up)
    return Camera(pose[None] if pose.dim() == 2 else pose,
                  perspective(field_of_view, size, near=near, far=far).to(pose.device))


def look_at(eye, target=(0.0, 0.0, 0.0), up=(0.0, 1.0, 0.0)) -> torch.Tensor:
    """Returns the world-to-camera matrix [..., 4, 4] of a camera at `eye` [..., 3] that looks at `target`.

    If `up` is parallel to the view direction, as in a view from straight above, -z is up in the image.
    """
    device = next((value.device for value in (eye, target, up) if isinstance(value, torch.Tensor)), 'cpu')
    eye, target, up = (_vectors(name, value, device)
                       for name, value in (('eye', eye), ('target', target), ('up', up)))
    eye, target, up = torch.broadcast_tensors(eye, target, up)
    if (eye == target).all(-1).any():
        raise ValueError('look_at: eye and target must differ')
    backward = torch.nn.functional.normalize(eye - target, dim=-1)
    up = torch.nn.functional.normalize(up, dim=-1)
    along = (up * backward).sum(-1, keepdim=True).abs() > 0.9999
    up = torch.where(along, up.new_tensor([0.0, 0.0, -1.0]), up)
    right = torch.nn.functional.normalize(torch.linalg.cross(up, backward), dim=-1)
    axes = torch.stack([right, torch.linalg.cross(backward, right), backward], -2)
    offset = -(axes * eye[..., None, :]).sum(-1, keepdim=True)
    last = axes.new_tensor([0.0, 0.0, 0.0, 1.0]).expand(*axes.shape[:-2], 1, 4)
    return torch.cat([torch.cat([axes, offset], -1), last], -2)


def perspective(field_of_view: float, size: Sequence[int], *, near: float = 0.05,
                far: float = 100.0) -> torch.Tensor:
    """Returns OpenGL's perspective projection matrix [4, 4], on the CPU.

    Args:
        field_of_view: horizontal, in (0, pi); in the files of the program's --cameras it is camera_angle_x.
        size: (height, width) of the image.
        near, far: distances of the planes at z/w = -1 and 1.
    """
    height, width = check_size('perspective', 'size', size)
    if not 0 < field_of_view < math.pi:
        raise ValueError(f'perspective: field_of_view must be in (0, pi) radians, found {field_of_view!r}')
    if not 0 < near < far:
        raise ValueError(f'perspective: 0 < near < far is wanted, found near={near!r}, far={far!r}')
    focal = 1 / math.tan(field_of_view / 2)
    return torch.tensor([[focal, 0, 0, 0], [0, focal * width / height, 0, 0],
                         [0, 0, -(far + near) / (far - near), -2 * far * near / (far - near)],
                         [0, 0, -1, 0]], dtype=torch.float32, device='cpu')


def _vectors(name: str, value, device) -> torch.Tensor:
    if not isinstance(value, torch.Tensor):
        try:
            value = torch.tensor(value, dtype=torch.float32, device=device)
        except (TypeError, ValueError):
            raise TypeError(f'look_at: {name} must be a tensor or numbers, found {value!r}') from None
    if value.dim() not in (1, 2) or value.shape[-1] != 3:
        raise ValueError(f'look_at: {name} must be of shape [3] or [*, 3], found {list(value.shape)}')
    check('look_at', name, value, torch.float32, tuple(value.shape))
    return value
