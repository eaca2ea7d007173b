import math

import pytest
import torch

import item3d
from conftest import assert_close, differences
from conftest import perspective as square_perspective


def test_the_target_is_in_the_middle_and_up_is_up():
    camera = item3d.camera(torch.tensor([[1.0, 2, 5], [-3, 0.5, 0]]), (0.5, 0.2, 0.1), size=(30, 40))
    assert camera.world_to_clip.shape == (2, 4, 4)
    points = torch.tensor([[0.5, 0.2, 0.1], [0.5, 0.3, 0.1]])
    clip = camera.project(points)
    middle, above = (clip[:, i, :2] / clip[:, i, 3:] for i in range(2))
    assert_close(middle + 1, torch.ones(2, 2), 1e-5)
    assert (above[:, 1] > 0.01).all() and above[:, 0].abs().max() < 1e-5
    assert_close(clip[:, 0, 3], (camera.position - points[0]).norm(dim=1), 1e-5)
    assert_close(camera.position, torch.tensor([[1.0, 2, 5], [-3, 0.5, 0]]), 1e-5)


def test_axes_are_opengls():
    camera = item3d.camera((0, 0, 2), size=(10, 10))
    assert_close(camera.world_to_camera[0], torch.tensor([[1.0, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, -2], [0, 0, 0, 1]]),
                 1e-6)
    above = item3d.look_at((0, 3, 0))  # up is parallel to the view direction, so -z is up in the image
    assert_close(above[:3, :3], torch.tensor([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]), 1e-6)


def test_the_field_of_view_is_horizontal():
    angle = 2 * math.atan(0.5 / 0.5)
    assert_close(item3d.perspective(angle, (8, 8), near=0.5, far=20), square_perspective(), 1e-6)
    wide = item3d.perspective(0.8, (20, 40), near=1, far=3)
    edge = torch.tensor([math.tan(0.4), math.tan(0.4) / 2, -1.0, 1]) @ wide.T
    assert_close(edge, torch.tensor([1.0, 1, -1, 1]), 1e-5)
    assert_close(torch.tensor([0.0, 0, -3, 1]) @ wide.T, torch.tensor([0.0, 0, 3, 3]), 1e-5)


def test_vertices_at_one_place_stay_at_one_place():
    camera = item3d.camera((1, 2, 3), size=(64, 48))
    point = torch.randn(1, 3)
    for count in (1, 7, 33, 1001):
        clip = camera.project(point.expand(count, 3))
        assert torch.equal(clip, clip[:, :1].expand_as(clip))
    points = torch.randn(200, 3)
    expected = torch.cat([points, torch.ones(200, 1)], 1).double() @ camera.world_to_clip[0].double().T
    assert_close(camera.project(points)[0], expected, 1e-5)
    assert_close(camera.project(points[None].expand(1, -1, -1))[0], expected, 1e-5)


def test_gradients_by_the_eye():
    eye, points, weights = torch.tensor([1.0, 2, 4]), torch.randn(9, 3), torch.randn(1, 9, 4)

    def loss(x):
        return (item3d.camera(x, size=(20, 30)).project(points).double() * weights).sum()

    leaf = eye.clone().requires_grad_()
    loss(leaf).backward()
    assert_close(leaf.grad, differences(loss, eye, 1e-2), 1e-3)


@pytest.mark.parametrize('make, error, message', [
    (lambda: item3d.camera((0, 0, 1), size=5), TypeError, 'size must be two whole numbers'),
    (lambda: item3d.camera((0, 0, 1), size=(5, 5), field_of_view=4), ValueError, r'in \(0, pi\) radians, found 4'),
    (lambda: item3d.camera((0, 0, 1), size=(5, 5), near=0), ValueError, '0 < near < far is wanted, found near=0'),
    (lambda: item3d.camera((0, 1), size=(5, 5)), ValueError, r'eye must be of shape \[3\] or \[\*, 3\], found \[2\]'),
    (lambda: item3d.look_at((1, 2, 3), (1, 2, 3)), ValueError, 'eye and target must differ'),
    (lambda: item3d.look_at('here'), TypeError, 'eye must be a tensor or numbers'),
    (lambda: item3d.look_at(torch.zeros(3).double()), TypeError, 'eye must be float32'),
    (lambda: item3d.camera((0, 0, 1), size=(5, 5)).project(torch.zeros(4, 2)), ValueError,
     r'positions must be of shape \[\*, 3\] or \[1, \*, 3\]'),
])
def test_errors_say_what_was_wanted(make, error, message):
    with pytest.raises(error, match=message):
        make()
