#!/usr/bin/env python3
"""Measures the time of the Python package's operations, and compares it with Mitsuba 3 and with `item3d edit`.

    PYTHONPATH=build/python-package:.deps/python python3 bench/python_operations.py [--mitsuba] [--edit MODEL]

The script prints Markdown tables. The time of an operation is the shortest of several calls on one thread. It is
processor time, except for single calls and imports, whose wall-clock time is measured. The comparisons use --threads
threads and give median wall-clock times.

--mitsuba renders a sphere in this process, with item3d.render (one sample per pixel) and with Mitsuba 3 (--samples
samples per pixel). bench/mitsuba_render.py says what Mitsuba needs and which light it traces. The times do not include
the preparation of the lights.
--edit MODEL runs `item3d edit` with the embedded prior. It then runs a loop in Python that optimises the model's
textures with item3d.Guidance and item3d.render, with the same number of iterations, views and pixels. In both, the
detail stage, settling, regularisation and changes of the light are off, and the prior gets the shape as an input. This
comparison needs the program."""
import argparse
import json
import math
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

import torch

import item3d
import item3d.nvdiffrast as dr
import mitsuba_render


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--threads', type=int, default=os.cpu_count(), help='number of threads in the comparisons')
    parser.add_argument('--repeats', type=int, default=7, help='number of measured runs of an operation or image')
    parser.add_argument('--no-operations', action='store_true', help='run the comparisons only')
    parser.add_argument('--mitsuba', action='store_true', help='compare item3d.render with Mitsuba 3')
    parser.add_argument('--samples', type=int, default=16, help='number of samples per pixel in Mitsuba')
    parser.add_argument('--variant', default='llvm_ad_rgb', help='variant of Mitsuba')
    parser.add_argument('--edit', metavar='MODEL', help='compare `item3d edit` of this model with a loop in Python')
    parser.add_argument('--iterations', type=int, default=100, help='number of iterations in the comparison of --edit')
    parser.add_argument('--texels', type=int, help='largest side of the textures that the loop of --edit optimises')
    return parser.parse_args()


def table(title, head, rows):
    print(f'\n{title}\n\n| ' + ' | '.join(head) + ' |\n|' + '---|' * len(head))
    for row in rows:
        print('| ' + ' | '.join(map(str, row)) + ' |')


def ball(rings=101, around=100):
    """Returns a unit sphere of 20,000 triangles: positions [V, 3], triangles [T, 3], UVs [V, 2]."""
    v, u = torch.meshgrid(torch.linspace(0, 1, rings + 1), torch.linspace(0, 1, around + 1), indexing='ij')
    polar, turn = math.pi * v, 2 * math.pi * u
    positions = torch.stack([polar.sin() * turn.sin(), polar.cos(), polar.sin() * turn.cos()], -1).view(-1, 3)
    first = (torch.arange(rings)[:, None] * (around + 1) + torch.arange(around)).view(-1)
    upper = torch.stack([first, first + around + 1, first + around + 2], -1)[:around * (rings - 1)]
    lower = torch.stack([first, first + around + 2, first + 1], -1)[around:]
    # A grid cell at a pole has one triangle, because the second one would have no area.
    triangles = torch.cat([upper, lower]).int()
    return positions, triangles, torch.stack([u, v], -1).view(-1, 2)


def thirds_camera(size):
    """Returns a camera in whose image the sphere covers a third of the pixels."""
    return item3d.camera((0.0, 1.2, 3.58), size=(size, size))


def ball_model(textures):
    positions, triangles, uvs = ball()
    primitive = item3d.Primitive(positions=positions, normals=positions.clone(), triangles=triangles, uvs=uvs)
    if len(textures) == 1:
        material = item3d.Material(base_color_texture=0, metallic_factor=0.0, roughness_factor=0.5)
    else:
        material = item3d.Material(base_color_texture=0, metallic_roughness_texture=1, normal_texture=2)
    return item3d.Model(primitives=[primitive], materials=[material], textures=textures)


