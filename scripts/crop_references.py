#!/usr/bin/env python3
"""Reduces the whole reference data (24 MB, outside of the repository) to the part that the tests use.

    python3 scripts/crop_references.py REFERENCES [OUT]

REFERENCES is the folder with dfg/, env/, gltf/, gradcheck/, meshes/, spheres/ and views_spot_sky_noon/. OUT is
tests/data/references by default. The script does not change README.md and LICENSE-CC-BY-4.0 there, which are written by
hand. Images are cropped to selected pixels, whose values do not change. OUT/crops.json says which pixels these are, so
that tests can select the same pixels of their own images. The script needs NumPy, OpenEXR and Pillow
(`pip install numpy OpenEXR Pillow`)."""
import json
import pathlib
import shutil
import sys

import numpy as np
import OpenEXR
from PIL import Image

HERE = pathlib.Path(__file__).resolve().parent
SPHERES = [f'spheres/{light}/{name}' for light in ('studio', 'sky_noon') for name in
           ('mask.png', *(f'lambertggx_m{metallic}_{roughness}.exr' for metallic in (0, 1) for roughness in ('r0p1', 'r0p5', 'r1')))]


def window(x, y, width, height, step=1):
    """Returns a crop of `width` columns and `height` rows: every `step`-th column and row from (x, y) on."""
    return dict(x=x, y=y, width=width, height=height, step=step)


# Column 0 of the BSDF table has the most grazing views, where its values are least accurate. The spheres fill their
# images. The windows of gradcheck/ and views_spot_sky_noon/ contain all pixels that are not background.
CROPS = {
    'dfg/dfg_correlated.bin': window(0, 1, 64, 64, 4),
    'env/sky_noon_irradiance.exr': window(1, 1, 64, 32, 4),
    'env/studio_irradiance.exr': window(1, 1, 64, 32, 4),
    'gradcheck/ibl_image.exr': window(28, 28, 88, 80),
    'views_spot_sky_noon/view_04_lambertggx.exr': window(64, 20, 128, 208),
    **{name: window(2, 2, 64, 64, 4) for name in SPHERES},
}

# Files that are copied, with the name of the copy if it differs.
WHOLE = {
    'env/sky_noon.hdr': None,
    'env/studio.hdr': None,
    'gltf/thirdparty/Box.glb': None,
    'gltf/thirdparty/BoxDraco/0.bin': None,
    'gltf/thirdparty/BoxDraco/BoxDraco.gltf': None,
    'gltf/thirdparty/BoxInterleaved.glb': None,
    'gltf/thirdparty/BoxMeshopt.glb': None,
    'gltf/thirdparty/BoxVertexColors.glb': None,
    'gltf/thirdparty/LICENSE-glTF-Transform.md': 'gltf/thirdparty/LICENSE-glTF-Transform',
    'gltf/thirdparty/LICENSE-tinygltf.txt': 'gltf/thirdparty/LICENSE-tinygltf',
    'gltf/thirdparty/LICENSE-trimesh.md': 'gltf/thirdparty/LICENSE-trimesh',
    'gltf/thirdparty/singleBlendshapeCube_sparse.glb': None,
    'meshes/spot/LICENSE.txt': 'meshes/spot/LICENSE',
    'meshes/spot/spot.mtl': None,
    'meshes/spot/spot.obj': None,
    'meshes/spot/spot_texture.png': None,
    'meshes/thirdparty/tinyobj/LICENSE': None,
    'meshes/thirdparty/tinyobj/cube-vertex-w-component.obj': None,
    'meshes/thirdparty/tinyobj/issue-295-trianguation-failure.obj': None,
    'meshes/thirdparty/tinyobj/pbr-mat-ext.mtl': None,
    'meshes/thirdparty/tinyobj/pbr-mat-ext.obj': None,
    'meshes/thirdparty/tinyobj/texture-filename-with-whitespace.mtl': None,
    'meshes/thirdparty/tinyobj/texture-filename-with-whitespace.obj': None,
    'meshes/thirdparty/trimesh/LICENSE.md': 'meshes/thirdparty/trimesh/LICENSE',
    'meshes/thirdparty/trimesh/joined_tetrahedra.obj': None,
    'meshes/thirdparty/trimesh/negative_indices.obj': None,
    'meshes/thirdparty/trimesh/polygonfaces.obj': None,
    'meshes/thirdparty/trimesh/singlevn.obj': None,
}

