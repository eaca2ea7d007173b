import pytest
import torch

import item3d
from conftest import assert_close, differences, inner_pixels, soup, turned_cube


def gathered(attributes, raster, triangles):
    """Interpolates attributes in plain PyTorch with float64."""
    views = raster.pixels.shape[0]
    attributes = attributes.double().expand(views, *attributes.shape[-2:])
    corners = triangles.long()[raster.triangle.clamp(min=0)]
    b = raster.barycentrics.double()
    weights = torch.stack([b[..., 0], b[..., 1], 1 - b[..., 0] - b[..., 1]], -1)
    at = attributes[torch.arange(views).view(-1, 1, 1, 1), corners]
    return (at * weights[..., None]).sum(-2) * raster.covered[..., None]


@pytest.mark.parametrize('form', ['each', 'one', 'flat'])
def test_values_and_gradients(form):
    positions, triangles = soup()
    raster = item3d.rasterize(positions, triangles, (30, 20), derivatives=True)
    attributes = torch.randn({'each': (2, 36, 5), 'one': (1, 36, 5), 'flat': (36, 5)}[form])
    leaf, again = attributes.clone().requires_grad_(), attributes.double().requires_grad_()
    values = item3d.interpolate(leaf, raster, triangles)
    expected = gathered(again, raster, triangles)
    assert_close(values, expected, 1e-6)
    weights = torch.randn_like(values)
    (values * weights).sum().backward()
    (expected * weights).sum().backward()
    assert_close(leaf.grad, again.grad, 1e-5)


def test_derivatives_of_chosen_channels():
    """An attribute is a linear function of the weights, so its derivatives are that function of theirs."""
    positions, triangles = soup()
    raster = item3d.rasterize(positions, triangles, (30, 20), derivatives=True)
    attributes = torch.randn(1, 36, 5)
    values, slopes = item3d.interpolate(attributes, raster, triangles, derivatives=[3, 0])
    assert values.shape[-1] == 5 and slopes.shape[-1] == 4
    at = attributes[0][triangles.long()[raster.triangle.clamp(min=0)]]
    for i, channel in enumerate((3, 0)):
        first, second = (at[..., k, channel] - at[..., 2, channel] for k in (0, 1))
        for axis in (0, 1):
            expected = raster.derivatives[..., axis] * first + raster.derivatives[..., 2 + axis] * second
            assert_close(slopes[..., 2 * i + axis], expected * raster.covered, 1e-5)
    everything = item3d.interpolate(attributes, raster, triangles, derivatives=True)[1]
    assert torch.equal(everything[..., 6:8], slopes[..., :2])


def test_gradients_through_derivatives():
    positions, triangles = turned_cube()
    raster = item3d.rasterize(positions, triangles, (12, 12), derivatives=True)
    inputs = [torch.randn(1, 8, 3), raster.pixels, raster.derivatives]
    weights = torch.randn(1, 12, 12, 3), torch.randn(1, 12, 12, 4)

    def loss(attributes, pixels, derivatives):
        values, slopes = item3d.interpolate(attributes, item3d.Raster(pixels, derivatives), triangles,
                                            derivatives=[2, 1])
        return (values.double() * weights[0]).sum() + (slopes.double() * weights[1]).sum()

    leaves = [x.detach().clone().requires_grad_() for x in inputs]
    loss(*leaves).backward()
    for i, leaf in enumerate(leaves):
        entries = torch.randperm(leaf.numel())[:120]
        if i == 1:
            entries = entries[entries % 4 < 2]  # depth and index are not differentiable
        expected = differences(lambda x: loss(*inputs[:i], x, *inputs[i + 1:]), inputs[i], 1e-2, entries)
        assert_close(leaf.grad.reshape(-1)[entries], expected, 1e-3)


def test_from_positions_to_a_picture():
    """Compares the gradient of the whole chain with finite differences, in pixels that are smooth in the positions."""
    positions, triangles = turned_cube()
    attributes = torch.randn(8, 2)
    raster = item3d.rasterize(positions, triangles, (40, 40))
    inner = inner_pixels(raster.triangle)

    def loss(p):
        values = item3d.interpolate(attributes, item3d.rasterize(p, triangles, (40, 40)), triangles)
        return values.double()[inner].square().sum()

    positions.requires_grad_()
    loss(positions).backward()
    assert_close(positions.grad.reshape(-1), differences(loss, positions, 2e-3), 1e-2)


@pytest.mark.parametrize('change, error, message', [
    (dict(attributes=torch.zeros(3, 8, 2)), ValueError, r'attributes must be of shape \[1, \*, \*\]'),
    (dict(attributes=torch.zeros(1, 4, 2)), RuntimeError, 'from 0 to 3'),
    (dict(raster=torch.zeros(1, 4, 4, 4)), TypeError, 'must be what rasterize'),
    (dict(derivatives=True), ValueError, 'a raster that has them'),
    (dict(triangles=torch.zeros(1, 3, dtype=torch.int32)), RuntimeError, 'beyond the 1 that are given'),
])
def test_errors_say_what_was_wanted(change, error, message):
    positions, triangles = turned_cube()
    raster = item3d.rasterize(positions, triangles, (8, 8))
    arguments = dict(attributes=torch.zeros(1, 8, 2), raster=raster, triangles=triangles)
    with pytest.raises(error, match=message):
        item3d.interpolate(**{**arguments, **change})


def test_channels_that_do_not_exist():
    positions, triangles = turned_cube()
    raster = item3d.rasterize(positions, triangles, (8, 8), derivatives=True)
    with pytest.raises(RuntimeError, match=r'channels must be in \[0, 2\), found 2'):
        item3d.interpolate(torch.zeros(1, 8, 2), raster, triangles, derivatives=[2])
