#include "item3d/edit/outputs/rebake_layer.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/edit/outputs/bake_options.h"
#include "item3d/edit/source_materials.h"
#include "item3d/field/atlas/shared_texels.h"
#include "item3d/layers/layer_field.h"
#include "item3d/layers/layer_fit.h"
#include "item3d/layers/layer_mask.h"
#include "item3d/layers/make_layer.h"
#include "item3d/region/region.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

namespace item3d {
namespace {

/// Largest distance between the corners of the old and the new bounding box of the edited part,
/// relative to the old diagonal.
constexpr float moved_too_far = 0.02f;

EditPlan plan_of(const EditLayer& layer, int texture_size) {
    try {
        EditSettings settings = layer.settings.get<EditSettings>();
        if (texture_size > 0) settings.texture_size = texture_size;
        return EditPlan(settings);
    } catch (const nlohmann::json::exception&) {
        throw InputError(layer.path.string(), "its settings of the edit cannot be read",
                         "the file is damaged; make the edit again");
    }
}

/// Returns the indices of the edited materials in this model, in rising order.
std::vector<int> materials_of(const EditLayer& layer, const Model& model) {
    std::vector<int> materials;
    for (const auto& [index, material] : layer.materials)
        materials.push_back(material_like(layer, index, model));
    std::sort(materials.begin(), materials.end());
    materials.erase(std::unique(materials.begin(), materials.end()), materials.end());
    return materials;
}

void require_same_place(const EditLayer& layer, const NeuralTextureOptions& field,
                        const FieldSpace& space) {
    const auto [low, high] = field.bounds;
    const auto [own_low, own_high] = space.bounds();
    const float apart = std::max(glm::length(own_low - low), glm::length(own_high - high));
    if (apart <= moved_too_far * glm::length(high - low)) return;
    const auto shown = [](Vec3 v) { return fmt::format("{:.4g},{:.4g},{:.4g}", v.x, v.y, v.z); };
    throw InputError(
        layer.path.string(),
        fmt::format("the edited surface lies between {} and {}, the model's between {} and {}",
                    shown(low), shown(high), shown(own_low), shown(own_high)),
        "apply it to a model of the same shape in the same place");
}

/// The edit's region, rebuilt on this model.
class RegionAgain {
  public:
    RegionAgain(const EditLayer& layer, const Model& model, const Geometry& geometry,
                const FieldSpace& space, int texture_size) {
        if (!layer.region) return;
        const bool same = has_same_uvs(layer, model);
        if (same && layer.primitives.empty()) mask_.emplace(layer, model, texture_size);
        if (mask_ && mask_->is_complete()) return;
        mask_.reset();
        const RegionRequest request{layer.region->include, layer.region->exclude,
                                    layer.region->feather};
        refuse_what_is_lost(layer, request, same);
        textured_ = std::make_unique<TexturedMaterials>(model);
        try {
            region_ =
                std::make_unique<Region>(request, RegionScene{model, geometry, *textured_, space});
        } catch (const InputError& error) {
            throw InputError(layer.path.string(), error.what());
        }
    }

    std::function<at::Tensor(const Surface&)> weight() const {
        if (mask_) return [this](const Surface& surface) { return mask_->weight(surface); };
        if (region_) return [this](const Surface& surface) { return region_->weight(surface); };
        return nullptr;
    }

  private:
    static void refuse_what_is_lost(const EditLayer& layer, const RegionRequest& request,
                                    bool same_uvs) {
        for (const auto* selectors : {&request.include, &request.exclude})
            for (const std::string& text : *selectors)
                if ((text.starts_with("mask=") && !same_uvs) || text.starts_with("words="))
                    throw InputError(
                        layer.path.string(),
                        "its region " + text + " cannot be transferred to another UV map",
                        "edit this model with a region by place, part or colour");
    }

    std::optional<LayerMask> mask_;
    std::unique_ptr<TexturedMaterials> textured_;
    std::unique_ptr<Region> region_;
};

}  // namespace

EditLayer rebake_layer(const EditLayer& layer, const Model& file_model, int texture_size) {
    const at::NoGradGuard no_grad;
    if (!layer.channels)
        throw InputError(layer.path.string(),
                         "lacks the changed channels, because an older item3d wrote it",
                         "make the edit again");
    const EditPlan plan = plan_of(layer, texture_size);
    EditFields fields = get_fields(layer);
    const std::vector<int> materials = materials_of(layer, file_model);
    const Geometry geometry = Geometry::from_model(file_model);
    FieldSpace space(file_model, materials);
    require_same_place(layer, fields.field->options(), space);
    const RegionAgain region(layer, file_model, geometry, space, plan.texture_size);

    Model model = file_model;
    const auto losses = prepare_materials(model, materials, plan);
    Atlas atlas = choose_uvs(model, space, materials, baked_uvs(plan));
    if (atlas.has_shared_texels())
        space.share(std::make_shared<SharedTexels>(model, atlas, plan.texture_size,
                                                   geometry.positions.device()));
    add_new_uvs(model, space, plan.texture_size, atlas);
    const TexturedMaterials textured(model);
    const BakedChannels& channels = *layer.channels;
    const BakeOptions options =
        bake_options(plan, {channels.base_color, channels.occlusion, channels.roughness,
                            channels.metallic, channels.normal});
    std::map<int, UneditedImages> unedited;
    ModelEdit edit = bake({model, geometry, textured, space, atlas, region.weight()}, fields.fitted,
                          fields.field, options, &unedited);
    apply_losses(losses, edit);

    EditLayer made = make_layer({file_model.materials, model, edit, unedited});
    made.path = layer.path;
    made.model = layer.model;
    made.model_hash = layer.model_hash;
    made.settings = layer.settings;
    made.claim = layer.claim;
    made.channels = layer.channels;
    made.region = layer.region;
    return made;
}

}  // namespace item3d
