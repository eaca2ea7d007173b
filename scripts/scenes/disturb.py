#!/usr/bin/env python3
"""Copies a dataset of NeRF-synthetic's layout with what photographs suffer from, to measure how much of it is mended.

    python3 scripts/scenes/disturb.py IN OUT [--turn 0.5] [--shift 0.5] [--exposure 0.2] [--blur 4] [--mask 1] [--jpeg 85]

Only training views are disturbed; what is held out stays exact. --turn: degrees, the length of a random axis; --shift: %
of the camera's distance from the origin; --exposure: the gain of each view and channel lies in 1 +- that; --blur: every
tenth view is moved along by so many pixels while it is taken; --mask: masks are larger or smaller by so many pixels;
--jpeg: colours are those of a JPEG of that quality. Needs NumPy and Pillow."""
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
    """Turned about the camera and shifted, both normally distributed with lengths as asked."""
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
    parser.add_argument('source')
    parser.add_argument('out')
    for name, kind in (('turn', float), ('shift', float), ('exposure', float), ('blur', int), ('mask', int), ('jpeg', int)):
        parser.add_argument(f'--{name}', type=kind, default=0)
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
