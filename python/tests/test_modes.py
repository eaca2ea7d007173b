"""PyTorch's modes around the operations: derivatives that they do not have, autocast, inference, default types."""
import pytest
import torch

import item3d

SIZE = (8, 10)


def triangle():
    positions = torch.tensor([[[-0.8, -0.8, 0, 1], [0.8, -0.8, 0, 1], [0, 0.8, 0, 1]]])
    return positions, torch.tensor([[0, 1, 2]], dtype=torch.int32)


def scene():
    """Returns a model of one textured triangle, a camera and a light."""
    positions, triangles = triangle()
    corners = positions[0, :, :3].contiguous()
    primitive = item3d.Primitive(positions=corners, normals=torch.tensor([[0.0, 0, 1]] * 3), triangles=triangles,
                                 uvs=corners[:, :2].contiguous())
    model = item3d.Model(primitives=[primitive], materials=[item3d.Material(base_color_texture=0)],
                         textures=[torch.rand(4, 4, 3)])
    return model, item3d.camera((0, 0, 3), size=SIZE), item3d.prefilter(torch.rand(8, 16, 3), size=16)


def operations():
    """Yields a function and its argument for each operation with gradients."""
    positions, triangles = triangle()
    raster = item3d.rasterize(positions, triangles, SIZE)
    uv = torch.rand(1, *SIZE, 2)
    _, _, light = scene()
    normal = torch.tensor([[0.0, 0, 1]])
    yield lambda x: item3d.rasterize(x, triangles, SIZE).pixels, positions
    yield lambda x: item3d.interpolate(x, raster, triangles), torch.rand(3, 2)
    yield lambda x: item3d.texture(x, uv), torch.rand(1, 4, 4, 3)
    yield lambda x: item3d.antialias(x, raster, positions, triangles), torch.rand(1, *SIZE, 3)
    yield item3d.srgb_to_linear, torch.rand(5)
    yield lambda x: item3d.prefilter(x, size=16).diffuse, torch.rand(8, 16, 3)
    yield lambda x: item3d.shade(light, normal=normal, view=normal, base_color=x, roughness=0.5,
                                 metallic=0.0), torch.rand(1, 3)


def test_a_second_derivative_is_an_error():
    for function, argument in operations():
        argument = argument.clone().requires_grad_()
        gradient, = torch.autograd.grad(function(argument).sum(), argument, create_graph=True)
        with pytest.raises(RuntimeError, match='item3d has no second derivatives'):
            gradient.square().sum().backward()


def test_create_graph_gives_the_same_gradient():
    for function, argument in operations():
        argument = argument.clone().requires_grad_()
        once, = torch.autograd.grad(function(argument).sum(), argument)
        again, = torch.autograd.grad(function(argument).sum(), argument, create_graph=True)
        assert torch.equal(once, again)


def test_a_forward_mode_derivative_is_an_error():
    for function, argument in operations():
        with pytest.raises(NotImplementedError, match='no forward-mode derivatives'):
            torch.func.jvp(function, (argument,), (argument,))


def test_render_computes_in_float32_under_autocast():
    model, camera, light = scene()
    expected = item3d.render(model, camera, light, SIZE)
    with torch.autocast('cpu', dtype=torch.bfloat16):
        assert torch.equal(item3d.render(model, camera, light, SIZE), expected)


def test_a_model_can_be_optimised_after_an_image_in_inference_mode():
    model, camera, light = scene()
    with torch.inference_mode():
        expected = item3d.render(model, camera, light, SIZE)
    model.primitives[0].positions.requires_grad_()
    image = item3d.render(model, camera, light, SIZE)
    assert torch.equal(image, expected)
    image.sum().backward()


def test_default_types_and_devices_change_nothing():
    model, camera, light = scene()
    expected = item3d.render(model, camera, light, SIZE)
    try:
        torch.set_default_dtype(torch.float64)
        assert torch.equal(item3d.render(model, camera, light, SIZE), expected)
        torch.set_default_dtype(torch.float32)
        torch.set_default_device('meta')
        image = item3d.render(model, camera, light, SIZE)
    finally:
        torch.set_default_dtype(torch.float32)
        torch.set_default_device(None)
    assert torch.equal(image, expected)


def test_options_of_another_type_are_errors():
    positions, triangles = triangle()
    raster = item3d.rasterize(positions, triangles, SIZE, derivatives=True)
    texture, uv = torch.rand(1, 4, 4, 3), torch.rand(1, *SIZE, 2)
    with pytest.raises(TypeError, match="rasterize: derivatives must be True or False, found 'no'"):
        item3d.rasterize(positions, triangles, SIZE, derivatives='no')
    for wrong in ('all', [True, False], [0.5]):
        with pytest.raises(TypeError, match='interpolate: derivatives must be True, False or a list of channels'):
            item3d.interpolate(torch.rand(3, 2), raster, triangles, derivatives=wrong)
    for wrong in (-1, 1.5, True, '2'):
        with pytest.raises(ValueError, match='max_level must be None or a whole number'):
            item3d.texture(texture, uv, max_level=wrong)
        with pytest.raises(ValueError, match='max_level must be None or a whole number'):
            item3d.mipmaps(texture, max_level=wrong)
    with pytest.raises(ValueError, match='prefilter: size must be a power of two'):
        item3d.prefilter(torch.rand(8, 16, 3), size=64.0)
