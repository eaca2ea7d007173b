"""Scenes that photograph.py and on_a_sheet.py render: objects and lights."""
from dataclasses import dataclass

import numpy as np

from shapes import box, fix, lathe, leaf, moved, smooth_profile, sphere, tube, turn


@dataclass
class Part:
    """A mesh with one material. base_color is linear. A texture replaces it by an sRGB image [H, W, 3 or 4]."""
    mesh: tuple
    base_color: tuple
    roughness: float
    metallic: float = 0.0
    clearcoat: float = 0.0
    texture: np.ndarray | None = None  # a fourth channel is the opacity, which cuts the mesh out


@dataclass
class Scene:
    parts: list
    light: callable  # directions [N, 3] -> radiance [N, 3]


# Lights. +Y is up. Azimuth 0 is +Z, azimuth 90 is +X. All angles are in degrees.

def direction(azimuth, elevation):
    a, e = np.radians([azimuth, elevation])
    return np.array([np.cos(e) * np.sin(a), np.sin(e), np.cos(e) * np.cos(a)])


def soft_boxes(boxes, ambient):
    """Returns a light of rectangular sources. boxes: (azimuth, elevation, half width, half height, radiance) each."""
    def light(d):
        result = np.ones((len(d), 1)) * np.asarray(ambient, float)
        for azimuth, elevation, width, height, radiance in boxes:
            to = direction(azimuth, elevation)
            right = np.cross([0, 1, 0], to)
            right /= np.linalg.norm(right)
            up = np.cross(to, right)
            depth = np.maximum(d @ to, 1e-6)
            inside = (np.abs(d @ right / depth) < np.tan(np.radians(width))) & \
                     (np.abs(d @ up / depth) < np.tan(np.radians(height))) & (d @ to > 0)
            result[inside] = radiance
        return result
    return light


def sky(azimuth, elevation, sun, zenith, horizon, ground, radius=2.0):
    """Returns a light with a sun of radiance `sun`, a sky and a uniform ground. radius: angular radius of the sun."""
    def light(d):
        up = np.clip(d[:, 1:2], 0, 1)
        result = (1 - up**0.5) * np.asarray(horizon, float) + up**0.5 * np.asarray(zenith, float)
        result[d[:, 1] < 0] = ground
        result[d @ direction(azimuth, elevation) > np.cos(np.radians(radius))] = sun
        return result
    return light


studio = soft_boxes([(-60, 35, 22, 30, (7, 6.8, 6.4)), (70, 20, 14, 34, (3.4, 3.6, 4.0)), (170, 55, 30, 12, (4, 4, 4))],
                    (0.16, 0.16, 0.17))
window = soft_boxes([(40, 30, 16, 24, (10, 10.5, 11)), (-120, 15, 40, 18, (0.7, 0.6, 0.5))], (0.22, 0.2, 0.18))
ring = soft_boxes([(a, 40, 10, 10, (6, 6, 6)) for a in range(0, 360, 60)], (0.12, 0.12, 0.12))
noon = sky(-50, 50, (900, 850, 760), (0.25, 0.45, 0.9), (0.7, 0.8, 0.95), (0.22, 0.2, 0.17))
evening = sky(110, 14, (600, 330, 130), (0.18, 0.25, 0.5), (0.9, 0.55, 0.35), (0.15, 0.12, 0.1))
overcast = sky(0, 80, (1.5, 1.5, 1.5), (1.3, 1.35, 1.4), (0.7, 0.72, 0.75), (0.3, 0.29, 0.27))

# Lights under which photograph.py renders each scene again.
other_lights = {'relit': window, 'relit_2': overcast}


