#include "item3d/edit/material_source.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/random.h"

#include <algorithm>

namespace item3d {
namespace {

constexpr std::int64_t mean_points = 20000;

}  // namespace

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
                                     is_there ? "visible: no visible triangle has this material"
                                              : "a material of this model"),
                         fmt::format("its materials are {}", fmt::join(known, ", ")));
    }
    return selected;
}

MaterialSource::MaterialSource(const Model& model, const TexturedMaterials& textured,
                               const FieldSpace& space, const std::vector<int>& edited_materials,
                               ChannelMask channels, const Region* region, at::Device device)
    : textured_(textured), space_(space), channels_(channels), region_(region) {
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

OwnMaterial MaterialSource::own(const Surface& surface) const {
    const at::NoGradGuard no_grad;
    return {textured_.sample(surface), region_ ? region_->weight(surface) : at::Tensor()};
}

MaterialSample MaterialSource::sample(const Surface& surface, NeuralTexture& field,
                                      const OwnMaterial& own) const {
    if (!channels_.any()) return own.sample;
    MaterialSample mixed = own.sample;
    const MaterialSample edited = field->forward(space_.positions(surface));
    const at::Tensor here = all_edited_ ? at::ones({1, 1}, is_edited_.options())
                                        : is_edited_.index_select(0, surface.material).unsqueeze(1);
    const auto blend = [&](const at::Tensor& was, const at::Tensor& now) {
        return own.edited.defined() ? was.lerp(now, own.edited) : now;
    };
    if (channels_.base_color)
        mixed.base_color =
            at::where(here, blend(mixed.base_color, edited.base_color), mixed.base_color);
    mixed.orm = at::where(here & orm_is_edited_, blend(mixed.orm, edited.orm), mixed.orm);
    if (channels_.normal) {
        mixed.normal = mixed.normal.defined()
                           ? at::where(here, blend(mixed.normal, edited.normal), mixed.normal)
                           : edited.normal;
    }
    return mixed;
}

at::Tensor mean_weights(const Region& region, const Geometry& geometry, const FieldSpace& space,
                        std::uint64_t seed) {
    Random random(seed, RandomStream::surface_means);
    return region.weight(SurfaceSampler(geometry, space).sample(mean_points, random)).cpu();
}

SurfaceMeans surface_means(const Model& model, const std::vector<int>& materials,
                           const at::Tensor& weights, std::uint64_t seed) {
    const at::NoGradGuard no_grad;
    const Geometry geometry = Geometry::from_model(model);
    const FieldSpace space(model, materials);
    const SurfaceSampler sampler(geometry, space);
    Random random(seed, RandomStream::surface_means);
    const MaterialSample sample =
        TexturedMaterials(model).sample(sampler.sample(mean_points, random));
    const auto mean = [&](const at::Tensor& values) {
        return weights.defined() ? (values * weights).sum(0) / weights.sum() : values.mean(0);
    };
    const at::Tensor color = mean(sample.base_color).contiguous();
    const at::Tensor orm = mean(sample.orm).contiguous();
    const float* rgb = color.data_ptr<float>();
    const float* values = orm.data_ptr<float>();
    return {Vec3(rgb[0], rgb[1], rgb[2]), values[1], values[2]};
}

}  // namespace item3d
