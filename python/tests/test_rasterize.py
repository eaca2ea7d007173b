import numpy as np
import pytest
import torch

import item3d
import reference
from conftest import assert_close, differences, inner_pixels, soup, turned_cube


@pytest.mark.parametrize('depth', ['z', 'w'])
@pytest.mark.parametrize('size', [(40, 56), (33, 17)])
def test_coverage_weights_and_depth(size, depth):
    positions, triangles = soup()
    raster = item3d.rasterize(positions, triangles, size, depth=depth)
    for view in range(2):
        weights, expected_depth, triangle = reference.raster(positions[view], triangles, *size,
                                                             by_w=depth == 'w')
        assert (triangle >= 0).mean() > 0.2
        # Where two triangles intersect, float and double may disagree about which is nearer.
        assert (raster.triangle[view].numpy() != triangle).sum() <= 2
        same = (raster.triangle[view].numpy() == triangle) & (triangle >= 0)
        assert_close(raster.barycentrics[view][same], torch.tensor(weights[same][:, :2]), 1e-5)
        assert_close(raster.depth[view][same], torch.tensor(expected_depth[same]), 1e-5)


def test_triangles_that_cross_the_near_plane_are_cut_there():
    positions = torch.tensor([[[-1.0, -1, -3, 1], [1, -1, 0, 1], [0, 1, 0, 1]]])
    triangles = torch.tensor([[0, 1, 2]], dtype=torch.int32)
    raster = item3d.rasterize(positions, triangles, (32, 32))
    assert float(raster.depth.min()) >= -1
    expected = reference.raster(positions[0], triangles, 32, 32)[2] >= 0
    assert (raster.covered[0].numpy() == expected).all() and 0 < expected.sum() < 32 * 32 // 2


def test_vertices_behind_the_eye_that_the_near_plane_does_not_cut():
    """With the same z at all vertices, which no camera gives, the near plane does not clip, and the visible part ends
    where w is z."""
    positions = torch.tensor([[[-0.2, -1, 0.5, -0.25], [3, -2.7, 0.5, 3], [-3, 3.1, 0.5, 3]]])
    triangles = torch.tensor([[0, 1, 2]], dtype=torch.int32)
    expected = reference.raster(positions[0], triangles, 32, 32)[2] >= 0
    raster = item3d.rasterize(positions, triangles, (32, 32))
    assert 50 < expected.sum() < 32 * 32 and (raster.covered[0].numpy() == expected).all()


def test_the_far_plane_cuts_by_z_and_not_by_w():
    positions = torch.tensor([[[-1.0, -1, 1.5, 1], [3, -1, 1.5, 1], [-1, 3, 1.5, 1]]])
    triangles = torch.tensor([[0, 1, 2]], dtype=torch.int32)
    assert not item3d.rasterize(positions, triangles, (4, 4)).covered.any()
    assert item3d.rasterize(positions, triangles, (4, 4), depth='w').covered.all()


def test_orthographic_views_are_ordered_by_z():
    """With the same w at all vertices, the nearer triangle, which is drawn last, must be visible."""
    corners = torch.tensor([[-1.0, -1], [3, -1], [-1, 3]])
    positions = torch.cat([torch.cat([corners, torch.full((3, 1), z), torch.ones(3, 1)], 1)
                           for z in (0.5, -0.5)])[None]
    triangles = torch.arange(6, dtype=torch.int32).view(2, 3)
    raster = item3d.rasterize(positions, triangles, (4, 4))
    assert (raster.triangle == 1).all() and torch.equal(raster.depth, torch.full((1, 4, 4), -0.5))


def grid(width, height, cells):
    """Returns a flat grid whose lines pass exactly through pixel centres: clip-space positions and triangles."""
    x = (torch.arange(cells + 1) * 2 + 0.5) * 2 / width - 1
    y = 1 - (torch.arange(cells + 1) * 2 + 0.5) * 2 / height
    positions = torch.stack([*torch.meshgrid(x, y, indexing='xy'), torch.zeros(cells + 1, cells + 1),
                             torch.ones(cells + 1, cells + 1)], -1).view(1, -1, 4)
    first = torch.arange(cells)[:, None] * (cells + 1) + torch.arange(cells)
    a, b, c, d = (first + i for i in (0, 1, cells + 1, cells + 2))
    triangles = torch.stack([torch.stack([a, b, d], -1), torch.stack([a, d, c], -1)], 2)
    return positions, triangles.reshape(-1, 3).int()


