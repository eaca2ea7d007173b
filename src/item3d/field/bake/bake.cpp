#include "item3d/field/bake/bake.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/field/bake/fill.h"
#include "item3d/field/bake/residual_gain.h"
#include "item3d/field/bake/shrink.h"
#include "item3d/field/bake/texel_values.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace item3d {
namespace {

const Vec3 luminance_weights(0.2126f, 0.7152f, 0.0722f);

Vec3 encode_srgb(Vec3 linear) {
    return Vec3(linear_to_srgb(linear.x), linear_to_srgb(linear.y), linear_to_srgb(linear.z));
}

Vec3 clamp_unit(Vec3 value) {
    return glm::clamp(value, 0.0f, 1.0f);
}

/// One image of a material while it is baked.
struct Slot {
    Image image;
    std::vector<std::uint8_t> covered;
    /// Bit c: channel c is baked or resampled, so texels beyond the triangles are filled too.
    unsigned filled_channels = 0;

    void open(int width, int height, int channels) {
        image = Image(width, height, channels);
        covered.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0);
    }
    void cover(int x, int y) {
        covered[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                static_cast<std::size_t>(x)] = 1;
    }
};

/// Bakes the images of one material.
class MaterialBaker {
  public:
    MaterialBaker(const BakeScene& scene, int material, const BakeOptions& options)
        : scene_(scene),
          options_(options),
          index_(material),
          material_(scene.model.materials[static_cast<std::size_t>(material)]),
          is_own_(scene.atlas.is_own(material)) {
        for (const Primitive& primitive : scene.model.primitives) {
            if (primitive.material != material) continue;
            has_uvs_ = has_uvs_ && !primitive.uvs.empty();
            for (const Vec4& color : primitive.colors) {
                has_vertex_colors_ = has_vertex_colors_ || Vec3(color) != Vec3(1.0f);
                has_vertex_alpha_ = has_vertex_alpha_ || color.w != 1.0f;
            }
        }
    }

    MaterialEdit run(NeuralTexture& fitted, NeuralTexture& now, Progress* progress);

  private:
    using Size = std::pair<int, int>;

    const Texture* texture(int index) const {
        return index >= 0 ? &scene_.model.textures[static_cast<std::size_t>(index)] : nullptr;
    }
    /// Without a size from the user each image keeps its own.
    Size slot_size(int own_texture) const {
        const Texture* own = texture(own_texture);
        if (options_.texture_size > 0 || !is_own_ || own == nullptr || own->image.empty()) {
            return atlas_size(scene_.model, index_, options_.texture_size, !is_own_);
        }
        const double longest = std::max(own->image.width, own->image.height);
        const double scale = std::min(1.0, 4096.0 / longest);
        return {std::max(1, static_cast<int>(std::lround(own->image.width * scale))),
                std::max(1, static_cast<int>(std::lround(own->image.height * scale)))};
    }
    /// The source image if its texels are the baked image's texels.
    const Image* texels_of(int texture_index, int uvs, Size size) const {
        const Texture* own = texture(texture_index);
        const bool same = own != nullptr && is_own_ && uvs == 0 && own->image.width == size.first &&
                          own->image.height == size.second;
        return same ? &own->image : nullptr;
    }
    /// Whether no image of this size is resampled from the source.
    bool copies_texels(Size size) const {
        const auto is_copied = [&](bool wanted, Size own, const Image* texels, int source) {
            return !wanted || own != size || texels != nullptr || texture(source) == nullptr;
        };
        return !has_vertex_colors_ && !has_vertex_alpha_ &&
               is_copied(wants_base_color_, base_color_size_, base_color_texels_,
                         material_.base_color_texture) &&
               is_copied(wants_orm_, orm_size_, orm_texels_,
                         material_.metallic_roughness_texture) &&
               is_copied(wants_orm_, orm_size_, occlusion_texels_, material_.occlusion_texture) &&
               is_copied(wants_normal_, normal_size_, normal_texels_, material_.normal_texture);
    }
    void plan();
    void start_base_color();
    void start_orm();
    void start_normal();
    void write_base_color(const TexelValue& texel, const RemainderGain& gain);
    void write_orm(const TexelValue& texel);
    void write_normal(const TexelValue& texel);

