#include "item3d/edit/detail/painting_plan.h"

#include "item3d/core/random.h"

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

constexpr float golden_angle = 2.39996323f;
constexpr float one_degree = pi / 180.0f;
constexpr double initial_share = 0.4, refine_share = 0.3;  ///< share of the views
constexpr int samples = 2;                                 ///< samples along a pixel's edge
constexpr float flattest = 0.2f;  ///< smallest cosine at which a point counts as seen
/// Smallest ratio of cosines, an earlier view's to this view's, at which a point keeps the earlier
/// view's paint.
constexpr float clearly_better = 0.7f;
constexpr float known_share = 0.75f;  ///< share of known pixels in a kept latent cell
/// Depth tolerance of the visibility test, in parts of the model's radius.
constexpr float depth_tolerance = 0.03f;

PaintingRound round_of(int index, int views) {
    const auto end_of = [&](double share) { return std::max(1l, std::lround(share * views)); };
    return index < end_of(initial_share)                  ? PaintingRound::initial
           : index < end_of(initial_share + refine_share) ? PaintingRound::refine
                                                          : PaintingRound::close_up;
}

Camera paint_camera(const BoundingSphere& sphere, int index, bool close_up, std::uint64_t seed) {
    Random random(mix_bits(seed) + static_cast<std::uint64_t>(index),
                  IndexedStream::painting_cameras);
    const auto draw = [&](double low, double high) {
        return static_cast<float>(random.uniform(low, high));
    };
    const float azimuth = golden_angle * static_cast<float>(index) + draw(-.2, .2);
    const float elevation = draw(-10, 45) * one_degree;
    const float field_of_view = draw(25.7, 45) * one_degree;
    const float fill = close_up ? draw(1.3, 2.0) : draw(0.85, 1.05);
    const float distance = sphere.radius / (fill * std::sin(0.5f * field_of_view));
    const float aside = (close_up ? 0.4f : 0.05f) * sphere.radius;
    const Vec3 target = sphere.center + aside * Vec3(draw(-1, 1), draw(-1, 1), draw(-1, 1));
    Camera camera = orbit_camera(target, distance, azimuth, elevation, field_of_view);
    camera.near_plane = std::max(0.02f * sphere.radius, distance - 2 * sphere.radius);
    camera.far_plane = distance + 2 * sphere.radius;
    return camera;
}

/// The surface points that a view sees, with one row for each covered sample.
struct Sight {
    Camera camera;
    at::Tensor depth;  ///< [S, S]
    Surface surface;
    at::Tensor cosine;  ///< [P] cosine between the normal and the direction to the camera

    Sight(const Geometry& geometry, const Camera& from, int size) : camera(from) {
        const Raster raster = rasterize(geometry, {camera}, size, size);
        surface = interpolate_surface(geometry, raster, {camera});
        depth = raster.depth[0];
        cosine = (surface.normal * surface.view).sum(1).clamp_min(0);
    }

    /// Returns the cosines at which this view sees the points of another view, one for each point;
    /// 0 for hidden points.
    at::Tensor cosine_of(const Surface& points, float tolerance) const {
        const auto options = points.position.options();
        const Mat4 view = camera.world_to_camera();
        const auto row = [&](int r) {
            const at::Tensor axis = at::tensor({view[0][r], view[1][r], view[2][r]}, options);
            return points.position.mv(axis) + view[3][r];
        };
        const at::Tensor ahead = -row(2);
        const std::int64_t size = depth.size(0);
        const float scale = 0.5f * static_cast<float>(size) / std::tan(camera.field_of_view_x / 2);
        const at::Tensor x = (row(0) / ahead * scale + 0.5f * size).floor().to(at::kLong);
        const at::Tensor y = (row(1) / -ahead * scale + 0.5f * size).floor().to(at::kLong);
        const at::Tensor inside = (ahead > 0) * (x >= 0) * (x < size) * (y >= 0) * (y < size);
        const at::Tensor seen =
            depth.flatten().index_select(0, (y * size + x) * inside.to(at::kLong));
        const at::Tensor origin =
            at::tensor({camera.position().x, camera.position().y, camera.position().z}, options);
        const at::Tensor way = origin - points.position;
        const at::Tensor cosines =
            (points.normal * way).sum(1) / way.square().sum(1).sqrt().clamp_min(1e-12);
        return cosines.clamp_min(0) * (inside * (seen > 0) * (ahead < seen + tolerance));
    }
};

/// Scatters the values of a view's points to pixels [1, 1, R, R], 0 elsewhere.
at::Tensor as_pixels(const Sight& sight, const at::Tensor& values) {
    const std::int64_t size = sight.depth.size(0);
    const at::Tensor pixels = at::zeros({size * size}, values.options())
                                  .index_copy(0, sight.surface.pixel, values)
                                  .view({1, 1, size, size});
    return at::avg_pool2d(pixels, samples);
}

at::Tensor known_cells(const at::Tensor& fresh, std::int64_t pixels_each) {
    const at::Tensor settled = 1 - at::max_pool2d(fresh, 3, 1, 1);
    return (at::avg_pool2d(settled, pixels_each) > known_share).to(at::kFloat);
}

}  // namespace

std::vector<PaintingView> plan_painting(const EditScene& scene, const EditPlan& plan) {
    const at::NoGradGuard no_grad;
    const std::int64_t pixels_each = scene.prior()->downscale();
    std::vector<PaintingView> views;
    std::vector<Sight> earlier;
    for (int i = 0; i < plan.detail_views; ++i) {
        PaintingView view;
        view.round = round_of(i, plan.detail_views);
        const bool begins_round = views.empty() || views.back().round != view.round;
        if (begins_round) earlier.clear();
        view.first_of_round = begins_round ? i : views.back().first_of_round;
        view.camera =
            paint_camera(scene.sphere, i, view.round == PaintingRound::close_up, plan.seed);
        const Sight sight(scene.geometry, view.camera, plan.resolution * samples);
        const at::Tensor own = as_pixels(sight, sight.cosine);
        view.facing = (own > flattest).to(at::kFloat);
        at::Tensor best = at::zeros_like(sight.cosine);
        for (const Sight& other : earlier) {
            best = at::maximum(
                best, other.cosine_of(sight.surface, depth_tolerance * scene.sphere.radius));
        }
        const at::Tensor fresh =
            view.facing * (as_pixels(sight, best) < clearly_better * own).to(at::kFloat);
        view.known = known_cells(fresh, pixels_each);
        earlier.push_back(sight);
        earlier.back().surface = {};  // this member is large, and later views need only the depth
        views.push_back(view);
    }
    return views;
}

}  // namespace item3d
