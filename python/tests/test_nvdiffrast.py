"""Compares item3d.nvdiffrast with the conventions in nvdiffrast's documentation."""
import logging

import pytest
import torch

import item3d
import item3d.nvdiffrast as dr
import reference
from conftest import assert_close, differences, inner_pixels, soup, turned_cube

CONTEXT = dr.RasterizeCudaContext()


def triangle():
    positions = torch.tensor([[[-0.8, -0.8, 0, 1], [0.8, -0.8, 0, 1], [-0.8, 0.8, 0, 1]]])
    return positions, torch.tensor([[0, 1, 2]], dtype=torch.int32)


def test_rows_go_up_and_empty_pixels_are_zero():
    positions, tri = triangle()
    rast, rast_db = dr.rasterize(CONTEXT, positions, tri, resolution=[16, 16])
    assert rast.shape == (1, 16, 16, 4) and rast_db.shape == (1, 16, 16, 4)
    covered = rast[0, ..., 3] > 0
    assert covered[2].sum() > covered[12].sum() > 0  # the wide side is at y = -0.8, near row 0
    assert not rast[0][~covered].any() and not rast_db[0][~covered].any()


@pytest.mark.parametrize('size', [(40, 56), (33, 17)])
def test_u_v_depth_and_triangle(size):
    positions, tri = soup()
    rast, _ = dr.rasterize(CONTEXT, positions, tri, size)
    for view in range(2):
        weights, depth, triangles = reference.raster(positions[view], tri, *size, bottom_up=True)
        found = rast[view]
        assert (found[..., 3].numpy() - 1 != triangles).sum() <= 2
        same = (found[..., 3].numpy() - 1 == triangles) & (triangles >= 0)
        assert_close(found[same][:, :2], torch.tensor(weights[same][:, :2]), 1e-5)
        assert_close(found[same][:, 2], torch.tensor(depth[same]), 1e-5)


def test_the_first_vertex_has_u_one_and_the_second_v_one():
    positions, tri = triangle()
    rast, _ = dr.rasterize(CONTEXT, positions, tri, (200, 200))
    values = rast[0][rast[0, ..., 3] > 0]
    for column, wanted in ((0, positions[0, 0]), (1, positions[0, 1])):
        at = (rast[0, ..., column] == values[:, column].max()).nonzero()[0]
        x, y = (at[1] + 0.5) / 100 - 1, (at[0] + 0.5) / 100 - 1
        assert (torch.stack([x, y]) - wanted[:2]).abs().max() < 0.03


def test_top_left_rule():
    """Pixel centres on a left or top edge belong to the triangle, those on a right or bottom edge do not."""
    for x0, y0, x1, y1, expected in ((-0.5, -0.5, 0.5, 0.5, (1, 3, 1, 3)),):
        positions = torch.tensor([[[x0, y0, 0, 1], [x1, y0, 0, 1], [x1, y1, 0, 1], [x0, y1, 0, 1]]])
        # The 4 x 4 pixel centres are at -0.75, -0.25, ... The shift by half a pixel puts the edges on centres.
        positions = positions + torch.tensor([0.25, 0.25, 0, 0])
        tri = torch.tensor([[0, 1, 2], [0, 2, 3]], dtype=torch.int32)
        covered = dr.rasterize(CONTEXT, positions, tri, (4, 4))[0][0, ..., 3] > 0
        rows, columns = covered.nonzero(as_tuple=True)
        # The edges in x, -0.25 and 0.75, are on the centres of columns 1 and 3. Column 1 (left) is covered, 3 is not.
        # Of rows 1 and 3, row 3 (top) is covered.
        assert sorted(set(columns.tolist())) == [1, 2] and sorted(set(rows.tolist())) == [2, 3]
        assert covered.sum() == 4


def test_derivatives_by_x_and_upward_y():
    positions, tri = turned_cube()
    rast, rast_db = dr.rasterize(CONTEXT, positions, tri, (24, 40))
    for row, column in (rast[0, ..., 3] > 0).nonzero()[::17].tolist():
        corners = tri[int(rast[0, row, column, 3]) - 1]
        def at(x, y):
            return reference.weights_at(positions[0], corners, (x + 0.5) / 20 - 1, (y + 0.5) / 12 - 1)
        step = 1e-5
        by_x = (at(column + step, row) - at(column - step, row)) / (2 * step)
        by_y = (at(column, row + step) - at(column, row - step)) / (2 * step)
        assert_close(rast_db[0, row, column], torch.tensor([by_x[0], by_y[0], by_x[1], by_y[1]]), 1e-4)


