#include "item3d/render/textured_materials.h"

#include "item3d/core/error.h"
#include "item3d/core/math.h"
#include "item3d/core/parallel.h"
#include "item3d/render/srgb.h"
#include "item3d/render/texture.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace item3d {
namespace {

/// The texture of one material property, reduced to the channels of that property.
struct MaterialTexture {
    std::vector<at::Tensor> levels;  ///< [H, W, C] and its mip levels; empty if there is no texture
    Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
    bool nearest = false;
    std::size_t map = 0;  ///< as in Material: 0 for Surface::uv, k for Surface::further_uvs[k - 1]

    bool defined() const { return !levels.empty(); }
    at::Tensor at(const Surface& surface) const {
        if (map == 0)
            return sample_texture(levels, surface.uv, surface.uv_footprint, wrap_u, wrap_v,
                                  nearest);
        ITEM3D_CHECK(map <= surface.further_uvs.size(),
                     "TexturedMaterials: a surface with the UV maps of its model");
        const auto& footprints = surface.further_uv_footprints;
        return sample_texture(levels, surface.further_uvs[map - 1],
                              footprints.empty() ? at::Tensor() : footprints[map - 1], wrap_u,
                              wrap_v, nearest);
    }
};

/// Decoder of sRGB to linear light. A table holds the 256 values of 8-bit images, because computing
/// a power for each of the 200 million values of an 8K texture would take seconds.
class SrgbDecoder {
  public:
    SrgbDecoder() {
        for (std::size_t i = 0; i < table_.size(); ++i)
            table_[i] = srgb_to_linear(byte_value(i));
    }
    float operator()(float encoded) const {
        if (encoded >= 0 && encoded <= 1) {
            const auto nearest = static_cast<std::size_t>(encoded * 255 + 0.5f);
            if (byte_value(nearest) == encoded) return table_[nearest];
        }
        return srgb_to_linear(encoded);
    }

  private:
    static float byte_value(std::size_t byte) { return static_cast<float>(byte) / 255.0f; }
    std::array<float, 256> table_;
};

/// Returns linear texels [H, W, channels], which are computed in one pass. channels: 3 or 4. A grey
/// image fills all colour channels; a missing alpha is 1.
at::Tensor linear_texels(const Image& image, int channels, bool srgb) {
    at::Tensor texels = at::empty({image.height, image.width, channels}, at::kFloat);
    const int have = image.channels;
    const int alpha = have == 2 ? 1 : (have >= 4 ? 3 : -1);
    const SrgbDecoder decoder;
    const float* in = image.pixels.data();
    float* out = texels.data_ptr<float>();
    parallel_for(
        "linear_texels", static_cast<std::int64_t>(image.width) * image.height,
        [=, &decoder](std::int64_t i) {
            const float* pixel = in + i * have;
            float* texel = out + i * channels;
            for (int c = 0; c < 3; ++c) {
                const float value = pixel[have >= 3 ? c : 0];
                texel[c] = srgb ? decoder(value) : value;
            }
            if (channels == 4) texel[3] = alpha < 0 ? 1.0f : pixel[alpha];
        },
        65536);
    return texels;
}

MaterialTexture load_texture(const Model& model, int index, int map, int channels, bool srgb,
                             at::Device device) {
    MaterialTexture texture;
    texture.map = static_cast<std::size_t>(map);
    if (index < 0 || index >= static_cast<int>(model.textures.size())) return texture;
    const Texture& source = model.textures[static_cast<std::size_t>(index)];
    if (source.image.empty()) return texture;
    texture.levels = texture_pyramid(linear_texels(source.image, channels, srgb).to(device));
    texture.wrap_u = source.wrap_u;
    texture.wrap_v = source.wrap_v;
    texture.nearest = source.nearest;
    return texture;
}

at::Tensor row(std::initializer_list<float> values, at::Device device) {
    return at::tensor(std::vector<float>(values)).to(device);
}

/// A material's factors as tensors, which are copied to the device once.
struct FactorRows {
    at::Tensor base_color;          ///< [4]
    at::Tensor roughness_metallic;  ///< [2]
    at::Tensor normal_scale;        ///< [3]
    at::Tensor emissive;            ///< [3]

    FactorRows(const Material& material, at::Device device)
        : base_color(row({material.base_color_factor.x, material.base_color_factor.y,
                          material.base_color_factor.z, material.base_color_factor.w},
                         device)),
          roughness_metallic(row({material.roughness_factor, material.metallic_factor}, device)),
          normal_scale(row({material.normal_scale, material.normal_scale, 1}, device)),
          emissive(row(
              {material.emissive_factor.x, material.emissive_factor.y, material.emissive_factor.z},
              device)) {}
};

struct MaterialTextures {
    Material factors;
    FactorRows rows;
    MaterialTexture base_color, metallic_roughness, occlusion, normal, emissive;
    bool emits() const {
        return factors.unlit || std::max({factors.emissive_factor.x, factors.emissive_factor.y,
                                          factors.emissive_factor.z}) > 0;
    }
    bool transparent() const { return factors.alpha != Material::Alpha::opaque; }
};

}  // namespace

struct TexturedMaterials::State {
    std::vector<MaterialTextures> materials;
    at::Tensor flat_normal;  ///< [3] for materials without a normal texture
    at::Tensor unlit_orm;    ///< [3] factor of orm that removes all reflection from a material
    bool any_normal = false, any_emissive = false, any_alpha = false;

    /// Samples one material at all points of a surface; reads only its UVs, footprints and colours.
    MaterialSample sample_one(const MaterialTextures& material, const Surface& surface) const;
};

