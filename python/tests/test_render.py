import dataclasses
import pathlib

import pytest
import torch
from torch.nn.functional import normalize

import files
import item3d
from conftest import assert_close, cube, differences

MUG = pathlib.Path(__file__).resolve().parents[2] / 'assets/demo/mug.glb'
FIELD_OF_VIEW = 0.8


@pytest.fixture(scope='module')
def light():
    torch.manual_seed(5)
    return item3d.prefilter(torch.rand(6, 32, 32, 3) + 0.2)


def quad(z=0.0, half=1.0, **more):
    """Returns a square that faces +z."""
    corner = torch.tensor([[-1.0, -1], [1, -1], [1, 1], [-1, 1]])
    positions = torch.cat([corner * half, torch.full((4, 1), z)], 1)
    return item3d.Primitive(positions=positions, normals=torch.tensor([[0.0, 0, 1]]).repeat(4, 1),
                            triangles=torch.tensor([[0, 1, 2], [0, 2, 3]], dtype=torch.int32),
                            uvs=torch.stack([corner[:, 0] + 1, 1 - corner[:, 1]], 1) / 2, **more)


def facing(size, half=1.0):
    """Returns a camera whose image is exactly filled by the square at z = 0."""
    distance = half / torch.tan(torch.tensor(FIELD_OF_VIEW / 2)).item()
    return item3d.camera((0, 0, distance), size=size, field_of_view=FIELD_OF_VIEW)


def ball(rows=24, columns=48):
    """Returns a unit sphere with a UV seam."""
    v, u = torch.meshgrid(torch.linspace(0, 1, rows + 1), torch.linspace(0, 1, columns + 1), indexing='ij')
    polar, azimuth = v * torch.pi, u * 2 * torch.pi
    positions = torch.stack([polar.sin() * azimuth.sin(), polar.cos(), polar.sin() * azimuth.cos()], -1).view(-1, 3)
    first = (torch.arange(rows)[:, None] * (columns + 1) + torch.arange(columns)).flatten()
    below = first + columns + 1
    triangles = torch.cat([torch.stack([first, below, first + 1], 1)[columns:],
                           torch.stack([first + 1, below, below + 1], 1)[:-columns]])
    return dict(positions=positions, normals=normalize(positions, dim=1), uvs=torch.stack([u, v], -1).view(-1, 2),
                triangles=triangles.to(torch.int32))


def unlit(color, **more):
    return item3d.Material(base_color_factor=color, unlit=True, **more)


def test_a_square_is_shade_at_each_pixel(light):
    material = item3d.Material(base_color_factor=(0.8, 0.3, 0.1, 1), roughness_factor=0.3, metallic_factor=0.6,
                               emissive_factor=(0.1, 0.2, 0.3))
    camera = facing((20, 20))
    found = item3d.render(item3d.Model(primitives=[quad()], materials=[material]), camera, light, (20, 20), samples=1)
    centre = (torch.arange(20) + 0.5) / 10 - 1
    y, x = torch.meshgrid(-centre, centre, indexing='ij')
    view = normalize(camera.position[0] - torch.stack([x, y, torch.zeros(20, 20)], -1), dim=-1)
    up = torch.tensor([0.0, 0, 1]).expand(20, 20, 3)
    expected = item3d.shade(light, normal=up, view=view, base_color=torch.tensor([0.8, 0.3, 0.1]).expand(20, 20, 3),
                            roughness=0.3, metallic=0.6, emissive=torch.tensor([0.1, 0.2, 0.3]).expand(20, 20, 3))
    assert (found[..., 3] == 1).all()
    assert_close(found[0, ..., :3], expected, 1e-4)


def test_textures_are_decoded_and_lie_as_in_gltf(light):
    texture = torch.rand(16, 16, 3)
    model = item3d.Model(primitives=[quad()], textures=[texture],
                         materials=[unlit((1, 1, 1, 1), base_color_texture=0)])
    found = item3d.render(model, facing((16, 16)), light, (16, 16), samples=1)
    assert_close(found[0, ..., :3], item3d.srgb_to_linear(texture), 1e-4)
    assert_close(item3d.linear_to_srgb(item3d.srgb_to_linear(texture)), texture, 1e-5)


@pytest.mark.parametrize('curve, formula', [
    (item3d.srgb_to_linear, lambda x: torch.where(x <= 0.04045, x / 12.92,
                                                  ((x.clamp(min=0.04) + 0.055) / 1.055) ** 2.4)),
    (item3d.linear_to_srgb, lambda x: torch.where(x <= 0.0031308, 12.92 * x,
                                                  1.055 * x.clamp(min=0.003) ** (1 / 2.4) - 0.055))])