# Times of the operations. -------------------------------------------------------------------------------------------

def shortest(run, clock, rounds, prepare=lambda: ()):
    taken = []
    for _ in range(rounds + 1):
        prepared = prepare()
        start = clock()
        run(*prepared)
        taken.append(clock() - start)
    return min(taken[1:])


def microseconds(run, rounds=300):
    return f'{1e6 * shortest(run, time.perf_counter, rounds):.1f}'


def milliseconds(run, repeats, prepare=lambda: ()):
    return f'{1e3 * shortest(run, time.process_time, repeats, prepare):.1f}'


def imports(repeats):
    code = ('import time, torch; start = time.perf_counter(); import item3d; '
            'print(time.perf_counter() - start)')
    return min(float(subprocess.run([sys.executable, '-c', code], check=True, capture_output=True, text=True).stdout)
               for _ in range(repeats))


def print_calls(repeats):
    positions = torch.tensor([[[-0.8, -0.8, 0, 1], [0.8, -0.8, 0, 1], [0, 0.8, 0, 1]]])
    triangles = torch.tensor([[0, 1, 2]], dtype=torch.int32)
    moving = positions.clone().requires_grad_()
    attributes, context = torch.eye(3)[None], dr.RasterizeCudaContext()
    raster = item3d.rasterize(positions, triangles, (8, 8))
    operator = torch.ops.item3d.rasterize.default
    table('Time of one call for a triangle on 8 x 8 pixels, the shortest of 300:',
          ('call', 'µs', 'with a position that requires gradients'),
          [('the operator', microseconds(lambda: operator(positions, triangles, None, None, 8, 8, False, False, False,
                                                          False)), ''),
           *((name, microseconds(lambda: call(positions)), microseconds(lambda: call(moving))) for name, call in
             (('`item3d.rasterize`', lambda p: item3d.rasterize(p, triangles, (8, 8))),
              ('`item3d.nvdiffrast.rasterize`', lambda p: dr.rasterize(context, p, triangles, (8, 8))))),
           ('`item3d.interpolate`', microseconds(lambda: item3d.interpolate(attributes, raster, triangles)), '')])
    print(f'\n`import item3d` after `import torch`: {1e3 * imports(repeats):.0f} ms.')


def print_rasterisation(repeats):
    vertices, triangles, uvs = ball()
    clip = thirds_camera(512).project(vertices)
    size, texels = (512, 512), torch.rand(1, 512, 512, 3)
    topology = item3d.topology(triangles, vertices)
    raster = item3d.rasterize(clip, triangles, size, derivatives=True)
    place, footprint = item3d.interpolate(uvs, raster, triangles, derivatives=True)
    image = item3d.texture(texels, place, derivatives=footprint)

    def all_of_them():
        moving, painted = clip.clone().requires_grad_(), texels.clone().requires_grad_()
        seen = item3d.rasterize(moving, triangles, size, derivatives=True)
        where, slopes = item3d.interpolate(uvs, seen, triangles, derivatives=True)
        color = item3d.texture(painted, where, derivatives=slopes)
        item3d.antialias(color, seen, moving, triangles, topology=topology).square().mean().backward()

    table(f'A sphere of {len(triangles):,} triangles on 512 x 512 pixels, {float(raster.covered.float().mean()):.0%} '
          'of them covered:', ('operation', 'ms'),
          [(name, milliseconds(run, repeats)) for name, run in
           (('`rasterize`', lambda: item3d.rasterize(clip, triangles, size)),
            ('`rasterize` with derivatives', lambda: item3d.rasterize(clip, triangles, size, derivatives=True)),
            ('`interpolate` with derivatives',
             lambda: item3d.interpolate(uvs, raster, triangles, derivatives=True)),
            ('a trilinear `texture` of 512 x 512 texels', lambda: item3d.texture(texels, place, derivatives=footprint)),
            ('`antialias`', lambda: item3d.antialias(image, raster, clip, triangles, topology=topology)),
            ('all of them forward and backward, with gradients by positions and texels', all_of_them))])


