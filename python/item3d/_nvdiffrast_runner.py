"""Runs a program that was written for nvdiffrast and a GPU on the CPU, without changes to it.

    python -m item3d.nvdiffrast PROGRAM.py [ARGUMENT...]
    python -m item3d.nvdiffrast -m MODULE [ARGUMENT...]

In the program, `import nvdiffrast.torch` imports item3d.nvdiffrast. Tensors that the program creates on 'cuda' are
created on the CPU, and torch.cuda reports that there is one device.
"""
from __future__ import annotations

import contextlib
import functools
import importlib.machinery
import os
import pathlib
import runpy
import sys
import threading
import time
import types

import torch
from torch.overrides import TorchFunctionMode

_real_device = torch.device


def _on_cpu(device):
    """Returns the device, or the CPU if it is a CUDA device."""
    if isinstance(device, bool):
        return device
    is_cuda = (isinstance(device, int) or isinstance(device, str) and device.startswith('cuda') or
               isinstance(device, _real_device) and device.type == 'cuda')
    return _real_device('cpu') if is_cuda else device


def _moved(source, result: torch.Tensor) -> torch.Tensor:
    """Returns a copy of `result`, as a move between devices does.

    If `result` is `source` and a leaf that requires gradients, returns it unchanged: on a GPU the program would have
    created this leaf there, and the move would return the leaf itself.
    """
    return result if result is source and source.is_leaf and source.requires_grad else result.clone()


def _cuda(tensor, device=None, non_blocking=False, memory_format=torch.preserve_format):
    return _moved(tensor, tensor)


def _cpu(tensor, memory_format=torch.preserve_format):
    return tensor.clone(memory_format=memory_format)


def _to(tensor, *args, **kwargs):
    result = torch.Tensor.to(tensor, *map(_on_cpu, args[:1]), *args[1:], **kwargs)
    names_device = kwargs.get('device') is not None or args and isinstance(args[0], (int, str, _real_device))
    if result is not tensor or not names_device:
        return result
    return tensor.clone() if args and args[0] == 'cpu' else _moved(tensor, tensor)


def _type(tensor, dtype=None, *args, **kwargs):
    if isinstance(dtype, str):
        dtype = dtype.replace('torch.cuda.', 'torch.')
    return torch.Tensor.type(tensor, dtype, *args, **kwargs)


def _from_data(function):
    def make(data, *args, **kwargs):
        result = function(data, *args, **kwargs)
        return result if kwargs.get('device') is None else _moved(data, result)
    return make


class _Mode(TorchFunctionMode):
    """Mode that creates tensors for a CUDA device on the CPU, and copies tensors that would change devices."""

    _replaced = {torch.Tensor.cuda: _cuda, torch.Tensor.cpu: _cpu, torch.Tensor.to: _to, torch.Tensor.type: _type,
                 torch.as_tensor: _from_data(torch.as_tensor), torch.asarray: _from_data(torch.asarray),
                 torch.Tensor.pin_memory: lambda tensor, *_, **__: tensor}

    def __torch_function__(self, function, classes, args=(), kwargs=None):
        if kwargs is None:
            return self._replaced.get(function, function)(*args)
        if 'device' in kwargs:
            kwargs = {**kwargs, 'device': _on_cpu(kwargs['device'])}
        return self._replaced.get(function, function)(*args, **kwargs)


def _made_on_cpu(real: type) -> type:
    """Returns a substitute for the class `real`, whose calls make a `real` for the CPU.

    Every `real` counts as an instance of the substitute.
    """
    class Metaclass(type):
        def __call__(cls, *args, **kwargs):
            if real is _real_device:
                made = real(*args, **kwargs)
                return real('cpu') if made.type == 'cuda' else made
            return real()

        def __instancecheck__(cls, value):
            return isinstance(value, real)

    return Metaclass(real.__name__, (), {'__module__': 'torch', '__doc__': real.__doc__})


class _Event:
    """Replacement of torch.cuda.Event that reads the clock, because work on the CPU is done when a call returns."""

    def __init__(self, enable_timing=False, blocking=False, interprocess=False, external=False):
        self._time = None

    def record(self, stream=None):
        self._time = time.perf_counter()

    def elapsed_time(self, end: _Event) -> float:
        if self._time is None or end._time is None:
            raise RuntimeError('Event.elapsed_time: both events must be recorded')
        return 1000 * (end._time - self._time)

    def query(self) -> bool:
        return True

    def _done(self, stream=None):
        pass

    synchronize = wait = _done


class _Stream(contextlib.nullcontext):
    """Replacement of torch.cuda.Stream, on which all work is done immediately and in order."""

    def __init__(self, device=None, priority=0):
        super().__init__(self)

    def record_event(self, event=None) -> _Event:
        event = event or _Event()
        event.record()
        return event

    def query(self) -> bool:
        return True

    def _done(self, other=None):
        pass

    synchronize = wait_event = wait_stream = _done


def _memory(name: str) -> int:
    return os.sysconf('SC_PAGE_SIZE') * os.sysconf(name)


def _properties(device=None):
    return types.SimpleNamespace(name='CPU', major=7, minor=0, total_memory=_memory('SC_PHYS_PAGES'),
                                 multi_processor_count=torch.get_num_threads())