def test_transfer_functions_are_their_formulas(curve, formula):
    values = torch.cat([torch.linspace(-1, 4, 20011), 10 ** torch.linspace(-8, 5.9, 9973)])
    found, exact = values.clone().requires_grad_(), values.double().requires_grad_()
    result, expected = curve(found), formula(exact)
    tolerance = torch.where(exact.abs() > 4, 5e-6, 1e-6)
    assert ((result - expected).abs() <= tolerance * expected.abs() + 1e-12).all()
    result.sum().backward()
    expected.sum().backward()
    assert ((found.grad - exact.grad).abs() <= tolerance * exact.grad).all()
    # A value is rounded by itself: not by its place, nor by its neighbours.
    assert torch.equal(curve(values[7:12345]), result[7:12345])
    assert torch.equal(curve(values[5:6]), result[5:6])


def test_transfer_functions_keep_values_that_are_not_colors():
    strange = torch.tensor([0.5, float('nan'), float('inf'), 1e30, -1e30, 0.25])
    for curve in (item3d.srgb_to_linear, item3d.linear_to_srgb):
        found = curve(strange)
        assert_close(found[[0, 5]], curve(strange[[0, 5]]), 1e-6)
        assert found[1].isnan() and found[2].isinf() and found[4] < -1e28
    with pytest.raises(TypeError, match='srgb_to_linear: values must be float32, found float64'):
        item3d.srgb_to_linear(strange.double())
    assert item3d.srgb_to_linear(torch.tensor(0.5)).shape == ()


def test_a_model_whose_mesh_changes_is_drawn_as_it_is(light):
    """What is kept of the mesh of the last image is of no use for another one."""
    primitive = quad()
    model = item3d.Model(primitives=[primitive], materials=[unlit((1, 1, 1, 1))])
    camera = facing((9, 9))

    def drawn(of):
        return item3d.render(of, camera, light, (9, 9), samples=1)

    assert torch.equal(drawn(model), drawn(model))
    primitive.positions.data *= 0.6
    assert torch.equal(drawn(model), drawn(dataclasses.replace(model)))
    primitive.triangles[1] = primitive.triangles[0]
    assert torch.equal(drawn(model), drawn(dataclasses.replace(model)))
    assert 0 < drawn(model)[..., 3].mean() < 0.3


def test_all_channels_of_a_material(light):
    """Textures with a single value act like factors, and their channels are those of glTF."""
    def flat(*values):
        return torch.tensor(values).expand(4, 4, len(values)).contiguous()

    textures = [flat(0.5, 0.7, 0.9), flat(0.9, 0.4, 0.6), flat(0.8, 0.1, 0.2), flat(0.5 + 0.3, 0.5 - 0.2, 0.9),
                flat(0.2, 0.4, 0.6), flat(0.25)]
    material = item3d.Material(base_color_factor=(0.5, 1, 1, 1), base_color_texture=0, roughness_factor=0.9,
                               metallic_factor=0.5, metallic_roughness_texture=1, occlusion_texture=2,
                               occlusion_strength=0.5, normal_texture=3, normal_scale=0.7, emissive_texture=4,
                               emissive_factor=(1, 0.5, 2))
    camera = facing((6, 6))
    found = item3d.render(item3d.Model(primitives=[quad()], materials=[material], textures=textures), camera, light,
                          (6, 6), samples=1)
    centre = (torch.arange(6) + 0.5) / 3 - 1
    y, x = torch.meshgrid(-centre, centre, indexing='ij')
    view = normalize(camera.position[0] - torch.stack([x, y, torch.zeros(6, 6)], -1), dim=-1)
    # The tangent is +x, and +y (up) of the normal map is +y.
    normal = normalize(torch.tensor([0.6 * 0.7, -0.4 * 0.7, 0.8]), dim=0).expand(6, 6, 3)
    emitted = item3d.srgb_to_linear(textures[4][0, 0]) * torch.tensor([1, 0.5, 2])
    color = item3d.srgb_to_linear(textures[0][0, 0]) * torch.tensor([0.5, 1, 1])
    expected = item3d.shade(light, normal=normal, view=view, base_color=color.expand(6, 6, 3), roughness=0.9 * 0.4,
                            metallic=0.5 * 0.6, occlusion=1 + 0.5 * (0.8 - 1), emissive=emitted.expand(6, 6, 3))
    assert_close(found[0, ..., :3], expected, 1e-4)
    grey = item3d.Model(primitives=[quad()], materials=[unlit((1, 1, 1, 1), base_color_texture=0)],
                        textures=textures[5:])
    found = item3d.render(grey, camera, light, (6, 6), samples=1)
    assert_close(found, torch.cat([item3d.srgb_to_linear(torch.full((1, 6, 6, 3), 0.25)), torch.ones(1, 6, 6, 1)], -1),
                 1e-5)


