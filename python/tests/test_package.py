"""Tests of the whole package: torch.compile, threads, processes, versions and time."""
import os
import subprocess
import sys
import textwrap
import threading

import pytest
import torch

import item3d
import item3d.nvdiffrast as dr
from conftest import assert_close, turned_cube
from item3d._library import ops


def draw(positions, triangles, colors, texture):
    raster = item3d.rasterize(positions, triangles, (24, 24), derivatives=True)
    values, slopes = item3d.interpolate(colors, raster, triangles, derivatives=[0, 1])
    looked_up = item3d.texture(texture, values[..., :2].contiguous(), derivatives=slopes)
    return item3d.antialias(looked_up * values[..., 2:], raster, positions, triangles)


def draw_by_nvdiffrast(positions, triangles, colors, texture):
    rast, rast_db = dr.rasterize(CONTEXT, positions, triangles, (24, 24))
    values, da = dr.interpolate(colors, rast, triangles, rast_db, diff_attrs=[0, 1])
    looked_up = dr.texture(texture, values[..., :2].contiguous(), da)
    return dr.antialias(looked_up * values[..., 2:], rast, positions, triangles)


CONTEXT = dr.RasterizeCudaContext()


def gradients(function):
    positions, triangles = turned_cube()
    inputs = [positions, torch.randn(8, 3), torch.randn(1, 8, 8, 1)]
    leaves = [x.clone().requires_grad_() for x in inputs]
    result = function(leaves[0], triangles, *leaves[1:])
    result.square().sum().backward()
    return [result.detach(), *(leaf.grad for leaf in leaves)]


@pytest.mark.parametrize('function', [draw, draw_by_nvdiffrast])
def test_compiled_without_breaks_it_gives_the_same(function):
    torch._dynamo.reset()
    torch.manual_seed(3)
    expected = gradients(function)
    torch.manual_seed(3)
    found = gradients(torch.compile(function, backend='aot_eager', fullgraph=True))
    for a, b in zip(found, expected):
        assert b.any()
        assert_close(a, b, 1e-5)


def test_shapes_that_the_compiler_is_told_are_right():
    positions, triangles = turned_cube()
    check = ('test_schema', 'test_faketensor')
    raster = (positions, triangles, None, None, 6, 5, False, True, True, True)
    torch.library.opcheck(ops.rasterize.default, raster, test_utils=check)
    pixels, slopes = ops.rasterize(*raster)
    torch.library.opcheck(ops.rasterize_backward.default,
                          (positions, triangles, pixels, pixels, slopes, True), test_utils=check)
    attributes = torch.randn(1, 8, 3)
    torch.library.opcheck(ops.interpolate.default, (attributes, pixels, triangles, slopes, [1, 2]),
                          test_utils=check)
    torch.library.opcheck(ops.interpolate.default, (attributes, pixels, triangles, None, []), test_utils=check)
    torch.library.opcheck(
        ops.interpolate_backward.default,
        (attributes, pixels, triangles, slopes, [1], torch.randn(1, 6, 5, 3), torch.randn(1, 6, 5, 2), True),
        test_utils=check)
    texture, uv = torch.randn(1, 4, 4, 2), torch.rand(2, 3, 3, 2)
    lookup = (texture, item3d.mipmaps(texture), uv, torch.rand(2, 3, 3, 4), torch.rand(2, 3, 3), 3, 0)
    torch.library.opcheck(ops.texture.default, lookup, test_utils=check)
    torch.library.opcheck(ops.texture_backward.default, (*lookup, torch.randn(2, 3, 3, 2), True, True),
                          test_utils=check)
    torch.library.opcheck(ops.halve.default, (texture,), test_utils=check)
    torch.library.opcheck(ops.halve_backward.default, (texture,), test_utils=check)
    torch.library.opcheck(ops.add_halve_backward.default, (texture, torch.randn(1, 8, 8, 2)), test_utils=check)
    for curve in (ops.srgb_to_linear, ops.linear_to_srgb):
        torch.library.opcheck(curve.default, (texture,), test_utils=check)
    for curve in (ops.srgb_to_linear_backward, ops.linear_to_srgb_backward):
        torch.library.opcheck(curve.default, (texture, texture), test_utils=check)
    torch.library.opcheck(ops.neighbours.default, (triangles, None), test_utils=check)
    topology = item3d.topology(triangles)
    smooth = (torch.randn(1, 6, 5, 2), pixels, positions, triangles, topology)
    torch.library.opcheck(ops.antialias.default, (*smooth, 1, True), test_utils=check)
    torch.library.opcheck(ops.antialias_backward.default, (*smooth, smooth[0], 1, True, True),
                          test_utils=check)


def test_several_threads_at_once():
    torch.manual_seed(3)
    expected = gradients(draw)
    positions, triangles = turned_cube()
    torch.manual_seed(3)
    colors, texture = torch.randn(8, 3), torch.randn(1, 8, 8, 1)
    results = [None] * 4

    def work(i):
        for _ in range(5):
            results[i] = draw(positions, triangles, colors, texture)

    threads = [threading.Thread(target=work, args=(i,)) for i in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for result in results:
        assert torch.equal(result, expected[0])


def run(code, **environment):
    """Runs code in a new Python process with item3d on its path."""
    root = os.path.dirname(os.path.dirname(os.path.abspath(item3d.__file__)))
    root = os.pathsep.join(filter(None, [root, os.environ.get('PYTHONPATH')]))
    return subprocess.run([sys.executable, '-c', textwrap.dedent(code)], capture_output=True, text=True,
                          timeout=600, env={**os.environ, 'PYTHONPATH': root, **environment})


def test_a_forked_child_computes_too():
    result = run('''
        import os, torch
        import item3d, item3d.nvdiffrast
        positions = torch.tensor([[[-1.0, -1, 0, 1], [1, -1, 0, 1], [0, 1, 0, 1]]])
        triangles = torch.tensor([[0, 1, 2]], dtype=torch.int32)
        child = os.fork()
        pixels = item3d.rasterize(positions, triangles, (16, 16)).pixels
        if child == 0:
            os._exit(0 if pixels.any() else 1)
        assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    ''')
    assert result.returncode == 0, result.stderr


def test_an_older_pytorch_is_one_line_of_english():
    result = run('''
        import sys, types
        torch = types.ModuleType('torch')
        torch.__version__ = '2.9.1+cpu'
        sys.modules['torch'] = torch
        try:
            import item3d
        except ImportError as error:
            print(error)
    ''')
    assert result.stdout == ('item3d needs PyTorch 2.10 or newer, found 2.9.1+cpu: '
                             "pip install 'torch>=2.10'\n"), result.stderr
