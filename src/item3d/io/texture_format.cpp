#include "item3d/io/texture_format.h"

#include "item3d/io/image/jpeg.h"
#include "item3d/io/image/ktx2_encode.h"
#include "item3d/io/image/png.h"
#include "item3d/io/image/webp.h"

#include <algorithm>

namespace item3d {
namespace {

/// Longest edge of images that are smallest as PNG.
constexpr int tiny_edge = 8;
/// JPEG quality of textures that the source lacks.
constexpr int new_quality = 92;
/// Lowest JPEG quality of an image with a channel from a JPEG.
constexpr int kept_quality = 95;

const Texture* texture_of(const Model& model, int index) {
    return index >= 0 ? &model.textures[static_cast<std::size_t>(index)] : nullptr;
}

bool is_transparent(const Image& image) {
    if (image.channels % 2 != 0) return false;
    const auto channels = static_cast<std::size_t>(image.channels);
    for (std::size_t i = channels - 1; i < image.pixels.size(); i += channels) {
        if (image.pixels[i] < 1.0f - 0.5f / 255.0f) return true;
    }
    return false;
}

ImageCoding wanted_coding(TextureFormat format, const Texture* source) {
    const ImageCoding own =
        source ? source->coding : ImageCoding{ImageEncoding::jpeg, false, new_quality};
    switch (format) {
        case TextureFormat::png:
            return {};
        case TextureFormat::jpeg:
            return {ImageEncoding::jpeg, false, own.is_lossless ? 95 : own.quality};
        case TextureFormat::webp:
            return {ImageEncoding::webp, own.is_lossless, own.is_lossless ? 95 : own.quality};
        case TextureFormat::ktx2:
            return {ImageEncoding::ktx2, false, 75};
        case TextureFormat::keep:
            break;
    }
    return own;
}

ImageCoding possible_coding(ImageCoding coding, const Image& image, bool must_be_exact) {
    if (std::max(image.width, image.height) <= tiny_edge) return {};
    if (must_be_exact && coding.encoding == ImageEncoding::webp)
        coding = {ImageEncoding::webp, true, 95};
    if (coding.encoding == ImageEncoding::ktx2 && (must_be_exact || !fits_ktx2(image))) return {};
    if (coding.encoding == ImageEncoding::jpeg && (must_be_exact || is_transparent(image)))
        return {};
    if (coding.encoding == ImageEncoding::webp &&
        std::max(image.width, image.height) > largest_webp_edge)
        return {};
    return coding;
}

}  // namespace

void choose_codings(const Model& model, TextureFormat format, ModelEdit& edit) {
    for (auto& entry : edit.materials) {
        MaterialEdit& material_edit = entry.second;
        const Material& material = model.materials[static_cast<std::size_t>(entry.first)];
        const Texture* base = texture_of(model, material.base_color_texture);
        const auto choose = [&](EditedTexture& texture, int slot, bool has_kept_channel) {
            const bool must_be_exact = has_kept_channel || material_edit.keeps_texels;
            if (!texture) return;
            const Texture* own = texture_of(model, slot);
            // A slot without an old texture takes the coding of the base colour only if that coding
            // is lossy. New textures are smooth, so they do not need PNG.
            const Texture* followed = own                                 ? own
                                      : base && !base->coding.is_lossless ? base
                                                                          : nullptr;
            ImageCoding coding = wanted_coding(format, followed);
            // A channel that was already lossy needs no PNG of four times its size.
            const bool is_kept_jpeg = must_be_exact && !material_edit.keeps_texels && own &&
                                      own->coding.encoding == ImageEncoding::jpeg &&
                                      coding.encoding == ImageEncoding::jpeg;
            if (is_kept_jpeg) coding.quality = std::max(coding.quality, kept_quality);
            coding = possible_coding(coding, *texture, must_be_exact && !is_kept_jpeg);
            // The other codings have eight bits, which would lose precision.
            if (format == TextureFormat::keep && own && own->bits_per_channel > 8) coding = {};
            if (coding.encoding == ImageEncoding::ktx2) {
                coding.is_srgb = &texture == &material_edit.base_color;
                coding.is_precise = &texture == &material_edit.normal;
            }
            texture.set_coding(coding);
        };
        choose(material_edit.base_color, material.base_color_texture, false);
        const int orm = material.metallic_roughness_texture;
        choose(material_edit.metallic_roughness, orm >= 0 ? orm : material.occlusion_texture,
               material_edit.keeps_orm_texels);
        choose(material_edit.normal, material.normal_texture, false);
    }
}

Bytes encode_texture(const Image& image, const ImageCoding& coding, int bits_per_channel) {
    switch (coding.encoding) {
        case ImageEncoding::jpeg:
            return encode_jpeg(image, coding.quality);
        case ImageEncoding::webp:
            return encode_webp_texture(image, coding.is_lossless, coding.quality);
        case ImageEncoding::ktx2:
            return encode_ktx2(image, coding.is_srgb, coding.is_precise,
                               coding.quality * 255 / 100);
        case ImageEncoding::png:
            break;
    }
    return encode_png(image, bits_per_channel);
}

const char* extension_of(ImageEncoding encoding) {
    return encoding == ImageEncoding::jpeg   ? ".jpg"
           : encoding == ImageEncoding::webp ? ".webp"
           : encoding == ImageEncoding::ktx2 ? ".ktx2"
                                             : ".png";
}

}  // namespace item3d
