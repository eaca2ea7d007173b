"""Tests of load(), which reads models with the program."""
import pathlib
import subprocess

import pytest
import torch

import item3d

MUG = pathlib.Path(__file__).resolve().parents[2] / 'assets/demo/mug.glb'


@pytest.fixture(scope='module', autouse=True)
def program():
    try:
        found = item3d.find_program()
    except item3d.ProgramMissing as error:
        pytest.skip(str(error))
    if subprocess.run([found, 'tensors', '--help'], capture_output=True).returncode != 0:
        pytest.skip('a program without the command tensors')


def test_the_demo():
    model = item3d.load(MUG)
    for primitive in model.primitives:
        vertices = len(primitive.positions)
        assert primitive.positions.shape == (vertices, 3) and primitive.positions.dtype == torch.float32
        assert primitive.uvs.shape == (vertices, 2)
        assert primitive.triangles.dtype == torch.int32 and 0 <= primitive.triangles.min()
        assert primitive.triangles.max() < vertices
        assert (primitive.normals.norm(dim=1) - 1).abs().max() < 1e-4
        material = model.materials[primitive.material]
        assert material.base_color_texture < len(model.textures) and len(material.base_color_factor) == 4
    assert all(0 <= texture.min() and texture.max() <= 1 for texture in model.textures)
    assert len(model.wraps) == len(model.textures)


def test_a_quad_with_two_materials(tmp_path):
    (tmp_path / 'quad.mtl').write_text('newmtl a\nKd 1 0 0\nnewmtl b\nKd 0 1 0\n')
    (tmp_path / 'quad.obj').write_text('mtllib quad.mtl\nv 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\n'
                                       'usemtl a\nf 1/1 2/2 3/3\nusemtl b\nf 1 3 4\n')
    model = item3d.load(tmp_path / 'quad.obj')
    assert sorted(model.materials[p.material].name for p in model.primitives) == ['a', 'b']
    first = next(p for p in model.primitives if model.materials[p.material].name == 'a')
    corners = first.positions[first.triangles[0].long()]
    assert torch.equal(corners, torch.tensor([[0.0, 0, 0], [2, 0, 0], [2, 1, 0]]))
    assert torch.equal(first.uvs[first.triangles[0].long()], torch.tensor([[0.0, 1], [1, 1], [1, 0]]))
    assert torch.equal(first.normals[0], torch.tensor([0.0, 0, 1]))


def test_refusals(tmp_path):
    with pytest.raises(item3d.InputError, match='none.glb'):
        item3d.load(tmp_path / 'none.glb')
    with pytest.raises(item3d.InputError, match='variant'):
        item3d.load(MUG, variant='none')
