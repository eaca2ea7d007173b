import numpy as np
import pytest
import torch

import item3d
import reference
from conftest import assert_close, differences
from item3d._library import chain_sizes, ops


def maps_of(light):
    return [light.diffuse, *light.specular]


def directions(size):
    return torch.tensor(reference.cube_directions(size), dtype=torch.float64)


def solid_angles(size):
    """Returns the solid angles of a cube map's texels [6 * size * size, 1], up to a constant factor."""
    centre = (torch.arange(size, dtype=torch.float64) + 0.5) * 2 / size - 1
    one = (1 + centre.square() + centre.square()[:, None]) ** -1.5
    return one.expand(6, size, size).reshape(-1, 1)


def test_a_constant_stays():
    light = item3d.prefilter(torch.full((6, 32, 32, 3), 0.7))
    assert_close(light.roughness, torch.tensor([0.08, 0.5, 0.63, 0.79, 1.0]), 1e-6)
    for map in maps_of(light):
        assert_close(map, torch.full_like(map, 0.7), 1e-5)


def test_irradiance_of_a_linear_environment():
    """For the radiance 1 + a d in direction d, the irradiance E(n) / pi is 1 + 2/3 a n."""
    light = item3d.prefilter((1 + 0.8 * directions(64)).float())
    assert_close(light.diffuse, 1 + 0.8 * 2 / 3 * directions(128), 1e-3)


