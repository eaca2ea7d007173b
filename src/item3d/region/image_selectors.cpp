#include "item3d/region/image_selectors.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/parallel.h"
#include "item3d/core/progress.h"
#include "item3d/io/load.h"
#include "item3d/io/text.h"
#include "item3d/render/occlusion/ray_scene.h"
#include "item3d/scene/model_view.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

namespace item3d {
namespace {

/// Offset of a visibility ray's start above the surface, as a fraction of the model's diagonal.
constexpr float clearance = 1e-4f;

std::pair<std::string, std::string> split_at(const std::string& text, char sign) {
    const std::size_t at = text.rfind(sign);
    if (at == std::string::npos) return {text, ""};
    return {text.substr(0, at), text.substr(at + 1)};
}

/// Returns the image as one channel: luminance times alpha.
Image load_mask(const SelectorText& text, const std::string& file) {
    const Image image = load_image(file);
    Image mask(image.width, image.height, 1);
    float whitest = 0;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            float value = image.at(x, y, 0);
            if (image.channels >= 3)
                value = 0.2126f * value + 0.7152f * image.at(x, y, 1) + 0.0722f * image.at(x, y, 2);
            if (image.channels % 2 == 0) value *= image.at(x, y, image.channels - 1);
            mask.at(x, y, 0) = std::clamp(value, 0.0f, 1.0f);
            whitest = std::max(whitest, mask.at(x, y, 0));
        }
    }
    if (whitest < 0.5f)
        throw InputError(text.whole, "the mask contains no white",
                         "paint the region white, and the rest black");
    return mask;
}

/// Interpolates at u, v in texels. Beyond the edge, the image repeats or is clamped.
float bilinear(const Image& image, float u, float v, bool repeats) {
    const float x = u - 0.5f, y = v - 0.5f;
    const float left = std::floor(x), top = std::floor(y);
    const auto texel = [&](float column, float row) {
        const auto place = [&](float at, int size) {
            const auto index = static_cast<long>(at);
            if (!repeats) return static_cast<int>(std::clamp<long>(index, 0, size - 1));
            return static_cast<int>(((index % size) + size) % size);
        };
        return image.at(place(column, image.width), place(row, image.height), 0);
    };
    const float a = x - left, b = y - top;
    return (1 - b) * ((1 - a) * texel(left, top) + a * texel(left + 1, top)) +
           b * ((1 - a) * texel(left, top + 1) + a * texel(left + 1, top + 1));
}

class MaskSelector : public Selector {
  public:
    MaskSelector(Image mask, at::Tensor has_mask)
        : mask_(std::move(mask)), has_mask_(std::move(has_mask)) {}
    at::Tensor weight(const Surface& surface) const override {
        const at::Tensor uv = surface.uv.cpu().contiguous();
        at::Tensor weights = at::empty({uv.size(0)}, at::kFloat);
        const float* from = uv.const_data_ptr<float>();
        float* to = weights.data_ptr<float>();
        parallel_for(
            "region_mask", uv.size(0),
            [&](std::int64_t i) {
                const float u = from[2 * i] - std::floor(from[2 * i]);
                const float v = from[2 * i + 1] - std::floor(from[2 * i + 1]);
                to[i] = bilinear(mask_, u * static_cast<float>(mask_.width),
                                 v * static_cast<float>(mask_.height), true);
            },
            4096);
        return weights * has_mask_.index_select(0, surface.primitive.cpu());
    }

  private:
    Image mask_;
    at::Tensor has_mask_;  ///< [primitives] 0 or 1
};

class ViewSelector : public Selector {
  public:
    ViewSelector(Image mask, const Camera& camera, const RegionScene& scene)
        : mask_(std::move(mask)),
          eye_(camera.position()),
          to_clip_(camera.world_to_clip(mask_.width, mask_.height)),
          rays_(std::make_shared<RayScene>(scene.geometry, &scene.model)) {
        const auto [low, high] = scene.model.bounds();
        clearance_ = clearance * glm::length(high - low);
    }
    at::Tensor weight(const Surface& surface) const override {
        const at::Tensor position = surface.position.detach().cpu().contiguous();
        const at::Tensor normal = surface.normal.detach().cpu().contiguous();
        at::Tensor weights = at::empty({position.size(0)}, at::kFloat);
        const float* p = position.const_data_ptr<float>();
        const float* n = normal.const_data_ptr<float>();
        float* to = weights.data_ptr<float>();
        parallel_for(
            "region_view", position.size(0),
            [&](std::int64_t i) {
                to[i] = at_place(Vec3(p[3 * i], p[3 * i + 1], p[3 * i + 2]),
                                 Vec3(n[3 * i], n[3 * i + 1], n[3 * i + 2]));
            },
            256);
        return weights;
    }