def test_a_context_without_derivatives():
    positions, tri = triangle()
    rast, rast_db = dr.rasterize(dr.RasterizeGLContext(output_db=False), positions, tri, (4, 6))
    assert rast.shape == (1, 4, 6, 4) and rast_db.shape == (1, 4, 6, 0)
    values, values_da = dr.interpolate(torch.ones(1, 3, 2), rast, tri)
    assert values.shape == (1, 4, 6, 2) and values_da.shape == (1, 4, 6, 0)


def test_range_mode_is_instanced_mode_of_each_mesh():
    positions, tri = soup(views=1)
    ranges = torch.tensor([[0, 4], [4, 8]], dtype=torch.int32)
    attributes = torch.randn(36, 3)
    rast, rast_db = dr.rasterize(CONTEXT, positions[0], tri, (20, 20), ranges=ranges)
    values, da = dr.interpolate(attributes, rast, tri, rast_db, diff_attrs='all')
    smooth = dr.antialias(values, rast, positions[0], tri)
    for view, (first, count) in enumerate(ranges.tolist()):
        part = tri[first:first + count].contiguous()
        one, one_db = dr.rasterize(CONTEXT, positions, part, (20, 20))
        expected, expected_da = dr.interpolate(attributes[None], one, part, one_db, diff_attrs='all')
        assert torch.equal(values[view], expected[0]) and torch.equal(da[view], expected_da[0])
        assert torch.equal(smooth[view], dr.antialias(expected, one, positions, part)[0])


@pytest.mark.parametrize('grad_db', [True, False])
def test_gradients_by_pos_with_and_without_those_of_derivatives(grad_db):
    positions, tri = turned_cube()
    rast, _ = dr.rasterize(CONTEXT, positions, tri, (40, 40))
    inner = inner_pixels(rast[..., 3].long() - 1)
    weights = torch.randn(1, 40, 40, 4) * (1.0 if grad_db else 0.0), torch.randn(1, 40, 40, 2)

    def loss(p):
        rast, rast_db = dr.rasterize(CONTEXT, p, tri, (40, 40), grad_db=grad_db)
        return ((rast_db.double() * weights[0])[inner].sum() +
                (rast[..., :2].double() * weights[1])[inner].sum())

    p = positions.clone().requires_grad_()
    loss(p).backward()
    assert_close(p.grad.reshape(-1), differences(loss, positions, 2e-3), 1e-2)
    p.grad = None
    dr.rasterize(CONTEXT, p, tri, (40, 40), grad_db=grad_db)[1].sum().add(0 * p.sum()).backward()
    assert bool(p.grad.any()) == grad_db


def test_depth_and_index_carry_no_gradients():
    positions, tri = turned_cube()
    positions.requires_grad_()
    dr.rasterize(CONTEXT, positions, tri, (8, 8))[0][..., 2:].sum().backward()
    assert not positions.grad.any()


def test_depth_peeling():
    positions, tri = soup(seed=3)
    layers = []
    with dr.DepthPeeler(CONTEXT, positions, tri, (32, 32)) as peeler:
        for _ in range(4):
            layers.append(peeler.rasterize_next_layer()[0])
    assert torch.equal(layers[0], dr.rasterize(CONTEXT, positions, tri, (32, 32))[0])
    for nearer, farther in zip(layers, layers[1:]):
        seen = farther[..., 3] > 0
        assert (nearer[..., 3][seen] > 0).all() and (farther[..., 2] > nearer[..., 2])[seen].all()
        assert (nearer[..., 3] != farther[..., 3])[seen].all()
    assert (layers[1][..., 3] > 0).sum() > 100
    for view in range(2):
        behind = torch.where(layers[0][view, ..., 3] > 0, layers[0][view, ..., 2], 2).double().numpy()
        expected = reference.raster(positions[view], tri, 32, 32, bottom_up=True, behind=behind)[2]
        assert (layers[1][view, ..., 3].numpy() - 1 != expected).sum() <= 2
    with pytest.raises(RuntimeError, match='inside of its with block'):
        peeler.rasterize_next_layer()