def print_lit_images(repeats):
    unit = torch.nn.functional.normalize
    environment, cube = torch.rand(256, 512, 3), torch.rand(6, 512, 512, 3)
    light = item3d.prefilter(environment)
    normal, view = unit(torch.randn(512 * 512, 3), dim=1), unit(torch.randn(512 * 512, 3), dim=1)
    base, rough = torch.rand(512 * 512, 3), torch.rand(512 * 512, 1)
    camera = thirds_camera(512)
    textures = [torch.rand(1024, 1024, 3) for _ in range(3)]

    def shaded(light, base):
        return item3d.shade(light, normal=normal, view=view, base_color=base, roughness=rough, metallic=0.5)

    def drawn(samples, *textures):
        return item3d.render(ball_model(list(textures)), camera, light, (512, 512), samples=samples)

    def forward_backward(make, *inputs):
        def prepare():
            result = make(*(each.clone().requires_grad_() for each in inputs))
            maps = [each for each in (result if isinstance(result, tuple) else (result,))
                    if isinstance(each, torch.Tensor) and each.requires_grad]
            return [sum(each.square().mean() for each in maps)]
        return (milliseconds(lambda: make(*inputs), repeats),
                milliseconds(lambda loss: loss.backward(), repeats, prepare))

    def by_light(environment):
        return shaded(item3d.prefilter(environment), base)

    table('Lit images:', ('operation', 'forward, ms', 'backward, ms'),
          [(name, *forward_backward(make, *inputs)) for name, make, inputs in
           (('`prefilter` of 256 x 512 texels, to a cube of 256', item3d.prefilter, [environment]),
            ('`prefilter` of a cube of 512', item3d.prefilter, [cube]),
            ('`shade` of 512 x 512 points, gradient by base colour', lambda color: shaded(light, color), [base]),
            ('`prefilter` of 256 x 512 and `shade`, gradient by the environment', by_light, [environment]),
            ('`render` of 512 x 512 pixels, the sphere with three textures of 1024, one sample a pixel',
             lambda *them: drawn(1, *them), textures),
            ('the same with 2 x 2 samples', lambda *them: drawn(2, *them), textures))])


# Comparison with Mitsuba. -------------------------------------------------------------------------------------------

def write_obj(path):
    positions, triangles, uvs = ball()
    with open(path, 'w') as file:
        for name, rows in (('v', positions), ('vt', torch.stack([uvs[:, 0], 1 - uvs[:, 1]], 1)), ('vn', positions)):
            file.writelines(f'{name} ' + ' '.join(map(repr, row)) + '\n' for row in rows.tolist())
        file.writelines('f ' + ' '.join(f'{i}/{i}/{i}' for i in row) + '\n' for row in (triangles + 1).tolist())


