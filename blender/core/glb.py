"""Reads the parts of a .glb that an edit changes: materials and their images."""
from __future__ import annotations

import hashlib
import json
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .errors import Item3dError

_SUFFIXES = {"image/png": ".png", "image/jpeg": ".jpg", "image/webp": ".webp"}
_PICTURE_EXTENSIONS = ("EXT_texture_webp",)


@dataclass(frozen=True)
class TextureUse:
    """A texture as a material uses it. `uv` is the index of the UV map. The transform is glTF's (V points down)."""

    image: int
    uv: int
    offset: tuple[float, float]
    rotation: float
    scale: tuple[float, float]
    strength: float  # strength of a normal map or of occlusion

    @property
    def is_transformed(self) -> bool:
        return self.offset != (0.0, 0.0) or self.rotation != 0.0 or self.scale != (1.0, 1.0)


class Glb:
    """A .glb in memory. Raises Item3dError if the file cannot be read or is no .glb."""

    def __init__(self, path: Path):
        self.path = path
        try:
            data = path.read_bytes()
            magic, version, _ = struct.unpack_from("<III", data)
            length, kind = struct.unpack_from("<II", data, 12)
            if magic != 0x46546C67 or version != 2 or kind != 0x4E4F534A:
                raise ValueError("not a glTF 2.0 binary")
            self.json: dict[str, Any] = json.loads(data[20 : 20 + length])
        except OSError as error:
            raise Item3dError(f"{path}: cannot be read, {error.strerror}; start the edit again") from error
        except (ValueError, struct.error) as error:
            raise Item3dError(f"{path}: broken ({error}); start the edit again") from error
        self.blob = data[28 + length :]

    def materials(self) -> list[dict[str, Any]]:
        return list(self.json.get("materials", []))

    def texture(self, info: dict[str, Any] | None) -> TextureUse | None:
        """Returns the texture of a textureInfo, or None if there is none."""
        if not info:
            return None
        texture = self.json["textures"][info["index"]]
        image = texture.get("source")
        for name in _PICTURE_EXTENSIONS:
            image = texture.get("extensions", {}).get(name, {}).get("source", image)
        if image is None:
            return None
        transform = info.get("extensions", {}).get("KHR_texture_transform", {})
        offset, scale = transform.get("offset", (0, 0)), transform.get("scale", (1, 1))
        return TextureUse(
            image=image,
            uv=transform.get("texCoord", info.get("texCoord", 0)),
            offset=(float(offset[0]), float(offset[1])),
            rotation=float(transform.get("rotation", 0)),
            scale=(float(scale[0]), float(scale[1])),
            strength=float(info.get("scale", info.get("strength", 1))),
        )

    def signature(self, index: int) -> str:
        """Returns a text that differs if an edit changed the material. It has the values, and hashes of the images."""

        def resolve(value: Any) -> Any:
            if isinstance(value, list):
                return [resolve(element) for element in value]
            if not isinstance(value, dict):
                return value
            found = {key: resolve(element) for key, element in value.items()}
            if isinstance(value.get("index"), int):
                use = self.texture(value)
                found["index"] = None if use is None else hashlib.sha256(self.image_bytes(use.image)).hexdigest()
            return found

        return json.dumps(resolve(self.json["materials"][index]), sort_keys=True)

    def image_bytes(self, index: int) -> bytes:
        view = self.json["bufferViews"][self.json["images"][index]["bufferView"]]
        start = view.get("byteOffset", 0)
        return self.blob[start : start + view["byteLength"]]

    def write_image(self, index: int, folder: Path) -> Path:
        """Writes an image with the bytes that it has in the .glb. Returns its path."""
        image = self.json["images"][index]
        name = "".join(c if c.isalnum() or c in "-_." else "_" for c in image.get("name", f"image_{index}"))
        path = folder / (name + _SUFFIXES.get(image.get("mimeType", ""), ".png"))
        folder.mkdir(parents=True, exist_ok=True)
        path.write_bytes(self.image_bytes(index))
        return path
