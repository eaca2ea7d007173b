#include "item3d/edit/optimize/live_textures.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/core/replace_file.h"
#include "item3d/field/atlas/uv_raster.h"
#include "item3d/field/surface_points.h"
#include "item3d/guidance/noised_latents.h"
#include "item3d/io/texture_format.h"
#include "item3d/render/srgb.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <tuple>

namespace item3d {
namespace {

using Json = nlohmann::json;

constexpr int live_edge = 256;  ///< texels along the longest edge
constexpr double seconds_between_looks = 1;
constexpr double seconds_to_first_look = 0.3;
/// Ratio of the pause between two updates to the duration of an update.
constexpr double rest = 25;
constexpr std::size_t max_direction_values = 200;

/// The covered texels of a texture set, in the order of the image, with their surface points.
struct CoveredTexels {
    std::vector<std::int64_t> triangle;
    std::vector<float> barycentrics;
    /// Has, for each texel of the image, the index of the nearest covered texel.
    std::vector<std::int64_t> shown;
};

CoveredTexels covered_texels(const EditScene& scene, const TextureSet& set, int width, int height) {
    std::vector<UvTriangle> triangles;
    for (const std::int32_t triangle : set.triangles)
        triangles.push_back(scene.atlas.triangles[static_cast<std::size_t>(triangle)]);
    UvRaster raster =
        rasterize_uv(triangles, width, height, wrap_of(scene.model, set.materials.front()));
    if (!set.shared.empty()) claim_texels(raster, triangles);
    CoveredTexels texels;
    texels.shown.assign(raster.owners.size(), -1);
    std::vector<std::int64_t> border;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const std::int32_t triangle = raster.at(x, y);
            if (triangle < 0) continue;
            const auto at = static_cast<std::int64_t>(y) * width + x;
            texels.shown[static_cast<std::size_t>(at)] =
                static_cast<std::int64_t>(texels.triangle.size());
            border.push_back(at);
            texels.triangle.push_back(set.triangles[static_cast<std::size_t>(triangle)]);
            const Vec2 weights =
                uv_barycentrics(triangles[static_cast<std::size_t>(triangle)], raster.uv_at(x, y));
            texels.barycentrics.insert(texels.barycentrics.end(), {weights.x, weights.y});
        }
    // Dilates the covered texels over the whole image, breadth first.
    for (std::size_t i = 0; i < border.size(); ++i) {
        const std::int64_t x = border[i] % width, y = border[i] / width;
        for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
            if (x + dx < 0 || x + dx >= width || y + dy < 0 || y + dy >= height) continue;
            const std::int64_t beside = border[i] + dy * width + dx;
            if (texels.shown[static_cast<std::size_t>(beside)] >= 0) continue;
            texels.shown[static_cast<std::size_t>(beside)] =
                texels.shown[static_cast<std::size_t>(border[i])];
            border.push_back(beside);
        }
    }
    return texels;
}

/// Returns the size of the base colour's texture, or of a square if there is no texture. The size
/// is reduced so that its longer edge is at most live_edge.
std::pair<int, int> live_size(const Model& model, int material) {
    auto [width, height] = atlas_size(model, material, 0);
    const double scale = std::min(1.0, static_cast<double>(live_edge) / std::max(width, height));
    return {std::max(1, static_cast<int>(std::lround(width * scale))),
            std::max(1, static_cast<int>(std::lround(height * scale)))};
}

/// Returns [6] with 1 for the edited channels of base colour (3), occlusion, roughness and
/// metallic.
at::Tensor edited_channels(const ChannelMask& channels, const at::TensorOptions& options) {
    const float color = channels.base_color ? 1.0f : 0.0f;
    return at::tensor({color, color, color, channels.occlusion ? 1.0f : 0.0f,
                       channels.roughness ? 1.0f : 0.0f, channels.metallic ? 1.0f : 0.0f},
                      options);
}

}  // namespace

struct LiveTextures::Set {
    std::vector<int> materials;
    int width = 0, height = 0;
    at::Tensor shown;      ///< [width * height] int64, rows of the tensors below
    at::Tensor positions;  ///< [P, 3] in the field's space
    at::Tensor weight;     ///< [P, 1] weight of the edit; undefined: 1 everywhere
    at::Tensor channels;   ///< [6] 1 for edited channels
    at::Tensor source;     ///< [P, 6] sRGB-encoded base colour, orm
    at::Tensor alpha;      ///< [P, 1]; undefined: opaque
    at::Tensor fitted;     ///< [P, 6]
};

struct LiveTextures::Images {
    std::vector<int> materials;
    Image base_color, orm;
};

LiveTextures::LiveTextures(std::filesystem::path folder, const EditScene& scene,
                           NeuralTexture& fitted)
    : folder_(std::move(folder)), scene_(scene), fitted_(fitted) {
    next_ = seconds_now() + seconds_to_first_look;
}

LiveTextures::~LiveTextures() {
    if (writing_.valid()) writing_.wait();
}