def test_each_primitive_has_its_material(light):
    model = item3d.Model(primitives=[quad(half=1.0, material=1), quad(z=0.001, half=0.5, material=0)],
                         materials=[unlit((1, 0, 0, 1)), unlit((0, 0, 1, 1))])
    found = item3d.render(model, facing((16, 16)), light, (16, 16), samples=1)[0]
    assert torch.equal(found[8, 8], torch.tensor([1.0, 0, 0, 1]))
    assert torch.equal(found[1, 8], torch.tensor([0.0, 0, 1, 1]))


def test_layers_of_alpha(light):
    cutout = torch.ones(4, 4, 4)
    cutout[:, :2, 3] = 0.2
    model = item3d.Model(
        primitives=[quad(z=-0.1, half=2, material=0), quad(z=-0.05, half=2, material=1), quad(material=2)],
        materials=[unlit((0, 1, 0, 1)), unlit((0, 0, 1, 0.25), alpha='blend'),
                   unlit((1, 0, 0, 1), base_color_texture=0, alpha='mask')], textures=[cutout])
    found = item3d.render(model, facing((16, 16)), light, (16, 16), samples=1)[0]
    assert_close(found[8, 12], torch.tensor([1.0, 0, 0, 1]), 1e-6)
    assert_close(found[8, 3], torch.tensor([0.0, 0.75, 0.25, 1]), 1e-6)
    alone = item3d.Model(primitives=[quad(half=0.5)], materials=[unlit((0, 0, 1, 0.25), alpha='blend')])
    clear = item3d.render(alone, facing((16, 16)), light, (16, 16))[0]
    assert_close(clear[8, 8], torch.tensor([0.0, 0, 0.25, 0.25]), 1e-6)
    assert not clear[0, 0].any()
    before_white = item3d.render(alone, facing((16, 16)), light, (16, 16), background=(1, 1, 1))[0]
    assert_close(before_white[8, 8], torch.tensor([0.75, 0.75, 1, 1]), 1e-6)
    assert torch.equal(before_white[0, 0], torch.ones(4))


def test_a_view_of_nothing_is_empty(light):
    camera = item3d.camera((0, 0, 5), (0, 0, 9), size=(8, 8))
    assert not item3d.render(item3d.Model(primitives=[quad()]), camera, light, (8, 8)).any()


def test_back_sides_are_lit_from_their_side(light):
    """A square looks the same from behind as a square that faces the viewer."""
    turned = quad()
    turned = dataclasses.replace(turned, positions=turned.positions * torch.tensor([-1.0, 1, -1]),
                                 normals=-turned.normals)
    camera = item3d.camera((0.3, 0.2, -4), size=(12, 12))
    a, b = (item3d.render(item3d.Model(primitives=[one]), camera, light, (12, 12)) for one in (quad(), turned))
    assert a[..., 3].max() == 1
    assert_close(a, b, 1e-4)


def test_views_at_once_are_views_one_by_one(light):
    model = scene()
    eyes = torch.tensor([[0.0, 1, 4], [3, -1, 2]])
    both = item3d.render(model, item3d.camera(eyes, size=(24, 20)), light, (24, 20))
    for eye, image in zip(eyes, both):
        assert torch.equal(item3d.render(model, item3d.camera(eye, size=(24, 20)), light, (24, 20))[0], image)


