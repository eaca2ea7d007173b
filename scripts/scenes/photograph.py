#!/usr/bin/env python3
"""Renders datasets in NeRF-synthetic's layout, to measure `item3d reconstruct`.

    python3 scripts/scenes/photograph.py OUT [SCENE ...] [--samples 64] [--size 256] [--train 60] [--test 12]

Mitsuba 3 path traces the scenes, including light between surfaces. scenes.py has eight scenes: two are for the choice
of settings, six for reported results. By default all scenes are rendered. The script writes to OUT/SCENE:

    train, test, transforms_*.json     photographs and cameras; +Z is up, and the alpha channel is the mask
    test_relit, test_relit_2           every second test view under two other lights
    test_gt                            true base colour, roughness (G), metallic (B), normal and depth of the test views
    gt/mesh.obj, gt/light*.exr         true surface and the three lights; +Y is up

Open Image Denoise removes the noise that remains at 64 samples per pixel. It also uses the base colours and normals.

The script needs Mitsuba 3, pyoidn and Pillow (pip install mitsuba pyoidn pillow). Mitsuba's llvm variants need an LLVM
library. If Mitsuba does not find it, the environment variable DRJIT_LIBLLVM_PATH must name it."""
import argparse
import json
import os
import time
import zlib

import mitsuba as mi
import numpy as np
import pyoidn
from PIL import Image

mi.set_variant(os.environ.get('MITSUBA_VARIANT', 'llvm_ad_rgb'))
import scenes  # noqa: E402

FIELD_OF_VIEW_X = 0.6911112070083618  # that of NeRF-synthetic
DISTANCE = 4.031128874149275
RADIUS = 1.25  # radius of the bounding sphere of each scene
Z_UP = np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1.0]])
LIGHT_HEIGHT = 256


def srgb(x):
    x = np.clip(x, 0, None)
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * np.maximum(x, 1e-8) ** (1 / 2.4) - 0.055)


def look_at(eye):
    z = eye / np.linalg.norm(eye)
    x = np.cross([0, 1, 0], z)
    x /= np.linalg.norm(x)
    m = np.eye(4)
    m[:3, 0], m[:3, 1], m[:3, 2], m[:3, 3] = x, np.cross(z, x), z, eye
    return m


def cameras(train, test):
    """Returns the training cameras, a spiral from below to above, and the test cameras, a wavy circle."""
    def at(azimuth, elevation):
        return look_at(DISTANCE * np.array([np.cos(elevation) * np.sin(azimuth), np.sin(elevation),
                                            np.cos(elevation) * np.cos(azimuth)]))
    low, high = np.sin(np.radians([-35, 75]))
    spiral = [at(2 * np.pi * 0.6180339887498949 * k, np.arcsin(low + (high - low) * (k + 0.5) / train)) for k in range(train)]
    around = [2 * np.pi * (k + 0.3) / test for k in range(test)]
    return spiral, [at(a, np.radians(20 + 25 * np.sin(2 * a + 1))) for a in around]


def normalised(parts):
    """Returns the meshes of the parts, moved and scaled into the bounding sphere."""
    everything = np.concatenate([part.mesh[0] for part in parts])
    centre = (everything.min(0) + everything.max(0)) / 2
    scale = RADIUS / np.linalg.norm(everything - centre, axis=1).max()
    return [((part.mesh[0] - centre) * scale, *part.mesh[1:]) for part in parts]


def bitmap(values, raw):
    return {'type': 'bitmap', 'bitmap': mi.Bitmap(np.ascontiguousarray(values, np.float32)), 'raw': raw}


def linear(picture):
    return np.where(picture <= 0.04045, picture / 12.92, ((picture + 0.055) / 1.055) ** 2.4)


def rgb(values):
    return {'type': 'rgb', 'value': [float(v) for v in values]}


def color_of(part):
    return rgb(part.base_color) if part.texture is None else bitmap(linear(part.texture[..., :3]), True)


def cut_out(part, bsdf):
    bsdf = {'type': 'twosided', 'nested': bsdf}
    if part.texture is None or part.texture.shape[-1] < 4:
        return bsdf
    return {'type': 'mask', 'opacity': bitmap(part.texture[..., 3:], True), 'nested': bsdf}


def surface(part):
    return cut_out(part, {'type': 'principled', 'base_color': color_of(part), 'roughness': part.roughness,
                          'metallic': float(part.metallic), 'specular': 0.5, 'clearcoat': part.clearcoat,
                          'clearcoat_gloss': 0.95})


def plain(color):
    return {'type': 'twosided', 'nested': {'type': 'diffuse', 'reflectance': color}}


