#include "item3d/reconstruct/outputs/scores.h"

#include "item3d/core/error.h"
#include "item3d/core/parallel.h"
#include "item3d/metrics/image_quality.h"
#include "item3d/reconstruct/surface/pose_step.h"
#include "item3d/render/image_tensor.h"
#include "item3d/render/occlusion/indirect_light.h"
#include "item3d/render/render.h"
#include "item3d/render/srgb.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace item3d {

namespace {

constexpr int light_cube = 128;
constexpr int alignment_steps = 6;

/// Converts [1, H, W, 4] premultiplied linear to [1, 3, H, W] sRGB over white.
at::Tensor displayed_over_white(const at::Tensor& image) {
    const at::Tensor color = image.narrow(3, 0, 3) + (1 - image.narrow(3, 3, 1));
    return linear_to_srgb(color.clamp(0, 1)).permute({0, 3, 1, 2}).contiguous();
}

Image as_image(const at::Tensor& planes) {
    return to_image(planes[0].permute({1, 2, 0}).contiguous());
}

/// Scores a render. drawn: [1, H, W, 4] as in TargetView.
ScoredView score_of(const TargetView& view, const at::Tensor& drawn, Vec3 gain, bool is_imaged) {
    const at::Tensor image =
        displayed_over_white(drawn * at::tensor({gain.x, gain.y, gain.z, 1.0f}));
    const at::Tensor truth = displayed_over_white(view.image);
    const at::Tensor a = drawn.select(3, 3), b = view.image.select(3, 3);
    ScoredView result;
    result.score = {view.name, psnr(image, truth), ssim(image, truth),
                    at::minimum(a, b).sum().item<double>() /
                        std::max(1e-9, at::maximum(a, b).sum().item<double>())};
    if (!is_imaged) return result;
    result.truth = as_image(truth);
    result.image = as_image(image);
    return result;
}

/// Least-squares gain of linear radiance over pixels where the photograph shows the object
/// unclipped.
class GainFit {
  public:
    void add(const TargetView& view, const at::Tensor& drawn) {
        const at::Tensor render = drawn.narrow(3, 0, 3).to(at::kDouble);
        const at::Tensor truth = view.image.narrow(3, 0, 3).to(at::kDouble);
        const at::Tensor used =
            (view.image.narrow(3, 3, 1) > 0.99f).logical_and(truth.amax(3, true) < 0.99);
        product_ += (render * truth * used).sum({0, 1, 2});
        square_ += (render * render * used).sum({0, 1, 2});
    }
    Vec3 gain() const {
        const at::Tensor gain = product_ / square_.clamp_min(1e-12);
        return {gain[0].item<float>(), gain[1].item<float>(), gain[2].item<float>()};
    }

  private:
    at::Tensor product_ = at::zeros({3}, at::kDouble);
    at::Tensor square_ = at::zeros({3}, at::kDouble);
};

std::vector<Vec3> points_on(const TriangleMesh& mesh, int count, Random& random) {
    const at::Tensor positions = mesh.positions.detach().contiguous();
    const at::Tensor triangles = mesh.triangles.contiguous();
    const float* p = positions.const_data_ptr<float>();
    const std::int64_t* t = triangles.const_data_ptr<std::int64_t>();
    const auto corner = [&](std::int64_t i, int c) {
        const float* at = p + 3 * t[3 * i + c];
        return Vec3(at[0], at[1], at[2]);
    };
    std::vector<double> area;
    double sum = 0;
    for (std::int64_t i = 0; i < triangles.size(0); ++i) {
        sum += glm::length(glm::cross(corner(i, 1) - corner(i, 0), corner(i, 2) - corner(i, 0)));
        area.push_back(sum);
    }
    std::vector<Vec3> points;
    for (int k = 0; k < count; ++k) {
        const auto found = std::upper_bound(area.begin(), area.end(), random.uniform() * sum);
        const auto i = std::min<std::int64_t>(found - area.begin(), triangles.size(0) - 1);
        auto u = static_cast<float>(random.uniform()), v = static_cast<float>(random.uniform());
        if (u + v > 1) {
            u = 1 - u;
            v = 1 - v;
        }
        points.push_back((1 - u - v) * corner(i, 0) + u * corner(i, 1) + v * corner(i, 2));
    }
    return points;
}

double mean_nearest(const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
    std::vector<float> nearest(from.size());
    parallel_for(
        "mean_nearest", static_cast<std::int64_t>(from.size()),
        [&](std::int64_t i) {
            float least = std::numeric_limits<float>::max();
            for (const Vec3& point : to) {
                const Vec3 d = point - from[static_cast<std::size_t>(i)];
                least = std::min(least, glm::dot(d, d));
            }
            nearest[static_cast<std::size_t>(i)] = std::sqrt(least);
        },
        64);
    double sum = 0;
    for (const float value : nearest)
        sum += value;
    return sum / static_cast<double>(from.size());
}

}  // namespace