def _returns(value):
    return lambda *args, **kwargs: value


def _set_rng_state(state, device=None):
    torch.set_rng_state(state)


# Members of torch.cuda that programs use. Each name gets its own function object, because torch.compile needs that.
_NOTHING = ('init', 'synchronize', 'set_device', 'empty_cache', 'ipc_collect', 'reset_peak_memory_stats',
            'reset_max_memory_allocated', 'set_stream', 'set_per_process_memory_fraction')
_ZERO = ('current_device', 'memory_allocated', 'max_memory_allocated', 'memory_reserved', 'max_memory_reserved',
         'utilization')
_CUDA = {
    **{name: _returns(None) for name in _NOTHING},
    **{name: _returns(0) for name in _ZERO},
    **{name: lambda *_: contextlib.nullcontext() for name in ('stream', 'device', 'device_of')},
    'is_available': _returns(True), 'is_bf16_supported': _returns(False), 'device_count': _returns(1),
    'is_current_stream_capturing': _returns(False),
    'get_device_name': _returns('CPU'), 'get_device_capability': _returns((7, 0)),
    'get_device_properties': _properties,
    'mem_get_info': lambda device=None: (_memory('SC_AVPHYS_PAGES'), _memory('SC_PHYS_PAGES')),
    'current_stream': lambda device=None: _Stream(), 'default_stream': lambda device=None: _Stream(),
    'Event': _Event, 'Stream': _Stream,
    'get_rng_state': lambda device=None: torch.get_rng_state(), 'set_rng_state': _set_rng_state,
    'get_rng_state_all': lambda: [torch.get_rng_state()], 'set_rng_state_all': lambda states: _set_rng_state(states[0]),
    'nvtx': types.SimpleNamespace(range_push=_returns(0), range_pop=_returns(0), mark=_returns(None),
                                  range=lambda *_, **__: contextlib.nullcontext()),
}


def _patch_cuda() -> None:
    for name, replacement in _CUDA.items():
        setattr(torch.cuda, name, replacement)
    for name in dir(torch.cuda):  # tensor types such as FloatTensor
        if name.endswith('Tensor') and hasattr(torch, name):
            setattr(torch.cuda, name, getattr(torch, name))
    # PyTorch calls these functions before it uses a device.
    torch.accelerator.is_available, torch.accelerator.current_accelerator = _returns(False), _returns(None)


def _patch_torch() -> None:
    torch.device, torch.Generator = _made_on_cpu(torch.device), _made_on_cpu(torch.Generator)
    set_device, set_type, load, start, fork = (torch.set_default_device, torch.set_default_tensor_type, torch.load,
                                               threading.Thread.start, torch.random.fork_rng)

    @functools.wraps(set_device)
    def set_default_device(device):
        set_device(_on_cpu(device))

    @functools.wraps(set_type)
    def set_default_tensor_type(kind):
        set_type(kind.replace('torch.cuda.', 'torch.') if isinstance(kind, str) else kind)

    @functools.wraps(load)
    def load_on_cpu(file, map_location=None, *args, **kwargs):
        return load(file, 'cpu' if map_location is None else _on_cpu(map_location), *args, **kwargs)

    @functools.wraps(start)
    def start_with_mode(thread):
        run = thread.run  # a mode applies to one thread, so each new thread needs its own

        def run_with_mode():
            with _Mode():
                run()
        thread.run = run_with_mode
        start(thread)

    @functools.wraps(fork)
    def fork_rng(devices=None, enabled=True, **_):
        return fork([], enabled)

    torch.random.fork_rng = fork_rng
    torch.set_default_device, torch.set_default_tensor_type = set_default_device, set_default_tensor_type
    torch.load, threading.Thread.start = load_on_cpu, start_with_mode


def _provide_nvdiffrast() -> None:
    import item3d.nvdiffrast as operations
    package = types.ModuleType('nvdiffrast', 'item3d.nvdiffrast by the name of nvdiffrast.')
    package.__path__ = []
    package.__spec__ = importlib.machinery.ModuleSpec('nvdiffrast', None, is_package=True)
    package.torch = operations
    sys.modules['nvdiffrast'], sys.modules['nvdiffrast.torch'] = package, operations


def main() -> int:
    """Runs the program or module that the command line names. Returns an exit code."""
    module = sys.argv[1:2] == ['-m']
    arguments = sys.argv[2 if module else 1:]
    if arguments[:1] in (['-h'], ['--help']) and not module:
        print(__doc__)
        return 0
    if not arguments or not module and not os.path.isfile(arguments[0]):
        found = f'there is no program {arguments[0]!r}' if arguments else 'name a program'
        print(f'python -m item3d.nvdiffrast: {found}', file=sys.stderr)
        return 2
    program = arguments[0]
    sys.argv = arguments
    _provide_nvdiffrast()
    _patch_torch()
    _patch_cuda()
    with _Mode():
        if module:
            runpy.run_module(program, run_name='__main__', alter_sys=True)
        else:
            if not getattr(sys.flags, 'safe_path', False):
                sys.path[0] = str(pathlib.Path(program).resolve().parent)
            runpy.run_path(program, run_name='__main__')
    return 0
