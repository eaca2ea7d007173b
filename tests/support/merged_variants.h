// Fixture for the tests of item3d variants: simulated edits of a model, merged into variants.
#pragma once

#include "item3d/core/error.h"
#include "item3d/io/variants.h"
#include "tests/support/edit_folder.h"

namespace item3d::testing_support {

/// Returns a document with two primitives. Edits change the first one, which has a texture with a
/// sampler. The second one has another material.
inline GltfQuad shop_quad() {
    GltfQuad quad;
    quad.json["samplers"] = GltfJson::array({GltfJson{{"wrapS", 33071}}});
    quad.set_base_color(quad.add_texture(plain_image(4, Vec3(1, 0, 0))));
    quad.json["textures"][0]["sampler"] = 0;
    quad.json["materials"].push_back(GltfJson{{"name", "handle"}});
    GltfJson second = quad.primitive();
    second["material"] = 1;
    quad.json["meshes"][0]["primitives"].push_back(second);
    return quad;
}

inline ModelEdit plain_edit(Vec3 color, bool has_orm = false) {
    ModelEdit edit;
    edit.materials[0].base_color = plain_image(16, color);
    if (has_orm) edit.materials[0].metallic_roughness = plain_image(16, Vec3(1, 0.2f, 1));
    return edit;
}

class MergedVariants : public ::testing::Test {
  protected:
    void begin(const std::string& name, GltfQuad quad) {
        folder_ = fresh_folder("merged_" + name);
        request_.model = quad.write(folder_);
        request_.output = folder_ / "shop.glb";
    }
    void add(const std::string& to, const ModelEdit& edit, const std::string& variant = "") {
        const std::string name = std::to_string(request_.edits.size());
        request_.edits.push_back(
            write_edit_folder(folder_ / name, request_.model, edit, to, variant));
    }
    Vec3 color_in(const std::string& variant, std::size_t primitive = 0) const {
        const Model model = load_model(request_.output, {.variant = variant});
        const Material& material =
            model.materials.at(static_cast<std::size_t>(model.primitives.at(primitive).material));
        if (material.base_color_texture < 0) return Vec3(material.base_color_factor);
        const Image& image =
            model.textures.at(static_cast<std::size_t>(material.base_color_texture)).image;
        return Vec3(image.at(0, 0, 0), image.at(0, 0, 1), image.at(0, 0, 2));
    }
    std::vector<std::string> names() const {
        std::vector<std::string> found;
        for (const MaterialVariant& variant : load_model(request_.output).variants)
            found.push_back(variant.name);
        return found;
    }
    std::string problem() const {
        try {
            write_variants(request_);
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    }

    fs::path folder_;
    VariantsRequest request_;
};

}  // namespace item3d::testing_support