ViewScore mean_score(const std::vector<ScoredView>& views) {
    ViewScore mean{"mean", 0, 0, 0};
    for (const ScoredView& view : views) {
        mean.psnr += view.score.psnr / static_cast<double>(views.size());
        mean.ssim += view.score.ssim / static_cast<double>(views.size());
        mean.mask_overlap += view.score.mask_overlap / static_cast<double>(views.size());
    }
    return mean;
}

ModelRenderer::ModelRenderer(const Model& model, const Image& light, std::int64_t shadow_points)
    : bounds_(model.bounds()),
      geometry_(Geometry::from_model(model)),
      materials_(model),
      light_(prefilter(light, light_cube)) {
    if (shadow_points == 0) return;
    OcclusionOptions options;
    options.light = light;
    options.max_points = shadow_points;
    occlusion_ = std::make_shared<Occlusion>(geometry_, &model, options);
    indirect_ = trace_indirect_light(geometry_, model, materials_, light_, *occlusion_);
}

at::Tensor ModelRenderer::draw(const TargetView& view) const {
    const at::NoGradGuard no_gradient;
    RenderOptions options;
    options.width = view.width();
    options.height = view.height();
    options.occlusion = occlusion_;
    options.indirect = indirect_;
    return render(geometry_, materials_, light_, {view.camera}, options);
}

TargetView ModelRenderer::target(const Photograph& view) const {
    return make_targets({view}, bounds_).front();
}

std::vector<ScoredView> ModelRenderer::score(const std::vector<Photograph>& views,
                                             Vec3 gain) const {
    const at::NoGradGuard no_gradient;
    std::vector<ScoredView> scored;
    for (const Photograph& view : views) {
        const TargetView wanted = target(view);
        scored.push_back(score_of(wanted, draw(wanted), gain, scored.size() < imaged_views));
    }
    return scored;
}

Vec3 ModelRenderer::best_gain(const std::vector<Photograph>& views) const {
    const at::NoGradGuard no_gradient;
    GainFit fit;
    for (const Photograph& view : views) {
        const TargetView wanted = target(view);
        fit.add(wanted, draw(wanted));
    }
    return fit.gain();
}

ModelRenderer::BothScores ModelRenderer::score_both(const std::vector<Photograph>& views) const {
    const at::NoGradGuard no_gradient;
    BothScores both;
    for (const Photograph& view : views) {
        const TargetView wanted = target(view);
        const at::Tensor drawn = draw(wanted);
        const bool is_imaged = both.as_it_is.size() < imaged_views;
        both.as_it_is.push_back(score_of(wanted, drawn, Vec3(1), is_imaged));
        GainFit fit;
        fit.add(wanted, drawn);
        both.each_scaled.push_back(score_of(wanted, drawn, fit.gain(), is_imaged));
    }
    return both;
}

std::vector<Photograph> ModelRenderer::aligned(std::vector<Photograph> views, Vec3 centre,
                                               float radius) const {
    const at::NoGradGuard no_gradient;
    const at::Tensor middle = at::tensor({centre.x, centre.y, centre.z});
    for (Photograph& view : views) {
        for (int step = 0; step < alignment_steps; ++step) {
            const TargetView wanted = target(view);
            const at::Tensor drawn = draw(wanted);
            GainFit fit;
            fit.add(wanted, drawn);
            const Vec3 gain = fit.gain();
            const Raster raster =
                rasterize(geometry_, {wanted.camera}, wanted.width(), wanted.height());
            const Surface surface = interpolate_surface(geometry_, raster, {wanted.camera});
            const SmallMotion motion =
                pose_step({wanted.camera, drawn * at::tensor({gain.x, gain.y, gain.z, 1.0f}),
                           surface.pixel, surface.position},
                          wanted.image, middle, radius);
            view.camera = rigid_motion(motion, middle, radius).seen_from(view.camera);
        }
    }
    return views;
}

double chamfer_distance(const TriangleMesh& mesh, const TriangleMesh& reference, int points,
                        std::uint64_t seed) {
    Random random(seed, RandomStream::chamfer);
    const auto a = points_on(mesh, points, random), b = points_on(reference, points, random);
    const at::Tensor size =
        std::get<0>(reference.positions.max(0)) - std::get<0>(reference.positions.min(0));
    return 0.5 * (mean_nearest(a, b) + mean_nearest(b, a)) / size.norm().item<double>();
}

TriangleMesh mesh_of(const Model& model) {
    std::vector<float> positions;
    std::vector<std::int64_t> triangles;
    for (const Primitive& primitive : model.primitives) {
        const auto first = static_cast<std::int64_t>(positions.size() / 3);
        for (const Vec3& p : primitive.positions)
            positions.insert(positions.end(), {p.x, p.y, p.z});
        for (const std::uint32_t index : primitive.indices)
            triangles.push_back(first + index);
    }
    return {at::tensor(positions).reshape({-1, 3}),
            at::tensor(triangles, at::kLong).reshape({-1, 3})};
}

}  // namespace item3d
