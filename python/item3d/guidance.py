"""Guidance for renderers other than item3d's: the gradient of an edit with respect to any images.

    with item3d.Guidance(None, 'a red mug', 'a golden mug', iterations=300) as guidance:
        for iteration in range(300):
            images = my_renderer()                          # [N, H, W, 3] sRGB in [0, 1]
            images.backward(guidance(images, iteration))
            optimizer.step()

The networks run in a separate process, `item3d guidance`. This process therefore does not load a second LibTorch, and a
crash of the networks does not end it.
"""
from __future__ import annotations

import json
import operator
import os
import signal
import subprocess
import threading

import torch

from ._checks import check
from .program import InternalError, ProgramMissing, failure, find_program, log_message, options_of, settings_of
from .settings import GuidanceSettings


class Guidance:
    """The direction from one sentence to another, as gradients with respect to images.

    Args:
        prior: folder or name of a diffusion model; None: the embedded prior, which was trained on 64 x 64 images of
            one object on a plain background.
        source, target: the sentences.
        settings, changes: GuidanceSettings, and single settings that override them. The setting `iterations` is the
            length of the whole optimization, which methods with a schedule need.

    Loading takes a few seconds.

    Attributes:
        size: side of the images in pixels that the prior was trained on.
        downscale: number by which the height and width of the images must be divisible.
        takes_shape: True if the prior uses depth, position and normal.
        needs_reference: True if the method needs images of the unedited object.
        direction_length, source_loss, direction: values of the last call.
        timestep: training timestep of the last call, the same for all of its images.
        noise_seed: seed of its noise: `torch.randn(latents.shape, generator=torch.Generator().manual_seed(noise_seed))`.

    Raises InputError, UsageError, ResourceError and InternalError as the commands do. The object is then closed. A
    TypeError or a ValueError leaves it open.
    """

    def __init__(self, prior, source: str, target: str, *, settings: GuidanceSettings | None = None,
                 program: str | None = None, **changes):
        settings = settings_of(GuidanceSettings, settings, changes)
        given = [] if prior is None else ['--prior', os.fspath(prior)]
        self._command = [program or find_program(), 'guidance', '--from', source, '--to', target, *given,
                         *options_of(settings)]
        self._lines: list[str] = []
        try:
            # The new process has its own process group, so that Ctrl-C interrupts only this process.
            self._process = subprocess.Popen(self._command, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                             stderr=subprocess.PIPE, start_new_session=True)
        except OSError as error:
            raise ProgramMissing(f'{self._command[0]} cannot be started: {error.strerror}', 127) from None
        self._reader = threading.Thread(target=self._read_messages, daemon=True)
        self._reader.start()
        first = self._guarded(self._read_line)
        self.size: int = first['size']
        self.downscale: int = first['downscale']
        self.takes_shape: bool = first['takes_shape']
        self.needs_reference: bool = first['needs_reference']
        self.direction_length: float | None = None
        self.source_loss: float | None = None
        self.direction: dict[str, float] | None = None
        self.timestep: int | None = None
        self.noise_seed: int | None = None

    def __call__(self, images: torch.Tensor, iteration: int, *, depth: torch.Tensor | None = None,
                 position: torch.Tensor | None = None, normal: torch.Tensor | None = None,
                 reference: torch.Tensor | None = None) -> torch.Tensor:
        """Returns the gradient [N, H, W, 3] with respect to the images, to be passed to images.backward().

        Gradient descent then moves the images in the direction of the edit. Images on a CUDA device are copied to the
        process, and the gradient is on this device.

        Args:
            images: [N, H, W, 3] float32, sRGB in [0, 1], row 0 at the top. H and W are multiples of `downscale`.
            iteration: number of the step, from 0. Noise and timesteps depend only on it and on the seed.
            depth: [N, H, W] z-depth, 0 for the background.
            position, normal: [N, H, W, 3] surface points, scaled into the unit sphere, and unit normals. Give both or
                none of them.
            reference: [N, H, W, 3] images of the unedited object.
        """
        if self._process.poll() is not None:
            raise ValueError('Guidance: it is closed; make a new one')
        check('Guidance', 'images', images, torch.float32, (None, None, None, 3))
        n, height, width, _ = images.shape
        if n == 0 or height % self.downscale or width % self.downscale or not height * width:
            raise ValueError(f'Guidance: images must be at least one, with sides divisible by {self.downscale}, found '
                             f'{list(images.shape)}')
        if operator.index(iteration) < 0:
            raise ValueError(f'Guidance: iteration must be 0 or more, found {iteration}')
        if (position is None) != (normal is None):
            raise ValueError('Guidance: position and normal must be given together')
        if position is not None and depth is None:
            raise ValueError('Guidance: position and normal need depth')
        if reference is None and self.needs_reference:
            raise ValueError('Guidance: this method needs reference, images of the unedited object')
        arrays = [images.detach().permute(0, 3, 1, 2)]
        for name, given, shape in (('depth', depth, (n, height, width)), ('position', position, (n, height, width, 3)),
                                   ('normal', normal, (n, height, width, 3))):
            if given is not None:
                check('Guidance', name, given, torch.float32, shape)
                arrays.append(given.detach())
        if reference is not None:
            check('Guidance', 'reference', reference, torch.float32, (n, height, width, 3))
            arrays.append(reference.detach().permute(0, 3, 1, 2))
        for name, given in (('images', images), ('depth', depth), ('position', position), ('normal', normal),
                            ('reference', reference)):
            if given is not None and not given.isfinite().all():
                raise ValueError(f'Guidance: {name} must be finite, found NaN or infinity')
        header = {'iteration': operator.index(iteration), 'views': n, 'height': height, 'width': width,
                  'depth': depth is not None, 'surface': position is not None, 'reference': reference is not None}
        gradient = torch.empty(n, 3, height, width, device='cpu')
        reply = self._guarded(lambda: self._exchange(header, arrays, gradient))
        self.direction_length = reply['direction_length']
        self.source_loss = reply['source_loss']
        self.direction = reply.get('direction')
        self.timestep = reply.get('timestep')
        self.noise_seed = reply.get('noise_seed')
        return gradient.permute(0, 2, 3, 1).to(images.device)

    def close(self) -> None:
        """Ends the process. Does nothing if it has already ended."""
        if self._process.poll() is None:
            try:
                os.killpg(self._process.pid, signal.SIGKILL)  # the process has nothing to save
            except ProcessLookupError:
                pass
        self._process.wait()
        self._reader.join()
        for pipe in (self._process.stdin, self._process.stdout, self._process.stderr):
            try:
                pipe.close()
            except OSError:  # bytes were left that could not be sent
                pass

    def __enter__(self) -> Guidance:
        return self

    def __exit__(self, *_) -> None:
        self.close()

    def __del__(self) -> None:
        if hasattr(self, '_reader'):
            self.close()

    def _read_messages(self) -> None:
        for line in self._process.stderr:
            text = line.decode('utf-8', 'replace').rstrip('\r\n')
            self._lines.append(text)
            log_message(text)

    def _guarded(self, exchange):
        """Returns the result of exchange(). Closes the object on errors, as the pipes may hold partial messages."""
        try:
            return exchange()
        except (EOFError, OSError):
            code = self._process.wait()
            self.close()
            raise failure(self._command, code or 1, self._lines) from None
        except BaseException:
            self.close()
            raise

    def _exchange(self, header, arrays, gradient):
        pipe = self._process.stdin
        pipe.write(json.dumps(header).encode() + b'\n')
        for array in arrays:
            pipe.write(memoryview(array.cpu().contiguous().numpy()).cast('B'))
        pipe.flush()
        reply = self._read_line()
        into = memoryview(gradient.numpy()).cast('B')
        while into:
            count = self._process.stdout.readinto(into)
            if not count:
                raise EOFError
            into = into[count:]
        return reply

    def _read_line(self):
        line = self._process.stdout.readline()
        if not line.endswith(b'\n'):
            raise EOFError
        try:
            return json.loads(line)
        except ValueError:
            raise InternalError(f'{self._command[0]} printed no JSON: is it item3d, and not too old?', 1) from None
