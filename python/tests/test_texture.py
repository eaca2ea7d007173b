import math

import pytest
import torch

import item3d
import reference
from conftest import assert_close, differences


def levels_of(texture):
    levels = [texture]
    while max(levels[-1].shape[:2]) > 1:
        levels.append(reference.halved(levels[-1]))
    return levels


@pytest.mark.parametrize('boundary', ['wrap', 'clamp', 'zero'])
def test_bilinear(boundary):
    texture, uv = torch.randn(2, 5, 7, 3), torch.rand(2, 6, 9, 2) * 3 - 1
    found = [texture.clone().requires_grad_(), uv.clone().requires_grad_()]
    exact = [texture.double().requires_grad_(), uv.double().requires_grad_()]
    values = item3d.texture(*found, filter='linear', boundary=boundary)
    expected = torch.stack([
        reference.bilinear(exact[0][n], exact[1][n, ..., 0].flatten(), exact[1][n, ..., 1].flatten(), boundary)
        for n in range(2)]).view(values.shape)
    assert_close(values, expected, 1e-5)
    weights = torch.randn_like(values)
    (values * weights).sum().backward()
    (expected * weights).sum().backward()
    for a, b in zip(found, exact):
        assert_close(a.grad, b.grad, 1e-4)


@pytest.mark.parametrize('boundary', ['wrap', 'clamp', 'zero'])
def test_nearest(boundary):
    texture, uv = torch.randn(1, 4, 6, 2), torch.rand(1, 20, 20, 2) * 3 - 1
    values = item3d.texture(texture, uv, filter='nearest', boundary=boundary)
    for row in range(20):
        for column in range(20):
            x, y = (uv[0, row, column] * torch.tensor([6.0, 4.0])).floor().long().tolist()
            if boundary == 'wrap':
                expected = texture[0, y % 4, x % 6]
            elif boundary == 'clamp':
                expected = texture[0, min(max(y, 0), 3), min(max(x, 0), 5)]
            else:
                inside = 0 <= x < 6 and 0 <= y < 4
                expected = texture[0, y, x] if inside else torch.zeros(2)
            assert torch.equal(values[0, row, column], expected)


def test_mipmaps_are_means():
    texture = torch.randn(2, 8, 2, 3)
    levels = item3d.mipmaps(texture)
    assert [tuple(level.shape[1:3]) for level in levels] == [(4, 1), (2, 1), (1, 1)]
    for n in range(2):
        for found, expected in zip(levels, levels_of(texture[n].double())[1:]):
            assert_close(found[n], expected, 1e-6)
    assert [tuple(level.shape[1:3]) for level in item3d.mipmaps(torch.zeros(1, 7, 5, 1))] == [(3, 2), (1, 1)]
    assert len(item3d.mipmaps(texture, max_level=1)) == 1


@pytest.mark.parametrize('boundary', ['wrap', 'clamp'])
@pytest.mark.parametrize('with_bias', [False, True])
def test_trilinear(boundary, with_bias):
    texture = torch.randn(1, 16, 8, 3)
    uv = torch.rand(2, 9, 9, 2)
    slopes = torch.randn(2, 9, 9, 4) * 10 ** (torch.rand(2, 9, 9, 1) * 2.5 - 2.5)
    bias = torch.randn(2, 9, 9) if with_bias else None
    found = [texture.clone().requires_grad_(), uv.clone().requires_grad_(), slopes.clone().requires_grad_()]
    exact = [x.detach().double().requires_grad_() for x in found]
    if with_bias:
        found.append(bias.clone().requires_grad_())
        exact.append(bias.double().requires_grad_())
    values = item3d.texture(found[0], found[1], derivatives=found[2], level_bias=found[3] if with_bias else None,
                            boundary=boundary)
    level = reference.footprint_level(exact[2].view(-1, 4), 8, 16)
    if with_bias:
        level = level + exact[3].view(-1)
    assert (level < 0).any() and ((level > 0) & (level < 4)).sum() > 50
    expected = reference.trilinear(levels_of(exact[0][0]), exact[1][..., 0].flatten(),
                                   exact[1][..., 1].flatten(), level, boundary).view(values.shape)
    assert_close(values, expected, 1e-4)
    weights = torch.randn_like(values)
    (values * weights).sum().backward()
    (expected * weights).sum().backward()
    for name, a, b in zip(('texels', 'uv', 'derivatives', 'bias'), found, exact):
        # The tolerance allows for the rounding of the mip level to float, which affects coordinates in coarse levels.
        assert_close(a.grad, b.grad, 2e-3), name


