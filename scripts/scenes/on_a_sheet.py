#!/usr/bin/env python3
"""Renders photographs of an object on a printed sheet, to test `item3d reconstruct --from-images`.

    python3 scripts/scenes/on_a_sheet.py OUT SCENE [--size 640 480] [--views 48] [--samples 36] [--exposure 0.25]

The script writes to OUT:

    images/IMG_0001.jpg ...    JPEG files with EXIF: focal length, exposure time, ISO, aperture, orientation
    masks/IMG_0001.jpg.png     masks of the object without the sheet, in the orientation of the stored images
    transforms.json            true cameras of these images, in nerfstudio's layout
    gt/mesh.obj, gt/light.exr  true surface of the object, and the light without the reflection of the sheet

The images simulate a phone. The camera moves around the object twice, at two heights. Every fifth image is in portrait
format. As phones do, the script stores its pixels in landscape format, with an EXIF orientation.

The script needs Mitsuba 3, pyoidn and Pillow; photograph.py says how to install them."""
import argparse
import json
import os
import time
import zlib

import numpy as np
from PIL import Image, ImageDraw

import photograph
from photograph import mi

FOCAL_35 = 50.0  # 35 mm equivalent focal length in millimetres
DIAGONAL_35 = 43.2666  # diagonal of a 35 mm film image in millimetres
APERTURE, ISO, TIME = 1.8, 100, 1 / 60
EXPOSURE = 0.7  # mean factor of the radiance, small enough that few pixels are clipped


def sheet_picture(size=1024):
    """Returns the image of the sheet, which is irregular so that COLMAP finds unique features."""
    random = np.random.default_rng(7)
    picture = Image.new('RGB', (size, size), (205, 203, 198))
    draw = ImageDraw.Draw(picture)
    for _ in range(900):
        x, y, r = *random.uniform(0, size, 2), random.uniform(4, 26)
        color = tuple(int(v) for v in random.uniform(15, 180, 3))
        if random.uniform() < 0.5:
            draw.ellipse([x - r, y - r, x + r, y + r], fill=color)
        else:
            draw.polygon([(x + r * np.cos(a), y + r * np.sin(a)) for a in np.sort(random.uniform(0, 2 * np.pi, 3))], fill=color)
    return np.asarray(picture, float) / 255


def sheet(height):
    side = 2.6
    v = np.array([[-side, height, side], [side, height, side], [side, height, -side], [-side, height, -side]])
    uv = np.array([[0, 0], [1, 0], [1, 1], [0, 1.0]])
    return v, uv, np.tile([0.0, 1, 0], (4, 1)), np.array([[0, 1, 2], [0, 2, 3]])


