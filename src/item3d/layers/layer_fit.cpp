#include "item3d/layers/layer_fit.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/layers/source_image.h"
#include "item3d/layers/uv_moments.h"

#include <algorithm>

namespace item3d {
namespace {

std::string shown(const std::optional<LayerSize>& size) {
    return size ? fmt::format("{} x {}", size->first, size->second) : "none";
}

}  // namespace

std::string misfit(const EditLayer& layer, const Model& model) {
    for (const auto& [index, material] : layer.materials) {
        const auto place = static_cast<std::size_t>(index);
        if (place >= model.materials.size())
            return fmt::format(
                "is for a model with a material '{}', which is missing in this model",
                material.name);
        const int texture = material.beginning ? material.beginning->base_color_texture : -1;
        if (texture >= static_cast<int>(model.textures.size()))
            return "is for a model with more textures than this one";
        for (const int image : material.images) {
            if (image < 0) continue;
            const LayerImage& own = layer.images[static_cast<std::size_t>(image)];
            const bool moved = material.beginning && own.slot == LayerSlot::base_color;
            const auto size =
                moved ? texture_size(model, texture) : source_size(model, index, own.slot);
            if (size != own.source_size)
                return fmt::format("is for a model whose texture of material '{}' is {}, not {}",
                                   material.name, shown(own.source_size), shown(size));
            const auto occlusion = occlusion_size(model, index, own.slot);
            if (occlusion != own.occlusion_size)
                return fmt::format("is for a model whose occlusion of material '{}' is {}, not {}",
                                   material.name, shown(own.occlusion_size), shown(occlusion));
        }
    }
    for (const auto& [index, edit] : layer.primitives) {
        const auto place = static_cast<std::size_t>(index);
        const auto count =
            place < model.primitives.size() ? model.primitives[place].positions.size() : 0;
        const bool fits = count > 0 &&
                          model.primitives[place].material == layer.primitive_materials.at(index) &&
                          std::all_of(edit.source_vertices.begin(), edit.source_vertices.end(),
                                      [&](std::uint32_t vertex) { return vertex < count; });
        if (!fits) return "has a new UV map for a mesh that is missing in this model";
    }
    return {};
}

bool has_same_uvs(const EditLayer& layer, const Model& model) {
    return std::all_of(layer.materials.begin(), layer.materials.end(), [&](const auto& entry) {
        const auto& [index, material] = entry;
        if (!material.uvs || static_cast<std::size_t>(index) >= model.materials.size()) return true;
        return same_uvs(*material.uvs, uv_moments(model, index));
    });
}

int material_like(const EditLayer& layer, int index, const Model& model) {
    const std::string& name = layer.materials.at(index).name;
    const std::vector<Material>& all = model.materials;
    const auto place = static_cast<std::size_t>(index);
    if (place < all.size() && all[place].name == name) return index;
    const auto found = std::find_if(all.begin(), all.end(),
                                    [&](const Material& other) { return other.name == name; });
    if (found != all.end()) return static_cast<int>(found - all.begin());
    if (all.size() == 1 && layer.materials.size() == 1) return 0;
    std::vector<std::string> names;
    for (const Material& material : all)
        names.push_back(material.name);
    throw InputError(layer.path.string(),
                     "its edit changed the material '" + name + "', which is missing in this model",
                     fmt::format("the model has {}", fmt::join(names, ", ")));
}

}  // namespace item3d