def materials():
    """Spheres of smooth and rough metals and dielectrics side by side."""
    kinds = [((1.0, 0.77, 0.34), 0.05, 1), ((0.95, 0.64, 0.54), 0.2, 1), ((0.91, 0.92, 0.92), 0.4, 1),
             ((0.6, 0.03, 0.03), 0.1, 0), ((0.05, 0.25, 0.5), 0.3, 0), ((0.1, 0.4, 0.12), 0.6, 0)]
    parts = [Part(box((0, -0.42, 0), (2.6, 0.16, 1.7), 0.05), (0.55, 0.53, 0.5), 0.7)]
    for i, (color, roughness, metallic) in enumerate(kinds):
        x, z = 0.82 * (i % 3 - 1), 0.4 - 0.8 * (i // 3)
        parts.append(Part(sphere((x, 0, z), 0.35), color, roughness, metallic))
    return Scene(parts, studio)


def horn():
    """A brass instrument: a coiled pipe with a bell, valves and a silver mouthpiece."""
    t = np.linspace(0, 1, 160)[:, None]
    coil = np.concatenate([0.45 * np.cos(4 * np.pi * t), 0.45 * np.sin(4 * np.pi * t), 0.5 * t - 0.25], 1)
    lead = np.array([[0.45, -0.9, -0.25], [0.45, -0.6, -0.25], [0.45, -0.3, -0.25]])
    bell = lathe(smooth_profile([(0.07, 0), (0.075, 0.3), (0.1, 0.6), (0.2, 0.85), (0.48, 1.0)]), 96)
    inside = lathe(smooth_profile([(0.47, 0.995), (0.19, 0.84), (0.09, 0.6), (0.06, 0.3), (0.05, 0.0)]), 96)
    brass = (0.88, 0.62, 0.26)
    at, out = (0.45, 0.0, 0.25), turn('x', 0)
    parts = [Part(tube(np.concatenate([lead, coil]), 0.055), brass, 0.12, 1),
             Part(moved(bell, at, turn=out), brass, 0.12, 1), Part(moved(inside, at, turn=out), brass, 0.2, 1),
             Part(moved(lathe(smooth_profile([(0.0, -0.2), (0.1, -0.2), (0.11, -0.17), (0.05, -0.05), (0.05, 0.02), (0, 0.02)])),
                        (0.45, -0.9, -0.25)), (0.92, 0.92, 0.93), 0.08, 1)]
    for k in range(3):
        parts.append(Part(moved(lathe([(0, -0.3), (0.085, -0.3), (0.085, 0.25), (0.04, 0.25), (0.04, 0.36), (0.07, 0.36),
                                       (0.07, 0.4), (0, 0.4)], 48), (0.2 * k - 0.2, 0, 0)), brass, 0.25, 1))
    return Scene(parts, window)


def chair():
    """A chair with thin legs and slats of varnished wood and a cloth seat."""
    wood, parts = (0.32, 0.15, 0.06), []
    for x in (-0.45, 0.45):
        parts.append(Part(tube([(x, -1, 0.45), (0.97 * x, -0.5, 0.42), (0.93 * x, 0, 0.4)], 0.035, 16), wood, 0.3))
        parts.append(Part(tube([(x, -1, -0.5), (0.97 * x, -0.4, -0.42), (0.93 * x, 0, -0.4), (0.93 * x, 0.5, -0.46),
                                (0.93 * x, 1, -0.56)], 0.035, 16), wood, 0.3))
    for k in range(5):
        x = 0.17 * (k - 2)
        parts.append(Part(tube([(x, 0.02, -0.4), (x, 0.5, -0.48), (x, 0.95, -0.55)], 0.018, 12), wood, 0.3))
    parts.append(Part(tube([(-0.45, 0.97, -0.55), (0, 1.0, -0.6), (0.45, 0.97, -0.55)], 0.045, 16), wood, 0.3))
    for z in (0.42, -0.44):
        parts.append(Part(tube([(-0.44, -0.55, z), (0.44, -0.55, z)], 0.02, 12), wood, 0.3))
    parts.append(Part(box((0, 0.03, 0), (0.96, 0.1, 0.9), 0.045), (0.55, 0.08, 0.07), 0.85))
    return Scene(parts, noon)


def leaf_picture(size=256):
    y, x = np.meshgrid(np.linspace(1, 0, size), np.linspace(-1, 1, size), indexing='ij')
    edge = np.sin(np.pi * np.clip(y, 0, 1) ** 0.8) * 0.95
    alpha = (np.abs(x) < edge).astype(float)
    vein = np.exp(-(x / 0.05) ** 2) + 0.6 * np.exp(-(((y * 9 - 3 * np.abs(x)) % 1 - 0.5) / 0.1) ** 2)
    green = np.array([0.22, 0.5, 0.16]) + np.clip(vein, 0, 1)[..., None] * np.array([0.2, 0.18, 0.1])
    return np.concatenate([green, alpha[..., None]], -1)


def plant():
    """A plant in a glazed pot, whose leaves are cut out by an opacity texture."""
    picture = leaf_picture()
    pot = smooth_profile([(0.0, -0.95), (0.34, -0.95), (0.42, -0.6), (0.47, -0.22), (0.5, -0.18), (0.45, -0.16), (0.42, -0.24),
                          (0.0, -0.26)])
    parts = [Part(lathe(pot), (0.6, 0.62, 0.58), 0.15)]
    for k in range(22):
        tilt, length = 18 + 50 * (k % 5) / 4, 1.15 - 0.09 * (k % 5)
        turned = turn('y', 137.5 * k) @ turn('x', tilt)
        parts.append(Part(moved(leaf(length, 0.3, 0.45), (0, -0.25, 0), turn=turned), (0.1, 0.3, 0.08), 0.4, texture=picture))
    return Scene(parts, overcast)


def toy():
    """A toy train of painted parts and bare metal."""
    red, blue, yellow, steel = (0.65, 0.03, 0.03), (0.02, 0.1, 0.5), (0.85, 0.6, 0.02), (0.8, 0.8, 0.82)
    parts = [Part(box((0, -0.3, 0), (2.0, 0.14, 0.7), 0.05), (0.04, 0.04, 0.045), 0.4),
             Part(moved(lathe([(0, -0.6), (0.3, -0.6), (0.33, -0.55), (0.33, 0.6), (0.3, 0.65), (0, 0.65)]), (0.3, 0.1, 0),
                        turn=turn('z', -90)), red, 0.2),
             Part(box((-0.65, 0.22, 0), (0.6, 0.9, 0.66), 0.05), blue, 0.25),
             Part(box((-0.65, 0.72, 0), (0.76, 0.1, 0.8), 0.04), yellow, 0.5),
             Part(moved(lathe([(0, 0), (0.08, 0), (0.08, 0.3), (0.14, 0.42), (0.1, 0.42), (0, 0.4)]), (0.65, 0.4, 0)), steel, 0.15, 1),
             Part(sphere((0.2, 0.46, 0), 0.13), (1.0, 0.77, 0.34), 0.15, 1)]
    for x in (-0.6, 0.0, 0.6):
        for z in (-0.4, 0.4):
            wheel = lathe([(0, -0.07), (0.05, -0.09), (0.06, -0.05), (0.24, -0.05), (0.27, -0.06), (0.27, 0.06), (0.24, 0.05),
                           (0.06, 0.05), (0.05, 0.09), (0, 0.07)], 64)
            parts.append(Part(moved(wheel, (x, -0.42, z), turn=turn('x', 90)), yellow if x == 0 else steel,
                              0.5 if x == 0 else 0.3, 0 if x == 0 else 1))
    return Scene(parts, evening)


def label_picture(size=512):
    from PIL import Image, ImageDraw, ImageFont
    picture = Image.new('RGB', (2 * size, size), (236, 226, 200))
    draw = ImageDraw.Draw(picture)
    for x in range(0, 2 * size, 64):
        draw.rectangle([x, 0, x + 31, 36], fill=(150, 30, 35))
        draw.rectangle([x + 32, size - 36, x + 63, size], fill=(30, 60, 120))
    font = ImageFont.load_default(120)
    for x in (60, size + 60):
        draw.text((x, 120), 'TONIC', font=font, fill=(20, 50, 110))
        draw.text((x, 270), 'No. 7', font=ImageFont.load_default(80), fill=(150, 30, 35))
    return np.asarray(picture, float) / 255


def bottle():
    """A lacquered bottle with a printed label under clear coat and a metal cap."""
    parts = [Part(lathe([(0, -1), (0.46, -1), (0.5, -0.96), (0.5, -0.62)]), (0.02, 0.16, 0.1), 0.15),
             Part(lathe([(0.5, -0.62), (0.5, 0.35)]), (0.8, 0.75, 0.6), 0.35, clearcoat=1.0, texture=label_picture()),
             Part(lathe(smooth_profile([(0.5, 0.35), (0.48, 0.5), (0.3, 0.68), (0.22, 0.78), (0.2, 0.85)])), (0.02, 0.16, 0.1), 0.15),
             Part(lathe([(0.2, 0.84), (0.25, 0.84), (0.26, 0.86), (0.26, 1.06), (0.24, 1.09), (0, 1.09)]), (0.9, 0.88, 0.84), 0.2, 1)]
    return Scene(parts, studio)


def dark():
    """A glossy black pot with a dull inside and copper handles."""
    body = smooth_profile([(0, -0.75), (0.4, -0.74), (0.72, -0.45), (0.8, 0.0), (0.62, 0.42), (0.42, 0.55), (0.46, 0.62)])
    lid = smooth_profile([(0.46, 0.6), (0.38, 0.72), (0.18, 0.83), (0.06, 0.86), (0.1, 0.94), (0.11, 1.02), (0.06, 1.08), (0, 1.09)])
    parts = [Part(lathe(body), (0.012, 0.012, 0.014), 0.08), Part(lathe(lid), (0.03, 0.012, 0.01), 0.2)]
    for s in (-1, 1):
        a = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 24)
        parts.append(Part(tube(np.stack([s * (0.7 + 0.3 * np.cos(a)), 0.05 + 0.3 * np.sin(a), 0 * a], 1), 0.05),
                          (0.95, 0.64, 0.54), 0.25, 1))
    return Scene(parts, ring)