    const BakeScene& scene_;
    const BakeOptions& options_;
    int index_;
    const Material& material_;
    bool is_own_;
    bool has_uvs_ = true;
    bool has_vertex_colors_ = false, has_vertex_alpha_ = false;
    bool wants_base_color_ = false, wants_orm_ = false, wants_normal_ = false;
    bool normal_changed_ = false;
    bool keeps_occlusion_ = false;
    Size base_color_size_, orm_size_, normal_size_;
    Slot base_color_, orm_, normal_;
    /// Source texels to copy; null: samples are used.
    const Image* base_color_texels_ = nullptr;
    const Image* orm_texels_ = nullptr;
    const Image* occlusion_texels_ = nullptr;
    const Image* normal_texels_ = nullptr;
};

void MaterialBaker::plan() {
    const BakedChannels& edited = options_.channels;
    wants_base_color_ = edited.base_color;
    wants_orm_ = edited.occlusion || edited.roughness || edited.metallic;
    // Tangent space needs a UV map in the source: without one the field's normals mean nothing.
    wants_normal_ = edited.normal && has_uvs_;
    base_color_size_ = slot_size(material_.base_color_texture);
    // Occlusion with a UV map of its own stays in its own picture: the others may repeat.
    keeps_occlusion_ =
        material_.occlusion_texture >= 0 && material_.occlusion_uvs != 0 && !edited.occlusion;
    // One image takes two slots' channels; it has the texels of one that must not change.
    const bool occlusion_rules =
        !keeps_occlusion_ && (material_.metallic_roughness_texture < 0 ||
                              (material_.occlusion_texture >= 0 && !edited.occlusion &&
                               edited.roughness && edited.metallic));
    orm_size_ = slot_size(occlusion_rules ? material_.occlusion_texture
                                          : material_.metallic_roughness_texture);
    normal_size_ = slot_size(material_.normal_texture);
    if (wants_base_color_) start_base_color();
    if (wants_orm_) start_orm();
    if (wants_normal_) start_normal();
}

void MaterialBaker::start_base_color() {
    base_color_texels_ = texels_of(material_.base_color_texture, 0, base_color_size_);
    if (has_vertex_colors_ || has_vertex_alpha_) base_color_texels_ = nullptr;
    const Texture* source = texture(material_.base_color_texture);
    // Without, the alpha factor stays a factor.
    const bool has_alpha =
        has_vertex_alpha_ || (source != nullptr && source->image.channels % 2 == 0);
    const auto [width, height] = base_color_size_;
    base_color_.open(width, height, has_alpha ? 4 : 3);
    base_color_.filled_channels = is_own_ && base_color_texels_ != nullptr ? 0u : ~0u;
    if (base_color_texels_ == nullptr) return;
    const Image& texels = *base_color_texels_;
    const Vec4 factor = material_.base_color_factor;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            for (int c = 0; c < 3; ++c) {
                const float value = texels.at(x, y, texels.channels >= 3 ? c : 0);
                base_color_.image.at(x, y, c) =
                    factor[c] == 1.0f ? value : linear_to_srgb(srgb_to_linear(value) * factor[c]);
            }
            if (!has_alpha) continue;
            base_color_.image.at(x, y, 3) =
                factor.w * (texels.channels % 2 == 0 ? texels.at(x, y, texels.channels - 1) : 1.0f);
        }
    }
}

void MaterialBaker::start_orm() {
    const auto [width, height] = orm_size_;
    orm_.open(width, height, 3);
    orm_texels_ = texels_of(material_.metallic_roughness_texture, material_.metallic_roughness_uvs,
                            orm_size_);
    occlusion_texels_ = texels_of(material_.occlusion_texture, material_.occlusion_uvs, orm_size_);
    if (orm_texels_ != nullptr && orm_texels_->channels < 3) orm_texels_ = nullptr;
    // Where the material has no occlusion red is 1: other values would switch it on.
    const bool fills_occlusion =
        occlusion_texels_ == nullptr && material_.occlusion_texture >= 0 && !keeps_occlusion_;
    orm_.filled_channels = (fills_occlusion ? 1u : 0u) | (orm_texels_ != nullptr ? 0u : 6u);
    const float strength = keeps_occlusion_ ? 1.0f : material_.occlusion_strength;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            float& occlusion = orm_.image.at(x, y, 0);
            occlusion = occlusion_texels_ != nullptr ? occlusion_texels_->at(x, y, 0) : 1.0f;
            if (strength != 1.0f) occlusion = 1.0f + strength * (occlusion - 1.0f);
            if (orm_texels_ == nullptr) continue;
            orm_.image.at(x, y, 1) = orm_texels_->at(x, y, 1) * material_.roughness_factor;
            orm_.image.at(x, y, 2) = orm_texels_->at(x, y, 2) * material_.metallic_factor;
        }
    }
}

