#!/usr/bin/env python3
"""Measures the time to render one image with item3d and with Mitsuba 3.

The script measures two times in milliseconds: the image alone (forward), and the image together with the gradient of
its mean square with respect to the base colour texture (forward and backward). One run measures both programs, one
after the other, with the same number of threads. docs/benchmarks.md has the results.

    python3 bench/mitsuba_render.py ITEM3D MODEL.obj TEXTURE.png LIGHT.hdr [--size 512] [--samples 16] ...

ITEM3D is the program. MODEL must name TEXTURE as its base colour, so that both programs draw the same surface.
Mitsuba traces direct light only (path depth 2: shadows, but no light between surfaces), with --samples samples per
pixel. item3d draws one sample per pixel, with antialiased edges. Both programs use the camera that
`item3d bench render` chooses.

The script needs Mitsuba 3 (pip install mitsuba) and numpy. Mitsuba's llvm variants need an LLVM library of version
17 to 19. If Mitsuba does not find the library, the environment variable DRJIT_LIBLLVM_PATH must name it."""
import argparse
import json
import os
import statistics
import subprocess
import sys
import time


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('item3d', help='the program')
    parser.add_argument('model', help='OBJ file of the model')
    parser.add_argument('texture', help="image of the model's base colour")
    parser.add_argument('light', help='equirectangular HDR image')
    parser.add_argument('--size', type=int, default=512, help='width and height of the image in pixels')
    parser.add_argument('--samples', type=int, default=16, help='number of samples per pixel in Mitsuba')
    parser.add_argument('--threads', type=int, default=os.cpu_count(), help='number of threads in both programs')
    parser.add_argument('--repeats', type=int, default=7, help='number of measured images')
    parser.add_argument('--variant', default='llvm_ad_rgb', help='variant of Mitsuba')
    return parser.parse_args()


def time_item3d(options):
    command = [options.item3d, 'bench', 'render', '--model', options.model, '--light', options.light,
               '--size', f'{options.size}x{options.size}', '--threads', str(options.threads),
               '--repeats', str(options.repeats), '--device', 'cpu', '--json', '--quiet']
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def median_ms(run, repeats):
    run(0)  # warm-up, in which Mitsuba compiles its kernels
    taken = []
    for seed in range(1, repeats + 1):
        start = time.perf_counter()
        run(seed)
        taken.append(1000 * (time.perf_counter() - start))
    return statistics.median(taken)


def time_mitsuba(options, camera):
    import mitsuba as mi
    mi.set_variant(options.variant)
    import drjit as dr
    import numpy as np
    dr.set_thread_count(options.threads)

    # A camera of Mitsuba looks along its +Z axis, and its +X axis points to the left.
    pose = np.array(camera['camera_to_world']) @ np.diag([-1.0, 1.0, -1.0, 1.0])
    scene = mi.load_dict({
        'type': 'scene',
        'integrator': {'type': 'path', 'max_depth': 2, 'hide_emitters': True},
        # The first column of a panorama in Mitsuba is the middle column in item3d.
        'light': {'type': 'envmap', 'filename': options.light,
                  'to_world': mi.ScalarTransform4f().rotate([0, 1, 0], 180)},
        'sensor': {'type': 'perspective', 'fov': camera['field_of_view_x_degrees'], 'fov_axis': 'x',
                   'near_clip': 0.01, 'far_clip': 1000.0, 'to_world': mi.ScalarTransform4f(pose),
                   'film': {'type': 'hdrfilm', 'width': options.size, 'height': options.size,
                            'pixel_format': 'rgba', 'rfilter': {'type': 'box'}},
                   'sampler': {'type': 'independent', 'sample_count': options.samples}},
        'model': {'type': 'obj', 'filename': options.model,
                  'bsdf': {'type': 'twosided', 'nested': {
                      'type': 'principled', 'roughness': 0.5, 'metallic': 0.0, 'specular': 0.5,
                      'base_color': {'type': 'bitmap', 'filename': options.texture, 'format': 'variant'}}}},
    })
    parameters = mi.traverse(scene)
    key = next(name for name in parameters.keys() if name.endswith('base_color.data'))

    def forward(seed):
        with dr.suspend_grad():
            image = mi.render(scene, spp=options.samples, seed=seed)
            dr.eval(image)
            dr.sync_thread()
        return image

    def forward_backward(seed):
        texture = type(parameters[key])(dr.detach(parameters[key]))
        dr.enable_grad(texture)
        parameters[key] = texture
        parameters.update()
        image = mi.render(scene, parameters, spp=options.samples, seed=seed, seed_grad=seed + 1000)
        dr.backward(dr.mean(dr.square(image), axis=None))
        gradient = dr.grad(texture)
        dr.eval(gradient)
        dr.sync_thread()
        if not np.abs(np.array(gradient)).max() > 0:
            sys.exit('Mitsuba gave no gradient')
        parameters[key] = dr.detach(texture)

    return {'version': mi.__version__, 'variant': mi.variant(), 'samples': options.samples,
            # Share of covered pixels; if both programs draw the same view, they agree on it.
            'coverage': float(np.array(forward(0))[..., 3].mean()),
            'forward_ms': median_ms(forward, options.repeats),
            'forward_backward_ms': median_ms(forward_backward, options.repeats)}


def main():
    options = arguments()
    ours = time_item3d(options)
    theirs = time_mitsuba(options, ours['camera'])
    faster = {name: theirs[name] / ours[name] for name in ('forward_ms', 'forward_backward_ms')}
    json.dump({'triangles': ours['triangles'], 'size': options.size, 'threads': options.threads,
               'item3d': {'coverage': ours['covered_pixels'] / options.size ** 2,
                          **{name: ours[name] for name in faster}},
               'mitsuba': theirs,
               'times_faster': {name.removesuffix('_ms'): value for name, value in faster.items()},
               'load_average': os.getloadavg()[0]}, sys.stdout, indent=2)
    print()


if __name__ == '__main__':
    main()