def test_the_nearest_level():
    texture = torch.randn(1, 8, 8, 1)
    levels = levels_of(texture[0].double())
    uv = torch.rand(1, 1, 40, 2)
    bias = torch.linspace(-1, 4, 40).view(1, 1, 40)
    values = item3d.texture(texture, uv, level_bias=bias, filter='linear-mipmap-nearest')
    for i in range(40):
        level = int(math.floor(min(max(float(bias[0, 0, i]), 0), 3) + 0.5))
        expected = reference.bilinear(levels[level], uv[0, 0, i:i + 1, 0].double(),
                                      uv[0, 0, i:i + 1, 1].double(), 'wrap')
        assert_close(values[0, 0, i:i + 1], expected, 1e-5)


def test_a_footprint_of_two_texels_is_level_one():
    texture = torch.randn(1, 8, 8, 1)
    uv = torch.rand(1, 3, 3, 2)
    slopes = torch.tensor([2 / 8, 0, 0, 0.5 / 8]).expand(1, 3, 3, 4).contiguous()
    expected = item3d.texture(item3d.mipmaps(texture)[0], uv, filter='linear')
    assert_close(item3d.texture(texture, uv, derivatives=slopes), expected, 1e-5)


def test_levels_of_ones_own_get_gradients_of_their_own():
    texture = torch.randn(1, 4, 4, 2, requires_grad=True)
    levels = [torch.randn(1, 2, 2, 2, requires_grad=True), torch.randn(1, 1, 1, 2, requires_grad=True)]
    uv, bias = torch.rand(1, 5, 5, 2), torch.full((1, 5, 5), 1.25)
    values = item3d.texture(texture, uv, level_bias=bias, mipmaps=levels)
    weights = torch.randn_like(values)
    (values * weights).sum().backward()
    assert not texture.grad.any()
    assert_close(levels[1].grad.flatten(), 0.25 * weights.sum((0, 1, 2)), 1e-5)
    assert_close(levels[0].grad.sum((0, 1, 2)), 0.75 * weights.sum((0, 1, 2)), 1e-5)


@pytest.mark.parametrize('size, cube', [((8, 4), False), ((7, 10), False), ((8, 8), True)])
def test_levels_that_are_made_give_their_gradients_to_the_texture(size, cube):
    texture = torch.randn(2, 6, *size, 3) if cube else torch.randn(2, *size, 3)
    made, given = texture.clone().requires_grad_(), texture.clone().requires_grad_()
    uv, bias = torch.randn(2, 5, 5, 3 if cube else 2), torch.rand(2, 5, 5) * 3
    boundary = 'cube' if cube else 'wrap'
    values = item3d.texture(made, uv, level_bias=bias, boundary=boundary)
    expected = item3d.texture(given, uv, level_bias=bias, boundary=boundary,
                              mipmaps=item3d.mipmaps(given, cube=cube))
    assert torch.equal(values, expected)
    weights = torch.randn_like(values)
    (values * weights).sum().backward()
    (expected * weights).sum().backward()
    assert_close(made.grad, given.grad, 1e-5)


def test_anisotropic_is_sharper_along_the_shorter_axis():
    """With a footprint that is long along the stripes of a texture, they stay sharp; a trilinear lookup blurs them."""
    texture = torch.zeros(1, 64, 64, 1)
    texture[:, ::8] = texture[:, 1::8] = texture[:, 2::8] = texture[:, 3::8] = 1
    y = (torch.arange(32) + 0.5) / 32
    uv = torch.stack(torch.meshgrid(y, y, indexing='xy'), -1)[None].contiguous()
    slopes = torch.tensor([16 / 64, 0, 0, 1 / 64]).expand(1, 32, 32, 4).contiguous()
    sharp = item3d.texture(texture, uv, derivatives=slopes, filter='anisotropic')
    blurred = item3d.texture(texture, uv, derivatives=slopes)
    assert sharp.std() > 0.4 and blurred.std() < 0.1


