#include "item3d/baselines/painting_scene.h"

#include "item3d/render/scatter.h"
#include "item3d/render/srgb.h"

#include <cmath>

namespace item3d {
namespace {

constexpr float degree = pi / 180.0f;
constexpr float painting_field_of_view = 40.0f * degree;
constexpr float background = 0.5f;  ///< sRGB
constexpr double min_share = 0.25;
/// Depth tolerance of visible texels, in parts of the radius.
constexpr float depth_tolerance = 0.01f;
/// Number of pixels along an edge up to which an image of the prior counts as small. Views of small
/// images are rendered at four times their size, other views at twice their size.
constexpr int small_image = 128;
int mask_scale(int resolution) {
    return resolution <= small_image ? 4 : 2;
}

}  // namespace

std::string side_of(ViewAngles angles) {
    if (angles.elevation >= 50) return "overhead";
    if (angles.elevation <= -50) return "bottom";
    const float turn = std::remainder(angles.azimuth, 360.0f);
    if (std::abs(turn) <= 35) return "front";
    if (std::abs(turn) >= 145) return "back";
    return turn > 0 ? "right" : "left";
}

SideView side_view(const PaintingScene& scene, ViewAngles angles) {
    SideView view{framing_camera(scene.points, angles.azimuth * degree, angles.elevation * degree,
                                 painting_field_of_view),
                  side_of(angles)};
    return view;
}

ViewRender::ViewRender(const PaintingScene& scene, const SideView& view, int wanted)
    : scene_(scene), view_(view) {
    const at::NoGradGuard no_grad;
    const int size = wanted > 0 ? wanted : scene.resolution * mask_scale(scene.resolution);
    raster_ = rasterize(scene.geometry, {view.camera}, size, size);
    surface_ = interpolate_surface(scene.geometry, raster_, {view.camera});
    shape_ = scene.shape(raster_, surface_);
    const auto options = surface_.position.options();
    const auto plane = [&](const at::Tensor& values) {
        return scatter(values, surface_, raster_, at::zeros({values.size(1)}, options))
            .permute({0, 3, 1, 2});
    };
    covered_ = (raster_.triangle >= 0).to(at::kFloat).unsqueeze(1);
    cosine_ = plane((surface_.normal * surface_.view).sum(1, true).clamp_min(0));
    const at::Tensor edited = scene.texels->has(surface_).unsqueeze(1);
    const at::Tensor weight = scene.texels->lookup(scene.weight, surface_) * edited;
    editable_ = plane((weight > 0).to(at::kFloat));
    own_color_ = at::where(
        edited, 0.0, linear_to_srgb(scene.materials->sample(surface_).base_color.clamp(0, 1)));
}

const TexelView& ViewRender::texels() const {
    if (!texel_view_)
        texel_view_ = see_texels(scene_.texels->surface(), view_.camera, raster_.depth[0],
                                 depth_tolerance * scene_.radius);
    return *texel_view_;
}

ImageSample ViewRender::colors_of(const at::Tensor& image) const {
    const at::Tensor covers =
        (at::adaptive_avg_pool2d(covered_, {image.size(2), image.size(3)}) > 0.999).to(at::kFloat);
    ImageSample sample = sample_pixels(image[0], covers[0], texels().place);
    sample.share = ((sample.share > min_share) & (texels().cosine > 0)).to(at::kFloat);
    return sample;
}

at::Tensor ViewRender::pixels(const at::Tensor& values) const {
    return scatter(scene_.texels->lookup(values, surface_), surface_, raster_,
                   at::zeros({values.size(1)}, values.options()))
        .permute({0, 3, 1, 2});
}

at::Tensor ViewRender::image(const at::Tensor& colors) const {
    const at::NoGradGuard no_grad;
    const at::Tensor shown = scene_.texels->lookup(colors, surface_) + own_color_;
    const at::Tensor image =
        scatter(shown, surface_, raster_, at::full({3}, background, shown.options()))
            .permute({0, 3, 1, 2});
    return at::avg_pool2d(image, size() / scene_.resolution);
}

at::Tensor ViewRender::condition(const DiffusionModel& model, const at::Tensor& latents) const {
    return condition_of_shape(model, shape_, latents);
}

at::Tensor any_in_cells(const at::Tensor& mask, std::int64_t height, std::int64_t width) {
    const std::int64_t cell = mask.size(2) / height;
    const std::int64_t across = mask.size(3) / width;
    return at::max_pool2d((mask != 0).to(at::kFloat), {cell, across}, {cell, across});
}

}  // namespace item3d