def test_centres_on_edges_belong_to_one_triangle():
    """Rasterises each triangle alone: each pixel inside the grid must be covered exactly once, on lines too."""
    positions, triangles = grid(16, 16, 7)
    count = torch.zeros(16, 16)
    for triangle in triangles:
        count += item3d.rasterize(positions, triangle[None], (16, 16)).covered[0]
    assert torch.equal(count[1:14, 1:14], torch.ones(13, 13)) and count.max() == 1


def test_two_layers():
    positions, triangles = soup(seed=3)
    first = item3d.rasterize(positions, triangles, (40, 40))
    behind = torch.where(first.covered, first.depth, 2.0).detach()
    second = item3d.rasterize(positions, triangles, (40, 40), behind=behind)
    for view in range(2):
        expected = reference.raster(positions[view], triangles, 40, 40,
                                    behind=behind[view].numpy().astype(float))
        assert (second.triangle[view].numpy() != expected[2]).sum() <= 2
    assert second.covered.sum() > 100
    both = second.covered
    assert (second.depth[both] > first.depth[both]).all() and not (both & ~first.covered).any()


def test_ranges_draw_what_separate_calls_draw():
    positions, triangles = soup(views=1)
    ranges = torch.tensor([[0, 5], [5, 7], [3, 0]], dtype=torch.int32)
    raster = item3d.rasterize(positions[0], triangles, (24, 24), ranges=ranges, derivatives=True)
    for view, (first, count) in enumerate(ranges.tolist()):
        one = item3d.rasterize(positions, triangles[first:first + count], (24, 24), derivatives=True)
        shift = torch.where(one.covered[0], float(first), 0.0)
        assert torch.equal(raster.pixels[view, ..., :3], one.pixels[0, ..., :3])
        assert torch.equal(raster.pixels[view, ..., 3], one.pixels[0, ..., 3] + shift)
        assert torch.equal(raster.derivatives[view], one.derivatives[0])
    assert not raster.covered[2].any()


def test_derivatives_are_differences_of_weights():
    positions, triangles = soup(seed=2)
    height, width = 24, 40
    raster = item3d.rasterize(positions, triangles, (height, width), derivatives=True)
    covered = raster.covered.nonzero()
    for view, row, column in covered[::29].tolist():
        corners = triangles[raster.triangle[view, row, column]]
        def at(x, y):
            return reference.weights_at(positions[view], corners, (x + 0.5) * 2 / width - 1,
                                        1 - (y + 0.5) * 2 / height)
        step = 1e-5
        by_x = (at(column + step, row) - at(column - step, row)) / (2 * step)
        by_y = (at(column, row + step) - at(column, row - step)) / (2 * step)
        expected = torch.tensor([by_x[0], by_y[0], by_x[1], by_y[1]])
        assert_close(raster.derivatives[view, row, column], expected, 1e-4)
    assert not raster.derivatives[~raster.covered].any()


@pytest.mark.parametrize('which', ['weights', 'derivatives'])
def test_gradients_by_positions(which):
    """Compares gradients in pixels whose visible triangle does not change with the step of the differences."""
    positions, triangles = turned_cube()
    weights = torch.randn(1, 40, 40, 2 if which == 'weights' else 4)
    fixed = item3d.rasterize(positions, triangles, (40, 40)).triangle
    inner = inner_pixels(fixed)

    def loss(p):
        raster = item3d.rasterize(p, triangles, (40, 40), derivatives=True)
        values = raster.barycentrics if which == 'weights' else raster.derivatives
        return (values.double() * weights)[inner].sum()

    positions.requires_grad_()
    loss(positions).backward()
    expected = differences(loss, positions, 2e-3)
    assert_close(positions.grad.reshape(-1), expected, 1e-2)
    assert not positions.grad[..., 2].any()


