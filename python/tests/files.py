"""Writes tensors as files for the program (glTF, PNG, Radiance HDR, transforms.json) and reads its OpenEXR images."""
import base64
import json
import struct
import zlib

import numpy as np
import torch

_WRAPS = {'repeat': 10497, 'mirrored_repeat': 33648, 'clamp_to_edge': 33071}


def png(texture) -> bytes:
    """Encodes a texture [H, W, 3 or 4] as PNG. Its values are multiples of 1 / 255 in [0, 1]."""
    values = (texture.detach() * 255).round().to(torch.uint8).numpy()
    height, width, channels = values.shape
    rows = b''.join(b'\0' + row.tobytes() for row in values)

    def chunk(name, content):
        return struct.pack('>I', len(content)) + name + content + struct.pack('>I', zlib.crc32(name + content))

    header = struct.pack('>IIBBBBB', width, height, 8, {3: 2, 4: 6}[channels], 0, 0, 0)
    return (b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', header) + chunk(b'IDAT', zlib.compress(rows)) +
            chunk(b'IEND', b''))


def write_gltf(path, model) -> None:
    """Writes an item3d.Model without further UV maps as glTF."""
    buffer, accessors, views, meshes, nodes = b'', [], [], [], []

    def accessor(tensor, kind, target, **more):
        nonlocal buffer
        content = tensor.detach().contiguous().numpy().tobytes()
        views.append(dict(buffer=0, byteOffset=len(buffer), byteLength=len(content), target=target))
        buffer += content + b'\0' * (-len(content) % 4)
        accessors.append(dict(bufferView=len(views) - 1, componentType=5126 if tensor.is_floating_point() else 5125,
                              count=tensor.numel() if kind == 'SCALAR' else len(tensor), type=kind, **more))
        return len(accessors) - 1

    for part in model.primitives:
        bounds = dict(min=part.positions.amin(0).tolist(), max=part.positions.amax(0).tolist())
        attributes = dict(POSITION=accessor(part.positions, 'VEC3', 34962, **bounds),
                          NORMAL=accessor(part.normals, 'VEC3', 34962))
        for name, tensor, kind in (('TEXCOORD_0', part.uvs, 'VEC2'), ('TANGENT', part.tangents, 'VEC4'),
                                   ('COLOR_0', part.colors, 'VEC4')):
            if tensor is not None:
                attributes[name] = accessor(tensor, kind, 34962)
        indices = accessor(part.triangles.flatten(), 'SCALAR', 34963)
        meshes.append(dict(primitives=[dict(attributes=attributes, indices=indices, material=part.material)]))
        nodes.append(dict(mesh=len(meshes) - 1))

    def texture(index, **more):
        return {} if index < 0 else dict(index=index, **more)

    materials = []
    for one in model.materials:
        pbr = dict(baseColorFactor=list(one.base_color_factor), metallicFactor=one.metallic_factor,
                   roughnessFactor=one.roughness_factor, baseColorTexture=texture(one.base_color_texture),
                   metallicRoughnessTexture=texture(one.metallic_roughness_texture))
        entry = dict(pbrMetallicRoughness={key: value for key, value in pbr.items() if value != {}},
                     emissiveFactor=list(one.emissive_factor), alphaMode=one.alpha.upper(),
                     normalTexture=texture(one.normal_texture, scale=one.normal_scale),
                     occlusionTexture=texture(one.occlusion_texture, strength=one.occlusion_strength),
                     emissiveTexture=texture(one.emissive_texture))
        if one.alpha == 'mask':
            entry['alphaCutoff'] = one.alpha_cutoff
        if one.unlit:
            entry['extensions'] = dict(KHR_materials_unlit={})
        materials.append({key: value for key, value in entry.items() if value != {}})
    uri = 'data:application/octet-stream;base64,' + base64.b64encode(buffer).decode()
    document = dict(
        asset=dict(version='2.0'), scene=0, scenes=[dict(nodes=list(range(len(nodes))))], nodes=nodes,
        meshes=meshes, materials=materials, accessors=accessors, bufferViews=views,
        buffers=[dict(uri=uri, byteLength=len(buffer))], extensionsUsed=['KHR_materials_unlit'])
    if model.textures:
        document['images'] = [dict(uri='data:image/png;base64,' + base64.b64encode(png(one)).decode())
                              for one in model.textures]
        document['samplers'] = [dict(wrapS=_WRAPS[u], wrapT=_WRAPS[v]) for u, v in model.wraps]
        document['textures'] = [dict(source=i, sampler=i) for i in range(len(model.textures))]
    path.write_text(json.dumps(document))


def write_radiance(path, environment) -> torch.Tensor:
    """Writes [H, W, 3] as .hdr. Returns the stored values, which have mantissas of 8 bits."""
    values = environment.numpy().astype(np.float64)
    _, exponent = np.frexp(values.max(-1))
    mantissa = np.clip(np.floor(values / 2.0 ** exponent[..., None] * 256), 0, 255)
    pixels = np.concatenate([mantissa, exponent[..., None] + 128], -1).astype(np.uint8)
    height, width = values.shape[:2]
    path.write_bytes(b'#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n' + f'-Y {height} +X {width}\n'.encode() +
                     pixels.tobytes())
    return torch.tensor(mantissa / 256 * 2.0 ** exponent[..., None], dtype=torch.float32)


def write_cameras(path, camera, field_of_view) -> None:
    poses = torch.linalg.inv(camera.world_to_camera)
    frames = [dict(file_path=f'view_{i}', transform_matrix=pose.tolist()) for i, pose in enumerate(poses)]
    path.write_text(json.dumps(dict(camera_angle_x=field_of_view, frames=frames)))


def read_exr(path) -> torch.Tensor:
    """Reads an OpenEXR image of the program as [H, W, 4]: 32-bit floats A, B, G, R with ZIP compression."""
    content = path.read_bytes()
    place, header = 8, {}
    while content[place]:
        name, kind, rest = content[place:].split(b'\0', 2)
        size = struct.unpack_from('<i', rest)[0]
        header[name] = rest[4:4 + size]
        place += len(name) + len(kind) + 2 + 4 + size
    assert header[b'channels'][:6] == b'A\0\2\0\0\0' and header[b'compression'] == b'\3'
    x0, y0, x1, y1 = struct.unpack('<4i', header[b'dataWindow'])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    blocks = (height + 15) // 16
    image = np.zeros((height, 4, width), np.float32)
    for offset in struct.unpack_from(f'<{blocks}Q', content, place + 1):
        y, size = struct.unpack_from('<2i', content, offset)
        rows = min(16, height - y)
        block = content[offset + 8:offset + 8 + size]
        if size < 16 * rows * width:  # otherwise the block is stored without compression
            delta = np.frombuffer(zlib.decompress(block), np.uint8).astype(np.int64)
            halves = ((np.cumsum(delta) - 128 * np.arange(len(delta))) % 256).astype(np.uint8)
            whole, half = np.empty_like(halves), (len(halves) + 1) // 2
            whole[0::2], whole[1::2] = halves[:half], halves[half:]
            block = whole.tobytes()
        image[y:y + rows] = np.frombuffer(block, '<f4').reshape(rows, 4, width)
    return torch.tensor(image[:, ::-1].copy()).permute(0, 2, 1)