def scene():
    """Returns a sphere with all textures, and a half transparent cube with vertex colours."""
    torch.manual_seed(3)

    def texture(height, width, channels, low=0, high=255):
        return torch.randint(low, high + 1, (height, width, channels)) / 255.0

    def smooth(height, width, channels, **more):
        coarse = texture(height // 4, width // 4, channels, **more).permute(2, 0, 1)[None]
        fine = torch.nn.functional.interpolate(coarse, (height, width), mode='bilinear')[0].permute(1, 2, 0)
        return (fine * 255).round() / 255

    corners, triangles = cube()
    points = corners[triangles.long()].view(-1, 3)
    faces = torch.linalg.cross(points[1::3] - points[0::3], points[2::3] - points[0::3])
    box = item3d.Primitive(positions=points * 0.4 + torch.tensor([1.1, 0.2, 0.9]),
                           normals=normalize(faces, dim=1).repeat_interleave(3, 0),
                           triangles=torch.arange(36, dtype=torch.int32).view(-1, 3),
                           colors=torch.cat([torch.rand(36, 3), torch.ones(36, 1)], 1), material=1)
    plain = item3d.Material(base_color_factor=(1, 0.9, 0.8, 0.6), roughness_factor=0.7, metallic_factor=0.1,
                            alpha='blend')
    rich = item3d.Material(base_color_texture=0, metallic_roughness_texture=1, occlusion_texture=1, normal_texture=2,
                           normal_scale=0.8, emissive_texture=3, emissive_factor=(0.2, 0.1, 0.05),
                           occlusion_strength=0.7, metallic_factor=0.8)
    tiled = ball()
    tiled['uvs'] = tiled['uvs'] * torch.tensor([3.0, 2.0]) - 0.3
    return item3d.Model(
        primitives=[item3d.Primitive(**tiled, material=0), box], materials=[rich, plain],
        textures=[texture(32, 64, 3), smooth(32, 32, 3, low=60), smooth(32, 32, 3, low=100, high=155),
                  texture(8, 8, 3)],
        wraps=[('repeat', 'mirrored_repeat'), ('mirrored_repeat', 'clamp_to_edge'), ('repeat', 'repeat'),
               ('clamp_to_edge', 'repeat')])


def program():
    try:
        return item3d.find_program()
    except item3d.ProgramMissing as error:
        pytest.skip(str(error))


def program_pictures(folder, model_file, camera, environment, size, *options):
    """Returns the images of `item3d render`, and the light that it has read."""
    program()
    light = files.write_radiance(folder / 'light.hdr', environment)
    files.write_cameras(folder / 'cameras.json', camera, FIELD_OF_VIEW)
    item3d.program.run_command(
        ['render', model_file, '-o', folder / 'pictures', '--format', 'exr', '--light', folder / 'light.hdr',
         '--cameras', folder / 'cameras.json', '--size', f'{size[1]}x{size[0]}', '--device', 'cpu', *options])
    return torch.stack([files.read_exr(folder / f'pictures/view_{i}.exr')
                        for i in range(len(camera.world_to_camera))]), light


def expect_the_same(found, expected):
    """Compares two images, which may differ because footprints and positions differ in their last bits."""
    error = (found - expected).abs().amax(-1)
    scale = float(expected.abs().max())
    assert expected[..., :3].std() > 0.03
    assert float(error.mean()) < 3e-6 * scale and float(error.max()) < 1e-3 * scale, (
        f'off by {float(error.mean()):.2g} on average and {float(error.max()):.2g} at most, of {scale:.3g}')


@pytest.mark.parametrize('options, more', [
    ([], {}), (['--samples', '1', '--background', '#ff8000'],
              dict(samples=1, background=item3d.srgb_to_linear(torch.tensor([1.0, 128 / 255, 0]))))])
def test_it_is_the_programs_picture(tmp_path, options, more):
    size = (60, 80)
    camera = item3d.camera(torch.tensor([[0.5, 1.5, 5], [-3, -1, 3]]), (0.3, 0, 0.2), size=size,
                           field_of_view=FIELD_OF_VIEW)
    environment = torch.rand(32, 64, 3) + torch.rand(32, 64, 1).pow(20) * 50 + 0.05
    model = scene()
    files.write_gltf(tmp_path / 'scene.gltf', model)
    expected, light = program_pictures(tmp_path, tmp_path / 'scene.gltf', camera, environment, size, *options)
    expect_the_same(item3d.render(model, camera, item3d.prefilter(light), size, **more), expected)


def test_the_mug_is_the_programs(tmp_path):
    program()
    try:
        model = item3d.load(MUG)
    except item3d.UsageError:
        pytest.skip('the program has no command `tensors`')
    size = (96, 96)
    points = torch.cat([part.positions for part in model.primitives])
    middle, radius = (points.amin(0) + points.amax(0)) / 2, float((points.amax(0) - points.amin(0)).norm()) / 2
    camera = item3d.camera(middle + 3 * radius * normalize(torch.tensor([0.4, 0.4, 1]), dim=0), middle, size=size,
                           field_of_view=FIELD_OF_VIEW, near=0.1 * radius, far=10 * radius)
    expected, light = program_pictures(tmp_path, MUG, camera, torch.rand(32, 64, 3) + 0.1, size)
    expect_the_same(item3d.render(model, camera, item3d.prefilter(light), size), expected)


def test_gradients_by_textures_factors_and_light(light):
    model, size = scene(), (24, 24)
    camera = item3d.camera((0.5, 1, 4), size=size)
    weights = torch.randn(1, 24, 24, 4)
    textures = [(texture * 0.8 + 0.1).requires_grad_() for texture in model.textures]
    factor = torch.tensor([0.9, 0.8, 0.7, 1.0], requires_grad=True)
    leaves = item3d.Light(light.diffuse.clone().requires_grad_(),
                          tuple(map.clone().requires_grad_() for map in light.specular), light.roughness)

    def loss(index, changed, lit=light, color=factor):
        parts = [one.detach() for one in textures]
        if index is not None:
            parts[index] = changed
        materials = [dataclasses.replace(model.materials[0], base_color_factor=color), model.materials[1]]
        picture = item3d.render(dataclasses.replace(model, textures=parts, materials=materials), camera, lit, size,
                                samples=1)
        return (picture.double() * weights).sum()

    for index, step in ((0, 1e-2), (1, 1e-2), (2, 1e-3), (3, 1e-2)):
        loss(index, textures[index]).backward()
        gradient = textures[index].grad.flatten()
        entries = gradient.abs().topk(6).indices
        expected = differences(lambda x: loss(index, x), textures[index], step, entries)
        assert gradient.any()
        good = (gradient[entries] - expected).abs() < 0.05 * expected.abs().max()
        assert good.float().mean() > 0.8, (index, gradient[entries], expected)  # for the others the step crosses a kink
    factor.grad = None
    loss(None, None, lit=leaves).backward()
    assert_close(factor.grad, differences(lambda x: loss(None, None, color=x), factor, 1e-2), 1e-2)
    entries = leaves.diffuse.grad.flatten().abs().topk(5).indices
    expected = differences(lambda x: loss(None, None, lit=light._replace(diffuse=x)), light.diffuse, 1.0, entries)
    assert_close(leaves.diffuse.grad.flatten()[entries], expected, 1e-3)
    assert all(map.grad.any() for map in leaves.specular)


def test_gradients_by_positions(light):
    """Tests the gradient of a square's motion, by antialiasing for its outline and by interpolation for its texture."""
    texture = torch.rand(4, 4, 3)
    texture = torch.nn.functional.interpolate(texture.permute(2, 0, 1)[None], (64, 64), mode='bilinear')
    part = quad(half=0.6)
    size, weights = (32, 32), torch.linspace(0.5, 1.5, 32)[:, None] * torch.linspace(0.5, 1.5, 32)

    def loss(shift):
        moved = dataclasses.replace(part, positions=part.positions + shift)
        model = item3d.Model(primitives=[moved], textures=[texture[0].permute(1, 2, 0).contiguous()],
                             materials=[item3d.Material(base_color_texture=0, metallic_factor=0.0)])
        return (item3d.render(model, facing(size), light, size)[0, ..., :3].double().sum(-1) * weights).sum()

    # At this position no outline passes through a pixel centre.
    at = torch.tensor([0.016, -0.016, 0.0])
    leaf = at.clone().requires_grad_()
    loss(leaf).backward()
    assert_close(leaf.grad, differences(loss, at, 4e-3), 0.06)


def test_a_texture_is_found_again(light):
    wanted = torch.rand(8, 8, 3) * 0.5 + 0.3
    size, camera = (16, 16), facing((16, 16))

    def draw(texture):
        model = item3d.Model(primitives=[quad()], textures=[texture],
                             materials=[item3d.Material(base_color_texture=0, metallic_factor=0.0)])
        return item3d.render(model, camera, light, size, samples=1)

    goal, found = draw(wanted), torch.full((8, 8, 3), 0.5, requires_grad=True)
    optimizer = torch.optim.Adam([found], 0.05)
    for _ in range(40):
        optimizer.zero_grad()
        (draw(found) - goal).square().mean().backward()
        optimizer.step()
    assert (found - wanted).abs().mean() < 0.02


def test_threads_do_not_change_a_bit(light):
    model, results = scene(), []
    before = torch.get_num_threads()
    try:
        for threads in (1, 2, 3):
            torch.set_num_threads(threads)
            texture = model.textures[0].clone().requires_grad_()
            positions = model.primitives[0].positions.clone().requires_grad_()
            changed = dataclasses.replace(model, textures=[texture, *model.textures[1:]], primitives=[
                dataclasses.replace(model.primitives[0], positions=positions), model.primitives[1]])
            image = item3d.render(changed, item3d.camera((0.5, 1, 4), size=(70, 70)), light, (70, 70))
            image.backward(image.detach())
            results.append([image, texture.grad, positions.grad])
    finally:
        torch.set_num_threads(before)
    for other in results[1:]:
        for a, b in zip(results[0], other):
            assert a.any() and torch.equal(a, b)


@pytest.mark.parametrize('change, error, message', [
    (dict(model=3), TypeError, 'model must be an item3d.Model, found int'),
    (dict(camera=torch.eye(4)), TypeError, 'camera must be an item3d.Camera, found Tensor'),
    (dict(camera=item3d.Camera(torch.eye(4), torch.eye(4))), ValueError,
     r'camera.world_to_camera must be of shape \[\*, 4, 4\]'),
    (dict(light=None), TypeError, 'render: light must be what prefilter'),
    (dict(model=item3d.Model(primitives=[quad()], materials=[item3d.Material(base_color_factor=(1, 1, 1))])),
     ValueError, r'materials\[0\].base_color_factor must be of shape \[4\], found \[3\]'),
    (dict(model=item3d.Model(primitives=[quad()], materials=[item3d.Material(roughness_factor=torch.ones(1))])),
     ValueError, r'materials\[0\].roughness_factor must be of shape \[\], found \[1\]'),
    (dict(model=item3d.Model(primitives=[quad()], materials=[item3d.Material(alpha='BLEND')])), ValueError,
     r"materials\[0\].alpha must be one of 'opaque', 'mask', 'blend', found 'BLEND'"),
    (dict(size=(8.5, 8)), TypeError, 'size must be two whole numbers'),
    (dict(size=(8, 8, 3)), TypeError, 'size must be two whole numbers'),
    (dict(size=(9000, 9000)), ValueError, r'size \* samples must be in'),
    (dict(samples=0), ValueError, r'samples must be a whole number in \[1, 16\], found 0'),
    (dict(background=(1, 2)), ValueError, 'background must be three numbers'),
    (dict(model=item3d.Model(primitives=[])), ValueError, 'must have a primitive'),
    (dict(model=item3d.Model(primitives=[quad(material=2)])), ValueError,
     r'primitives\[0\].material must be in \[0, 1\), found 2'),
    (dict(model=item3d.Model(primitives=[dataclasses.replace(quad(), normals=torch.zeros(3, 3))])), ValueError,
     r'primitives\[0\].normals must be of shape \[4, 3\], found \[3, 3\]'),
    (dict(model=item3d.Model(primitives=[dataclasses.replace(quad(), uvs=torch.zeros(4, 2).double())])), TypeError,
     r'primitives\[0\].uvs must be float32'),
    (dict(model=item3d.Model(primitives=[dataclasses.replace(quad(), positions=torch.full((4, 3), torch.nan))])),
     RuntimeError, 'positions'),
    (dict(model=item3d.Model(primitives=[quad()], materials=[item3d.Material(base_color_texture=1)])), ValueError,
     r'materials\[0\].base_color_texture must be below the number of textures, 0, found 1'),
    (dict(model=item3d.Model(primitives=[quad()], materials=[item3d.Material(normal_texture=0)],
                             textures=[torch.zeros(4, 4)])), ValueError, r'textures\[0\] must be of shape'),
    (dict(model=item3d.Model(primitives=[quad()], materials=[item3d.Material(normal_texture=0)],
                             textures=[torch.zeros(4, 4, 3)], wraps=[('repeat', 'mirror')])), ValueError,
     r"wraps\[0\] must be two of 'repeat', 'mirrored_repeat', 'clamp_to_edge', found 'mirror'"),
    (dict(model=item3d.Model(primitives=[quad()], textures=[torch.zeros(4, 4, 3)],
                             materials=[item3d.Material(emissive_texture=0, emissive_factor=(1, 1, 1),
                                                        emissive_uvs=1)])), ValueError, 'takes UV map 1'),
])
def test_errors_say_what_was_wanted(light, change, error, message):
    arguments = dict(model=item3d.Model(primitives=[quad()]), camera=facing((8, 8)), light=light, size=(8, 8))
    with pytest.raises(error, match=message):
        item3d.render(**{**arguments, **change})