def cameras(count):
    """Returns camera-to-world matrices of two turns around the object, a low and a high one, with a little noise."""
    random = np.random.default_rng(3)
    result = []
    for k in range(count):
        high = k >= count // 2
        azimuth = 2 * np.pi * (k % (count // 2)) / (count // 2) + 0.13 * high + random.normal() * 0.03
        elevation = np.radians((52 if high else 22) + 4 * random.normal())
        distance = photograph.DISTANCE * (1.55 + 0.05 * random.normal())
        eye = distance * np.array([np.cos(elevation) * np.sin(azimuth), np.sin(elevation), np.cos(elevation) * np.cos(azimuth)])
        result.append(photograph.look_at(eye))
    return result


def sensor(size, focal):
    return mi.load_dict({'type': 'perspective', 'fov': float(np.degrees(2 * np.arctan(0.5 * size[0] / focal))), 'fov_axis': 'x',
                         'film': {'type': 'hdrfilm', 'width': size[0], 'height': size[1], 'rfilter': {'type': 'box'},
                                  'pixel_format': 'rgba', 'component_format': 'float32'},
                         'sampler': {'type': 'multijitter'}})


def place(view, camera):
    """Moves a sensor. With a new sensor, Mitsuba would compile its kernels again."""
    values = mi.traverse(view)
    values['to_world'] = mi.Transform4f((camera @ np.diag([-1.0, 1, -1, 1])).tolist())
    values.update()


def exif(orientation, exposure_time):
    from fractions import Fraction
    from PIL.TiffImagePlugin import IFDRational

    def rational(value):
        part = Fraction(value).limit_denominator(10000)
        return IFDRational(part.numerator, part.denominator)
    tags = Image.Exif()
    tags[0x0112] = orientation
    tags[0x010f], tags[0x0110] = 'item3d', 'path tracer'
    inner = tags.get_ifd(0x8769)
    inner[0x829a], inner[0x829d], inner[0x8827] = rational(exposure_time), rational(APERTURE), ISO
    inner[0x920a], inner[0xa405] = rational(FOCAL_35 / 6), int(FOCAL_35)
    return tags


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('out', help='folder for the dataset')
    parser.add_argument('scene', help='scene of scenes.py')
    parser.add_argument('--size', type=int, nargs=2, default=[640, 480], help='width and height of the images')
    parser.add_argument('--views', type=int, default=48, help='number of images')
    parser.add_argument('--samples', type=int, default=36, help='number of samples per pixel, a square number')
    parser.add_argument('--exposure', type=float, default=0.25, help='largest relative deviation of the exposure time')
    options = parser.parse_args()
    scene = photograph.scenes.scenes[options.scene]()
    meshes = photograph.normalised(scene.parts)
    for part in ('images', 'masks', 'gt'):
        os.makedirs(f'{options.out}/{part}', exist_ok=True)
    photograph.write_obj(f'{options.out}/gt/mesh.obj', meshes)
    picture = photograph.light_picture(scene.light)
    photograph.save_exr(f'{options.out}/gt/light.exr', picture)

    parts = {f'part{i}': photograph.mesh(data, photograph.surface(part)) for i, (part, data) in enumerate(zip(scene.parts, meshes))}
    ground = {'type': 'diffuse', 'reflectance': photograph.bitmap(photograph.linear(sheet_picture()), True)}
    height = min(data[0][:, 1].min() for data in meshes) - 0.004
    light = photograph.emitter(picture)
    alone = mi.load_dict({'type': 'scene', **parts, 'light': light})
    whole = mi.load_dict({'type': 'scene', **parts, 'sheet': photograph.mesh(sheet(height), {'type': 'twosided', 'nested': ground}),
                          'light': light})
    integrator = mi.load_dict(photograph.with_guides({'type': 'path', 'max_depth': 4, 'hide_emitters': False}))
    outline = mi.load_dict({'type': 'path', 'max_depth': 2, 'hide_emitters': True})
    size = options.size
    focal = FOCAL_35 / DIAGONAL_35 * float(np.hypot(*size))
    random = np.random.default_rng(11)
    view = sensor(size, focal)
    frames, begin, seed = [], time.time(), zlib.crc32(options.scene.encode()) % 100000
    for k, camera in enumerate(cameras(options.views)):
        upright = k % 5 == 3
        if upright:  # the phone is turned, so the stored image is rotated by 90 degrees
            turn = np.eye(4)
            turn[:2, :2] = [[0, 1], [-1, 0]]
            camera = camera @ turn
        gain = EXPOSURE * (1 + options.exposure * random.uniform(-1, 1))
        place(view, camera)
        color = photograph.denoised(np.array(mi.render(whole, sensor=view, integrator=integrator, spp=options.samples, seed=seed + k)))
        alpha = np.array(mi.render(alone, sensor=view, integrator=outline, spp=16, seed=k))[..., 3]
        name = f'IMG_{k + 1:04}.jpg'
        stored = (np.clip(photograph.srgb(gain * color[..., :3]), 0, 1) * 255 + 0.5).astype(np.uint8)
        Image.fromarray(stored).save(f'{options.out}/images/{name}', quality=92, exif=exif(6 if upright else 1, gain / EXPOSURE * TIME))
        Image.fromarray((np.clip(alpha, 0, 1) * 255 + 0.5).astype(np.uint8)).save(f'{options.out}/masks/{name}.png')
        frames.append({'file_path': f'images/{name}', 'mask_path': f'masks/{name}.png', 'transform_matrix': camera.tolist()})
        print(name, f'{time.time() - begin:.0f} s', flush=True)
    with open(f'{options.out}/transforms.json', 'w') as out:
        json.dump({'w': size[0], 'h': size[1], 'fl_x': focal, 'fl_y': focal, 'cx': size[0] / 2, 'cy': size[1] / 2, 'frames': frames}, out, indent=1)


if __name__ == '__main__':
    main()