def test_surfaces_at_one_depth_are_one_layer():
    positions, tri = triangle()
    with dr.DepthPeeler(CONTEXT, positions, tri.repeat(2, 1), (16, 16)) as peeler:
        assert peeler.rasterize_next_layer()[0].any()
        assert not peeler.rasterize_next_layer()[0].any()


def test_attributes_are_broadcast_and_differentiated():
    positions, tri = soup()
    rast, rast_db = dr.rasterize(CONTEXT, positions, tri, (20, 20))
    attributes = torch.randn(1, 36, 4)
    values, da = dr.interpolate(attributes, rast, tri, rast_db=rast_db, diff_attrs=[1, 3])
    assert values.shape == (2, 20, 20, 4) and da.shape == (2, 20, 20, 4)
    corners = attributes[0][tri.long()[(rast[..., 3].long() - 1).clamp(min=0)]]
    u, v = rast[..., 0:1], rast[..., 1:2]
    expected = u * corners[..., 0, :] + v * corners[..., 1, :] + (1 - u - v) * corners[..., 2, :]
    covered = rast[..., 3:] > 0
    assert_close(values, expected * covered, 1e-5)
    for i, channel in enumerate((1, 3)):
        a = corners[..., channel]
        for axis in (0, 1):
            wanted = (rast_db[..., axis] * (a[..., 0] - a[..., 2]) +
                      rast_db[..., 2 + axis] * (a[..., 1] - a[..., 2]))
            assert_close(da[..., 2 * i + axis], wanted * covered[..., 0], 1e-5)


# Textures: values and gradients are those of item3d.texture (test_texture.py). ---------------------

def test_filter_modes_are_chosen_by_what_is_given():
    tex, uv = torch.randn(1, 8, 8, 3), torch.rand(1, 6, 6, 2)
    uv_da, bias = torch.randn(1, 6, 6, 4) * 0.2, torch.rand(1, 6, 6) * 3
    assert torch.equal(dr.texture(tex, uv), item3d.texture(tex, uv, filter='linear'))
    assert torch.equal(dr.texture(tex, uv, uv_da),
                       item3d.texture(tex, uv, derivatives=uv_da, filter='linear-mipmap-linear'))
    assert torch.equal(dr.texture(tex, uv, mip_level_bias=bias), item3d.texture(tex, uv, level_bias=bias))
    assert torch.equal(dr.texture(tex, uv, uv_da, filter_mode='nearest'),
                       item3d.texture(tex, uv, filter='nearest'))
    assert torch.equal(dr.texture(tex, uv, uv_da, max_mip_level=0), dr.texture(tex, uv))
    assert torch.equal(dr.texture(tex, uv, uv_da, bias, filter_mode='linear-mipmap-nearest'),
                       item3d.texture(tex, uv, derivatives=uv_da, level_bias=bias,
                                      filter='linear-mipmap-nearest'))
    for boundary in ('wrap', 'clamp', 'zero'):
        assert torch.equal(dr.texture(tex, 3 * uv - 1, boundary_mode=boundary),
                           item3d.texture(tex, 3 * uv - 1, boundary=boundary))


def test_mip_stacks():
    tex, uv = torch.randn(2, 8, 4, 3, requires_grad=True), torch.rand(2, 6, 6, 2)
    bias = torch.full((2, 6, 6), 1.5)
    direct = dr.texture(tex, uv, mip_level_bias=bias)
    stack = dr.texture_construct_mip(tex)
    assert torch.equal(dr.texture(tex, uv, mip_level_bias=bias, mip=stack), direct)
    assert torch.equal(dr.texture(tex, uv, mip_level_bias=bias, mip=item3d.mipmaps(tex)), direct)
    assert torch.equal(dr.texture(tex, uv, mip_level_bias=bias + 9, max_mip_level=1),
                       dr.texture(tex, uv, mip_level_bias=bias - 0.5))
    direct.sum().backward()
    expected, tex.grad = tex.grad, None
    for _ in range(2):  # the same mip levels may be used several times
        dr.texture(tex, uv, mip_level_bias=bias, mip=stack).sum().backward()
    assert_close(tex.grad, 2 * expected, 1e-5)


