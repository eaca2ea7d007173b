#include "item3d/field/bake/bake.h"

#include "item3d/core/progress.h"
#include "item3d/field/bake/fill.h"
#include "item3d/field/bake/keep_flat.h"
#include "item3d/field/bake/painted_color.h"
#include "item3d/field/bake/residual_gain.h"
#include "item3d/field/bake/shrink.h"
#include "item3d/field/bake/slot.h"
#include "item3d/field/bake/source_texels.h"
#include "item3d/field/bake/texel_values.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <utility>

namespace item3d {
namespace {

const Vec3 luminance_weights(0.2126f, 0.7152f, 0.0722f);
/// Longest edge with which a new texture is baked first.
constexpr int tried_edge = 256;

bool shows_alpha(const Image& image) {
    if (image.channels % 2 != 0) return false;
    const auto channels = static_cast<std::size_t>(image.channels);
    for (std::size_t i = channels - 1; i < image.pixels.size(); i += channels)
        if (image.pixels[i] < 1.0f) return true;
    return false;
}

Vec3 encode_srgb(Vec3 linear) {
    return Vec3(linear_to_srgb(linear.x), linear_to_srgb(linear.y), linear_to_srgb(linear.z));
}

Vec3 clamp_unit(Vec3 value) {
    return glm::clamp(value, 0.0f, 1.0f);
}

using Size = TextureSize;

/// Bakes the images of one texture set.
class SetBaker {
  public:
    /// unedited: may be null.
    SetBaker(const BakeScene& scene, const TextureSet& set, const BakeOptions& options,
             UneditedImages* unedited);

    /// Bakes the images. on_progress: receives the finished share.
    MaterialEdit run(NeuralTexture& fitted, NeuralTexture& now,
                     const std::function<void(double)>& on_progress);

  private:
    const Texture* texture(int index) const {
        return index >= 0 ? &scene_.model.textures[static_cast<std::size_t>(index)] : nullptr;
    }
    Size slot_size(int own_texture) const;
    const Image* texels_of(int texture_index, int uvs, Size size) const;
    bool copies_texels(Size size) const;
    bool needs_source(Size size) const;
    bool shows_source(const Slot& slot) const;
    void plan();
    void open(Slot& slot, int texture, Size size);
    void start();
    void start_base_color();
    void start_orm();
    void start_normal();
    void write_base_color(const TexelValue& texel, const ResidualGain* gain);
    void write_orm(const TexelValue& texel);
    void write_normal(const TexelValue& texel);
    void bake_wanted(NeuralTexture& fitted, NeuralTexture& now,
                     const std::function<void(double)>& on_progress);
    bool is_new(const Slot& slot) const;
    bool finish(Slot& slot, EditedTexture& edited);
    void hand_over(Slot& slot, const EditedTexture& edited);

