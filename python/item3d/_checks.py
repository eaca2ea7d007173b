"""Argument checks. An error is one line with the argument's name, the expected value and the found value."""
from __future__ import annotations

import operator

import torch


def _shape(wanted) -> str:
    return '[' + ', '.join('*' if size is None else str(size) for size in wanted) + ']'


def check(operation: str, name: str, tensor, dtype: torch.dtype, *shapes) -> None:
    """Checks that an argument is a dense float or integer tensor on the CPU or a CUDA device.

    Raises TypeError if `tensor` is not a tensor of type `dtype`. Raises ValueError if it is on another kind of device,
    not dense, or has none of the given shapes. None in a shape allows any size. Without shapes, every shape passes.
    The operators check that all of their tensors are on one device.
    """
    if not isinstance(tensor, torch.Tensor):
        raise TypeError(f'{operation}: {name} must be a tensor, found {type(tensor).__name__}')
    if tensor.dtype is not dtype:
        # Bytes are most often an image in [0, 255].
        scale = ' / 255 for an image' if tensor.dtype is torch.uint8 and dtype.is_floating_point else ''
        raise TypeError(f'{operation}: {name} must be {str(dtype)[6:]}, found {str(tensor.dtype)[6:]} '
                        f'(tensor.to({dtype}){scale})')
    if tensor.device.type not in ('cpu', 'cuda'):
        raise ValueError(f'{operation}: {name} must be on the CPU or a CUDA device, found {tensor.device} '
                         f'(tensor.cpu())')
    if tensor.layout is not torch.strided:
        raise ValueError(f'{operation}: {name} must be dense, found {tensor.layout}')
    if not shapes:
        return
    found = tensor.shape
    for wanted in shapes:
        if len(wanted) == len(found) and all(
                w is None or w == f for w, f in zip(wanted, found)):
            return
    raise ValueError(f'{operation}: {name} must be of shape ' +
                     ' or '.join(dict.fromkeys(map(_shape, shapes))) + f', found {list(found)}')


def check_size(operation: str, name: str, size) -> tuple[int, int]:
    """Returns `size` as (height, width). Raises TypeError or ValueError if it is not a valid image size."""
    if isinstance(size, torch.Tensor):
        size = size.tolist()
    try:
        height, width = map(operator.index, size)
    except (TypeError, ValueError):
        raise TypeError(
            f'{operation}: {name} must be two whole numbers, (height, width), found {size!r}'
        ) from None
    if not (1 <= height <= 16384 and 1 <= width <= 16384):
        raise ValueError(f'{operation}: {name} must be in [1, 16384], found {height} x {width}')
    return height, width


def choice(operation: str, name: str, value, choices: dict):
    """Returns choices[value]. Raises ValueError with a list of the choices if `value` is not one of them."""
    try:
        return choices[value]
    except (KeyError, TypeError):
        raise ValueError(f'{operation}: {name} must be one of {", ".join(map(repr, choices))}, '
                         f'found {value!r}') from None
