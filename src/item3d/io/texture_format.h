// The file formats of edited textures.
#pragma once

#include "item3d/core/files.h"
#include "item3d/io/save.h"
#include "item3d/scene/image_coding.h"

namespace item3d {

/// Format of edited textures. `keep` means the format of the replaced texture. `webp` is lossless
/// if the replaced texture was lossless. `ktx2` means UASTC for normal maps and ETC1S for other
/// textures, but PNG if an edge is not a multiple of four.
enum class TextureFormat { keep, png, jpeg, webp, ktx2 };

/// Sets the codings of all images of the edit. Where a material had no texture in a slot, the base
/// colour's coding is used if it is lossy, else JPEG. An image gets a lossless coding instead if it
/// is transparent and would be a JPEG, if TextureFormat::keep applies to a texture of more than 8
/// bits, or if MaterialEdit::keeps_texels is set. MaterialEdit::keeps_orm_texels does the same,
/// unless the old and the new texture are JPEGs.
void choose_codings(const Model& model, TextureFormat format, ModelEdit& edit);

/// Encodes an image. bits_per_channel is 8, or 16 for PNG only.
Bytes encode_texture(const Image& image, const ImageCoding& coding, int bits_per_channel);

/// Returns ".png", ".jpg", ".webp" or ".ktx2".
const char* extension_of(ImageEncoding encoding);

}  // namespace item3d
