"""Helpers of all tests: scenes, finite differences and comparisons."""
import numpy as np
import pytest
import torch


@pytest.fixture(autouse=True)
def seed():
    torch.manual_seed(1)
    np.random.seed(1)


def perspective(near=0.5, far=20.0, size=0.5):
    """Returns OpenGL's projection matrix for a square image."""
    return torch.tensor([[near / size, 0, 0, 0], [0, near / size, 0, 0],
                         [0, 0, -(far + near) / (far - near), -2 * far * near / (far - near)],
                         [0, 0, -1, 0]])


def soup(triangles=12, views=2, distance=3.0, seed=0):
    """Returns random triangles: clip-space positions [N, V, 4] and indices [T, 3].

    The triangles intersect each other, and some intersect the near plane.
    """
    generator = torch.Generator().manual_seed(seed)
    world = torch.rand(views, 3 * triangles, 3, generator=generator) * 4 - 2
    world[..., 2] -= distance
    homogeneous = torch.cat([world, torch.ones(views, 3 * triangles, 1)], -1)
    return homogeneous @ perspective().T, torch.arange(3 * triangles, dtype=torch.int32).view(-1, 3)


def cube():
    """Returns the corners [8, 3] and triangles [12, 3] of a cube with side 2, which face outwards."""
    corners = torch.tensor([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)],
                           dtype=torch.float32)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    return corners, torch.tensor(triangles, dtype=torch.int32)


def turned_cube(angle=0.5, distance=3.2):
    """Returns the cube, rotated by `angle` about two axes: clip-space positions [1, 8, 4] and triangles."""
    corners, triangles = cube()
    c, s = np.cos(angle), np.sin(angle)
    turn = torch.tensor([[c, 0, s], [0, 1, 0], [-s, 0, c]], dtype=torch.float32)
    turn = turn @ torch.tensor([[1, 0, 0], [0, c, -s], [0, s, c]], dtype=torch.float32)
    world = corners @ turn.T - torch.tensor([0, 0, distance])
    clip = torch.cat([world, torch.ones(8, 1)], 1) @ perspective().T
    return clip[None], triangles


def inner_pixels(triangle):
    """Returns the mask [N, H, W] of pixels whose neighbours have the same triangle.

    In these pixels a small step of the vertices does not change the visible triangle.
    """
    inner = triangle >= 0
    for shift in ((0, 1), (1, 0), (0, -1), (-1, 0)):
        inner = inner & (triangle == triangle.roll(shift, (1, 2)))
    assert inner.sum() > 50
    return inner


def differences(f, x, step=1e-3, entries=None):
    """Returns the gradient of the number f(x) by central differences. entries: flat indices; None: all of x."""
    flat = x.detach().reshape(-1)
    entries = range(flat.numel()) if entries is None else entries
    result = []
    for i in entries:
        values = []
        for sign in (1, -1):
            moved = flat.clone()
            moved[i] += sign * step
            values.append((float(f(moved.view(x.shape)).detach()), float(moved[i])))
        result.append((values[0][0] - values[1][0]) / (values[0][1] - values[1][1]))
    return torch.tensor(result, dtype=torch.float64)


def assert_close(found, expected, tolerance):
    """Asserts that the largest difference is at most `tolerance` times the largest expected value."""
    found, expected = found.detach().double(), expected.detach().double()
    assert found.shape == expected.shape
    scale = max(float(expected.abs().max()), 1e-12)
    error = (found - expected).abs()
    worst = int(error.argmax())
    assert float(error.max()) <= tolerance * scale, (
        f'off by {float(error.max()):.3g} of {scale:.3g} at {worst}: found '
        f'{float(found.reshape(-1)[worst]):.6g}, expected {float(expected.reshape(-1)[worst]):.6g}')