def solid(part, data, times=4):
    """Returns the mesh without the parts that an opacity texture cuts out. Triangles are subdivided for that."""
    if part.texture is None or part.texture.shape[-1] < 4:
        return data
    v, uv, n, f = data
    corners = np.concatenate([v, uv, n], 1)[f]
    for _ in range(times):
        a, b, c = corners.transpose(1, 0, 2)
        ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
        corners = np.concatenate([np.stack(t, 1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    opacity = part.texture[..., 3]
    middle = corners[..., 3:5].mean(1)
    row, column = ((middle[:, ::-1] % 1) * opacity.shape).astype(int).T
    corners = corners[opacity[row, column] >= 0.5].reshape(-1, corners.shape[-1])
    length = np.linalg.norm(corners[:, 5:], axis=1, keepdims=True)
    return corners[:, :3], corners[:, 3:5], corners[:, 5:] / np.maximum(length, 1e-20), np.arange(len(corners)).reshape(-1, 3)


def mesh(data, bsdf):
    v, uv, n, f = data
    properties = mi.Properties()
    properties['bsdf'] = mi.load_dict(bsdf)
    result = mi.Mesh('part', len(v), len(f), has_vertex_normals=True, has_vertex_texcoords=True, props=properties)
    values = mi.traverse(result)
    values['vertex_positions'] = v.astype(np.float32).ravel()
    values['vertex_normals'] = n.astype(np.float32).ravel()
    values['vertex_texcoords'] = np.stack([uv[:, 0], uv[:, 1]], 1).astype(np.float32).ravel()
    values['faces'] = f.astype(np.uint32).ravel()
    values.update()
    return result


def light_picture(light):
    """Returns an equirectangular map of a light, with 4 x 4 samples per texel.

    The middle column is -Z, and +X is a quarter of the width to the right of it.
    """
    h, w, n = LIGHT_HEIGHT, 2 * LIGHT_HEIGHT, 4
    v, u = np.meshgrid((np.arange(n * h) + 0.5) / (n * h), (np.arange(n * w) + 0.5) / (n * w), indexing='ij')
    theta, phi = np.pi * v, 2 * np.pi * (u - 0.5)
    d = np.stack([np.sin(theta) * np.sin(phi), np.cos(theta), -np.sin(theta) * np.cos(phi)], -1)
    return light(d.reshape(-1, 3)).reshape(h, n, w, n, 3).mean((1, 3))


def emitter(picture):
    """Returns Mitsuba's emitter for a map, whose first column is our middle column and whose rows include the poles."""
    rolled = np.roll(picture, -picture.shape[1] // 2, axis=1)
    y = np.clip(np.arange(2 * len(rolled) + 1) / 2 - 0.5, 0, len(rolled) - 1)
    low = np.minimum(y.astype(int), len(rolled) - 2)
    rows = rolled[low] + (y - low)[:, None, None] * (rolled[low + 1] - rolled[low])
    return {'type': 'envmap', 'bitmap': mi.Bitmap(np.ascontiguousarray(rows, np.float32))}


def sensor(camera, size):
    # A camera of Mitsuba looks along its +Z axis, and its +X axis points to the left.
    return mi.load_dict({'type': 'perspective', 'fov': float(np.degrees(FIELD_OF_VIEW_X)), 'fov_axis': 'x',
                         'to_world': mi.ScalarTransform4f((camera @ np.diag([-1.0, 1, -1, 1])).tolist()),
                         'film': {'type': 'hdrfilm', 'width': size, 'height': size, 'rfilter': {'type': 'box'},
                                  'pixel_format': 'rgba', 'component_format': 'float32'},
                         'sampler': {'type': 'multijitter'}})


def with_guides(integrator):
    """Returns an integrator whose images have the channels RGBA, then base colour, normal and depth."""
    return {'type': 'aov', 'aovs': 'albedo:albedo,normal:sh_normal,depth:depth', 'nested': integrator}


def denoised(image):
    part = [np.ascontiguousarray(image[..., at:at + 3], np.float32) for at in (0, 4, 7)]
    color = pyoidn.denoise(part[0], albedo=np.clip(part[1], 0, 1), normal=part[2], hdr=True)
    return np.concatenate([color, image[..., 3:4]], -1)


def save_rgba(path, image):
    """Saves a linear image with premultiplied alpha as an sRGB file with straight alpha."""
    alpha = np.clip(image[..., 3:4], 0, 1)
    color = np.clip(srgb(image[..., :3] / np.maximum(alpha, 1e-6)), 0, 1) * (alpha > 0)
    Image.fromarray((np.concatenate([color, alpha], -1) * 255 + 0.5).astype(np.uint8)).save(path)


def save_exr(path, values):
    layout = {1: mi.Bitmap.PixelFormat.Y, 3: mi.Bitmap.PixelFormat.RGB}[values.shape[-1]]
    mi.Bitmap(np.ascontiguousarray(values, np.float32), layout).convert(layout, mi.Struct.Type.Float16, False).write(path)


def write_obj(path, meshes):
    first = 1
    with open(path, 'w') as out:
        for v, _, n, f in meshes:
            out.writelines('v %.6f %.6f %.6f\n' % tuple(p) for p in v)
            out.writelines('vn %.5f %.5f %.5f\n' % tuple(p) for p in n)
            out.writelines('f {0}//{0} {1}//{1} {2}//{2}\n'.format(*t) for t in (f + first).tolist())
            first += len(v)


def world(parts, meshes, bsdf, light):
    shapes = {f'part{i}': mesh(data, bsdf(part)) for i, (part, data) in enumerate(zip(parts, meshes))}
    return mi.load_dict({'type': 'scene', **shapes, 'light': light})


def write_truth(folder, parts, meshes, views, size):
    cut = [solid(part, data) for part, data in zip(parts, meshes)]
    write_obj(f'{folder}/gt/mesh.obj', cut)
    white = {'type': 'constant', 'radiance': 1.0}
    truth = mi.load_dict(with_guides({'type': 'path', 'max_depth': 2, 'hide_emitters': True}))
    colors = world(parts, cut, lambda part: plain(color_of(part)), white)
    others = world(parts, cut, lambda part: plain(rgb((0, part.roughness, float(part.metallic)))), white)
    for k, camera in enumerate(views):
        view = sensor(camera, size)
        a = np.array(mi.render(colors, sensor=view, integrator=truth, spp=64, seed=k))
        b = np.array(mi.render(others, sensor=view, integrator=truth, spp=64, seed=k))
        alpha = a[..., 3:4]
        save_rgba(f'{folder}/test_gt/r_{k}_albedo.png', np.concatenate([a[..., 4:7], alpha], -1))
        orm = np.concatenate([b[..., 4:7] / np.maximum(alpha, 1e-6), alpha], -1)
        Image.fromarray((np.clip(orm, 0, 1) * 255 + 0.5).astype(np.uint8)).save(f'{folder}/test_gt/r_{k}_orm.png')
        save_exr(f'{folder}/test_gt/r_{k}_normal.exr', a[..., 7:10])
        save_exr(f'{folder}/test_gt/r_{k}_depth.exr', a[..., 10:11])


def photograph(name, folder, options):
    scene = scenes.scenes[name]()
    meshes = normalised(scene.parts)
    lights = {'': scene.light} | scenes.other_lights
    for part in ('train', 'test', 'test_gt', 'gt', *(f'test_{light}' for light in lights if light)):
        os.makedirs(f'{folder}/{part}', exist_ok=True)

    seed = zlib.crc32(name.encode()) % 100000
    path = mi.load_dict(with_guides({'type': 'path', 'max_depth': options.depth, 'hide_emitters': True}))
    train, test = cameras(options.train, options.test)
    begin = time.time()
    for suffix, light in lights.items():
        picture = light_picture(light)
        save_exr(f'{folder}/gt/light{"_" + suffix if suffix else ""}.exr', picture)
        lit = world(scene.parts, meshes, surface, emitter(picture))
        splits = {f'test_{suffix}': (test, 2)} if suffix else {'train': (train, 1), 'test': (test, 1)}
        for number, (split, (views, step)) in enumerate(splits.items()):
            for k in range(0, len(views), step):
                image = mi.render(lit, sensor=sensor(views[k], options.size), integrator=path, spp=options.samples,
                                  seed=seed + 1000 * number + k)
                save_rgba(f'{folder}/{split}/r_{k}.png', denoised(np.array(image)))
            print(name, split, f'{time.time() - begin:.0f} s', flush=True)
    for split, views in (('train', train), ('test', test)):
        frames = [{'file_path': f'./{split}/r_{k}', 'transform_matrix': (Z_UP @ m).tolist()} for k, m in enumerate(views)]
        with open(f'{folder}/transforms_{split}.json', 'w') as out:
            json.dump({'camera_angle_x': FIELD_OF_VIEW_X, 'frames': frames}, out, indent=1)

    write_truth(folder, scene.parts, meshes, test, options.size)
    with open(f'{folder}/info.json', 'w') as out:
        json.dump({'scene': name, 'for': 'tuning' if name in scenes.tuning else 'reporting', 'samples': options.samples,
                   'depth': options.depth, 'bsdf': 'Mitsuba principled, specular 0.5', 'seconds': round(time.time() - begin)},
                  out, indent=1)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('out', help='folder for the datasets')
    parser.add_argument('scene', nargs='*', help='scenes to render: ' + ', '.join(scenes.scenes))
    parser.add_argument('--samples', type=int, default=64, help='number of samples per pixel, a square number')
    parser.add_argument('--depth', type=int, default=4, help='maximum path depth')
    parser.add_argument('--size', type=int, default=256, help='width and height of the images in pixels')
    parser.add_argument('--train', type=int, default=60, help='number of training views')
    parser.add_argument('--test', type=int, default=12, help='number of test views')
    options = parser.parse_args()
    for name in options.scene or scenes.scenes:
        if name not in scenes.scenes:
            parser.error(f'no scene {name}; there are {", ".join(scenes.scenes)}')
        photograph(name, f'{options.out}/{name}', options)


if __name__ == '__main__':
    main()