    const BakeScene& scene_;
    const TextureSet& set_;
    const BakeOptions& options_;
    UneditedImages* unedited_;
    int index_;
    const Material& material_;
    bool in_part_;  ///< the edit has a region
    bool has_uvs_ = true;
    bool has_vertex_colors_ = false, has_vertex_alpha_ = false;
    std::atomic<bool> normal_changed_ = false;
    bool keeps_occlusion_ = false;
    Slot base_color_, orm_, normal_;
    /// Source texels to copy. If null, samples are used.
    const Image* base_color_texels_ = nullptr;
    const Image* orm_texels_ = nullptr;
    const Image* occlusion_texels_ = nullptr;
    const Image* normal_texels_ = nullptr;
    const Image* painted_ = nullptr;  ///< painted base colour; null: the fields' base colour
};

SetBaker::SetBaker(const BakeScene& scene, const TextureSet& set, const BakeOptions& options,
                   UneditedImages* unedited)
    : scene_(scene),
      set_(set),
      options_(options),
      unedited_(unedited),
      index_(set.materials.front()),
      material_(scene.model.materials[static_cast<std::size_t>(index_)]),
      in_part_(scene.weight != nullptr) {
    if (scene.painted != nullptr) painted_ = &scene.painted->at(index_);
    for (const Primitive& primitive : scene.model.primitives) {
        if (!set.has(primitive.material)) continue;
        has_uvs_ = has_uvs_ && !primitive.uvs.empty();
        for (const Vec4& color : primitive.colors) {
            has_vertex_colors_ = has_vertex_colors_ || Vec3(color) != Vec3(1.0f);
            has_vertex_alpha_ = has_vertex_alpha_ || color.w != 1.0f;
        }
    }
}

/// Returns the size of the image, which is the user's if given, else that of the source's image.
Size SetBaker::slot_size(int own_texture) const {
    const Texture* own = texture(own_texture);
    if (options_.texture_size > 0 || !set_.is_own() || own == nullptr || own->image.empty()) {
        return atlas_size(scene_.model, index_, options_.texture_size, !set_.is_own());
    }
    const double longest = std::max(own->image.width, own->image.height);
    const double scale = std::min(1.0, 4096.0 / longest);
    return {std::max(1, static_cast<int>(std::lround(own->image.width * scale))),
            std::max(1, static_cast<int>(std::lround(own->image.height * scale)))};
}

/// Returns the source image if its texels map one to one to the baked image's.
const Image* SetBaker::texels_of(int texture_index, int uvs, Size size) const {
    const Texture* own = texture(texture_index);
    const bool same = own != nullptr && set_.is_own() && uvs == 0 &&
                      own->image.width == size.first && own->image.height == size.second;
    return same ? &own->image : nullptr;
}

/// True if no image of this size is resampled from the source.
bool SetBaker::copies_texels(Size size) const {
    const auto is_copied = [&](const Slot& slot, const Image* texels, int source) {
        return !slot.is_baked_at(size) || texels != nullptr || texture(source) == nullptr;
    };
    return !has_vertex_colors_ && !has_vertex_alpha_ &&
           is_copied(base_color_, base_color_texels_, material_.base_color_texture) &&
           is_copied(orm_, orm_texels_, material_.metallic_roughness_texture) &&
           is_copied(orm_, occlusion_texels_, material_.occlusion_texture) &&
           is_copied(normal_, normal_texels_, material_.normal_texture);
}

/// True if an image of this size needs resampled values of the source.
bool SetBaker::needs_source(Size size) const {
    const auto lacks = [&](const Slot& slot, const Image* texels) {
        return slot.is_baked_at(size) && texels == nullptr;
    };
    return lacks(base_color_, base_color_texels_) || lacks(orm_, orm_texels_) ||
           (!keeps_occlusion_ && lacks(orm_, occlusion_texels_)) || lacks(normal_, normal_texels_);
}

/// True if the image without the edit equals the source's texels times the factors.
bool SetBaker::shows_source(const Slot& slot) const {
    const auto is_copied = [&](const Image* texels, int source) {
        return texels != nullptr || texture(source) == nullptr;
    };
    if (&slot == &base_color_)
        return is_copied(base_color_texels_, material_.base_color_texture) && !has_vertex_colors_ &&
               !has_vertex_alpha_;
    if (&slot == &normal_) return is_copied(normal_texels_, material_.normal_texture);
    return is_copied(orm_texels_, material_.metallic_roughness_texture) &&
           (keeps_occlusion_ || is_copied(occlusion_texels_, material_.occlusion_texture));
}

void SetBaker::open(Slot& slot, int texture_index, Size size) {
    slot.texture = texture_index;
    slot.wanted = true;
    slot.full_size = slot.size = size;
    if (!is_new(slot)) return;
    const int scale = std::max(1, std::max(size.first, size.second) / tried_edge);
    slot.size = {std::max(1, size.first / scale), std::max(1, size.second / scale)};
}

void SetBaker::plan() {
    const BakedChannels& edited = options_.channels;
    // Occlusion with its own UV map keeps its own image, because the other UV map may repeat.
    keeps_occlusion_ =
        material_.occlusion_texture >= 0 && material_.occlusion_uvs != 0 && !edited.occlusion;
    if (edited.base_color)
        open(base_color_, material_.base_color_texture, slot_size(material_.base_color_texture));
    if (edited.occlusion || edited.roughness || edited.metallic) {
        // The three share an image of the size of the texture whose channels must not change.
        const bool occlusion_rules =
            !keeps_occlusion_ && (material_.metallic_roughness_texture < 0 ||
                                  (material_.occlusion_texture >= 0 && !edited.occlusion &&
                                   edited.roughness && edited.metallic));
        open(orm_, material_.metallic_roughness_texture,
             slot_size(occlusion_rules ? material_.occlusion_texture
                                       : material_.metallic_roughness_texture));
    }
    // Without a UV map in the source there is no tangent space, and normals are undefined.
    if (edited.normal && has_uvs_)
        open(normal_, material_.normal_texture, slot_size(material_.normal_texture));
}

void SetBaker::start() {
    if (base_color_.wanted) start_base_color();
    if (orm_.wanted) start_orm();
    if (normal_.wanted) start_normal();
    for (Slot* slot : {&base_color_, &orm_, &normal_}) {
        if (slot->wanted && (in_part_ || (unedited_ != nullptr && !shows_source(*slot))))
            slot->keep_source();
    }
}

void SetBaker::start_base_color() {
    base_color_texels_ = texels_of(material_.base_color_texture, 0, base_color_.size);
    if (has_vertex_colors_ || has_vertex_alpha_) base_color_texels_ = nullptr;
    const Texture* source = texture(material_.base_color_texture);
    // Without an alpha channel, the alpha factor stays a factor.
    const bool has_alpha = (has_vertex_alpha_ && material_.alpha != Material::Alpha::opaque) ||
                           (source != nullptr && shows_alpha(source->image));
    base_color_.open(has_alpha ? 4 : 3, in_part_);
    base_color_.filled_channels = set_.is_own() && base_color_texels_ != nullptr ? 0u : ~0u;
    if (base_color_texels_ != nullptr)
        copy_base_color(*base_color_texels_, material_.base_color_factor, base_color_.image);
}

void SetBaker::start_orm() {
    orm_.open(3, in_part_);
    orm_texels_ = texels_of(material_.metallic_roughness_texture, material_.metallic_roughness_uvs,
                            orm_.size);
    occlusion_texels_ = texels_of(material_.occlusion_texture, material_.occlusion_uvs, orm_.size);
    if (orm_texels_ != nullptr && orm_texels_->channels < 3) orm_texels_ = nullptr;
    // Without an occlusion texture red stays 1, since other values would act as occlusion.
    const bool fills_occlusion =
        occlusion_texels_ == nullptr && material_.occlusion_texture >= 0 && !keeps_occlusion_;
    orm_.filled_channels = (fills_occlusion ? 1u : 0u) | (orm_texels_ != nullptr ? 0u : 6u);
    const float strength = keeps_occlusion_ ? 1.0f : material_.occlusion_strength;
    copy_orm({occlusion_texels_, orm_texels_, strength}, material_, orm_.image);
}

void SetBaker::start_normal() {
    normal_.open(3, in_part_);
    normal_texels_ = texels_of(material_.normal_texture, material_.normal_uvs, normal_.size);
    if (normal_texels_ != nullptr &&
        (normal_texels_->channels < 3 || material_.normal_scale != 1.0f)) {
        normal_texels_ = nullptr;
    }
    normal_.filled_channels = normal_texels_ != nullptr ? 0u : 7u;
    copy_normal(normal_texels_, normal_.image);
}

void SetBaker::write_base_color(const TexelValue& texel, const ResidualGain* gain) {
    Image& image = base_color_.image;
    base_color_.cover(texel.x, texel.y, texel.weight);
    Vec3 source;
    if (base_color_texels_ != nullptr) {
        for (int c = 0; c < 3; ++c)
            source[c] = image.at(texel.x, texel.y, c);
    } else {
        source = encode_srgb(texel.source.base_color);
        for (int c = 0; c < 3; ++c)
            image.at(texel.x, texel.y, c) = source[c];
        if (image.channels == 4) image.at(texel.x, texel.y, 3) = texel.source.alpha;
        for (int c = 0; !base_color_.source.empty() && c < image.channels; ++c)
            base_color_.source.at(texel.x, texel.y, c) = image.at(texel.x, texel.y, c);
    }
    if (!options_.channels.base_color) return;
    if (painted_ != nullptr) {
        base_color_.filled_channels |= 7u;
        const Vec3 painted = color_at_texel(*painted_, texel.x, texel.y, base_color_.size);
        for (int c = 0; c < 3; ++c)
            image.at(texel.x, texel.y, c) = painted[c];
        return;
    }
    const Vec3 fitted = encode_srgb(texel.fitted.base_color);
    const Vec3 change = encode_srgb(texel.now.base_color) - fitted;
    if (change == Vec3(0.0f)) return;
    base_color_.filled_channels |= 7u;
    const Vec3 remainder = source - fitted;
    const Vec3 chroma = remainder - Vec3(glm::dot(remainder, luminance_weights));
    const float moved = std::max({std::abs(change.x), std::abs(change.y), std::abs(change.z)});
    const float fade = glm::smoothstep(options_.chroma_fade_begin, options_.chroma_fade_end, moved);
    const Vec3 kept = gain->at(texel.x, texel.y) * (remainder - fade * chroma);
    const Vec3 baked = clamp_unit(source + change + (kept - remainder));
    for (int c = 0; c < 3; ++c)
        image.at(texel.x, texel.y, c) = baked[c];
}

void SetBaker::write_orm(const TexelValue& texel) {
    orm_.cover(texel.x, texel.y, texel.weight);
    const bool edited[3] = {options_.channels.occlusion, options_.channels.roughness,
                            options_.channels.metallic};
    for (int c = 0; c < 3; ++c) {
        float& value = orm_.image.at(texel.x, texel.y, c);
        const bool copied = c == 0 ? occlusion_texels_ != nullptr : orm_texels_ != nullptr;
        if (c == 0 && keeps_occlusion_) continue;
        if (!copied) value = texel.source.orm[c];
        if (!copied && !orm_.source.empty()) orm_.source.at(texel.x, texel.y, c) = value;
        const float change = texel.now.orm[c] - texel.fitted.orm[c];
        if (!edited[c] || change == 0.0f) continue;
        orm_.filled_channels |= 1u << c;
        value = std::clamp(value + change, 0.0f, 1.0f);
    }
}

void SetBaker::write_normal(const TexelValue& texel) {
    normal_.cover(texel.x, texel.y, texel.weight);
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
    for (int c = 0; c < 3; ++c) {
        normal_.image.at(texel.x, texel.y, c) = 0.5f + 0.5f * normal[c];
        if (!normal_.source.empty() && normal_texels_ == nullptr)
            normal_.source.at(texel.x, texel.y, c) = 0.5f + 0.5f * texel.source.normal[c];
    }
}

void SetBaker::bake_wanted(NeuralTexture& fitted, NeuralTexture& now,
                           const std::function<void(double)>& on_progress) {
    std::vector<Size> sizes;
    for (const Slot* slot : {&base_color_, &orm_, &normal_}) {
        if (slot->wanted && std::find(sizes.begin(), sizes.end(), slot->size) == sizes.end())
            sizes.push_back(slot->size);
    }
    for (std::size_t i = 0; i < sizes.size(); ++i) {
        const auto [width, height] = sizes[i];
        // Where texels are copied, only the smooth change is sampled, so one sample suffices.
        const int samples = copies_texels(sizes[i]) ? 1 : options_.supersampling;
        const TexelEvaluator evaluator(
            scene_, set_, width, height, samples,
            {.source = needs_source(sizes[i]), .normals = normal_.is_baked_at(sizes[i])});
        std::optional<ResidualGain> gain;
        if (base_color_.is_baked_at(sizes[i]) && painted_ == nullptr)
            gain.emplace(scene_, set_, width, height, fitted, now);
        const auto write = [&](const std::vector<TexelValue>& texels) {
            for (const TexelValue& texel : texels) {
                if (base_color_.is_baked_at(sizes[i]))
                    write_base_color(texel, gain ? &*gain : nullptr);
                if (orm_.is_baked_at(sizes[i])) write_orm(texel);
                if (normal_.is_baked_at(sizes[i])) write_normal(texel);
            }
        };
        evaluator.for_rows(fitted, now, write, [&](double share) {
            on_progress((static_cast<double>(i) + share) / static_cast<double>(sizes.size()));
        });
    }
}

/// True for a texture that the source lacks and whose size is not requested.
bool SetBaker::is_new(const Slot& slot) const {
    const bool holds_occlusion = &slot == &orm_ && material_.occlusion_texture >= 0;
    return texture(slot.texture) == nullptr && !holds_occlusion && options_.texture_size == 0 &&
           !in_part_;
}

/// Returns false if the tried size was too small for the texture's content.
bool SetBaker::finish(Slot& slot, EditedTexture& edited) {
    const Image* texels = &slot == &base_color_ ? base_color_texels_ : orm_texels_;
    if (texels != nullptr && &slot != &normal_ && !(painted_ && &slot == &base_color_))
        keep_flat(slot.image, *texels, slot.covered, slot.filled_channels, options_.blotch);
    const bool hides = slot.image.channels == 4 && material_.alpha != Material::Alpha::opaque;
    (hides ? fill_invisible : fill_uncovered)(slot.image, slot.covered, slot.filled_channels,
                                              texture_padding);
    const bool is_copied = &slot == &base_color_ ? base_color_texels_ != nullptr
                           : &slot == &orm_      ? orm_texels_ != nullptr
                                                 : normal_texels_ != nullptr;
    slot.blend_with_source(is_copied, texture_padding);
    Image image = std::move(slot.image);
    if (is_new(slot)) {
        image = shrink(std::move(image), wrap_of(scene_.model, index_), options_.blotch);
        if (slot.size != slot.full_size && image.width == slot.size.first) return false;
    }
    const int bits = texture(slot.texture) != nullptr ? texture(slot.texture)->bits_per_channel : 8;
    edited = EditedTexture(std::move(image), bits > 8 ? 16 : 8);
    return true;
}

/// Gives the images without the edit, and the weight, to the caller.
void SetBaker::hand_over(Slot& slot, const EditedTexture& edited) {
    if (unedited_ == nullptr || !edited) return;
    Image& image = &slot == &base_color_ ? unedited_->base_color
                   : &slot == &orm_      ? unedited_->metallic_roughness
                                         : unedited_->normal;
    if (!shows_source(slot)) image = halved_to(std::move(slot.source), *edited);
    if (unedited_->weight.empty()) unedited_->weight = std::move(slot.weight);
}

MaterialEdit SetBaker::run(NeuralTexture& fitted, NeuralTexture& now,
                           const std::function<void(double)>& on_progress) {
    MaterialEdit edit;
    plan();
    bool is_done = false;
    while (!is_done) {
        is_done = true;
        start();
        bake_wanted(fitted, now, on_progress);
        const auto take = [&](Slot& slot, EditedTexture& edited) {
            if (!slot.wanted) return;
            slot.wanted = (&slot != &normal_ || normal_changed_) && !finish(slot, edited);
            hand_over(slot, edited);
            slot.size = slot.full_size;
            is_done = is_done && !slot.wanted;
        };
        take(base_color_, edit.base_color);
        take(orm_, edit.metallic_roughness);
        take(normal_, edit.normal);
    }
    const BakedChannels& edited = options_.channels;
    edit.keeps_orm_texels =
        (material_.occlusion_texture >= 0 && !keeps_occlusion_ && !edited.occlusion) ||
        (material_.metallic_roughness_texture >= 0 && !(edited.roughness && edited.metallic));
    edit.keeps_occlusion = keeps_occlusion_;
    edit.keeps_texels = in_part_;
    edit.includes_vertex_colors = has_vertex_colors_ || has_vertex_alpha_;
    return edit;
}

}  // namespace

ModelEdit bake(const BakeScene& scene, NeuralTexture& fitted, NeuralTexture& now,
               const BakeOptions& options, std::map<int, UneditedImages>* unedited) {
    ModelEdit edit;
    edit.primitives = scene.atlas.primitives;
    std::optional<Progress> progress;
    if (options.show_progress) progress.emplace("bake", 100);
    const auto count = static_cast<double>(scene.atlas.sets.size());
    for (std::size_t i = 0; i < scene.atlas.sets.size(); ++i) {
        const TextureSet& set = scene.atlas.sets[i];
        const MaterialEdit baked =
            SetBaker(scene, set, options, unedited ? &(*unedited)[set.materials.front()] : nullptr)
                .run(fitted, now, [&](double share) {
                    if (progress)
                        progress->update(
                            std::lround(100 * (static_cast<double>(i) + share) / count));
                });
        for (const int material : set.materials)
            edit.materials[material] = baked;
    }
    return edit;
}

}  // namespace item3d
