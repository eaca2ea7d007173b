import pytest
import torch
from torch.nn.functional import normalize

import item3d
import reference
from conftest import assert_close, differences
from item3d._library import ops


def some_light(size=16, levels=5):
    roughness = torch.tensor([0.08, 0.2, 0.4, 0.7, 1.0])[:levels]
    return item3d.Light(torch.rand(6, size, size, 3) + 0.2,
                        tuple(torch.rand(6, size, size, 3) + 0.2 for _ in range(levels)), roughness)


def some_points(*shape, rough=(0.1, 0.95)):
    normal = normalize(torch.randn(*shape, 3), dim=-1)
    view = normalize(normal + 0.6 * torch.randn(*shape, 3), dim=-1)
    view = view * (normal * view).sum(-1, True).sign()
    roughness = torch.rand(*shape, 1) * (rough[1] - rough[0]) + rough[0]
    return dict(normal=normal, view=view, base_color=torch.rand(*shape, 3), roughness=roughness,
                metallic=torch.rand(*shape, 1), occlusion=torch.rand(*shape, 1))


def albedo(n_dot_v, roughness, samples=400):
    """Returns A and B of F0 A + B for GGX with height-correlated Smith masking, from a grid of half vectors."""
    u = (torch.arange(samples, dtype=torch.float64) + 0.5) / samples
    u, azimuth = torch.meshgrid(u, u * 2 * torch.pi, indexing='ij')
    alpha2 = roughness ** 4
    cosine = ((1 - u) / (1 + (alpha2 - 1) * u)).sqrt()
    h = torch.stack([(1 - cosine ** 2).sqrt() * azimuth.cos(), (1 - cosine ** 2).sqrt() * azimuth.sin(), cosine], -1)
    v = torch.tensor([(1 - n_dot_v ** 2) ** 0.5, 0, n_dot_v], dtype=torch.float64)
    v_dot_h = (h @ v).clamp_min(0)
    n_dot_l = (2 * v_dot_h * h[..., 2] - v[2])
    seen = (n_dot_l > 0) & (v_dot_h > 0)
    n_dot_l = n_dot_l.clamp_min(1e-9)

    def smith(c):
        return (1 + (1 + alpha2 * (1 - c * c) / (c * c)).sqrt()) / 2 - 1

    masking = 1 / (1 + smith(torch.tensor(n_dot_v, dtype=torch.float64)) + smith(n_dot_l))
    weight = torch.where(seen, masking * v_dot_h / (cosine * n_dot_v), 0.0)
    fresnel = (1 - v_dot_h) ** 5
    return (weight * (1 - fresnel)).mean(), (weight * fresnel).mean()


@pytest.mark.parametrize('multiple_scattering', [False, True])
def test_under_constant_maps_it_is_the_formula(multiple_scattering):
    irradiance, levels = torch.rand(3), torch.rand(5, 3)
    roughness_of = torch.tensor([0.08, 0.2, 0.4, 0.7, 1.0])
    light = item3d.Light(irradiance.expand(6, 4, 4, 3), tuple(one.expand(6, 4, 4, 3) for one in levels),
                         roughness_of)
    points = some_points(40, rough=(0.3, 0.95))
    found = item3d.shade(light, **points, emissive=torch.full((40, 3), 0.25),
                         multiple_scattering=multiple_scattering)
    for i in range(40):
        n, v, color = (points[name][i].double() for name in ('normal', 'view', 'base_color'))
        rough, metallic, occlusion = (float(points[name][i]) for name in ('roughness', 'metallic', 'occlusion'))
        # Interpolate with the cubic polynomial in log roughness through four levels.
        first = int(rough >= 0.4)
        nodes, x, specular = roughness_of.double().log()[first:first + 4], torch.tensor(rough).double().log(), 0
        for k in range(4):
            others = [j for j in range(4) if j != k]
            weight = torch.stack([(x - nodes[j]) / (nodes[k] - nodes[j]) for j in others]).prod()
            specular = specular + weight * levels[first + k].double()
        a, b = albedo(float(n @ v), rough)
        f0 = 0.04 * (1 - metallic) + metallic * color
        reflectance = f0 * a + b
        if multiple_scattering:
            reflectance = reflectance * (1 + f0 * (1 / (a + b) - 1))
        expected = occlusion * ((1 - metallic) * color * irradiance + specular * reflectance) + 0.25
        assert_close(found[i], expected, 4e-3)