  private:
    float at_place(Vec3 position, Vec3 normal) const {
        const Vec4 clip = to_clip_ * Vec4(position, 1);
        if (clip.w <= 0 || std::abs(clip.x) > clip.w || std::abs(clip.y) > clip.w) return 0;
        const float value =
            bilinear(mask_, (0.5f + 0.5f * clip.x / clip.w) * static_cast<float>(mask_.width),
                     (0.5f - 0.5f * clip.y / clip.w) * static_cast<float>(mask_.height), false);
        if (value == 0) return 0;
        const Vec3 way = eye_ - position;
        // The normal may point away from this camera. The ray starts on the side that faces the
        // camera.
        const Vec3 up = glm::dot(normal, way) < 0 ? -normal : normal;
        if (rays_->blocked(position + clearance_ * up, glm::normalize(way))) return 0;
        return value;
    }

    Image mask_;
    Vec3 eye_;
    Mat4 to_clip_;
    std::shared_ptr<const RayScene> rays_;
    float clearance_ = 0;
};

/// Returns [primitives]: 1 for primitives with UVs and this material, else 0. "" means any
/// material.
at::Tensor primitives_with(const SelectorText& text, const RegionScene& scene,
                           const std::string& material, const Image& mask) {
    const Model& model = scene.model;
    std::vector<float> has;
    bool any = false, is_known = false, is_noted = !scene.says_notes;
    for (const Primitive& primitive : model.primitives) {
        const Material& own = model.materials[static_cast<std::size_t>(primitive.material)];
        const bool is_meant = material.empty() || own.name == material;
        is_known = is_known || is_meant;
        has.push_back(is_meant && !primitive.uvs.empty() ? 1.0f : 0.0f);
        any = any || has.back() > 0;
        if (has.back() == 0 || own.base_color_texture < 0 || is_noted) continue;
        const Image& image = model.textures[static_cast<std::size_t>(own.base_color_texture)].image;
        if (image.width == mask.width && image.height == mask.height) continue;
        is_noted = true;
        note(fmt::format("{}: the mask is {}x{}, the texture of '{}' is {}x{}; the mask is scaled",
                         text.whole, mask.width, mask.height, own.name, image.width, image.height));
    }
    if (!is_known) {
        std::vector<std::string> names;
        for (const Material& own : model.materials)
            names.push_back(own.name);
        throw InputError(text.whole, "the model has no material '" + material + "'",
                         fmt::format("choose from {}", fmt::join(names, ", ")));
    }
    if (!any)
        throw InputError(text.whole, "the model has no UV map for a mask",
                         "use view=, box= or sphere=");
    return at::tensor(has);
}

Camera named_camera(const SelectorText& text, const std::string& camera, const Model& model) {
    const auto [file, frame] = split_at(camera, '#');
    const std::vector<Camera> cameras = load_cameras(file, model.origin);
    std::vector<std::string> names;
    for (const Camera& candidate : cameras) {
        if (frame.empty() || candidate.name == frame) return candidate;
        names.push_back(candidate.name);
    }
    throw InputError(text.whole, "the file has no frame '" + frame + "'",
                     fmt::format("choose from {}", fmt::join(names, ", ")));
}

/// True if the whole value is the name of a file. A name that is too long for the system is none.
bool names_file(const SelectorText& text) {
    std::error_code none;
    return std::filesystem::exists(text.value, none);
}

}  // namespace

std::unique_ptr<Selector> select_mask(const SelectorText& text, const RegionScene& scene) {
    const bool is_file = names_file(text);
    const auto [file, material] =
        is_file ? std::pair(text.value, std::string()) : split_at(text.value, '@');
    Image mask = load_mask(text, file);
    const at::Tensor has_mask = primitives_with(text, scene, material, mask);
    return std::make_unique<MaskSelector>(std::move(mask), has_mask);
}

std::unique_ptr<Selector> select_view(const SelectorText& text, const RegionScene& scene) {
    const bool is_file = names_file(text);
    const auto [file, place] =
        is_file ? std::pair(text.value, std::string()) : split_at(text.value, '@');
    Image mask = load_mask(text, file);
    const float aspect = static_cast<float>(mask.width) / static_cast<float>(mask.height);
    Camera camera = default_view(scene.model, aspect);
    if (place.find(".json") != std::string::npos) {
        camera = named_camera(text, place, scene.model);
    } else if (!place.empty()) {
        const std::vector<float> angles =
            numbers_of({text.whole, place, "view=FILE@AZIMUTH,ELEVATION"}, 2);
        camera = view_from(scene.model, angles[0] * pi / 180, angles[1] * pi / 180, aspect);
    }
    return std::make_unique<ViewSelector>(std::move(mask), camera, scene);
}

}  // namespace item3d
