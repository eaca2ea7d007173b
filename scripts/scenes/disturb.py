#!/usr/bin/env python3
"""Copies a dataset in NeRF-synthetic's layout and adds the errors of real photographs to it.

The copies measure how well `item3d reconstruct` corrects these errors.

    python3 scripts/scenes/disturb.py IN OUT [--turn 0.5] [--shift 0.5] [--exposure 0.2] [--blur 4] [--mask 1] [--jpeg 85]

Only the training views get errors; the test views stay exact. The default of each option is 0, no error. The script
needs NumPy and Pillow."""
import argparse
import io
import json
import os
import shutil

import numpy as np
from PIL import Image, ImageFilter


def rotation(axis):
    angle = np.linalg.norm(axis)
    x, y, z = axis / max(angle, 1e-12)
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


def moved(pose, options, random):
    """Returns a camera pose with a random rotation and a random shift, both normally distributed."""
    result = np.array(pose, float)
    axis, shift = random.normal(size=3) / 3**0.5, random.normal(size=3) / 3**0.5
    result[:3, :3] = rotation(np.radians(options.turn) * axis) @ result[:3, :3]
    result[:3, 3] += options.shift / 100 * np.linalg.norm(result[:3, 3]) * shift
    return result.tolist()


def linear(x):
    return np.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4)


def encoded(x):
    x = np.clip(x, 0, 1)
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * np.maximum(x, 1e-8) ** (1 / 2.4) - 0.055)


def disturbed(picture, index, options, random):
    pixels = np.asarray(picture.convert('RGBA'), float) / 255
    color, alpha = linear(pixels[..., :3]), pixels[..., 3:]
    color = color * (1 + options.exposure * random.uniform(-1, 1, size=3))
    if options.blur > 0 and index % 10 == 5:
        steps = [np.roll(np.concatenate([color * alpha, alpha], -1), k - options.blur // 2, axis=1) for k in range(options.blur + 1)]
        mean = np.mean(steps, 0)
        color, alpha = mean[..., :3] / np.maximum(mean[..., 3:], 1e-6), mean[..., 3:]
    if options.mask > 0:
        grow = ImageFilter.MaxFilter if random.uniform() < 0.5 else ImageFilter.MinFilter
        mask = Image.fromarray((alpha[..., 0] * 255 + 0.5).astype(np.uint8)).filter(grow(2 * options.mask + 1))
        alpha = np.asarray(mask, float)[..., None] / 255
    result = (encoded(color) * 255 + 0.5).astype(np.uint8)
    if options.jpeg > 0:
        buffer = io.BytesIO()
        Image.fromarray(result).save(buffer, 'JPEG', quality=options.jpeg)
        result = np.asarray(Image.open(buffer))
    return Image.fromarray(np.concatenate([result, (alpha * 255 + 0.5).astype(np.uint8)], -1))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('source', help='folder of the dataset')
    parser.add_argument('out', help='folder of the copy')
    for name, kind, description in (
            ('turn', float, 'root mean square rotation of the cameras in degrees'),
            ('shift', float, "root mean square shift of the cameras in %% of their distance from the origin"),
            ('exposure', float, 'largest relative deviation of the gain of a view and channel from 1'),
            ('blur', int, 'length of the motion blur in every tenth view, in pixels'),
            ('mask', int, 'number of pixels by which masks are too large or too small'),
            ('jpeg', int, 'quality of JPEG compression of the colours')):
        parser.add_argument(f'--{name}', type=kind, default=0, help=description)
    options = parser.parse_args()
    random = np.random.default_rng(0)
    shutil.copytree(options.source, options.out, dirs_exist_ok=True)
    with open(f'{options.source}/transforms_train.json') as file:
        transforms = json.load(file)
    for index, frame in enumerate(transforms['frames']):
        frame['transform_matrix'] = moved(frame['transform_matrix'], options, random)
        path = os.path.normpath(f'{options.out}/{frame["file_path"]}.png')
        disturbed(Image.open(path), index, options, random).save(path)
    with open(f'{options.out}/transforms_train.json', 'w') as file:
        json.dump(transforms, file, indent=1)


if __name__ == '__main__':
    main()
