"""Tests of Guidance: the protocol with a stand-in for the program, and the gradient with the program if it exists."""
import stat
import subprocess
import sys
import textwrap

import pytest
import torch

import item3d

STAND_IN = '''
import json, struct, sys
sys.stdout.buffer.write(b'{"size": 8, "downscale": 4, "takes_shape": true, "needs_reference": REFERENCE}\\n')
sys.stdout.buffer.flush()
for line in sys.stdin.buffer:
    ask = json.loads(line)
    pixels = ask['views'] * ask['height'] * ask['width']
    read = lambda n: struct.unpack(f'<{n}f', sys.stdin.buffer.read(4 * n))
    images = read(3 * pixels)
    depth = read(pixels) if ask['depth'] else ()
    surface = read(6 * pixels) if ask['surface'] else ()
    reference = read(3 * pixels) if ask['reference'] else ()
    if ask['iteration'] == 9:
        sys.exit('item3d: error: stdin: a number is wrong; send another') or 0
    if ask['iteration'] == 8:
        sys.exit(0)
    reply = dict(iteration=ask['iteration'], direction_length=sum(depth), source_loss=sum(surface) + sum(reference),
                 timestep=40 + ask['iteration'], noise_seed=2 ** 64 - 1)
    sys.stdout.buffer.write(json.dumps(reply).encode() + b'\\n')
    sys.stdout.buffer.write(struct.pack(f'<{3 * pixels}f', *(2 * v + ask['iteration'] for v in images)))
    sys.stdout.buffer.flush()
'''


@pytest.fixture
def stand_in(tmp_path):
    """Returns a function that writes a stand-in for the program, which replies with 2 * images + iteration."""
    def make(reference='false'):
        path = tmp_path / 'item3d'
        path.write_text(f'#!{sys.executable}\n' + textwrap.dedent(STAND_IN.replace('REFERENCE', reference)))
        path.chmod(path.stat().st_mode | stat.S_IEXEC)
        return str(path)
    return make


def test_images_go_and_gradients_come(stand_in):
    images = torch.rand(2, 4, 8, 3)
    with item3d.Guidance('prior', 'a', 'b', program=stand_in(), seed=3) as guidance:
        assert guidance._command[1:] == ['guidance', '--from', 'a', '--to', 'b', '--prior', 'prior', '--seed', '3']
        assert (guidance.size, guidance.downscale, guidance.takes_shape) == (8, 4, True)
        for iteration in range(3):
            gradient = guidance(images, iteration)
            assert torch.equal(gradient, 2 * images + iteration) or (gradient - 2 * images - iteration).abs().max() < 1e-6
        depth, surface = torch.ones(2, 4, 8), torch.ones(2, 4, 8, 3)
        guidance(images, 0, depth=depth, position=surface, normal=surface, reference=surface)
        assert guidance.direction_length == 64 and guidance.source_loss == 9 * 64
        assert guidance.timestep >= 40 and guidance.noise_seed == 2 ** 64 - 1
        guidance(images.requires_grad_(), 1)
    with pytest.raises(ValueError, match='closed'):
        guidance(images, 0)
    guidance.close()


def test_wrong_arguments(stand_in):
    images = torch.rand(1, 8, 8, 3)
    with item3d.Guidance(None, 'a', 'b', program=stand_in('true')) as guidance:
        with pytest.raises(TypeError, match='float32'):
            guidance(images.double(), 0)
        with pytest.raises(ValueError, match='shape'):
            guidance(images.permute(0, 3, 1, 2), 0)
        for wrong in (images[:0], images[:, :7]):
            with pytest.raises(ValueError, match='at least one, with sides divisible by 4'):
                guidance(wrong, 0, reference=wrong)
        with pytest.raises(ValueError, match='iteration must be 0 or more, found -1'):
            guidance(images, -1, reference=images)
        with pytest.raises(TypeError, match='integer'):
            guidance(images, 1.5, reference=images)
        with pytest.raises(ValueError, match='reference must be finite, found NaN or infinity'):
            guidance(images, 0, reference=images / 0)
        with pytest.raises(ValueError, match='needs reference'):
            guidance(images, 0)
        with pytest.raises(ValueError, match='must be given together'):
            guidance(images, 0, reference=images, depth=images[..., 0], normal=images)
        with pytest.raises(ValueError, match='need depth'):
            guidance(images, 0, reference=images, position=images, normal=images)
        with pytest.raises(ValueError, match='depth must be of shape'):
            guidance(images, 0, reference=images, depth=images)
        assert guidance(images, 0, reference=images).shape == images.shape  # the object still works after these errors
    with pytest.raises(TypeError, match='GuidanceSettings has no seeds'):
        item3d.Guidance(None, 'a', 'b', program=stand_in(), seeds=3)


def test_a_process_that_ends(stand_in):
    guidance = item3d.Guidance(None, 'a', 'b', program=stand_in())
    with pytest.raises(item3d.InternalError, match='a number is wrong'):
        guidance(torch.rand(1, 8, 8, 3), 9)
    guidance = item3d.Guidance(None, 'a', 'b', program=stand_in())
    with pytest.raises(item3d.InternalError, match='ended with code'):
        guidance(torch.rand(1, 8, 8, 3), 8)


@pytest.fixture(scope='module')
def program():
    try:
        found = item3d.find_program()
    except item3d.ProgramMissing as error:
        pytest.skip(str(error))
    if subprocess.run([found, 'guidance', '--help'], capture_output=True).returncode != 0:
        pytest.skip('a program without the command guidance')
    return found


def test_the_embedded_prior(program):
    images = torch.rand(2, 64, 64, 3)
    with item3d.Guidance(None, 'a red mug', 'a golden mug', program=program, adjust='off', seed=1) as guidance:
        first = guidance(images, 0)
        assert first.shape == images.shape and first.isfinite().all() and first.abs().max() > 0
        assert torch.equal(guidance(images, 0), first)
        assert not torch.equal(guidance(images, 1), first)
        depth = torch.ones(2, 64, 64)
        points = torch.zeros(2, 64, 64, 3)
        with_shape = guidance(images, 0, depth=depth, position=points, normal=points)
        assert not torch.equal(with_shape, first)
        assert guidance.direction_length > 0
    # Between equal sentences the direction is zero.
    with item3d.Guidance(None, 'a red mug', 'a red mug', program=program, adjust='off') as guidance:
        assert guidance(images, 0).abs().max() < 1e-6


def test_refusals_of_the_program(program):
    with pytest.raises(item3d.InputError, match='no_such_prior'):
        item3d.Guidance('no_such_prior', 'a', 'b', program=program)
    guidance = item3d.Guidance(None, 'a red mug', 'a golden mug', program=program)
    with pytest.raises(ValueError, match='sides divisible by 4'):
        guidance(torch.rand(1, 63, 64, 3), 0)
    with pytest.raises(ValueError, match='images must be finite'):
        guidance(torch.full((1, 64, 64, 3), float('nan')), 0)
    with pytest.raises(item3d.InputError, match='depth'):
        guidance(torch.rand(1, 64, 64, 3), 0, depth=torch.ones(1, 64, 64))
    with pytest.raises(item3d.UsageError, match='caption'):
        item3d.Guidance(None, 'a', 'b', program=program, adjust='caption')
