#include "item3d/layers/apply_layers.h"

#include "item3d/core/error.h"
#include "item3d/layers/image_sum.h"
#include "item3d/layers/layer_fit.h"

#include <algorithm>
#include <utility>

namespace item3d {
namespace {

unsigned used_channels(const LayerUse& use, LayerSlot slot) {
    const LayerChannels& channels = use.channels;
    if (slot == LayerSlot::base_color) return channels.base_color ? ~0u : 0u;
    if (slot == LayerSlot::normal) return channels.normal ? ~0u : 0u;
    return (channels.occlusion ? 1u : 0u) | (channels.roughness ? 2u : 0u) |
           (channels.metallic ? 4u : 0u);
}

bool is_equal(const PrimitiveEdit& a, const PrimitiveEdit& b) {
    return a.source_vertices == b.source_vertices && a.uvs == b.uvs && a.indices == b.indices;
}

class LayerStack {
  public:
    LayerStack(std::span<const AppliedLayer> layers, Model& model)
        : layers_(layers), model_(model) {}

    ModelEdit edit() {
        for (const AppliedLayer& applied : layers_) {
            if (applied.use.strength == 0) continue;
            for (const auto& [index, material] : applied.layer.materials)
                if (changes_anything(applied, material)) of_material_[index].push_back(&applied);
        }
        for (const auto& [index, layers] : of_material_)
            require_same_uvs(index, layers);
        for (const auto& [index, layers] : of_material_)
            edit_material(index, layers);
        return std::move(edit_);
    }

  private:
    using Layers = std::vector<const AppliedLayer*>;

    static bool changes_anything(const AppliedLayer& applied, const LayerMaterial& material) {
        return std::any_of(layer_slots.begin(), layer_slots.end(), [&](LayerSlot slot) {
            return material.images[static_cast<std::size_t>(slot)] >= 0 &&
                   used_channels(applied.use, slot) != 0;
        });
    }

    static std::map<int, const PrimitiveEdit*> uvs_of(const EditLayer& layer, int material) {
        std::map<int, const PrimitiveEdit*> found;
        for (const auto& [index, edit] : layer.primitives)
            if (layer.primitive_materials.at(index) == material) found[index] = &edit;
        return found;
    }

    const std::string& name_of(int material) const {
        return model_.materials[static_cast<std::size_t>(material)].name;
    }

    /// Checks that layers have the same UVs, and adopts a new UV map, if any.
    void require_same_uvs(int material, const Layers& layers) {
        const auto first = uvs_of(layers.front()->layer, material);
        for (const AppliedLayer* other : layers) {
            const auto own = uvs_of(other->layer, material);
            const bool same =
                std::equal(own.begin(), own.end(), first.begin(), first.end(),
                           [](const auto& a, const auto& b) {
                               return a.first == b.first && is_equal(*a.second, *b.second);
                           });
            if (!same)
                throw InputError(
                    other->layer.path.string(),
                    "its texels of material '" + name_of(material) +
                        "' use a different UV map than those of " +
                        layers.front()->layer.path.string(),
                    "make the edits of a material with the same --uv and --texture-size");
        }
        for (const auto& [index, edit] : first)
            edit_.primitives[index] = *edit;
    }

    void edit_material(int index, const Layers& layers) {
        // The sum begins with a layer whose image contains the source's occlusion.
        const AppliedLayer* first = layers.front();
        for (const AppliedLayer* other : layers)
            if (!flags_of(*other, index).keeps_occlusion) {
                first = other;
                break;
            }
        begin(index, layers);
        MaterialEdit edit = flags_of(*first, index);
        for (const AppliedLayer* other : layers)
            join(flags_of(*other, index), edit);
        keep_channels(index, layers, edit);
        edit.base_color = image(index, LayerSlot::base_color, layers, first);
        edit.metallic_roughness = image(index, LayerSlot::metallic_roughness, layers, first);
        edit.normal = image(index, LayerSlot::normal, layers, first);
        edit_.materials[index] = std::move(edit);
    }

