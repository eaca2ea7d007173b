"""CUDA devices without a GPU: PyTorch's fake tensors have a device, but no memory.

They show that every tensor that the package makes is on the device of its arguments. What the operators compute on a
device is tested by the other tests with the library of emulated_device.cpp (`make test-python`).
"""
import pytest
import torch
from torch._subclasses.fake_tensor import FakeTensorMode
from torch.fx.experimental.symbolic_shapes import ShapeEnv

import item3d
import item3d.nvdiffrast as dr

SIZE = (16, 24)


@pytest.fixture
def device():
    """A CUDA device on which tensors of unknown values can be made."""
    with FakeTensorMode(shape_env=ShapeEnv(), allow_non_fake_inputs=False):
        yield torch.device('cuda', 0)


def triangle(device):
    positions = torch.rand(1, 3, 4, device=device)
    return positions, torch.zeros(1, 3, dtype=torch.int32, device=device)


def test_operations(device):
    positions, triangles = triangle(device)
    raster = item3d.rasterize(positions, triangles, SIZE, derivatives=True)
    assert raster.pixels.device == device
    colors = torch.rand(3, 2, device=device)
    values, slopes = item3d.interpolate(colors, raster, triangles, derivatives=True)
    assert values.device == device
    texture = torch.rand(1, 6, 8, 3, device=device)
    sampled = item3d.texture(texture, values, derivatives=slopes)
    assert sampled.device == device
    topology = item3d.topology(triangles, positions[0])
    smooth = item3d.antialias(sampled, raster, positions, triangles, topology=topology)
    assert smooth.device == device


def test_light_and_shading(device):
    environment = torch.rand(8, 16, 3, device=device)
    light = item3d.prefilter(environment, size=16)
    assert {tensor.device for tensor in (light.diffuse, *light.specular)} == {device}
    assert light.roughness.device.type == 'cpu'
    color = torch.rand(5, 3, device=device)
    normal = torch.rand(5, 3, device=device)
    radiance = item3d.shade(light, normal=normal, view=normal, base_color=color, roughness=0.4, metallic=0.0)
    assert radiance.device == device
    assert item3d.linear_to_srgb(item3d.srgb_to_linear(color)).device == device


def model():
    corners = torch.tensor([[-1.0, -1, 0], [1, -1, 0], [0, 1, 0]])
    primitive = item3d.Primitive(positions=corners, normals=torch.tensor([[0.0, 0, 1]] * 3),
                                 triangles=torch.tensor([[0, 1, 2]], dtype=torch.int32), uvs=corners[:, :2],
                                 further_uvs={1: corners[:, :2]})
    material = item3d.Material(base_color_texture=0, metallic_roughness_texture=0, occlusion_texture=0,
                               normal_texture=0, emissive_texture=0, emissive_factor=(1.0, 1.0, 1.0),
                               normal_scale=torch.ones(()), normal_uvs=1)
    return item3d.Model(primitives=[primitive], materials=[material], textures=[torch.rand(4, 4, 3)])


def test_render(device, monkeypatch):
    # Fake tensors have no values; a condition on one is taken for true.
    monkeypatch.setattr(torch.Tensor, '__bool__', lambda tensor: True)
    here = model().to(device)
    camera = item3d.Camera(torch.rand(1, 4, 4), torch.rand(4, 4)).to(device)
    light = item3d.prefilter(torch.rand(8, 16, 3, device=device), size=16)
    image = item3d.render(here, camera, light, SIZE, background=(0.1, 0.2, 0.3))
    assert image.device == device
    assert list(image.shape) == [1, *SIZE, 4]


def test_model_moves_with_all_of_its_tensors(device):
    moved = model().to(device)
    primitive = moved.primitives[0]
    tensors = [primitive.positions, primitive.normals, primitive.triangles, primitive.uvs, primitive.further_uvs[1],
               moved.materials[0].normal_scale, *moved.textures]
    assert {tensor.device for tensor in tensors} == {device}


def test_cameras_at_a_tensor_on_a_device_are_on_it(device, monkeypatch):
    # Fake tensors have no values; no eye equals its target.
    monkeypatch.setattr(torch.Tensor, '__bool__', lambda tensor: False)
    camera = item3d.camera(torch.rand(2, 3, device=device), size=SIZE)
    assert camera.project(torch.rand(3, 3, device=device)).device == device
    assert camera.position.device == device


def test_nvdiffrast(device):
    context = dr.RasterizeCudaContext(device=device)
    positions, triangles = triangle(device)
    raster, slopes = dr.rasterize(context, positions, triangles, SIZE)
    colors, color_slopes = dr.interpolate(torch.rand(1, 3, 2, device=device), raster, triangles, rast_db=slopes,
                                          diff_attrs='all')
    sampled = dr.texture(torch.rand(1, 8, 8, 3, device=device), colors, color_slopes)
    assert dr.antialias(sampled, raster, positions, triangles).device == device
    ranges = torch.zeros(2, 2, dtype=torch.int32, device='cpu')
    raster, _ = dr.rasterize(context, positions[0], triangles, SIZE, ranges=ranges)
    assert raster.device == device and len(raster) == 2