void MaterialBaker::start_normal() {
    const auto [width, height] = normal_size_;
    normal_.open(width, height, 3);
    normal_texels_ = texels_of(material_.normal_texture, material_.normal_uvs, normal_size_);
    if (normal_texels_ != nullptr &&
        (normal_texels_->channels < 3 || material_.normal_scale != 1.0f)) {
        normal_texels_ = nullptr;
    }
    normal_.filled_channels = normal_texels_ != nullptr ? 0u : 7u;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            for (int c = 0; c < 3; ++c) {
                normal_.image.at(x, y, c) = normal_texels_ != nullptr ? normal_texels_->at(x, y, c)
                                                                      : (c == 2 ? 1.0f : 0.5f);
            }
        }
    }
}

void MaterialBaker::write_base_color(const TexelValue& texel, const RemainderGain& gain) {
    Image& image = base_color_.image;
    base_color_.cover(texel.x, texel.y);
    Vec3 source;
    if (base_color_texels_ != nullptr) {
        for (int c = 0; c < 3; ++c)
            source[c] = image.at(texel.x, texel.y, c);
    } else {
        source = encode_srgb(texel.source.base_color);
        for (int c = 0; c < 3; ++c)
            image.at(texel.x, texel.y, c) = source[c];
        if (image.channels == 4) image.at(texel.x, texel.y, 3) = texel.source.alpha;
    }
    if (!options_.channels.base_color) return;
    const Vec3 fitted = encode_srgb(texel.fitted.base_color);
    const Vec3 change = encode_srgb(texel.now.base_color) - fitted;
    if (change == Vec3(0.0f)) return;
    base_color_.filled_channels |= 7u;
    const Vec3 remainder = source - fitted;
    const Vec3 chroma = remainder - Vec3(glm::dot(remainder, luminance_weights));
    const float moved = std::max({std::abs(change.x), std::abs(change.y), std::abs(change.z)});
    const float fade = glm::smoothstep(options_.chroma_fade_begin, options_.chroma_fade_end, moved);
    const Vec3 kept = gain.at(texel.x, texel.y) * (remainder - fade * chroma);
    const Vec3 baked = clamp_unit(source + change + (kept - remainder));
    for (int c = 0; c < 3; ++c)
        image.at(texel.x, texel.y, c) = baked[c];
}

void MaterialBaker::write_orm(const TexelValue& texel) {
    orm_.cover(texel.x, texel.y);
    const bool edited[3] = {options_.channels.occlusion, options_.channels.roughness,
                            options_.channels.metallic};
    for (int c = 0; c < 3; ++c) {
        float& value = orm_.image.at(texel.x, texel.y, c);
        const bool copied = c == 0 ? occlusion_texels_ != nullptr : orm_texels_ != nullptr;
        if (c == 0 && keeps_occlusion_) continue;
        if (!copied) value = texel.source.orm[c];
        const float change = texel.now.orm[c] - texel.fitted.orm[c];
        if (!edited[c] || change == 0.0f) continue;
        orm_.filled_channels |= 1u << c;
        value = std::clamp(value + change, 0.0f, 1.0f);
    }
}

void MaterialBaker::write_normal(const TexelValue& texel) {
    normal_.cover(texel.x, texel.y);
    const Vec3 change = texel.now.normal - texel.fitted.normal;
    const bool is_changed = options_.channels.normal && change != Vec3(0.0f);
    if (normal_texels_ != nullptr && !is_changed) return;
    Vec3 normal = texel.source.normal;
    if (is_changed) {
        normal += change;
        normal_changed_ = true;
        normal_.filled_channels = 7u;
    }
    const float length = glm::length(normal);
    normal = length > 1e-6f ? normal / length : Vec3(0.0f, 0.0f, 1.0f);
    for (int c = 0; c < 3; ++c)
        normal_.image.at(texel.x, texel.y, c) = 0.5f + 0.5f * normal[c];
}