def test_levels_are_sums_under_ggx():
    size = 64
    cube = (torch.rand(6, size, size, 3) * 0.2 + 1 + 0.5 * directions(size)).float()
    cube[2, 20, 45] = 800
    cube[4, 3, 0] = 300  # at an edge between faces
    light = item3d.prefilter(cube)
    assert [map.shape[1] for map in light.specular] == chain_sizes(size)
    sources, angle = directions(size).view(-1, 3), solid_angles(size)
    flux = cube.double().view(-1, 3) * angle
    for roughness, map in zip(light.roughness.double(), light.specular):
        normals = directions(map.shape[1]).view(-1, 3)
        chosen = torch.arange(5, len(normals), len(normals) // 101)
        cosine = (normals[chosen] @ sources.T).clamp_min(0)
        # For n = v the half vector is between n and l: (n.h)^2 = (1 + n.l) / 2.
        weight = cosine / (0.5 * (1 + cosine) * (roughness ** 4 - 1) + 1) ** 2
        expected = weight @ flux / (weight @ angle)
        error = (map.double().view(-1, 3)[chosen] - expected).abs().sum() / expected.sum()
        assert error < 0.006, (float(roughness), float(error))


def test_irradiance_where_a_sun_sets():
    size = 128
    cube = (0.02 + 0.01 * directions(size)).float()
    cube[2, 42:45, 64:68] += 300
    found = item3d.prefilter(cube).diffuse.double().view(-1, 3)[::397]
    normals = directions(128).view(-1, 3)[::397]
    cosine = (normals @ directions(size).view(-1, 3).T).clamp_min(0)
    expected = cosine @ (cube.double().view(-1, 3) * solid_angles(size)) / (cosine @ solid_angles(size))
    assert ((found - expected).abs() / expected).max() < 0.005


@pytest.mark.parametrize('kind', ['equirectangular', 'cube', 'sun'])
def test_gradients(kind):
    environment = torch.rand(20, 40, 3) if kind == 'equirectangular' else torch.rand(6, 32, 32, 3)
    if kind == 'sun':
        environment[2, 5, 6:8] = 500
    leaf = environment.clone().requires_grad_()
    light = item3d.prefilter(leaf, size=32)
    weights = [torch.randn_like(map) for map in maps_of(light)]

    def loss(x):
        return sum((map.double() * w).sum() for map, w in zip(maps_of(item3d.prefilter(x, size=32)), weights))

    loss(leaf).backward()
    # The light is linear in the environment, so the step may be large. It must be smaller than the sun, so that it does
    # not add another sun, which would be treated separately.
    entries = torch.randperm(environment.numel())[:6]
    assert_close(leaf.grad.flatten()[entries], differences(loss, environment, 1.0, entries), 2e-3)
    # The gradient is the adjoint: <A x, y> = <x, A^T y>.
    assert_close((leaf.grad.double() * environment).sum(), loss(environment), 1e-3)


def test_only_the_maps_that_are_used_have_gradients():
    cube = torch.rand(6, 16, 16, 3, requires_grad=True)
    light = item3d.prefilter(cube)
    light.diffuse.sum().backward()
    alone = cube.grad.clone()
    cube.grad = None
    light = item3d.prefilter(cube)
    (light.diffuse.sum() + 0 * sum(map.sum() for map in light.specular)).backward()
    assert alone.any() and torch.equal(alone, cube.grad)


def test_equirectangular_columns_are_directions():
    rows, columns = (torch.arange(64) + 0.5) / 64, (torch.arange(128) + 0.5) / 128
    polar, azimuth = torch.meshgrid(rows * torch.pi, (columns - 0.5) * 2 * torch.pi, indexing='ij')
    environment = 1 + torch.stack([polar.sin() * azimuth.sin(), polar.cos(), -polar.sin() * azimuth.cos()], -1)
    cube = ops.equirectangular(environment, 16)
    assert_close(cube, 1 + directions(16), 0.01)


def test_a_sun_of_one_texel_is_not_missed():
    environment = torch.zeros(64, 128, 3)
    environment[20, 77] = 1000
    flux = 1000 * np.sin(np.pi * 20.5 / 64) * (np.pi / 64) ** 2
    for size in (16, 64):
        cube = item3d.shading._to_cube(environment, size).double().view(-1, 3)
        found = (cube * solid_angles(size) * 4 / size ** 2).sum(0)
        assert ((found - flux).abs() < 0.1 * flux).all()


def test_threads_do_not_change_a_bit():
    environment, results = torch.rand(64, 128, 3).pow(8) * 50, []
    before = torch.get_num_threads()
    try:
        for threads in (1, 2, 3):
            torch.set_num_threads(threads)
            leaf = environment.clone().requires_grad_()
            light = item3d.prefilter(leaf, size=64)
            sum(map.square().mul(0.5).flatten()[::7].sum() for map in maps_of(light)).backward()
            results.append([*maps_of(light), leaf.grad])
    finally:
        torch.set_num_threads(before)
    for other in results[1:]:
        assert all(torch.equal(a, b) for a, b in zip(results[0], other))


def test_compiled_without_breaks_it_gives_the_same():
    torch._dynamo.reset()

    def loss(x):
        light = item3d.prefilter(x, size=16)
        return sum(map.square().mean() for map in light.specular) + light.diffuse.mean() * light.roughness[0]

    results = []
    for function in (loss, torch.compile(loss, backend='aot_eager', fullgraph=True)):
        torch.manual_seed(1)
        leaf = torch.rand(40, 80, 3).requires_grad_()
        value = function(leaf)
        value.backward()
        results.append((value, leaf.grad))
    assert results[0][1].any()
    for a, b in zip(*results):
        assert_close(b, a, 1e-5)


def test_shapes_that_the_compiler_is_told_are_right():
    check = ('test_schema', 'test_faketensor')
    environment = torch.rand(8, 16, 3)
    torch.library.opcheck(ops.equirectangular.default, (environment, 16), test_utils=check)
    torch.library.opcheck(ops.equirectangular_backward.default, (torch.rand(6, 16, 16, 3), 8, 16),
                          test_utils=check)
    for size in (16, 32, 64):
        cube = torch.rand(6, size, size, 3)
        torch.library.opcheck(ops.prefilter.default, (cube,), test_utils=check)
        maps, weights, _, bright = ops.prefilter(cube)
        torch.library.opcheck(ops.prefilter_backward.default, (maps, weights, bright, size), test_utils=check)


@pytest.mark.parametrize('environment, size, error, message', [
    (torch.zeros(8, 16, 4), 256, ValueError, r'environment must be of shape \[\*, \*, 3\] or \[6, \*, \*, 3\]'),
    (torch.zeros(8, 16, 3).double(), 256, TypeError, 'environment must be float32, found float64'),
    ([1.0], 256, TypeError, 'environment must be a tensor, found list'),
    (torch.zeros(8, 16, 3, device='meta'), 256, ValueError, 'must be on the CPU or a CUDA device, found meta'),
    (torch.zeros(8, 16, 3), 100, ValueError, 'a power of two in .16, 1024., found 100'),
    (torch.zeros(6, 24, 24, 3), 256, ValueError, 'a power of two in .16, 1024. texels, found 24 x 24'),
    (torch.zeros(6, 32, 16, 3), 256, ValueError, 'square'),
    (torch.full((8, 16, 3), torch.nan), 16, RuntimeError, 'environment must be finite, found NaN'),
    (torch.full((6, 16, 16, 3), torch.inf), 16, RuntimeError, 'environment must be finite'),
    (torch.zeros(0, 16, 3), 16, RuntimeError, 'must have texels'),
])
def test_errors_say_what_was_wanted(environment, size, error, message):
    with pytest.raises(error, match=message):
        item3d.prefilter(environment, size=size)