TexturedMaterials::TexturedMaterials(const Model& model, at::Device device) {
    const at::NoGradGuard no_gradient;
    auto state = std::make_shared<State>();
    state->flat_normal = row({0, 0, 1}, device);
    state->unlit_orm = row({0, 1, 1}, device);
    for (const Material& material : model.materials) {
        MaterialTextures textures{material, FactorRows(material, device), {}, {}, {}, {}, {}};
        textures.base_color = load_texture(model, material.base_color_texture, 0, 4, true, device);
        textures.metallic_roughness =
            load_texture(model, material.metallic_roughness_texture,
                         material.metallic_roughness_uvs, 3, false, device);
        textures.occlusion = load_texture(model, material.occlusion_texture, material.occlusion_uvs,
                                          3, false, device);
        textures.normal =
            load_texture(model, material.normal_texture, material.normal_uvs, 3, false, device);
        textures.emissive =
            load_texture(model, material.emissive_texture, material.emissive_uvs, 3, true, device);
        state->any_normal = state->any_normal || textures.normal.defined();
        state->any_emissive = state->any_emissive || textures.emits();
        state->any_alpha = state->any_alpha || textures.transparent();
        state->materials.push_back(std::move(textures));
    }
    state_ = std::move(state);
}

bool TexturedMaterials::has_alpha() const {
    return state_->any_alpha;
}

MaterialSample TexturedMaterials::State::sample_one(const MaterialTextures& material,
                                                    const Surface& surface) const {
    const Material& factors = material.factors;
    const FactorRows& rows = material.rows;
    const std::int64_t count = surface.uv.size(0);

    at::Tensor base_color = surface.color * rows.base_color;
    if (material.base_color.defined()) base_color = base_color * material.base_color.at(surface);

    MaterialSample sample;
    sample.base_color = base_color.narrow(1, 0, 3).clamp(0, 1);
    at::Tensor roughness_metallic = rows.roughness_metallic.expand({count, 2});
    if (material.metallic_roughness.defined())
        roughness_metallic =
            roughness_metallic * material.metallic_roughness.at(surface).narrow(1, 1, 2);
    at::Tensor occlusion = at::ones({count, 1}, surface.uv.options());
    if (material.occlusion.defined())
        occlusion =
            1 + factors.occlusion_strength * (material.occlusion.at(surface).narrow(1, 0, 1) - 1);
    sample.orm = at::cat({occlusion, roughness_metallic}, 1).clamp(0, 1);

    if (any_normal) {
        if (material.normal.defined()) {
            const at::Tensor normal = (2 * material.normal.at(surface) - 1) * rows.normal_scale;
            sample.normal = normal / normal.norm(2, 1, true).clamp_min(1e-6f);
        } else {
            sample.normal = flat_normal.expand({count, 3});
        }
    }
    if (factors.unlit) {
        // An unlit material emits its base colour and reflects nothing.
        sample.emissive = sample.base_color;
        sample.orm = sample.orm * unlit_orm;
    } else if (any_emissive) {
        sample.emissive = rows.emissive.expand({count, 3});
        if (material.emissive.defined())
            sample.emissive = sample.emissive * material.emissive.at(surface);
    }
    if (any_alpha) {
        const at::Tensor alpha = base_color.select(1, 3);
        if (factors.alpha == Material::Alpha::mask)
            sample.alpha = (alpha >= factors.alpha_cutoff).to(at::kFloat);
        else if (factors.alpha == Material::Alpha::blend)
            sample.alpha = alpha.clamp(0, 1);
        else
            sample.alpha = at::ones_like(alpha);
    }
    return sample;
}

MaterialSample TexturedMaterials::sample(const Surface& surface) const {
    const std::size_t materials = state_->materials.size();
    ITEM3D_CHECK(materials > 0, "TexturedMaterials: a model with at least one material");
    if (materials == 1) return state_->sample_one(state_->materials[0], surface);

    // Samples each point from its own material, then scatters the results.
    std::vector<MaterialSample> parts;
    std::vector<at::Tensor> places;
    for (std::size_t m = 0; m < materials; ++m) {
        const at::Tensor place =
            (surface.material == static_cast<std::int64_t>(m)).nonzero().squeeze(1);
        if (place.size(0) == 0 && !(parts.empty() && m + 1 == materials)) continue;
        places.push_back(place);
        Surface part;
        part.uv = surface.uv.index_select(0, place);
        part.color = surface.color.index_select(0, place);
        if (surface.uv_footprint.defined())
            part.uv_footprint = surface.uv_footprint.index_select(0, place);
        for (const at::Tensor& further : surface.further_uvs)
            part.further_uvs.push_back(further.index_select(0, place));
        for (const at::Tensor& further : surface.further_uv_footprints)
            part.further_uv_footprints.push_back(further.index_select(0, place));
        parts.push_back(state_->sample_one(state_->materials[m], part));
    }
    const at::Tensor order = at::argsort(at::cat(places));
    const auto gather = [&](at::Tensor MaterialSample::*member) -> at::Tensor {
        if (!(parts[0].*member).defined()) return {};
        std::vector<at::Tensor> values;
        for (const MaterialSample& part : parts)
            values.push_back(part.*member);
        return at::cat(values).index_select(0, order);
    };
    return {gather(&MaterialSample::base_color), gather(&MaterialSample::orm),
            gather(&MaterialSample::normal), gather(&MaterialSample::emissive),
            gather(&MaterialSample::alpha)};
}

}  // namespace item3d
