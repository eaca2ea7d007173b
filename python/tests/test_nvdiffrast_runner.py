"""Tests of python -m item3d.nvdiffrast, which runs programs that were written for nvdiffrast and a GPU."""
import os
import subprocess
import sys
import textwrap

import item3d


def run(tmp_path, source, *arguments, name='program.py', code=0):
    """Runs source code as a program. Returns its stdout, or its stderr if the expected exit code `code` is not 0."""
    (tmp_path / name).write_text(textwrap.dedent(source))
    return start(str(tmp_path / name), *arguments, code=code)


def start(*arguments, code=0, **options):
    root = os.path.dirname(os.path.dirname(os.path.abspath(item3d.__file__)))
    root = os.pathsep.join(filter(None, [root, os.environ.get('PYTHONPATH')]))
    result = subprocess.run([sys.executable, '-m', 'item3d.nvdiffrast', *arguments], capture_output=True, text=True,
                            timeout=600, env={**os.environ, 'PYTHONPATH': root}, **options)
    assert result.returncode == code, result.stderr
    return result.stderr if code else result.stdout


def test_a_program_for_a_gpu_fits_a_triangle(tmp_path):
    (tmp_path / 'beside.py').write_text('steps = 100\n')
    printed = run(tmp_path, '''
        import sys
        import torch
        import beside
        import nvdiffrast.torch
        import nvdiffrast.torch as dr

        assert __name__ == '__main__' and sys.argv[1:] == ['--size', '32'] and torch.cuda.is_available()
        device = torch.device('cuda')
        glctx = dr.RasterizeCudaContext(device=device)
        wanted = torch.tensor([[[-0.8, -0.8, 0, 1], [0.8, -0.8, 0, 1], [0, 0.8, 0, 1]]], device='cuda')
        tri = torch.arange(3, dtype=torch.int32, device='cuda:0').view(1, 3)
        color = torch.eye(3).cuda()[None]
        found = (wanted + torch.tensor([0.1, -0.1, 0, 0]).to(device)).requires_grad_()
        optimizer = torch.optim.Adam([found], 0.01)

        def draw(pos):
            rast, _ = dr.rasterize(glctx, pos, tri, resolution=[int(sys.argv[2])] * 2)
            return dr.antialias(dr.interpolate(color, rast, tri)[0], rast, pos, tri)

        first = torch.cuda.Event(enable_timing=True)
        last = torch.cuda.Event(enable_timing=True)
        first.record()
        errors = []
        for _ in range(beside.steps):
            optimizer.zero_grad()
            loss = (draw(found) - draw(wanted)).square().mean()
            loss.backward()
            optimizer.step()
            errors.append(float(loss))
        last.record()
        torch.cuda.synchronize()
        assert first.elapsed_time(last) > 0
        print('fell' if errors[-1] < 0.01 * errors[0] else errors)
    ''', '--size', '32')
    assert printed == 'fell\n'


def test_moves_between_devices_copy(tmp_path):
    printed = run(tmp_path, '''
        import numpy as np
        import torch

        array = np.zeros(3, np.float32)
        moved = [torch.from_numpy(array).cuda(), torch.from_numpy(array).to('cuda'),
                 torch.from_numpy(array).to(device='cuda'), torch.as_tensor(array, device='cuda'),
                 torch.from_numpy(array).to(torch.device('cuda:0')), torch.from_numpy(array).to(0)]
        array += 1
        assert not any(tensor.any() for tensor in moved)
        parameter = torch.zeros(3, device='cuda', requires_grad=True)
        before = [parameter.detach().cpu(), parameter.detach().to('cpu'), parameter.cpu().detach()]
        with torch.no_grad():
            parameter += 1
        assert not any(tensor.any() for tensor in before)
        assert parameter.to('cuda') is parameter and parameter.cuda() is parameter  # as on a GPU
        parameter.cpu().sum().backward()
        assert parameter.grad.tolist() == [1, 1, 1]
        assert torch.zeros(2).to(torch.float32, copy=False).dtype is torch.float32
        module = torch.nn.Linear(2, 1).cuda().to('cuda:0')
        module(torch.ones(1, 2, device='cuda')).sum().backward()
        assert all(each.grad is not None for each in module.parameters())
        print('good')
    ''')
    assert printed == 'good\n'


def test_what_else_programs_ask_of_cuda(tmp_path):
    printed = run(tmp_path, '''
        import importlib.util
        import threading
        import torch

        assert importlib.util.find_spec('nvdiffrast') is not None
        device = torch.device('cuda', torch.cuda.current_device())
        assert isinstance(device, torch.device) and isinstance(torch.zeros(1).device, torch.device)
        assert torch.zeros(1, device=device).device == device
        torch.cuda.set_device(device)
        torch.cuda.manual_seed_all(1)
        torch.cuda.empty_cache()
        torch.cuda.reset_peak_memory_stats()
        assert torch.cuda.max_memory_allocated() == 0 and torch.cuda.get_device_properties(0).total_memory > 0
        assert torch.cuda.get_device_name(0) and torch.cuda.device_count() == 1
        with torch.cuda.device(0), torch.cuda.stream(torch.cuda.Stream()), torch.cuda.nvtx.range('part'):
            torch.cuda.current_stream().synchronize()
        generator = torch.Generator(device='cuda').manual_seed(3)
        assert isinstance(generator, torch.Generator)
        assert torch.rand(2, generator=generator, device='cuda').shape == (2,)
        assert torch.zeros(1).type('torch.cuda.LongTensor').dtype is torch.int64
        assert torch.cuda.FloatTensor([1, 2]).tolist() == [1, 2] and torch.zeros_like(torch.ones(2), device='cuda').sum() == 0
        with torch.device('cuda'):
            assert torch.zeros(1).device.type == 'cpu'
        scaler = torch.amp.GradScaler('cuda')
        weight = torch.ones(2, device='cuda', requires_grad=True)
        optimizer = torch.optim.Adam([weight])
        with torch.autocast('cuda', dtype=torch.float16):
            loss = weight.sum()
        scaler.scale(loss).backward()
        scaler.step(optimizer)
        scaler.update()
        assert weight[0] < 1
        torch.save({'weight': weight.detach()}, 'file.pt')
        assert torch.load('file.pt', map_location='cuda')['weight'].device.type == 'cpu'
        made = []
        thread = threading.Thread(target=lambda: made.append(torch.ones(1, device='cuda')))
        thread.start()
        thread.join()
        with torch.random.fork_rng():
            torch.manual_seed(2)
        torch.set_default_device('cuda')
        assert torch.zeros(1).device == made[0].device
        torch.set_default_device(None)
        print('good')
    '''.replace("'file.pt'", repr(str(tmp_path / 'file.pt'))))
    assert printed == 'good\n'


def test_a_module_by_its_name(tmp_path):
    (tmp_path / 'package').mkdir()
    (tmp_path / 'package/__init__.py').write_text('')
    (tmp_path / 'package/train.py').write_text('import sys\nimport nvdiffrast.torch as dr\n'
                                               'print(dr.__name__, __name__, sys.argv[1:])\n')
    assert start('-m', 'package.train', '3', cwd=tmp_path) == "item3d.nvdiffrast __main__ ['3']\n"


def test_errors_are_one_line():
    assert start('missing.py', code=2) == "python -m item3d.nvdiffrast: there is no program 'missing.py'\n"
    assert start(code=2) == 'python -m item3d.nvdiffrast: name a program\n'
    assert 'PROGRAM.py' in start('--help')


def test_the_exit_code_is_the_programs(tmp_path):
    assert run(tmp_path, 'import sys\nsys.exit(5)\n', code=5) == ''