def test_the_same_bytes_for_any_number_of_threads():
    positions, triangles = soup(200, seed=5)
    before = torch.get_num_threads()
    results = []
    try:
        for threads in (1, 2, 3):
            torch.set_num_threads(threads)
            p = positions.clone().requires_grad_()
            raster = item3d.rasterize(p, triangles, (200, 150), derivatives=True)
            (raster.pixels[..., :2].sum() + raster.derivatives.square().sum()).backward()
            results.append((raster.pixels.detach(), raster.derivatives.detach(), p.grad))
    finally:
        torch.set_num_threads(before)
    for result in results[1:]:
        assert all(torch.equal(a, b) for a, b in zip(result, results[0]))


def test_nothing_to_draw():
    no_triangles = torch.zeros(0, 3, dtype=torch.int32)
    assert not item3d.rasterize(torch.zeros(2, 3, 4), no_triangles, (4, 5)).pixels.any()
    assert item3d.rasterize(torch.zeros(0, 3, 4), no_triangles, (4, 5)).pixels.shape == (0, 4, 5, 4)
    degenerate = torch.zeros(1, 3, dtype=torch.int32)
    assert not item3d.rasterize(torch.ones(1, 1, 4), degenerate, (4, 5)).covered.any()


@pytest.mark.parametrize('change, error, message', [
    (dict(positions=[1]), TypeError, 'positions must be a tensor, found list'),
    (dict(positions=torch.zeros(1, 3, 4, dtype=torch.float64)), TypeError, 'must be float32, found float64'),
    (dict(positions=torch.zeros(3, 4)), ValueError, r'of shape \[\*, \*, 4\], found \[3, 4\]'),
    (dict(positions=torch.zeros(1, 3, 4, device='meta')), ValueError, 'must be on the CPU or a CUDA device, found meta'),
    (dict(triangles=torch.zeros(1, 3, dtype=torch.int64)), TypeError, 'must be int32, found int64'),
    (dict(triangles=torch.full((1, 3), 7, dtype=torch.int32)), RuntimeError, 'from 0 to 2, found 7'),
    (dict(triangles=torch.full((1, 3), -1, dtype=torch.int32)), RuntimeError, 'from 0 to 2, found -1'),
    (dict(positions=torch.full((2, 3, 4), torch.nan)), RuntimeError,
     'must be finite, found nan in vertex 0 of view 0'),
    (dict(size=(0, 4)), ValueError, r'in \[1, 16384\], found 0 x 4'),
    (dict(size=4), TypeError, 'two whole numbers'),
    (dict(depth='x'), ValueError, "must be one of 'z', 'w', found 'x'"),
    (dict(behind=torch.zeros(1, 2, 2)), ValueError, r'behind must be of shape \[1, 4, 4\]'),
    (dict(positions=torch.zeros(3, 4), ranges=torch.tensor([[0, 2]], dtype=torch.int32)), RuntimeError,
     'found first 0, count 2 for view 0'),
])
def test_errors_say_what_was_wanted(change, error, message):
    arguments = dict(positions=torch.ones(1, 3, 4), triangles=torch.zeros(1, 3, dtype=torch.int32),
                     size=(4, 4))
    with pytest.raises(error, match=message):
        item3d.rasterize(**{**arguments, **change})


def test_strides_do_not_matter():
    positions, triangles = soup()
    strided = positions.transpose(0, 1).contiguous().transpose(0, 1)
    assert not strided.is_contiguous()
    assert torch.equal(item3d.rasterize(strided, triangles, (20, 20)).pixels,
                       item3d.rasterize(positions, triangles, (20, 20)).pixels)


def test_second_derivatives_are_an_error():
    positions, triangles = turned_cube()
    positions.requires_grad_()
    total = item3d.rasterize(positions, triangles, (8, 8)).barycentrics.square().sum()
    gradient, = torch.autograd.grad(total, positions, create_graph=True)
    with pytest.raises(RuntimeError):
        gradient.sum().backward()


def test_numpy_scalars_are_sizes():
    positions, triangles = turned_cube()
    assert item3d.rasterize(positions, triangles, np.array([6, 8])).pixels.shape == (1, 6, 8, 4)
