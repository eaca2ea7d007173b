// The file formats of edited textures.
#pragma once

#include "item3d/core/files.h"
#include "item3d/io/save.h"
#include "item3d/scene/image_coding.h"

namespace item3d {

/// keep: the format of the replaced texture. webp: lossless where that texture was. ktx2: ETC1S,
/// normals UASTC; PNG where edges are no multiples of four.
enum class TextureFormat { keep, png, jpeg, webp, ktx2 };

/// Sets the codings of all images of the edit. Where a material had no texture in a slot, the base
/// colour's coding is used if lossy, else JPEG. Images that JPEG or a lossy WebP cannot hold get a
/// lossless coding: those with alpha (JPEG), those that keep texels (MaterialEdit) unless those are
/// a JPEG's, and with 16 bits.
void choose_codings(const Model& model, TextureFormat format, ModelEdit& edit);

/// bits_per_channel: 8, or 16, which only PNG supports.
Bytes encode_texture(const Image& image, const ImageCoding& coding, int bits_per_channel);

/// Returns ".png", ".jpg", ".webp" or ".ktx2".
const char* extension_of(ImageEncoding encoding);

}  // namespace item3d