/// Computes the tensors that stay constant during the edit.
void LiveTextures::prepare(NeuralTexture& fitted) {
    const at::Device device = scene_.geometry.positions.device();
    for (const TextureSet& texture_set : scene_.atlas.sets) {
        if (!texture_set.is_own() || texture_set.triangles.empty()) continue;
        Set set;
        set.materials = texture_set.materials;
        std::tie(set.width, set.height) = live_size(scene_.model, set.materials.front());
        const CoveredTexels texels = covered_texels(scene_, texture_set, set.width, set.height);
        const auto count = static_cast<std::int64_t>(texels.triangle.size());
        if (count == 0) continue;
        const at::Tensor triangle = at::tensor(texels.triangle).to(device);
        const at::Tensor barycentrics = at::tensor(texels.barycentrics).view({count, 2}).to(device);
        const Surface surface = surface_at(scene_.geometry, triangle, barycentrics);
        set.shown = at::tensor(texels.shown).to(device);
        set.positions = scene_.space->positions(surface);
        if (scene_.region) set.weight = scene_.region->weight(surface);
        const MaterialSample sample = scene_.textured->sample(surface);
        set.source = at::cat({linear_to_srgb(sample.base_color.clamp(0, 1)), sample.orm}, 1);
        const Material& material =
            scene_.model.materials[static_cast<std::size_t>(set.materials.front())];
        if (sample.alpha.defined() && material.alpha != Material::Alpha::opaque)
            set.alpha = sample.alpha.unsqueeze(1);
        set.channels = edited_channels(scene_.start.channels, set.source.options());
        set.fitted = fitted->encoded(set.positions).narrow(1, 0, 6);
        sets_.push_back(std::move(set));
    }
}

std::vector<LiveTextures::Images> LiveTextures::draw(NeuralTexture field) const {
    std::vector<Images> all;
    for (const Set& set : sets_) {
        at::Tensor change = (field->encoded(set.positions).narrow(1, 0, 6) - set.fitted);
        change = change * set.channels;
        if (set.weight.defined()) change = change * set.weight;
        const at::Tensor values = (set.source + change).clamp(0, 1);
        at::Tensor color = values.narrow(1, 0, 3);
        if (set.alpha.defined()) color = at::cat({color, set.alpha}, 1);
        const auto image_of = [&](const at::Tensor& texels) {
            const at::Tensor rows = texels.index_select(0, set.shown).cpu().contiguous();
            Image image(set.width, set.height, static_cast<int>(texels.size(1)));
            const float* first = rows.const_data_ptr<float>();
            std::copy(first, first + rows.numel(), image.pixels.begin());
            return image;
        };
        all.push_back({set.materials, image_of(color), image_of(values.narrow(1, 3, 3))});
    }
    return all;
}

void LiveTextures::write(const std::vector<Images>& images, const std::vector<float>& direction) {
    const ImageCoding coding{.encoding = ImageEncoding::png};
    Json textures = Json::array();
    for (const Images& one : images) {
        const int first = one.materials.front();
        for (const auto& [slot, image] :
             {std::pair{"base_color", &one.base_color}, {"orm", &one.orm}}) {
            const std::string file = fmt::format("{}_{}.png", first, slot);
            const Bytes bytes = encode_texture(*image, coding, 8);
            replace_file(folder_ / file,
                         {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
            for (const int material : one.materials)
                textures.push_back({{"material", material}, {"slot", slot}, {"file", file}});
        }
    }
    Json lengths = Json::array();
    const std::size_t step = direction.size() / max_direction_values + 1;
    for (std::size_t i = 0; i < direction.size(); i += step)
        lengths.push_back(std::round(direction[i] * 1e4) / 1e4);
    replace_file(
        folder_ / "textures.json",
        Json{{"revision", revision_}, {"textures", textures}, {"direction", lengths}}.dump());
}

/// Returns false while the files are being written. Once they are written, delays the next update
/// in proportion to the duration of this one.
bool LiveTextures::has_written() {
    if (!writing_.valid()) return true;
    if (writing_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return false;
    try {
        const double cost = drawn_ + writing_.get();
        next_ = std::max(next_, next_ - seconds_between_looks + rest * cost);
    } catch (const Error& error) {
        warn(std::string("live textures stop: ") + error.what());
        folder_.clear();
    }
    return true;
}

void LiveTextures::update(const EditState& state, bool is_last) {
    if (folder_.empty() || state.field.is_empty()) return;
    if (is_last && writing_.valid()) writing_.wait();
    if (!has_written() || folder_.empty() || (!is_last && seconds_now() < next_)) return;
    const at::NoGradGuard no_grad;
    const double begin = seconds_now();
    if (revision_ == 0) prepare(fitted_);
    ++revision_;
    std::vector<Images> images = draw(state.field);
    drawn_ = seconds_now() - begin;
    next_ = seconds_now() + seconds_between_looks;
    writing_ = std::async(std::launch::async,
                          [this, images = std::move(images), direction = state.direction_length] {
                              const double start = seconds_now();
                              write(images, direction);
                              return seconds_now() - start;
                          });
}

}  // namespace item3d