def test_mirrors_look_along_the_mirrored_view():
    smooth = torch.tensor(1 + reference.cube_directions(64), dtype=torch.float32)
    light = item3d.Light(torch.zeros(6, 4, 4, 3), (smooth,) * 4, torch.tensor([0.1, 0.3, 0.6, 1.0]))
    points = {**some_points(300), 'base_color': torch.ones(300, 3), 'metallic': 1.0, 'occlusion': 1.0,
              'roughness': 0.1}
    found = item3d.shade(light, **points)
    n, v = points['normal'], points['view']
    expected = 1 + 2 * (n * v).sum(-1, True) * n - v  # a white metal loses no light
    seen = (n * v).sum(-1) > 0.1
    assert_close(found[seen], expected[seen], 5e-3)


def test_normal_maps_are_in_the_tangents_frame():
    light, points = some_light(), some_points(200)
    n = points['normal']
    across = normalize(torch.linalg.cross(n, torch.randn_like(n)), dim=-1)
    handedness = torch.randn(200, 1).sign()
    leaning = normalize(torch.randn(200, 3) * 0.3 + torch.tensor([0.0, 0, 1]), dim=-1)
    # Tangents need not be orthogonal to the normal.
    tangent = torch.cat([across + 0.3 * n, handedness], -1)
    found = item3d.shade(light, **points, normal_map=leaning, tangent=tangent)
    bent = leaning[:, :1] * across + leaning[:, 1:2] * handedness * torch.linalg.cross(n, across) + leaning[:, 2:] * n
    expected = item3d.shade(light, **{**points, 'normal': bent})
    assert_close(found, expected, 1e-4)


@pytest.mark.parametrize('mapped', [False, True])
def test_gradients_by_points(mapped):
    light, points = some_light(), some_points(60)
    if mapped:
        points['normal_map'] = normalize(torch.randn(60, 3) * 0.3 + torch.tensor([0.0, 0, 1]), dim=-1)
        points['tangent'] = torch.cat([torch.linalg.cross(points['normal'], torch.randn(60, 3)),
                                       torch.randn(60, 1).sign()], -1)
    weights = torch.randn(60, 3)

    def loss(changed):
        return (item3d.shade(light, **{**points, **changed}).double() * weights).sum()

    names = ['base_color', 'roughness', 'metallic', 'occlusion', 'normal'] + ['normal_map'] * mapped
    leaves = {name: points[name].clone().requires_grad_() for name in names}
    loss(leaves).backward()
    for name in names:
        expected = differences(lambda x: loss({name: x}), points[name], 1e-3)
        found = leaves[name].grad.reshape(-1)
        good = (found - expected).abs() < 0.01 * expected.abs().max() + 0.02 * expected.abs()
        # The function has a kink at texel centres, at edges of faces and at entries of the table.
        assert found.any() and good.double().mean() > (0.95 if name in ('base_color', 'metallic', 'occlusion')
                                                       else 0.85), (name, good.double().mean())


@pytest.mark.parametrize('count', [50, 20000])
def test_gradients_by_the_light(count):
    light, points = some_light(8), some_points(count)
    leaves = item3d.Light(light.diffuse.clone().requires_grad_(),
                          tuple(map.clone().requires_grad_() for map in light.specular), light.roughness)
    weights = torch.randn(count, 3)

    def loss(maps):
        return (item3d.shade(item3d.Light(maps[0], tuple(maps[1:]), light.roughness), **points).double()
                * weights).sum()

    maps = [light.diffuse, *light.specular]
    loss([leaves.diffuse, *leaves.specular]).backward()
    for i, (map, leaf) in enumerate(zip(maps, [leaves.diffuse, *leaves.specular])):
        entries = torch.randperm(map.numel())[:60]
        expected = differences(lambda x: loss([*maps[:i], x, *maps[i + 1:]]), map, 1.0, entries)  # linear
        assert leaf.grad.any()
        assert (leaf.grad.flatten()[entries] - expected).abs().max() < 1e-3 * leaf.grad.abs().max()


def test_where_nothing_is_seen_it_is_black_without_gradients():
    light, points = some_light(), some_points(2, 3, 4)
    points['normal'][0] = 0
    points['view'][1, 1] = 0
    leaves = {name: value.clone().requires_grad_() for name, value in points.items()}
    found = item3d.shade(light, **leaves)
    assert found.shape == (2, 3, 4, 3)
    assert not found[0].any() and not found[1, 1].any() and found[1, 0].all() and found[1, 2].all()
    found.sum().backward()
    for name in ('normal', 'base_color', 'roughness', 'metallic', 'occlusion'):
        gradient = leaves[name].grad
        assert not gradient[0].any() and not gradient[1, 1].any() and gradient[1, 0].any(), name
    none = item3d.shade(light, **{name: value[:0] for name, value in points.items()})
    assert none.shape == (0, 3, 4, 3)


def test_numbers_are_tensors_of_one_value():
    light, points = some_light(), some_points(5, 6)
    points.update(roughness=0.3, metallic=1, occlusion=0.5)
    full = {name: torch.full((5, 6, 1), float(value)) if isinstance(value, (int, float)) else value
            for name, value in points.items()}
    assert torch.equal(item3d.shade(light, **points), item3d.shade(light, **full))


