"""Reference implementations of the operations in NumPy and PyTorch with float64, straight from the formulas."""
import numpy as np
import torch


def raster(positions, triangles, height, width, bottom_up=False, by_w=False, behind=None):
    """Rasterises one view of positions [V, 4] and triangles [T, 3].

    Returns weights [H, W, 3], depth [H, W] and triangle [H, W] (-1: none). For a pixel q = (x, y, 1) and the vertices
    p_i = (x, y, w), the equation q = b_0 p_0 + b_1 p_1 + b_2 p_2 is solved for b. The barycentrics are b divided by its
    sum."""
    positions = np.asarray(positions, np.float64)
    rows = np.arange(height) + 0.5
    y = rows * 2 / height - 1 if bottom_up else 1 - rows * 2 / height
    x = (np.arange(width) + 0.5) * 2 / width - 1
    q = np.stack([*np.meshgrid(x, y), np.ones((height, width))], -1)
    best = np.full((height, width), np.inf)
    found, weights = np.full((height, width), -1), np.zeros((height, width, 3))
    for t, corners in enumerate(np.asarray(triangles)):
        p = positions[corners]
        matrix = p[:, [0, 1, 3]].T
        if abs(np.linalg.det(matrix)) < 1e-14:
            continue
        b = q @ np.linalg.inv(matrix).T
        total = b.sum(-1)
        inside = ((b > 0).all(-1)) & (total > 0)
        b = b / np.where(inside, total, 1)[..., None]
        z, w = b @ p[:, 2], b @ p[:, 3]
        inside &= (w > 0) & (z >= -w)
        w = np.where(inside, w, 1)
        if not by_w:
            inside &= z < w
        depth = w if by_w else z / w
        nearer = inside & (depth < best)
        if behind is not None:
            nearer &= depth > behind + 1e-6
        best[nearer], found[nearer], weights[nearer] = depth[nearer], t, b[nearer]
    return weights, np.where(found >= 0, best, 0), found


def weights_at(positions, corners, x, y):
    """Returns the barycentrics of one triangle at a point in normalised device coordinates."""
    p = np.asarray(positions, np.float64)[np.asarray(corners)]
    b = np.linalg.solve(p[:, [0, 1, 3]].T, [x, y, 1])
    return b / b.sum()


def bilinear(texture, u, v, boundary):
    """Samples a texture [H, W, C] at coordinates [P] in float64, with gradients."""
    height, width = texture.shape[:2]
    x, y = u * width - 0.5, v * height - 0.5
    if boundary == 'clamp':
        x, y = x.clamp(0, width - 1), y.clamp(0, height - 1)
    x0, y0 = x.detach().floor(), y.detach().floor()
    fx, fy = (x - x0)[:, None], (y - y0)[:, None]

    def texel(dx, dy):
        column, row = (x0 + dx).long(), (y0 + dy).long()
        outside = (column < 0) | (column >= width) | (row < 0) | (row >= height)
        if boundary == 'clamp':
            column, row = column.clamp(0, width - 1), row.clamp(0, height - 1)
        value = texture[row % height, column % width]
        return torch.where(outside[:, None], 0.0, value) if boundary == 'zero' else value

    return ((1 - fx) * (1 - fy) * texel(0, 0) + fx * (1 - fy) * texel(1, 0) +
            (1 - fx) * fy * texel(0, 1) + fx * fy * texel(1, 1))


def halved(texture):
    height, width = texture.shape[:2]
    if height > 1:
        texture = (texture[0::2] + texture[1::2]) / 2
    if width > 1:
        texture = (texture[:, 0::2] + texture[:, 1::2]) / 2
    return texture


def footprint_level(slopes, width, height):
    """Returns log2 of the longer axis of the footprint in texels, from the singular values of the Jacobian.

    slopes: [P, 4] derivatives du/dx, du/dy, dv/dx, dv/dy.
    """
    scale = torch.tensor([width, width, height, height], dtype=slopes.dtype)
    jacobian = (slopes * scale).view(-1, 2, 2)
    return torch.log2(torch.linalg.svdvals(jacobian)[:, 0])


def trilinear(levels, u, v, level, boundary):
    """Samples between two mip levels, with gradients. levels: textures [h, w, C]. level: [P]."""
    level = level.clamp(0, len(levels) - 1)
    fine = level.detach().floor().clamp(max=max(0, len(levels) - 2)).long()
    fraction = (level - fine)[:, None]
    result = 0
    for i, texture in enumerate(levels):
        share = torch.where(fine[:, None] == i, 1 - fraction, 0.0)
        share = share + torch.where(fine[:, None] == i - 1, fraction, 0.0)
        result = result + share * bilinear(texture, u, v, boundary)
    return result


# The values sc, tc and ma of each cube face (OpenGL 4.6, table 8.19).
_FACES = [(lambda d: (-d[2], -d[1], d[0])), (lambda d: (d[2], -d[1], -d[0])),
          (lambda d: (d[0], d[2], d[1])), (lambda d: (d[0], -d[2], -d[1])),
          (lambda d: (d[0], -d[1], d[2])), (lambda d: (-d[0], -d[1], -d[2]))]


def cube_coordinates(direction):
    """Returns the cube face of a direction, and its coordinates s and t in [0, 1]."""
    axis = int(np.argmax(np.abs(direction)))
    face = 2 * axis + (1 if direction[axis] < 0 else 0)
    sc, tc, ma = _FACES[face](direction)
    return face, (sc / ma + 1) / 2, (tc / ma + 1) / 2


def cube_directions(size):
    """Returns the unit directions [6, size, size, 3] of the centres of a cube map's texels."""
    result = np.zeros((6, size, size, 3))
    centre = (np.arange(size) + 0.5) * 2 / size - 1
    t, s = np.meshgrid(centre, centre, indexing='ij')
    one = np.ones_like(s)
    for face, axes in enumerate([(one, -t, -s), (-one, -t, s), (s, one, t), (s, -one, -t),
                                 (s, -t, one), (-s, -t, -one)]):
        result[face] = np.stack(axes, -1)
    return result / np.linalg.norm(result, axis=-1, keepdims=True)
