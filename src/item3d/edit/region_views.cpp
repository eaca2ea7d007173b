#include "item3d/edit/region_views.h"

#include "item3d/core/error.h"
#include "item3d/core/random.h"
#include "item3d/edit/views.h"
#include "item3d/render/occlusion/ray_scene.h"

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

constexpr std::int64_t max_looks = 128;
constexpr int tries = 12;            ///< directions tried around a point's normal
constexpr float widest_turn = 0.9f;  ///< tangent of the largest angle to the normal
constexpr float clearance = 1e-4f;   ///< start of a ray, in parts of the model's radius
/// Radius of a close-up, in parts of the model's radius: its smallest value, and its largest value
/// for a close-up around one point.
constexpr float min_radius = 0.12f, largest_radius = 0.45f;
constexpr float margin = 1.3f;

Vec3 row_of(const at::Tensor& rows, std::int64_t i) {
    const float* row = rows.const_data_ptr<float>() + 3 * i;
    return {row[0], row[1], row[2]};
}

Vec3 random_vector(Random& random) {
    return Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
}

}  // namespace

RegionViews::RegionViews(const RegionPoints& points, const Model& model, const Geometry& geometry)
    : model_radius_(bounding_sphere(model).radius) {
    const at::Tensor positions = points.positions.contiguous();
    const at::Tensor normals = points.normals.contiguous();
    const std::int64_t count = positions.size(0);
    Vec3 centre(0);
    for (std::int64_t i = 0; i < count; ++i)
        centre += row_of(positions, i) / static_cast<float>(count);
    float region_radius = 0;
    for (std::int64_t i = 0; i < count; ++i)
        region_radius = std::max(region_radius, glm::length(row_of(positions, i) - centre));
    // A close-up shows all of a small region. Of a large or scattered region it shows the part
    // around one point.
    const bool is_small = margin * region_radius <= largest_radius * model_radius_;
    const float radius =
        std::clamp(is_small ? margin * region_radius : largest_radius * model_radius_,
                   min_radius * model_radius_, largest_radius * model_radius_);

    const RayScene rays(geometry, &model);
    Random random(0, RandomStream::region);
    const std::int64_t step = std::max<std::int64_t>(1, count / max_looks);
    for (std::int64_t i = 0; i < count; i += step) {
        const Vec3 place = row_of(positions, i);
        // Tries the opposite side too, because normals may point inwards.
        for (int t = 0; t < 2 * tries; ++t) {
            const Vec3 normal = (t < tries ? 1.0f : -1.0f) * row_of(normals, i);
            const float turn = widest_turn * static_cast<float>(t % tries) / tries;
            const Vec3 direction = glm::normalize(normal + turn * random_vector(random));
            if (rays.blocked(place + clearance * model_radius_ * normal, direction)) continue;
            looks_.push_back({is_small ? centre : place, direction, radius});
            break;
        }
    }
    if (looks_.empty())
        throw InputError("--region", "is not visible from outside the model",
                         "choose a region on its outer surfaces");
}

Camera RegionViews::camera(const Look& look, std::uint64_t seed, std::int64_t iteration) const {
    Random random(mix_bits(seed) ^ static_cast<std::uint64_t>(iteration),
                  IndexedStream::region_cameras);
    const auto field_of_view = static_cast<float>(random.uniform(25.7, 45)) * pi / 180;
    const auto fill = static_cast<float>(random.uniform(0.75, 1.05));
    const Vec3 direction = glm::normalize(look.direction + 0.15f * random_vector(random));
    const Vec3 target = look.target + 0.1f * look.radius * random_vector(random);
    const float distance = look.radius / (fill * std::sin(0.5f * field_of_view));
    const float elevation = std::asin(std::clamp(direction.y, -0.99f, 0.99f));
    Camera camera = orbit_camera(target, distance, std::atan2(direction.x, direction.z), elevation,
                                 field_of_view);
    camera.near_plane = 0.02f * look.radius;
    camera.far_plane = distance + 3 * model_radius_;
    return camera;
}

void RegionViews::take_turns(std::vector<Camera>& cameras, std::uint64_t seed,
                             std::int64_t iteration) const {
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        const std::int64_t turn =
            iteration * static_cast<std::int64_t>(cameras.size()) + static_cast<std::int64_t>(i);
        if (turn % 2 != 0) continue;
        Random random(mix_bits(seed) ^ static_cast<std::uint64_t>(turn),
                      IndexedStream::region_looks);
        const auto chosen = random.index(static_cast<std::int64_t>(looks_.size()));
        cameras[i] = camera(looks_[static_cast<std::size_t>(chosen)], seed, turn);
    }
}

}  // namespace item3d