def test_threads_do_not_change_a_bit():
    light, points, results = some_light(8), some_points(20000), []
    before = torch.get_num_threads()
    try:
        for threads in (1, 2, 3):
            torch.set_num_threads(threads)
            leaves = {name: value.clone().requires_grad_() for name, value in points.items()}
            maps = item3d.Light(light.diffuse.clone().requires_grad_(),
                                tuple(map.clone().requires_grad_() for map in light.specular), light.roughness)
            found = item3d.shade(maps, **leaves)
            found.backward(found.detach())
            results.append([found, maps.diffuse.grad, *(map.grad for map in maps.specular),
                            *(leaf.grad for name, leaf in leaves.items() if name != 'view')])
    finally:
        torch.set_num_threads(before)
    for other in results[1:]:
        assert all(torch.equal(a, b) for a, b in zip(results[0], other))


def test_compiled_without_breaks_it_gives_the_same():
    torch._dynamo.reset()

    def loss(environment, points):
        return item3d.shade(item3d.prefilter(environment), **points).square().mean()

    results = []
    for function in (loss, torch.compile(loss, backend='aot_eager', fullgraph=True)):
        torch.manual_seed(1)
        environment = torch.rand(6, 16, 16, 3).requires_grad_()
        points = some_points(4, 5)
        points['base_color'].requires_grad_()
        value = function(environment, points)
        value.backward()
        results.append((value, environment.grad, points['base_color'].grad))
    assert results[0][1].any()
    for a, b in zip(*results):
        assert_close(b, a, 1e-5)


def test_shapes_that_the_compiler_is_told_are_right():
    check = ('test_schema', 'test_faketensor')
    light, points = some_light(4), some_points(7)
    tangent = torch.randn(7, 4)
    for mapped in (False, True):
        arguments = (points['base_color'], torch.rand(7, 3), points['normal'] if mapped else None,
                     points['normal'], tangent if mapped else None, points['view'], light.diffuse,
                     list(light.specular), light.roughness, True)
        torch.library.opcheck(ops.shade.default, arguments, test_utils=check)
        for wanted in ((True, False), (False, True)):
            torch.library.opcheck(ops.shade_backward.default, (*arguments, torch.randn(7, 3), *wanted),
                                  test_utils=check)


LIGHT = some_light(4)


@pytest.mark.parametrize('change, error, message', [
    (dict(light=3), TypeError, r'light must be what prefilter\(\) returned, found int'),
    (dict(light=LIGHT._replace(specular=LIGHT.specular[:3], roughness=LIGHT.roughness[:3])), RuntimeError,
     'light.specular needs 4 to 16 levels'),
    (dict(light=LIGHT._replace(roughness=LIGHT.roughness.flip(0))), RuntimeError, 'ascending'),
    (dict(light=LIGHT._replace(diffuse=torch.zeros(6, 4, 3, 3))), RuntimeError, 'square faces'),
    (dict(base_color=torch.zeros(2, 3, 4)), ValueError, r'base_color must be of shape \[\*, \*, 3\]'),
    (dict(base_color=None), TypeError, 'base_color must be a tensor'),
    (dict(normal=torch.zeros(2, 3)), ValueError, r'normal must be of shape \[2, 3, 3\], found \[2, 3\]'),
    (dict(view=None), TypeError, 'view must be a tensor'),
    (dict(view=torch.zeros(2, 3, 3).double()), TypeError, 'view must be float32, found float64'),
    (dict(roughness=torch.zeros(2, 3)), ValueError, r'roughness must be of shape \[2, 3, 1\]'),
    (dict(metallic='steel'), TypeError, 'metallic must be a tensor, found str'),
    (dict(occlusion=torch.zeros(2, 3, 1, device='meta')), ValueError, 'occlusion must be on the CPU or a CUDA device'),
    (dict(normal_map=torch.zeros(2, 3, 3)), ValueError, 'normal_map needs a tangent'),
    (dict(normal=torch.full((2, 3, 3), torch.nan)), RuntimeError, 'normal must be finite, found NaN or infinity'),
    (dict(roughness=torch.full((2, 3, 1), torch.inf)), RuntimeError,
     'occlusion, roughness and metallic must be finite'),
    (dict(base_color=torch.full((2, 3, 3), torch.nan)), RuntimeError, 'base_color must be finite'),
])
def test_errors_say_what_was_wanted(change, error, message):
    points = dict(light=LIGHT, normal=torch.ones(2, 3, 3), view=torch.ones(2, 3, 3),
                  base_color=torch.ones(2, 3, 3), roughness=0.5, metallic=0.0)
    with pytest.raises(error, match=message):
        item3d.shade(**{**points, **change})