def test_anisotropic_gradients():
    texture, uv, slopes = torch.randn(2, 8, 8, 2), torch.rand(2, 4, 4, 2), torch.randn(2, 4, 4, 4) * 0.1
    weights = torch.randn(2, 4, 4, 2)

    def loss(t, c):
        return (item3d.texture(t, c, derivatives=slopes, filter='anisotropic').double() * weights).sum()

    leaves = [texture.clone().requires_grad_(), uv.clone().requires_grad_()]
    loss(*leaves).backward()
    entries = torch.randperm(texture.numel())[:80]
    assert_close(leaves[0].grad.reshape(-1)[entries], differences(lambda t: loss(t, uv), texture, 1e-1, entries),
                 1e-3)
    found, expected = leaves[1].grad.reshape(-1), differences(lambda c: loss(texture, c), uv, 1e-4)
    # The function has a kink at texel centres.
    assert ((found - expected).abs() < 0.02 * expected.abs().max()).float().mean() > 0.9


# Cube maps. --------------------------------------------------------------------------------------

def test_cube_faces_are_opengls():
    texture = torch.randn(1, 6, 4, 4, 2)
    directions = torch.randn(1, 12, 12, 3)
    values = item3d.texture(texture, directions, filter='nearest', boundary='cube')
    for d, value in zip(directions.view(-1, 3), values.view(-1, 2)):
        face, s, t = reference.cube_coordinates(d.double().numpy())
        assert torch.equal(value, texture[0, face, int(t * 4), int(s * 4)])


def test_cube_lookups_are_bilinear_within_faces():
    texture = torch.randn(1, 6, 8, 8, 3)
    directions = torch.randn(1, 20, 20, 3)
    values = item3d.texture(texture, directions, filter='linear', boundary='cube')
    tested = 0
    for d, value in zip(directions.view(-1, 3), values.view(-1, 3)):
        face, s, t = reference.cube_coordinates(d.double().numpy())
        if min(s, t) > 0.5 / 8 and max(s, t) < 1 - 0.5 / 8:
            expected = reference.bilinear(texture[0, face].double(), torch.tensor([s]).double(),
                                          torch.tensor([t]).double(), 'clamp')
            assert_close(value[None], expected, 1e-4)
            tested += 1
    assert tested > 200


def test_cubes_have_no_seams():
    """A cube map of a smooth function of the direction gives this function everywhere, at edges and corners too, and
    lookups on both sides of an edge agree."""
    texture = torch.tensor(reference.cube_directions(32), dtype=torch.float32)[None]
    directions = torch.nn.functional.normalize(torch.randn(1, 50, 50, 3), dim=-1)
    corner = torch.tensor([1.0, 1, 1])
    edges = torch.tensor([[1.0, 1, 0.3], [1, -1, 0.2], [-1, 0.1, 1], [0.4, -1, -1]])
    near = torch.cat([edges, corner[None], -corner[None]]).repeat_interleave(40, 0)
    near = near + torch.randn_like(near) * 0.02
    for d in (directions, near.view(1, 1, -1, 3)):
        values = item3d.texture(texture, d, filter='linear', boundary='cube')
        assert (values - torch.nn.functional.normalize(d, dim=-1)).norm(dim=-1).max() < 0.04
    rough = torch.randn(1, 6, 4, 4, 1)
    sides = torch.tensor([[[[1.0, 1 - 1e-5, 0.3]], [[1 - 1e-5, 1.0, 0.3]]]])
    values = item3d.texture(rough, sides, filter='linear', boundary='cube')
    assert float((values[0, 0] - values[0, 1]).abs()) < 1e-3


