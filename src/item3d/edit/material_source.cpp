#include "item3d/edit/material_source.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/random.h"

#include <algorithm>

namespace item3d {

std::vector<int> select_materials(const Model& model, const std::vector<std::string>& names) {
    std::vector<bool> used(model.materials.size(), false);
    for (const Primitive& primitive : model.primitives) {
        used[static_cast<std::size_t>(primitive.material)] = true;
    }
    std::vector<int> selected;
    for (std::size_t i = 0; i < model.materials.size(); ++i) {
        const bool wanted = names.empty() || std::find(names.begin(), names.end(),
                                                       model.materials[i].name) != names.end();
        if (wanted && used[i]) selected.push_back(static_cast<int>(i));
    }
    for (const std::string& name : names) {
        const bool found = std::any_of(selected.begin(), selected.end(), [&](int index) {
            return model.materials[static_cast<std::size_t>(index)].name == name;
        });
        if (found) continue;
        std::vector<std::string> known;
        for (const Material& material : model.materials)
            known.push_back(material.name);
        const bool is_there = std::find(known.begin(), known.end(), name) != known.end();
        throw InputError("--material",
                         fmt::format("'{}' is not {}", name,
                                     is_there ? "seen: nothing that is shown has this material"
                                              : "a material of this model"),
                         fmt::format("it has {}", fmt::join(known, ", ")));
    }
    return selected;
}

MaterialSource::MaterialSource(const Model& model, const TexturedMaterials& textured,
                               const FieldSpace& space, const std::vector<int>& edited_materials,
                               ChannelMask channels, at::Device device)
    : textured_(textured), space_(space), channels_(channels) {
    at::Tensor is_edited =
        at::zeros({static_cast<std::int64_t>(model.materials.size())}, at::kBool);
    for (const int index : edited_materials)
        is_edited[index] = true;
    for (const Primitive& primitive : model.primitives) {
        all_edited_ = all_edited_ && is_edited[primitive.material].item<bool>();
    }
    is_edited_ = is_edited.to(device);
    orm_is_edited_ =
        at::tensor({int{channels.occlusion}, int{channels.roughness}, int{channels.metallic}})
            .to(device, at::kBool);
}

MaterialSample MaterialSource::own(const Surface& surface) const {
    const at::NoGradGuard no_grad;
    return textured_.sample(surface);
}

MaterialSample MaterialSource::sample(const Surface& surface, NeuralTexture& field,
                                      const MaterialSample& own) const {
    if (!channels_.any()) return own;
    MaterialSample mixed = own;
    const MaterialSample edited = field->forward(space_.positions(surface));
    const at::Tensor here = all_edited_ ? at::ones({1, 1}, is_edited_.options())
                                        : is_edited_.index_select(0, surface.material).unsqueeze(1);
    if (channels_.base_color) mixed.base_color = at::where(here, edited.base_color, own.base_color);
    mixed.orm = at::where(here & orm_is_edited_, edited.orm, own.orm);
    if (channels_.normal) {
        mixed.normal =
            own.normal.defined() ? at::where(here, edited.normal, own.normal) : edited.normal;
    }
    return mixed;
}

SurfaceMeans surface_means(const Model& model, const std::vector<int>& materials,
                           std::uint64_t seed) {
    const at::NoGradGuard no_grad;
    const Geometry geometry = Geometry::from_model(model);
    const FieldSpace space(model, materials);
    const SurfaceSampler sampler(geometry, space);
    Random random(seed, RandomStream::surface_means);
    const MaterialSample sample = TexturedMaterials(model).sample(sampler.sample(20000, random));
    const at::Tensor color = sample.base_color.mean(0).contiguous();
    const at::Tensor orm = sample.orm.mean(0).contiguous();
    const float* rgb = color.data_ptr<float>();
    const float* values = orm.data_ptr<float>();
    return {Vec3(rgb[0], rgb[1], rgb[2]), values[1], values[2]};
}

}  // namespace item3d