def test_sizes_that_cannot_be_halved():
    uv, bias = torch.rand(1, 4, 4, 2), torch.ones(1, 4, 4)
    atlas = torch.randn(1, 32, 160, 1)
    with pytest.raises(ValueError, match='level 5 has 1 x 5 texels, .* max_mip_level=5'):
        dr.texture(atlas, uv, mip_level_bias=bias)
    assert dr.texture(atlas, uv, mip_level_bias=bias, max_mip_level=5).shape == (1, 4, 4, 1)
    with pytest.raises(ValueError, match='level 0 has 7 x 8 texels'):
        dr.texture_construct_mip(torch.zeros(1, 7, 8, 1))


def test_cube_maps():
    tex = torch.tensor(reference.cube_directions(16), dtype=torch.float32)[None]
    directions = torch.nn.functional.normalize(torch.randn(1, 20, 20, 3), dim=-1)
    for arguments in ({}, dict(mip_level_bias=torch.zeros(1, 20, 20)),
                      dict(mip_level_bias=torch.zeros(1, 20, 20),
                           mip=dr.texture_construct_mip(tex, cube_mode=True))):
        values = dr.texture(tex, directions, boundary_mode='cube', **arguments)
        assert (values - directions).norm(dim=-1).max() < 0.06
    with pytest.raises(ValueError, match='cube map'):
        dr.texture(tex, directions, boundary_mode='cube', mip_level_bias=torch.zeros(1, 20, 20),
                   mip=dr.texture_construct_mip(torch.zeros(1, 4, 4, 3)))


# Antialiasing. -----------------------------------------------------------------------------------

def test_outlines_are_blended_by_coverage_upside_up():
    """The topmost row of a white rectangle is grey, by the share of the row that the rectangle covers."""
    top = 5.3 / 8 * 2 - 1
    positions = torch.tensor([[[-3.0, -2, 0, 1], [3, -2, 0, 1], [3, top, 0, 1], [-3, top, 0, 1]]])
    tri = torch.tensor([[0, 1, 2], [0, 2, 3]], dtype=torch.int32)
    rast, _ = dr.rasterize(CONTEXT, positions, tri, (8, 8))
    color = (rast[..., 3:] > 0).float()
    result = dr.antialias(color, rast, positions, tri)
    assert_close(result[0, :, 3, 0], torch.tensor([1, 1, 1, 1, 1, 0.3, 0, 0]), 1e-5)
    p = positions.clone().requires_grad_()
    for boost in (1.0, 3.0):
        p.grad = None
        dr.antialias(color, rast, p, tri, pos_gradient_boost=boost).sum().backward()
        # If the edge moves up by 1 in y, each of the 8 columns gains 4 white pixels.
        assert_close(p.grad[0, 2:, 1].sum(), torch.tensor(boost * 32), 1e-4)


def test_a_topology_hash_changes_nothing_but_time():
    positions, tri = turned_cube()
    rast, _ = dr.rasterize(CONTEXT, positions, tri, (20, 20))
    color = torch.randn(1, 20, 20, 2)
    topology = dr.antialias_construct_topology_hash(tri)
    assert torch.equal(dr.antialias(color, rast, positions, tri, topology_hash=topology),
                       dr.antialias(color, rast, positions, tri))
    with pytest.raises(ValueError, match="topology_hash's triangles"):
        dr.antialias(color, rast, positions, tri, dr.antialias_construct_topology_hash(tri[:3]))


def test_inner_edges_stay_sharp():
    positions, tri = turned_cube()
    # The mesh is one face of the cube, and its two triangles have different colours.
    tri = tri[:2]
    rast, _ = dr.rasterize(CONTEXT, positions, tri, (32, 32))
    color = rast[..., 3:].clone()
    result = dr.antialias(color, rast, positions, tri)
    changed = (result != color)[0, ..., 0]
    empty = (rast[0, ..., 3] == 0)
    beside = torch.zeros_like(empty)
    for shift in ((0, 1), (1, 0), (0, -1), (-1, 0)):
        beside |= empty != empty.roll(shift, (0, 1))
    assert changed.any() and not (changed & ~beside).any()