# Images that are compressed again, with all pixels. Only the channels R, G and B are kept.
RECOMPRESSED = ('gradcheck/ibl_gradient.exr', 'gradcheck/ibl_target.exr', 'gradcheck/texture_now.exr')


def slices(crop):
    return (slice(crop['y'], crop['y'] + (crop['height'] - 1) * crop['step'] + 1, crop['step']),
            slice(crop['x'], crop['x'] + (crop['width'] - 1) * crop['step'] + 1, crop['step']))


def read_exr(path):
    """Returns the channels R, G and B of a file, each [height, width], in the file's data type."""
    with OpenEXR.File(str(path), separate_channels=True) as file:
        return {name: np.array(file.channels()[name].pixels) for name in 'RGB'}


def write_exr(path, channels):
    header = {'compression': OpenEXR.ZIP_COMPRESSION, 'type': OpenEXR.scanlineimage}
    OpenEXR.File(header, {name: np.ascontiguousarray(values) for name, values in channels.items()}).write(str(path))


def crop_file(source, to, crop):
    """Writes the pixels of a crop. Returns the height and width of the whole image."""
    rows, columns = slices(crop)
    if source.suffix == '.exr':
        channels = read_exr(source)
        write_exr(to, {name: values[rows, columns] for name, values in channels.items()})
        return channels['R'].shape
    if source.suffix == '.bin':
        table = np.fromfile(source, '<f4').reshape(256, 256, 2)
        table[rows, columns].tofile(to)
        return table.shape[:2]
    values = np.asarray(Image.open(source))
    Image.fromarray(np.ascontiguousarray(values[rows, columns])).save(to, optimize=True)
    return values.shape[:2]


def coarser_torus(source, folder, step=4):
    """Writes a torus with every `step`-th ring and every `step`-th vertex of a ring, which keeps its bounding box."""
    lines = {key: [line for line in source.read_text().splitlines() if line.startswith(key + ' ')] for key in ('v', 'vt', 'vn')}
    rings, around = 65, 33
    kept = [i * around + j for i in range(0, rings, step) for j in range(0, around, step)]
    text = [lines[key][vertex] for key in ('v', 'vt', 'vn') for vertex in kept]
    columns = (around - 1) // step + 1
    for i in range((rings - 1) // step):
        for j in range(columns - 1):
            a, b = i * columns + j + 1, (i + 1) * columns + j + 1
            for triangle in ((a, b, a + 1), (b, b + 1, a + 1)):
                text.append('f ' + ' '.join(f'{vertex}/{vertex}/{vertex}' for vertex in triangle))
    (folder / source.name).write_text('\n'.join(text) + '\n')
    whole = json.loads((source.parent / 'manifest.json').read_text())[source.name]
    entry = {'triangles': sum(line.startswith('f ') for line in text), 'bbox': whole['bbox'], 'note': whole['note']}
    (folder / 'manifest.json').write_text(json.dumps({source.name: entry}, indent=1) + '\n')


def main(references, out):
    for name in (*CROPS, *WHOLE, *RECOMPRESSED, 'meshes/nasty/torus_uv_seams.obj'):
        if not (references / name).is_file():
            sys.exit(f'crop_references.py: {references} has no {name}; name the folder of the whole reference data')
        (out / name).parent.mkdir(parents=True, exist_ok=True)
    crops = {}
    for name, crop in CROPS.items():
        height, width = crop_file(references / name, out / name, crop)
        crops[name] = {'of': [height, width], **crop}
    lines = ',\n'.join(f' {json.dumps(name)}: {json.dumps(crop)}' for name, crop in crops.items())
    (out / 'crops.json').write_text('{\n' + lines + '\n}\n')
    for name in RECOMPRESSED:
        write_exr(out / name, read_exr(references / name))
    for name, to in WHOLE.items():
        shutil.copyfile(references / name, out / (to or name))
    coarser_torus(references / 'meshes/nasty/torus_uv_seams.obj', out / 'meshes/nasty')
    files = [file for file in out.rglob('*') if file.is_file()]
    print(f'{len(files)} files, {sum(file.stat().st_size for file in files)} bytes in {out}')


if __name__ == '__main__':
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    main(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]) if len(sys.argv) == 3 else HERE.parent / 'tests/data/references')
