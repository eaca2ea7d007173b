#include "item3d/edit/outputs/outside_texels.h"

#include "item3d/region/masks.h"

#include <algorithm>

namespace item3d {
namespace {

const Image* image_of(const Model& model, int texture) {
    return texture >= 0 ? &model.textures[static_cast<std::size_t>(texture)].image : nullptr;
}

/// Compares two images where `mask` is 0, and adds to the counts. channels: bit mask of the
/// compared channels.
void compare(const Image* was, const Image* now, const Image& mask, unsigned channels,
             OutsideTexels& outside) {
    if (was == nullptr || now == nullptr || was->width != mask.width ||
        was->height != mask.height || now->width != mask.width || now->height != mask.height)
        return;
    for (int y = 0; y < mask.height; ++y) {
        for (int x = 0; x < mask.width; ++x) {
            if (mask.at(x, y, 0) > 0) continue;
            ++outside.compared;
            bool is_same = true;
            for (int c = 0; c < std::min(was->channels, now->channels); ++c)
                if ((channels >> c & 1u) != 0)
                    is_same = is_same && was->at(x, y, c) == now->at(x, y, c);
            outside.changed += is_same ? 0 : 1;
        }
    }
}

}  // namespace

OutsideTexels compare_outside(const EditScene& scene, const Model& edited) {
    OutsideTexels outside;
    if (!scene.region || edited.materials.size() != scene.model.materials.size()) return outside;
    for (const auto& [index, mask] :
         region_masks(*scene.region, scene.model, scene.geometry, scene.atlas, 0)) {
        const Material& was = scene.model.materials[static_cast<std::size_t>(index)];
        const Material& now = edited.materials[static_cast<std::size_t>(index)];
        if (was.base_color_factor == Vec4(1.0f))
            compare(image_of(scene.model, was.base_color_texture),
                    image_of(edited, now.base_color_texture), mask, 7u, outside);
        if (was.roughness_factor == 1 && was.metallic_factor == 1)
            compare(image_of(scene.model, was.metallic_roughness_texture),
                    image_of(edited, now.metallic_roughness_texture), mask, 6u, outside);
        if (was.normal_scale == 1)
            compare(image_of(scene.model, was.normal_texture), image_of(edited, now.normal_texture),
                    mask, 7u, outside);
    }
    return outside;
}

}  // namespace item3d
