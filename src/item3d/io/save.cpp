#include "item3d/io/save.h"

#include "item3d/core/error.h"
#include "item3d/io/gltf/write.h"
#include "item3d/io/image/jpeg.h"
#include "item3d/io/image/openexr.h"
#include "item3d/io/image/png.h"
#include "item3d/io/image/radiance.h"
#include "item3d/io/image_claims.h"
#include "item3d/io/obj/write.h"
#include "item3d/io/text.h"

namespace item3d {

void save_image(const std::filesystem::path& path, const Image& image, int bits_per_channel) {
    const std::string extension = to_lower(path.extension().string());
    Bytes bytes;
    if (extension == ".png") {
        bytes = encode_png(image, bits_per_channel);
    } else if (extension == ".jpg" || extension == ".jpeg") {
        bytes = encode_jpeg(image);
    } else if (extension == ".hdr") {
        bytes = encode_radiance(image);
    } else if (extension == ".exr") {
        bytes = encode_openexr(image, bits_per_channel);
    } else {
        throw InputError(path.string(),
                         "images are written as .png, .jpg, .hdr or .exr, not '" + extension + "'",
                         "use one of these extensions");
    }
    write_atomically(path, std::span<const std::uint8_t>(bytes));
}

void save_model(const std::filesystem::path& path, const Model& model, const ModelEdit& edit,
                const Provenance& provenance) {
    const std::string extension = to_lower(path.extension().string());
    std::vector<EditedTexture> textures;
    for (const auto& [index, material] : edit.materials)
        textures.insert(textures.end(),
                        {material.base_color, material.metallic_roughness, material.normal});
    encode_all(textures);
    put_claims(provenance, model, edit);
    if (extension == ".glb" || extension == ".gltf" || extension == ".vrm") {
        write_gltf(path, model, edit, provenance);
    } else if (extension == ".obj") {
        write_obj(path, model, edit);
    } else {
        throw InputError(path.string(),
                         "models are written as .glb, .gltf or .obj, not '" + extension + "'",
                         "use one of these extensions");
    }
}

}  // namespace item3d