def compare_with_mitsuba(options):
    import mitsuba
    mitsuba.set_variant(options.variant)
    size = 512
    texture = (torch.rand(1024, 1024, 3) * 255).to(torch.uint8)
    # The environment has a smooth sky, a small sun and a dark ground.
    height, turn = torch.meshgrid(torch.linspace(1, -1, 256), torch.linspace(0, 2 * math.pi, 512), indexing='ij')
    environment = torch.stack([(0.6 + channel * height + 0.2 * turn.cos()).clamp(min=0.05)
                               for channel in (0.2, 0.3, 0.5)], -1)
    environment[40:48, 100:108] += 50

    camera = thirds_camera(size)
    light = item3d.prefilter(environment)
    texels = (texture.float() / 255).requires_grad_()
    model = ball_model([texels])

    def forward(_):
        with torch.no_grad():
            return item3d.render(model, camera, light, (size, size), samples=1)

    def forward_backward(_):
        texels.grad = None
        item3d.render(model, camera, light, (size, size), samples=1).square().mean().backward()

    ours = {'coverage': float(forward(0)[..., 3].mean()),
            'forward_ms': mitsuba_render.median_ms(forward, options.repeats),
            'forward_backward_ms': mitsuba_render.median_ms(forward_backward, options.repeats)}
    with tempfile.TemporaryDirectory() as folder:
        at = pathlib.Path(folder)
        write_obj(at / 'ball.obj')
        mitsuba.Bitmap(texture.numpy()).write(str(at / 'texture.png'))
        mitsuba.Bitmap(environment.numpy()).write(str(at / 'light.exr'))
        seen = {'camera_to_world': torch.linalg.inv(camera.world_to_camera[0]).tolist(),
                'field_of_view_x_degrees': math.degrees(0.8)}
        theirs = mitsuba_render.time_mitsuba(argparse.Namespace(
            variant=options.variant, threads=options.threads, light=str(at / 'light.exr'), size=size,
            samples=options.samples, model=str(at / 'ball.obj'), texture=str(at / 'texture.png'),
            repeats=options.repeats), seen)
    table(f'One view of a sphere of 20,000 triangles with a texture of 1024 on {size} x {size} pixels, {options.threads} '
          f'threads. Mitsuba {theirs["version"]}, `{theirs["variant"]}`, {theirs["samples"]} samples a pixel; '
          'item3d one. The gradient is that by the texture.', ('', 'item3d', 'Mitsuba', 'ratio'),
          [('covered pixels', f'{ours["coverage"]:.1%}', f'{theirs["coverage"]:.1%}', ''),
           *((name, f'{ours[key]:.0f} ms', f'{theirs[key]:.0f} ms', f'{theirs[key] / ours[key]:.1f}') for name, key in
             (('image', 'forward_ms'), ('image and gradient', 'forward_backward_ms')))])


# Comparison with `item3d edit`. -------------------------------------------------------------------------------------

BATCH, PIXELS = 2, 64
SENTENCES = ('a red mug', 'a golden mug')


def program_seconds(options):
    """Runs `item3d edit` and returns the seconds of an iteration, and the seconds of each part of it."""
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([item3d.find_program(), 'edit', options.edit, '--from', SENTENCES[0], '--to', SENTENCES[1],
                        '-o', f'{folder}/edit', '--guidance', 'rdl', '--iterations', str(options.iterations),
                        '--batch', str(BATCH), '--resolution', str(PIXELS), '--detail', 'off', '--settle', '0',
                        '--evenness', '0', '--light-augment', 'off', '--background', 'white', '--region', 'all',
                        '--threads', str(options.threads)], check=True, capture_output=True)
        report = json.loads(pathlib.Path(folder, 'edit/edit.json').read_text())
    return report['seconds']['optimize'] / report['iterations_done'], report['seconds_per_iteration']


def shrunk(texture, largest):
    """Returns a copy of a texture [H, W, C], reduced to at most `largest` texels along a side unless that is None."""
    factor = 1 if largest is None else max(1, math.ceil(max(texture.shape[:2]) / largest))
    return torch.nn.functional.avg_pool2d(texture.permute(2, 0, 1), factor).permute(1, 2, 0).contiguous()