def test_gradients_of_antialiasing():
    positions, tri = turned_cube()
    colors, weights = torch.randn(12, 3), torch.randn(1, 24, 24, 3)

    def loss(p):
        rast, _ = dr.rasterize(CONTEXT, p, tri, (24, 24))
        color = torch.where(rast[..., 3:] > 0, colors[(rast[..., 3].long() - 1).clamp(min=0)], 0.0)
        return (dr.antialias(color, rast, p, tri).double() * weights).sum()

    p = positions.clone().requires_grad_()
    loss(p).backward()
    found, expected = p.grad.reshape(-1), differences(loss, positions, 1e-4)
    assert ((found - expected).abs() < 0.02 * expected.abs().max()).double().mean() > 0.9


def test_a_shape_is_found_by_its_outline():
    """Gradient descent on antialiased images moves a triangle to its target."""
    target, tri = triangle()
    def draw(p):
        rast, _ = dr.rasterize(CONTEXT, p, tri, (16, 16))
        return dr.antialias((rast[..., 3:] > 0).float(), rast, p, tri)
    wanted = draw(target)
    offset = torch.tensor([0.25, -0.15], requires_grad=True)
    optimizer = torch.optim.Adam([offset], 0.02)
    for _ in range(80):
        optimizer.zero_grad()
        loss = (draw(target + torch.nn.functional.pad(offset, (0, 2))) - wanted).square().mean()
        loss.backward()
        optimizer.step()
    assert offset.abs().max() < 0.02, offset


# Other functions that programs call. ---------------------------------------------------------------

def test_contexts():
    dr.RasterizeCudaContext(device='cpu')
    manual = dr.RasterizeGLContext(mode='manual', device=torch.device('cpu'))
    manual.set_context()
    manual.release_context()
    with pytest.raises(RuntimeError, match='automatic mode'):
        dr.RasterizeGLContext().set_context()
    with pytest.raises(ValueError, match="one of 'automatic', 'manual'"):
        dr.RasterizeGLContext(mode='x')


def test_log_levels():
    assert dr.get_log_level() == 1
    dr.set_log_level(0)
    assert dr.get_log_level() == 0 and logging.getLogger('item3d.nvdiffrast').level == logging.INFO
    dr.set_log_level(1)
    with pytest.raises(ValueError):
        dr.set_log_level(4)


def test_triangles_with_nan_are_not_drawn():
    positions, tri = triangle()
    positions[0, 0, 0] = torch.nan
    assert not dr.rasterize(CONTEXT, positions, tri, (8, 8))[0].any()


@pytest.mark.parametrize('call, error, message', [
    (lambda p, t: dr.rasterize(None, p, t, (4, 4)), TypeError, 'glctx must be a RasterizeCudaContext'),
    (lambda p, t: dr.rasterize(CONTEXT, p[0], t, (4, 4)), ValueError, 'needs ranges'),
    (lambda p, t: dr.rasterize(CONTEXT, p, t.long(), (4, 4)), TypeError, 'tri must be int32, found int64'),
    (lambda p, t: dr.rasterize(CONTEXT, p[..., :3], t, (4, 4)), ValueError, r'pos must be of shape'),
    (lambda p, t: dr.interpolate(torch.zeros(1, 3, 2), torch.zeros(1, 4, 4, 4), t, diff_attrs='all'),
     ValueError, 'needs rast_db'),
    (lambda p, t: dr.interpolate(torch.zeros(1, 3, 2), torch.zeros(1, 4, 4, 4), t, torch.zeros(1, 4, 4, 4),
                                 'some'), ValueError, "one of 'all', found 'some'"),
    (lambda p, t: dr.texture(torch.zeros(1, 4, 4, 1), torch.zeros(1, 4, 4, 2), filter_mode='cubic'),
     ValueError, 'filter_mode must be one of'),
    (lambda p, t: dr.antialias(torch.zeros(1, 4, 4, 1), torch.zeros(1, 4, 4, 4), p, t, 'hash'), TypeError,
     'antialias_construct_topology_hash'),
])
def test_errors_say_what_was_wanted(call, error, message):
    with pytest.raises(error, match=message):
        call(*triangle())
