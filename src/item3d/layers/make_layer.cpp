#include "item3d/layers/make_layer.h"

#include "item3d/core/error.h"
#include "item3d/core/parallel.h"
#include "item3d/layers/source_image.h"
#include "item3d/layers/uv_moments.h"

#include <algorithm>
#include <limits>
#include <set>
#include <utility>

namespace item3d {
namespace {

constexpr int rows_at_once = 16;

/// Returns the image's values as integers of a file, [height, width, channels].
at::Tensor file_values(const Image& image, int bits) {
    at::Tensor values =
        at::empty({image.height, image.width, image.channels}, at::TensorOptions(at::kInt));
    auto* out = values.data_ptr<std::int32_t>();
    parallel_for(
        "file_values", static_cast<std::int64_t>(image.pixels.size()),
        [&](std::int64_t i) {
            out[i] = to_file_value(image.pixels[static_cast<std::size_t>(i)], bits);
        },
        4096);
    return values;
}

/// Returns the half-open range of a row's nonzero columns; {width, 0} if there are none.
std::pair<std::int64_t, std::int64_t> used_columns(const std::int32_t* row, std::int64_t width,
                                                   std::int64_t channels) {
    std::pair<std::int64_t, std::int64_t> used(width, 0);
    for (std::int64_t i = 0; i < width * channels; ++i) {
        if (row[i] == 0) continue;
        used.first = std::min(used.first, i / channels);
        used.second = i / channels + 1;
    }
    return used;
}

/// Sets the image's change to the smallest rectangle and channels with all nonzero values.
void crop(const at::Tensor& change, LayerImage& image) {
    const std::int64_t height = change.size(0), width = change.size(1), channels = change.size(2);
    const auto* values = change.const_data_ptr<std::int32_t>();
    std::vector<std::pair<std::int64_t, std::int64_t>> rows(static_cast<std::size_t>(height));
    parallel_for(
        "crop", height,
        [&](std::int64_t y) {
            rows[static_cast<std::size_t>(y)] =
                used_columns(values + y * width * channels, width, channels);
        },
        rows_at_once);
    std::int64_t left = width, right = 0, top = height, bottom = 0;
    for (std::int64_t y = 0; y < height; ++y) {
        const auto [first, last] = rows[static_cast<std::size_t>(y)];
        if (last == 0) continue;
        left = std::min(left, first);
        right = std::max(right, last);
        top = std::min(top, y);
        bottom = y + 1;
    }
    if (right == 0) return;
    at::Tensor cut = change.slice(0, top, bottom).slice(1, left, right);
    const at::Tensor used = cut.ne(0).flatten(0, 1).any(0).nonzero();
    image.x = static_cast<int>(left);
    image.y = static_cast<int>(top);
    image.channel = static_cast<int>(used.min().item<std::int64_t>());
    cut = cut.slice(2, image.channel, used.max().item<std::int64_t>() + 1);
    const auto farthest = cut.abs().max().item<std::int64_t>();
    const at::ScalarType type = farthest <= std::numeric_limits<std::int8_t>::max()    ? at::kChar
                                : farthest <= std::numeric_limits<std::int16_t>::max() ? at::kShort
                                                                                       : at::kInt;
    image.change = cut.to(type).contiguous();
}

class LayerMaker {
  public:
    explicit LayerMaker(const BakedEdit& baked) : baked_(baked) {}

    EditLayer make() {
        for (const auto& [index, edit] : baked_.edit.materials)
            add_material(index, edit);
        for (const auto& [index, edit] : baked_.edit.primitives) {
            layer_.primitives[index] = edit;
            layer_.primitive_materials[index] = material_of(index);
        }
        return std::move(layer_);
    }

  private:
    int material_of(int primitive) const {
        return baked_.model.primitives[static_cast<std::size_t>(primitive)].material;
    }

    bool remakes_uvs(int material) const {
        return std::any_of(
            baked_.edit.primitives.begin(), baked_.edit.primitives.end(),
            [&](const auto& primitive) { return material_of(primitive.first) == material; });
    }

    void add_material(int index, const MaterialEdit& edit) {
        LayerMaterial& material = layer_.materials[index];
        const auto place = static_cast<std::size_t>(index);
        const Material& begun = baked_.model.materials[place];
        const Material& read = baked_.file_materials[place];
        material.name = begun.name;
        material.uvs = uv_moments(baked_.model, index);
        material.changes = edit;
        const EditedTexture* textures[] = {&edit.base_color, &edit.metallic_roughness,
                                           &edit.normal};
        for (std::size_t slot = 0; slot < std::size(textures); ++slot) {
            if (*textures[slot])
                material.images[slot] = layer_image_of(index, layer_slots[slot], *textures[slot]);
        }
        material.changes.base_color = material.changes.metallic_roughness =
            material.changes.normal = EditedTexture();
        if (begun.base_color_texture != read.base_color_texture ||
            begun.base_color_factor != read.base_color_factor ||
            begun.metallic_factor != read.metallic_factor)
            material.beginning = MaterialBeginning{begun.base_color_texture,
                                                   begun.base_color_factor, begun.metallic_factor};
    }

    /// Returns the index of an image in the layer. Materials that share an image get the same
    /// index.
    int layer_image_of(int material, LayerSlot slot, const EditedTexture& texture) {
        const auto [known, is_new] =
            seen_.emplace(texture.identity(), static_cast<int>(layer_.images.size()));
        if (is_new) layer_.images.push_back(make_image(material, slot, texture));
        return known->second;
    }

    LayerImage make_image(int material, LayerSlot slot, const EditedTexture& texture) {
        LayerImage image;
        image.slot = slot;
        image.width = texture->width;
        image.height = texture->height;
        image.channels = texture->channels;
        image.bits = texture.bits_per_channel();
        image.source_size = source_size(baked_.model, material, slot);
        image.occlusion_size = occlusion_size(baked_.model, material, slot);
        const auto found = baked_.unedited.find(material);
        const UneditedImages* unedited = found == baked_.unedited.end() ? nullptr : &found->second;
        const MaterialEdit& edit = baked_.edit.materials.at(material);
        at::Tensor source;
        if (has_source_image(baked_.model, material, image, edit, remakes_uvs(material))) {
            source = file_values(source_image(baked_.model, material, image, edit), image.bits);
        } else {
            ITEM3D_CHECK(unedited != nullptr, "the bake returned no texture set");
            const Image& before = slot == LayerSlot::base_color ? unedited->base_color
                                  : slot == LayerSlot::normal   ? unedited->normal
                                                                : unedited->metallic_roughness;
            ITEM3D_CHECK(before.pixels.size() == texture->pixels.size(),
                         "an image before the edit has another size");
            source = file_values(before, image.bits);
            image.source = source.to(image.bits > 8 ? at::kInt : at::kByte);
        }
        crop(file_values(*texture, image.bits) - source, image);
        if (unedited != nullptr && !has_mask_.contains(unedited) &&
            unedited->weight.width == image.width && unedited->weight.height == image.height) {
            image.mask = file_values(unedited->weight, 8).squeeze(2).to(at::kByte);
            has_mask_.insert(unedited);
        }
        return image;
    }

    const BakedEdit& baked_;
    EditLayer layer_;
    std::map<const void*, int> seen_;
    std::set<const void*> has_mask_;  ///< texture sets whose mask is stored
};

}  // namespace

EditLayer make_layer(const BakedEdit& baked) {
    const at::NoGradGuard no_grad;
    return LayerMaker(baked).make();
}

}  // namespace item3d
