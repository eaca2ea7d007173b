import pytest
import torch

import item3d
from conftest import assert_close, differences, turned_cube


def quad(left, right=0.9, size=8):
    """Returns a rectangle, taller than the image, from x = `left` to `right`. `size`: width of the image in pixels."""
    x0, x1 = (left * 2 / size - 1), (right * 2 / size - 1)
    positions = torch.tensor([[[x0, -2.0, 0, 1], [x1, -2, 0, 1], [x1, 2, 0, 1], [x0, 2, 0, 1]]])
    return positions, torch.tensor([[0, 1, 2], [0, 2, 3]], dtype=torch.int32)


@pytest.mark.parametrize('left', [2.6, 3.0, 3.3, 3.45])
def test_an_upright_edge_is_blended_by_coverage(left):
    """Between two pixel centres, the share of white is the part of the pixel's area that the rectangle covers."""
    positions, triangles = quad(left, 20)
    raster = item3d.rasterize(positions, triangles, (8, 8))
    image = raster.covered.float()[..., None]
    result = item3d.antialias(image, raster, positions, triangles)
    expected = torch.clamp(torch.arange(8) + 1 - left, 0, 1).expand(8, 8)
    assert_close(result[0, ..., 0], expected, 1e-5)


def test_the_edges_motion_has_the_gradient_of_its_area():
    """If the edge moves left by a pixel, each of the 8 rows gains one unit of white. A pixel is 2 / 8 in x."""
    positions, triangles = quad(3.3, 20)
    positions.requires_grad_()
    raster = item3d.rasterize(positions, triangles, (8, 8))
    result = item3d.antialias(raster.covered.float()[..., None], raster, positions, triangles)
    result.sum().backward()
    assert_close(positions.grad[0, [0, 3], 0].sum(), torch.tensor(-8 * 8 / 2.0), 1e-4)
    assert abs(float(positions.grad[0, [1, 2]].abs().max())) < 1e-5


def test_gradients_by_finite_differences():
    positions, triangles = turned_cube()
    topology = item3d.topology(triangles)
    colors = torch.randn(12, 3)
    weights = torch.randn(1, 24, 24, 3)

    def loss(p, shift=None):
        raster = item3d.rasterize(p, triangles, (24, 24))
        image = torch.where(raster.covered[..., None], colors[raster.triangle.clamp(min=0)], 0.0)
        image = image if shift is None else image + shift
        result = item3d.antialias(image, raster, p, triangles, topology=topology)
        return (result.double() * weights).sum()

    positions.requires_grad_()
    shift = torch.zeros(1, 24, 24, 3, requires_grad=True)
    loss(positions, shift).backward()
    # The loss jumps if a step changes the visible triangle at a pixel centre, or the edge that is crossed between two
    # centres. Therefore only most of the entries must agree.
    found = positions.grad.reshape(-1)
    expected = differences(loss, positions, 1e-4)
    agree = (found - expected).abs() < 0.02 * expected.abs().max()
    assert agree.double().mean() > 0.9, (found, expected)
    entries = torch.randperm(shift.numel())[:200]
    assert_close(shift.grad.reshape(-1)[entries],
                 differences(lambda s: loss(positions.detach(), s), shift, 1e-1, entries), 1e-4)


def test_inner_edges_stay_sharp_and_seams_are_inner_with_positions():
    """Without positions, the diagonal of a quad whose triangles share no vertex index is an outline."""
    positions, _ = quad(-5, 20)
    apart = positions[:, [0, 1, 2, 0, 2, 3]]
    triangles = torch.tensor([[0, 1, 2], [3, 4, 5]], dtype=torch.int32)
    raster = item3d.rasterize(apart, triangles, (8, 8))
    image = raster.triangle.float()[..., None]
    assert not torch.equal(item3d.antialias(image, raster, apart, triangles), image)
    topology = item3d.topology(triangles, apart[0])
    assert (topology >= 0).sum() == 2
    assert torch.equal(item3d.antialias(image, raster, apart, triangles, topology=topology), image)


def test_ranges_and_batches_agree():
    positions, triangles = turned_cube()
    ranges = torch.tensor([[0, 12], [0, 12]], dtype=torch.int32)
    both = item3d.rasterize(positions[0], triangles, (16, 16), ranges=ranges)
    one = item3d.rasterize(positions, triangles, (16, 16))
    image = torch.randn(1, 16, 16, 3)
    flat, each = positions[0].clone().requires_grad_(), positions.clone().requires_grad_()
    result = item3d.antialias(image.expand(2, -1, -1, -1).contiguous(), both, flat, triangles)
    expected = item3d.antialias(image, one, each, triangles)
    assert torch.equal(result, expected.expand(2, -1, -1, -1))
    result.square().sum().backward()
    (2 * expected.square().sum()).backward()
    assert_close(flat.grad, each.grad[0], 1e-5)


@pytest.mark.parametrize('change, error, message', [
    (dict(image=torch.zeros(1, 4, 4, 1)), ValueError, r'image must be of shape \[1, 8, 8, \*\]'),
    (dict(topology=torch.zeros(3, 3, dtype=torch.int32)), ValueError, r'topology must be of shape \[12, 3\]'),
    (dict(topology=torch.full((12, 3), 99, dtype=torch.int32)), RuntimeError, 'not that of these triangles'),
    (dict(raster=None), TypeError, 'must be what rasterize'),
])
def test_errors_say_what_was_wanted(change, error, message):
    positions, triangles = turned_cube()
    raster = item3d.rasterize(positions, triangles, (8, 8))
    arguments = dict(image=torch.zeros(1, 8, 8, 1), raster=raster, positions=positions, triangles=triangles)
    with pytest.raises(error, match=message):
        item3d.antialias(**{**arguments, **change})


def test_the_topology_of_triangles_with_gaps_in_memory():
    positions, triangles = turned_cube()
    padded = torch.cat([triangles, torch.full((len(triangles), 1), 99, dtype=torch.int32)], 1)
    assert torch.equal(item3d.topology(padded[:, :3], positions[0]), item3d.topology(triangles, positions[0]))
    with pytest.raises(RuntimeError, match='triangles must name vertices from 0 to 7, found 99'):
        item3d.topology(padded[:, 1:], positions[0])
