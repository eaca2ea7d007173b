"""Environment maps from files and presets."""
from __future__ import annotations

import os
import struct
import tempfile
import zlib

import torch

from .program import run_command


def load_light(light, *, rotate: float = 0.0, exposure: float = 0.0) -> torch.Tensor:
    """Returns a light as an equirectangular map [H, W, 3], linear float32, the zenith in row 0, for prefilter().

    Args:
        light: 'studio', 'noon', 'sunset', 'overcast' or 'night', or the path of an .hdr or .exr file.
        rotate: rotation about +y in degrees, from north (-z) to east (+x).
        exposure: the light is multiplied by 2^exposure.

    Runs `item3d light`. Raises InputError for an unknown name and for a file that cannot be read.
    """
    with tempfile.TemporaryDirectory(prefix='item3d-') as folder:
        file = os.path.join(folder, 'light.exr')
        run_command(['light', light, '-o', file, '--rotate', str(rotate), '--exposure', str(exposure)])
        with open(file, 'rb') as opened:
            return _decode(opened.read())


def _decode(content: bytes) -> torch.Tensor:
    """Decodes an OpenEXR image as the program writes it: 32-bit floats B, G, R in blocks of 16 rows, with ZIP."""
    place, header = 8, {}
    while content[place]:
        name, kind, rest = content[place:place + 512].split(b'\0', 2)
        begin = place + len(name) + len(kind) + 2
        size = struct.unpack_from('<i', content, begin)[0]
        header[name] = content[begin + 4:begin + 4 + size]
        place = begin + 4 + size
    if header[b'compression'] != b'\3' or header[b'channels'][:6] != b'B\0\2\0\0\0':
        raise ValueError('load_light: the program wrote an image of an unknown kind; it is not of this version')
    left, top, right, bottom = struct.unpack('<4i', header[b'dataWindow'])
    width, height = right - left + 1, bottom - top + 1
    rows = []
    for offset in struct.unpack_from(f'<{(height + 15) // 16}Q', content, place + 1):
        first, size = struct.unpack_from('<2i', content, offset)
        count = min(16, bottom - first + 1)
        block = content[offset + 8:offset + 8 + size]
        if size < 12 * count * width:  # a block that compression would enlarge is stored as it is
            block = _undo_prediction(zlib.decompress(block))
        rows.append(torch.frombuffer(bytearray(block), dtype=torch.float32).reshape(count, 3, width))
    return torch.cat(rows).flip(1).transpose(1, 2).contiguous()


def _undo_prediction(packed: bytes) -> bytes:
    """Adds the differences up. The first half of the sums are the even bytes, the second half the odd ones."""
    deltas = torch.frombuffer(bytearray(packed), dtype=torch.uint8).long()
    sums = ((deltas.cumsum(0) - 128 * torch.arange(len(deltas), device='cpu')) % 256).to(torch.uint8)
    half = (len(sums) + 1) // 2
    whole = torch.empty_like(sums)
    whole[0::2], whole[1::2] = sums[:half], sums[half:]
    return whole.numpy().tobytes()