def vase():
    """A fluted vase with white glaze and a blue band."""
    def fluted(profile, color, roughness):
        v, uv, n, f = lathe(smooth_profile(profile), 192)
        a = np.arctan2(v[:, 0], v[:, 2])
        swell = 1 + 0.03 * np.cos(16 * a)
        return Part(fix(v * np.stack([swell, np.ones_like(a), swell], 1), uv, f), color, roughness)
    white, blue = (0.82, 0.81, 0.78), (0.02, 0.06, 0.35)
    parts = [fluted([(0, -1), (0.34, -1), (0.38, -0.95), (0.56, -0.5), (0.62, -0.1)], white, 0.12),
             fluted([(0.62, -0.1), (0.63, 0.0), (0.61, 0.12)], blue, 0.12),
             fluted([(0.61, 0.12), (0.5, 0.4), (0.28, 0.66), (0.24, 0.8), (0.36, 1.0)], white, 0.12),
             fluted([(0.36, 1.0), (0.33, 1.01), (0.2, 0.8), (0.22, 0.6)], white, 0.12)]
    return Scene(parts, window)


tuning = {'materials': materials, 'toy': toy}
reported = {'horn': horn, 'chair': chair, 'plant': plant, 'bottle': bottle, 'dark': dark, 'vase': vase}
scenes = tuning | reported