MaterialEdit MaterialBaker::run(NeuralTexture& fitted, NeuralTexture& now, Progress* progress) {
    plan();
    std::vector<Size> sizes;
    const auto want = [&](bool wanted, Size size) {
        if (wanted && std::find(sizes.begin(), sizes.end(), size) == sizes.end()) {
            sizes.push_back(size);
        }
    };
    want(wants_base_color_, base_color_size_);
    want(wants_orm_, orm_size_);
    want(wants_normal_, normal_size_);
    for (std::size_t i = 0; i < sizes.size(); ++i) {
        const auto [width, height] = sizes[i];
        // Copied texels take only the sampled change, which is smooth.
        const int supersampling = copies_texels(sizes[i]) ? 1 : options_.supersampling;
        const TexelEvaluator evaluator(scene_, index_, width, height, supersampling, wants_normal_);
        std::optional<RemainderGain> gain;
        if (wants_base_color_ && base_color_size_ == sizes[i])
            gain.emplace(scene_, index_, width, height, fitted, now);
        for (int first = 0; first < height; first += evaluator.rows_at_once()) {
            const int last = std::min(height, first + evaluator.rows_at_once());
            for (const TexelValue& texel : evaluator.rows(first, last, fitted, now)) {
                if (gain) write_base_color(texel, *gain);
                if (wants_orm_ && orm_size_ == sizes[i]) write_orm(texel);
                if (wants_normal_ && normal_size_ == sizes[i]) write_normal(texel);
            }
            if (progress != nullptr) {
                progress->update(static_cast<std::int64_t>(100 * i) /
                                     static_cast<std::int64_t>(sizes.size()) +
                                 100 * last / (height * static_cast<int>(sizes.size())));
            }
            if (interrupted()) throw Interrupted("interrupted while the textures were baked");
        }
    }
    MaterialEdit edit;
    const auto finish = [&](bool wanted, Slot& slot, int source, std::optional<Image>& image) {
        if (!wanted) return;
        fill_uncovered(slot.image, slot.covered, slot.filled_channels);
        if (texture(source) != nullptr) {
            edit.bits_per_channel =
                std::max(edit.bits_per_channel, texture(source)->bits_per_channel);
        }
        // A new texture has no size of its own unless one is asked for.
        const bool holds_occlusion = &slot == &orm_ && material_.occlusion_texture >= 0;
        image = texture(source) == nullptr && !holds_occlusion && options_.texture_size == 0
                    ? shrink(std::move(slot.image), wrap_of(scene_.model, index_), options_.blotch)
                    : std::move(slot.image);
    };
    finish(wants_base_color_, base_color_, material_.base_color_texture, edit.base_color);
    finish(wants_orm_, orm_, material_.metallic_roughness_texture, edit.metallic_roughness);
    finish(wants_normal_ && normal_changed_, normal_, material_.normal_texture, edit.normal);
    const BakedChannels& edited = options_.channels;
    edit.keeps_orm_texels = (occlusion_texels_ != nullptr && !edited.occlusion) ||
                            (orm_texels_ != nullptr && !(edited.roughness && edited.metallic));
    edit.keeps_occlusion = keeps_occlusion_;
    edit.includes_vertex_colors = has_vertex_colors_ || has_vertex_alpha_;
    edit.bits_per_channel = edit.bits_per_channel > 8 ? 16 : 8;
    return edit;
}

}  // namespace

ModelEdit bake(const BakeScene& scene, NeuralTexture& fitted, NeuralTexture& now,
               const BakeOptions& options) {
    ModelEdit edit;
    edit.primitives = scene.atlas.primitives;
    for (const auto& [material, triangles] : scene.atlas.material_triangles) {
        std::optional<Progress> progress;
        if (options.show_progress) progress.emplace("bake", 100);
        edit.materials[material] = MaterialBaker(scene, material, options)
                                       .run(fitted, now, progress ? &*progress : nullptr);
    }
    return edit;
}

}  // namespace item3d
