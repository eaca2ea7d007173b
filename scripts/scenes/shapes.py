"""Triangle meshes for the scenes, as tuples (vertices, texture coordinates, normals, faces). +Y is up."""
import numpy as np


def lathe(profile, segments=96):
    """Returns the surface of revolution of a curve of (radius, height) about the Y axis.

    Texture coordinate u runs around the axis, v along the curve.
    """
    profile = np.asarray(profile, float)
    along = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(profile, axis=0), axis=1))])
    angle = np.linspace(0, 2 * np.pi, segments + 1)
    radius, height = profile[:, :1], profile[:, 1:]
    vertices = np.stack([radius * np.sin(angle), np.broadcast_to(height, (len(profile), len(angle))),
                         radius * np.cos(angle)], -1)
    uv = np.stack(np.broadcast_arrays((angle / (2 * np.pi))[None], (1 - along / along[-1])[:, None]), -1)
    return grid(vertices, uv)


def smooth_profile(points, steps=12):
    """Returns points on a Catmull-Rom spline through the given points."""
    p = np.asarray(points, float)
    p = np.concatenate([2 * p[:1] - p[1:2], p, 2 * p[-1:] - p[-2:-1]])
    t = np.linspace(0, 1, steps, endpoint=False)[:, None]
    pieces = [0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t**2 + (3 * b - a - 3 * c + d) * t**3)
              for a, b, c, d in zip(p, p[1:], p[2:], p[3:])]
    return np.concatenate(pieces + [p[-2:-1]])


def tube(path, radius, sides=24):
    """Returns a tube along a path. radius: a number, or one for each point of the path."""
    path = np.asarray(path, float)
    radius = np.broadcast_to(np.asarray(radius, float), (len(path),))
    tangent = np.gradient(path, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    side = np.cross(tangent[0], [0.3, 1, 0.2])
    rings = []
    angle = np.linspace(0, 2 * np.pi, sides + 1)
    for point, t, r in zip(path, tangent, radius):
        side = side - t * (side @ t)  # parallel transport along the path
        side /= np.linalg.norm(side)
        rings.append(point + r * (np.cos(angle)[:, None] * side + np.sin(angle)[:, None] * np.cross(t, side)))
    v = np.linspace(0, 1, len(path))
    uv = np.stack(np.broadcast_arrays((angle / (2 * np.pi))[None], v[:, None]), -1)
    return grid(np.array(rings), uv)


def sphere(centre, radius, rings=48):
    angle = np.linspace(-np.pi / 2, np.pi / 2, rings)
    return moved(lathe(np.stack([np.cos(angle), np.sin(angle)], 1), 2 * rings), centre, radius)


def box(centre, size, bevel=0.02):
    """Returns a box with rounded edges, made by moving the octants of a sphere apart."""
    half = np.asarray(size, float) / 2
    r = min(bevel, *half)
    _, uv, n, f = sphere((0, 0, 0), 1, 24)
    corner = np.sign(np.where(np.abs(n) < 1e-6, 0, n)) * (half - r)
    return fix(corner + r * n + np.asarray(centre, float), uv, f)


def leaf(length, width, bend, segments=8):
    """Returns a bent strip, from which an opacity texture cuts out a leaf."""
    t = np.linspace(0, 1, segments + 1)
    x = np.linspace(-0.5, 0.5, 5)
    vertices = np.stack(np.broadcast_arrays(width * x[None], length * (t - 0.35 * bend * t**2)[:, None],
                                            length * bend * (t**2)[:, None] + 0.15 * width * np.abs(2 * x)[None]), -1)
    return grid(vertices, np.stack(np.broadcast_arrays((x + 0.5)[None], (1 - t)[:, None]), -1))


def grid(vertices, uv):
    rows, columns = vertices.shape[:2]
    at = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = at[:-1, :-1], at[:-1, 1:], at[1:, 1:], at[1:, :-1]
    faces = np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)])
    return fix(vertices.reshape(-1, 3), uv.reshape(-1, 2), faces)


def fix(vertices, uv, faces):
    """Removes triangles without area, and computes normals, weighted by area and equal for vertices at one position."""
    corners = vertices[faces]
    area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    keep = np.linalg.norm(area, axis=1) > 1e-12
    faces, area = faces[keep], area[keep]
    _, place = np.unique(np.round(vertices, 6), axis=0, return_inverse=True)
    place = place.reshape(-1)
    normals = np.zeros((place.max() + 1, 3))
    for k in range(3):
        np.add.at(normals, place[faces[:, k]], area)
    normals = normals[place]
    return vertices, uv, normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-20), faces


def moved(mesh, offset=(0, 0, 0), scale=1.0, turn=None):
    """Returns a mesh that is scaled, then rotated by the matrix `turn`, then translated by `offset`."""
    v, uv, n, f = mesh
    v = v * scale
    if turn is not None:
        v, n = v @ np.asarray(turn).T, n @ np.asarray(turn).T
    return v + np.asarray(offset, float), uv, n, f


def turn(axis, degrees):
    """Returns the rotation matrix about axis 'x', 'y' or 'z'."""
    a = np.radians(degrees)
    c, s = np.cos(a), np.sin(a)
    i, j = {'x': (1, 2), 'y': (2, 0), 'z': (0, 1)}[axis]
    m = np.eye(3)
    m[i, i] = m[j, j] = c
    m[i, j], m[j, i] = -s, s
    return m
