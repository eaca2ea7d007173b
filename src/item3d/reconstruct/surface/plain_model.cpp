#include "item3d/reconstruct/surface/plain_model.h"

#include "item3d/field/atlas/atlas.h"
#include "item3d/io/load.h"
#include "item3d/scene/far_origin.h"

namespace item3d {

Model plain_model(const at::Tensor& positions_, const at::Tensor& triangles_) {
    const at::Tensor positions = positions_.detach().contiguous();
    const at::Tensor triangles = triangles_.contiguous();
    Model model;
    model.name = "model";
    Primitive primitive;
    primitive.name = "surface";
    const float* p = positions.const_data_ptr<float>();
    for (std::int64_t v = 0; v < positions.size(0); ++v, p += 3)
        primitive.positions.emplace_back(p[0], p[1], p[2]);
    const std::int64_t* t = triangles.const_data_ptr<std::int64_t>();
    for (std::int64_t i = 0; i < triangles.numel(); ++i)
        primitive.indices.push_back(static_cast<std::uint32_t>(t[i]));
    compute_smooth_normals(primitive);
    model.primitives.push_back(std::move(primitive));
    model.materials.emplace_back();
    model.materials.back().name = "surface";
    return model;
}

Model load_plain_model(const std::filesystem::path& path) {
    Model source = load_model(path);
    move_origin(source, glm::dvec3(0.0));  // back to the frame of the dataset's cameras
    Model model;
    model.name = "model";
    Primitive joined;
    joined.name = "surface";
    bool has_uvs = true;
    for (const Primitive& part : source.primitives) {
        const auto first = static_cast<std::uint32_t>(joined.positions.size());
        has_uvs = has_uvs && part.uvs.size() == part.positions.size();
        joined.positions.insert(joined.positions.end(), part.positions.begin(),
                                part.positions.end());
        joined.normals.insert(joined.normals.end(), part.normals.begin(), part.normals.end());
        joined.uvs.insert(joined.uvs.end(), part.uvs.begin(), part.uvs.end());
        for (const std::uint32_t index : part.indices)
            joined.indices.push_back(first + index);
    }
    if (!has_uvs) joined.uvs.clear();
    model.primitives.push_back(std::move(joined));
    model.materials.emplace_back();
    model.materials.back().name = "surface";
    return model;
}

int texture_size_for(const Model& model, float pixel) {
    constexpr double texels_a_pixel = 2.5, used_share = 0.6;
    double area = 0;
    for (const Primitive& primitive : model.primitives) {
        for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
            const auto corner = [&](std::size_t k) {
                return primitive.positions[primitive.indices[i + k]];
            };
            area += 0.5 * static_cast<double>(glm::length(
                              glm::cross(corner(1) - corner(0), corner(2) - corner(0))));
        }
    }
    const double side = texels_a_pixel * std::sqrt(area / used_share) / static_cast<double>(pixel);
    int size = 1024;
    while (size < 4096 && side > std::sqrt(2.0) * size)
        size *= 2;
    return size;
}

Model unwrapped(Model model, int texture_size) {
    const FieldSpace space(model, {0});
    const Atlas atlas = make_atlas(model, space, {0}, texture_size);
    if (!atlas.sets.front().is_own())
        model.primitives[0] = apply(atlas.primitives.at(0), model.primitives[0]);
    return model;
}

NeuralTexture constant_field(const NeuralTextureOptions& options) {
    const at::NoGradGuard no_gradient;
    NeuralTexture field(options);
    for (const at::Tensor& parameter : field->network_parameters())
        parameter.zero_();
    return field;
}

void set_constant_material(Model& model, const MaterialRanges& ranges) {
    const auto middle = [](const std::array<float, 2>& range) {
        return 0.5f * (range[0] + range[1]);
    };
    Material& material = model.materials.front();
    const float base_color = srgb_to_linear(middle(ranges.base_color));
    material.base_color_factor = Vec4(base_color, base_color, base_color, 1);
    material.roughness_factor = middle(ranges.roughness);
    material.metallic_factor = middle(ranges.metallic);
}

}  // namespace item3d