    static const MaterialEdit& flags_of(const AppliedLayer& applied, int material) {
        return applied.layer.materials.at(material).changes;
    }

    static void join(const MaterialEdit& other, MaterialEdit& edit) {
        edit.keeps_orm_texels = edit.keeps_orm_texels && other.keeps_orm_texels;
        edit.keeps_texels = edit.keeps_texels && other.keeps_texels;
        edit.keeps_occlusion = edit.keeps_occlusion && other.keeps_occlusion;
        edit.removes_emission = edit.removes_emission || other.removes_emission;
        edit.makes_opaque = edit.makes_opaque || other.makes_opaque;
        for (const std::string& name : other.removed_extensions) {
            auto& all = edit.removed_extensions;
            if (std::find(all.begin(), all.end(), name) == all.end()) all.push_back(name);
        }
    }

    /// Keeps the texture's channels that no layer uses equal to the source's.
    void keep_channels(int index, const Layers& layers, MaterialEdit& edit) const {
        const Material& material = model_.materials[static_cast<std::size_t>(index)];
        if (material.metallic_roughness_texture < 0) return;
        unsigned used = 0;
        for (const AppliedLayer* layer : layers)
            used |= used_channels(layer->use, LayerSlot::metallic_roughness);
        if ((used & 6u) != 6u) edit.keeps_orm_texels = true;
    }

    void begin(int index, const Layers& layers) {
        Material& material = model_.materials[static_cast<std::size_t>(index)];
        for (const AppliedLayer* layer : layers) {
            const auto& beginning = layer->layer.materials.at(index).beginning;
            if (!beginning) continue;
            material.base_color_texture = beginning->base_color_texture;
            material.base_color_factor = beginning->base_color_factor;
            material.metallic_factor = beginning->metallic_factor;
        }
        for (const AppliedLayer* layer : layers) {
            const MaterialEdit& flags = flags_of(*layer, index);
            if (flags.makes_opaque) material.alpha = Material::Alpha::opaque;
            if (!flags.removes_emission) continue;
            material.unlit = false;
            material.emissive_factor = Vec3(0.0f);
            material.emissive_texture = -1;
        }
    }

    EditedTexture image(int index, LayerSlot slot, const Layers& layers,
                        const AppliedLayer* first) {
        std::vector<ImageTerm> terms;
        std::vector<const void*> key;
        const AppliedLayer* base = nullptr;
        for (const AppliedLayer* layer : layers) {
            const unsigned channels = used_channels(layer->use, slot);
            const int image =
                layer->layer.materials.at(index).images[static_cast<std::size_t>(slot)];
            if (image < 0 || channels == 0) continue;
            terms.push_back({&layer->layer.images[static_cast<std::size_t>(image)],
                             layer->use.strength, channels, layer->layer.path.string()});
            key.push_back(terms.back().image);
            if (base == nullptr || layer == first) {
                base = layer;
                std::swap(terms.front(), terms.back());
            }
        }
        if (terms.empty()) return {};
        EditedTexture& made = made_[std::move(key)];
        if (!made) {
            const bool remakes_uvs = !uvs_of(base->layer, index).empty();
            made = image_sum(terms, model_, index, flags_of(*base, index), remakes_uvs);
        }
        return made;
    }

    std::span<const AppliedLayer> layers_;
    Model& model_;
    std::map<int, Layers> of_material_;  ///< layers that change a material
    std::map<std::vector<const void*>, EditedTexture> made_;
    ModelEdit edit_;
};

}  // namespace

ModelEdit apply_layers(std::span<const AppliedLayer> layers, Model& model) {
    for (const AppliedLayer& applied : layers) {
        const std::string problem = misfit(applied.layer, model);
        if (!problem.empty())
            throw InputError(applied.layer.path.string(), problem,
                             "apply it to " + applied.layer.model + ", which it was made for");
    }
    return LayerStack(layers, model).edit();
}

}  // namespace item3d