def loop_seconds(options):
    """Runs the loop in Python and returns the median seconds of an iteration, and the mean seconds of each part."""
    model = item3d.load(options.edit)
    model = item3d.Model(primitives=model.primitives, materials=model.materials, wraps=model.wraps,
                         textures=[shrunk(each, options.texels).requires_grad_() for each in model.textures])
    positions = torch.cat([each.positions for each in model.primitives])
    center = (positions.amin(0) + positions.amax(0)) / 2
    radius = float((positions - center).norm(dim=1).max())
    turns = torch.rand(options.iterations, BATCH, generator=torch.Generator().manual_seed(0)) * 2 * math.pi
    light = item3d.prefilter(torch.rand(64, 128, 3), size=64)
    optimizer = torch.optim.Adam(model.textures, 0.01, fused=True)
    offsets = torch.tensor([0, *(len(each.positions) for each in model.primitives)]).cumsum(0)
    triangles = torch.cat([each.triangles + int(offset) for each, offset in zip(model.primitives, offsets)]).int()
    surface = torch.cat([(positions - center) / radius, torch.cat([each.normals for each in model.primitives])], 1)
    parts, whole = {'render': 0.0, 'shape': 0.0, 'guidance': 0.0, 'backward': 0.0, 'step': 0.0}, []
    with item3d.Guidance(None, *SENTENCES, iterations=options.iterations, seed=0, threads=options.threads) as guidance:
        for iteration in range(options.iterations):
            marks = [time.perf_counter()]
            turn = turns[iteration]
            eye = center + 2.6 * radius * torch.stack([turn.sin(), torch.full_like(turn, 0.4), turn.cos()], 1)
            camera = item3d.camera(eye, center, size=(PIXELS, PIXELS), near=0.5 * radius, far=5 * radius)
            drawn = item3d.render(model, camera, light, (PIXELS, PIXELS), background=(1, 1, 1))
            images = item3d.linear_to_srgb(drawn[..., :3].clamp(0, 1))
            marks.append(time.perf_counter())
            raster = item3d.rasterize(camera.project(positions), triangles, (PIXELS, PIXELS), depth='w')
            place, normal = item3d.interpolate(surface, raster, triangles).split(3, -1)
            depth = torch.where(raster.covered, raster.depth, 0.0)
            marks.append(time.perf_counter())
            gradient = guidance(images, iteration, depth=depth, position=place.contiguous(),
                                normal=torch.nn.functional.normalize(normal, dim=-1))
            marks.append(time.perf_counter())
            optimizer.zero_grad()
            images.backward(gradient)
            marks.append(time.perf_counter())
            optimizer.step()
            with torch.no_grad():
                for texture in model.textures:
                    texture.clamp_(0, 1)
            marks.append(time.perf_counter())
            for name, start, end in zip(parts, marks, marks[1:]):
                parts[name] += (end - start) / options.iterations
            whole.append(marks[-1] - marks[0])
    return statistics.median(whole), parts


def compare_with_edit(options):
    theirs, their_parts = program_seconds(options)
    ours, our_parts = loop_seconds(options)
    rows = [('an iteration', f'{1e3 * theirs:.1f}', f'{1e3 * ours:.1f}', f'{ours / theirs:.3f}'),
            ('images', f'{1e3 * their_parts["render"]:.1f}',
             f'{1e3 * (our_parts["render"] + our_parts["shape"]):.1f}', ''),
            ('the prior', f'{1e3 * (their_parts["encode"] + their_parts["unet"]):.1f}',
             f'{1e3 * our_parts["guidance"]:.1f}', ''),
            ('the gradient by the textures (by the prior too, in the program)', f'{1e3 * their_parts["backward"]:.1f}',
             f'{1e3 * our_parts["backward"]:.1f}', ''),
            ('the optimiser', f'{1e3 * their_parts["step"]:.1f}', f'{1e3 * our_parts["step"]:.1f}', ''),
            ('images for the report', f'{1e3 * their_parts["adjust"]:.1f}', '', '')]
    table(f'{options.iterations} iterations of {BATCH} views of {PIXELS} x {PIXELS} pixels, {options.threads} threads, '
          'ms an iteration:', ('', '`item3d edit`', 'loop in Python', 'ratio'), rows)


def main():
    options = arguments()
    print(f'PyTorch {torch.__version__}, Python {sys.version.split()[0]}, load average {os.getloadavg()[0]:.1f}.')
    if not options.no_operations:
        torch.set_num_threads(1)
        print_calls(options.repeats)
        print_rasterisation(options.repeats)
        print_lit_images(options.repeats)
    torch.set_num_threads(options.threads)
    if options.mitsuba:
        compare_with_mitsuba(options)
    if options.edit:
        compare_with_edit(options)


if __name__ == '__main__':
    main()