@pytest.mark.parametrize('with_slopes', [False, True])
def test_cube_gradients(with_slopes):
    texture, directions = torch.randn(1, 6, 8, 8, 2), torch.randn(2, 6, 6, 3)
    slopes = torch.randn(2, 6, 6, 6) * 0.2 if with_slopes else None
    weights = torch.randn(2, 6, 6, 2)

    def loss(t, d, s):
        return (item3d.texture(t, d, derivatives=s, boundary='cube').double() * weights).sum()

    inputs = [texture, directions, slopes]
    leaves = [None if x is None else x.clone().requires_grad_() for x in inputs]
    loss(*leaves).backward()
    for i, step, share in ((0, 1e-1, 1.0), (1, 1e-3, 0.9), (2, 1e-3, 0.9)):
        if inputs[i] is None:
            continue
        entries = torch.randperm(inputs[i].numel())[:150]
        expected = differences(lambda x: loss(*inputs[:i], x, *inputs[i + 1:]), inputs[i], step, entries)
        found = leaves[i].grad.reshape(-1)[entries]
        good = (found - expected).abs() < 0.01 * expected.abs().max() + 0.02 * expected.abs()
        # The function has a kink at texel centres, at edges of faces and at whole mip levels.
        assert good.double().mean() >= share, (i, good.double().mean())


def test_cube_levels_grow_with_the_footprint():
    """In the middle of a face, a step of the direction by 2 / size is a step of one texel."""
    texture = torch.randn(1, 6, 16, 16, 1)
    directions = torch.tensor([1.0, 0.1, 0.2]).expand(1, 2, 2, 3).contiguous()
    slopes = torch.tensor([0, 0, 0, 0, -4 * 2 / 16, 0]).expand(1, 2, 2, 6).contiguous()
    levels = item3d.mipmaps(texture, cube=True)
    expected = item3d.texture(levels[1], directions, filter='linear', boundary='cube')
    assert_close(item3d.texture(texture, directions, derivatives=slopes, boundary='cube'), expected, 1e-5)


def test_no_direction_is_zero_without_gradients():
    texture = torch.ones(1, 6, 4, 4, 2, requires_grad=True)
    directions = torch.tensor([[0.0, 0, 0], [torch.nan, 1, 0], [torch.inf, 0, 0]]).view(1, 1, 3, 3)
    directions.requires_grad_()
    values = item3d.texture(texture, directions, filter='linear', boundary='cube')
    assert not values.any()
    values.sum().backward()
    assert not texture.grad.any() and not directions.grad.any()


@pytest.mark.parametrize('change, error, message', [
    (dict(texture=torch.zeros(3, 4, 4, 1)), ValueError, r'\[2, \*, \*, \*\] or \[1, \*, \*, \*\], found'),
    (dict(uv=torch.zeros(2, 3, 3, 3)), ValueError, r'uv must be of shape \[\*, \*, \*, 2\]'),
    (dict(boundary='mirror'), ValueError, "one of 'wrap', 'clamp', 'zero', 'cube', found 'mirror'"),
    (dict(filter='cubic'), ValueError, 'filter must be one of'),
    (dict(filter='linear-mipmap-linear'), ValueError, 'needs derivatives or level_bias'),
    (dict(derivatives=torch.zeros(2, 3, 3, 2)), ValueError, r'derivatives must be of shape \[2, 3, 3, 4\]'),
    (dict(filter='anisotropic', level_bias=torch.zeros(2, 3, 3)), ValueError, 'no level_bias'),
    (dict(level_bias=torch.zeros(2, 3, 3), mipmaps=[torch.zeros(1, 3, 2, 1)]), ValueError,
     r'mipmaps\[0\] must be of shape \[1, 2, 2, 1\]'),
    (dict(texture=torch.zeros(1, 0, 4, 1)), RuntimeError, 'must have texels'),
])
def test_errors_say_what_was_wanted(change, error, message):
    arguments = dict(texture=torch.zeros(1, 4, 4, 1), uv=torch.zeros(2, 3, 3, 2))
    with pytest.raises(error, match=message):
        item3d.texture(**{**arguments, **change})


def test_nan_coordinates_are_the_corner():
    texture = torch.randn(1, 4, 4, 1)
    values = item3d.texture(texture, torch.full((1, 2, 2, 2), torch.nan), filter='nearest')
    assert torch.equal(values, texture[:, :1, :1].expand(1, 2, 2, 1))


def test_bytes_are_scaled_as_an_image():
    with pytest.raises(TypeError, match=r'found uint8 \(tensor.to\(torch.float32\) / 255 for an image\)'):
        item3d.texture(torch.zeros(1, 4, 4, 3, dtype=torch.uint8), torch.zeros(1, 2, 2, 2))
