#include "item3d/render/occlusion/occlusion.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/core/random.h"
#include "item3d/render/checks.h"
#include "item3d/render/dispatch.h"
#include "item3d/render/kernels/occlusion.h"
#include "item3d/render/occlusion/occlusion_grid.h"
#include "item3d/render/occlusion/occlusion_light.h"
#include "item3d/render/occlusion/ray_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

namespace item3d {
namespace {

constexpr int fewest_rays = 32;
/// Maximum number of rays of all points and sides. If the requested number of rays exceeds it, each
/// point gets fewer.
constexpr std::int64_t ray_budget = std::int64_t{1} << 24;

/// Maximum number of triangles from which the rays of one point start.
constexpr std::int64_t max_members = 16;

using Bits2 = std::array<std::uint32_t, 2>;

/// Returns a point of the (0, 2)-sequence of van der Corput and Sobol', as fixed-point fractions:
/// any aligned block of 2^k of its points is evenly distributed over the unit square.
Bits2 sequence_point(std::uint32_t index) {
    std::uint32_t x = 0, y = 0, direction = 1u << 31;
    for (std::uint32_t bits = index, place = 1u << 31; bits != 0; bits >>= 1, place >>= 1) {
        if ((bits & 1u) != 0) {
            x ^= place;
            y ^= direction;
        }
        direction ^= direction >> 1;
    }
    return {x, y};
}

/// Returns the point with scrambled digits. Scrambling preserves the even distribution.
Vec2 scrambled(Bits2 point, std::uint64_t scramble) {
    const std::uint32_t x = point[0] ^ static_cast<std::uint32_t>(scramble);
    const std::uint32_t y = point[1] ^ static_cast<std::uint32_t>(scramble >> 32);
    // A float below 1 holds 24 bits.
    return Vec2(static_cast<float>(x >> 8), static_cast<float>(y >> 8)) * 0x1.0p-24f;
}

/// Origin of rays: a point, and a frame around its normal.
struct Start {
    Vec3 position, face;
    Vec3 normal, side, other_side;

    Start() = default;
    Start(const OcclusionGrid::Point& point, bool behind)
        : position(point.position),
          face(point.face),
          normal(behind ? -point.normal : point.normal) {
        if (glm::dot(normal, face) < 0) face = -face;
        side = glm::normalize(
            glm::cross(normal, std::abs(normal.x) < 0.7f ? Vec3(1, 0, 0) : Vec3(0, 1, 0)));
        other_side = glm::cross(normal, side);
    }

    /// Returns a direction around the normal, with the density cos / pi.
    Vec3 cosine_direction(Vec2 square) const {
        const float radius = std::sqrt(square.x), angle = 2 * pi * square.y;
        return radius * std::cos(angle) * side + radius * std::sin(angle) * other_side +
               std::sqrt(std::max(0.0f, 1 - square.x)) * normal;
    }
};

/// Traces the rays of groups of points.
class Tracer {
  public:
    Tracer(const OcclusionGrid& grid, const RayScene& scene, const OcclusionOptions& options)
        : grid_(grid), scene_(scene), seed_(options.seed) {
        if (!options.light.empty()) light_.emplace(options.light);
        if (light_ && light_->dark()) light_.reset();
        const auto groups = static_cast<std::int64_t>(grid.begin.size()) - 1;
        const std::int64_t share = ray_budget / std::max<std::int64_t>(1, 2 * groups);
        rays_ = static_cast<int>(
            std::clamp<std::int64_t>(share, std::min(fewest_rays, options.rays), options.rays));
        // The offset is large enough for a ray to leave its own triangle despite rounding.
        offset_ = std::max(5e-5f * grid.diagonal, 1e-6f * grid.farthest);
        for (int ray = 0; ray < rays_; ++ray)
            sequence_.push_back(sequence_point(static_cast<std::uint32_t>(ray)));
    }

    /// Returns the share of light that reaches the points of a group, on the side of the normal or
    /// on the opposite side.
    float openness(std::size_t group, bool behind) const {
        const std::int64_t begin = grid_.begin[group], members = grid_.begin[group + 1] - begin;
        const std::uint64_t key =
            grid_.key[static_cast<std::size_t>(grid_.member[static_cast<std::size_t>(begin)])];
        Random random(seed_, key ^ (behind ? 1u : 0u));
        const std::uint64_t scramble = random.bits(), choice = random.bits();

        // Rays start from the planes of all triangles that share the point.
        std::array<Start, max_members> starts;
        const std::int64_t chosen = std::min<std::int64_t>(members, max_members);
        for (std::int64_t k = 0; k < chosen; ++k) {
            const auto member = static_cast<std::size_t>(begin + k * members / chosen);
            starts[static_cast<std::size_t>(k)] = Start(grid_.point(grid_.member[member]), behind);
        }

        double arrives = 0, comes = 0;
        for (int ray = 0; ray < rays_; ++ray) {
            // If no light has arrived so far, the point is in a deep crevice or inside a closed
            // shape.
            if (ray == rays_ / 4 && ray >= 16 && arrives == 0 && comes > 0) return 0;
            const std::uint64_t bits = mix_bits(choice ^ static_cast<std::uint64_t>(ray));
            const Start& start =
                starts[static_cast<std::size_t>(bits % static_cast<std::uint64_t>(chosen))];
            const Vec3 up = start.face;
            if (up == Vec3(0.0f)) continue;
            const Sample sample = direction(start, static_cast<std::size_t>(ray), scramble);
            // A direction of the interpolated normal's hemisphere may point below the triangle.
            // Such a direction does not count as occluded.
            if (!(sample.weight > 0) || !(glm::dot(sample.direction, up) > 0)) continue;
            comes += sample.weight;
            if (!scene_.blocked(start.position + offset_ * up, sample.direction, bits))
                arrives += sample.weight;
        }
        return comes > 0 ? static_cast<float>(arrives / comes) : 1.0f;
    }

  private:
    struct Sample {
        Vec3 direction;
        float weight;
    };

    /// Draws a direction. With a light, half of the rays are drawn in proportion to its luminance
    /// and half in proportion to the cosine; each is weighted by the sum of both densities (the
    /// balance heuristic of Veach 1997).
    Sample direction(const Start& start, std::size_t ray, std::uint64_t scramble) const {
        if (!light_) return {start.cosine_direction(scrambled(sequence_[ray], scramble)), 1.0f};
        const bool follows_cosine = ray % 2 == 0;
        const Vec2 square =
            scrambled(sequence_[ray / 2], follows_cosine ? scramble : mix_bits(scramble));
        OcclusionLight::Drawn drawn{};
        if (follows_cosine)
            drawn.direction = start.cosine_direction(square);
        else
            drawn = light_->draw(square);
        const float cosine = glm::dot(start.normal, drawn.direction);
        if (!(cosine > 0)) return {drawn.direction, 0.0f};
        const float radiance =
            follows_cosine ? light_->luminance(drawn.direction) : drawn.luminance;
        return {drawn.direction, radiance * cosine / (cosine / pi + radiance / light_->total())};
    }

    const OcclusionGrid& grid_;
    const RayScene& scene_;
    std::optional<OcclusionLight> light_;
    std::uint64_t seed_;
    std::vector<Bits2> sequence_;  ///< one point for each ray
    int rays_ = 0;
    float offset_ = 0;
};

template <typename T>
at::Tensor to_tensor(const std::vector<T>& values, at::ScalarType type) {
    return at::from_blob(const_cast<T*>(values.data()), {static_cast<std::int64_t>(values.size())},
                         type)
        .clone();
}

}  // namespace

struct Occlusion::State {
    at::Tensor positions, normals, triangles;
    at::Tensor first;       ///< [T + 1] int64
    at::Tensor resolution;  ///< [T] int32
    at::Tensor values;      ///< [points, 2] uint8
};

Occlusion::Occlusion(const Geometry& geometry, const Model* model,
                     const OcclusionOptions& options) {
    ITEM3D_CHECK(options.rays >= 1, "Occlusion: at least one ray");
    const OcclusionGrid grid = make_occlusion_grid(geometry, options.spacing, options.max_points);
    const RayScene scene(geometry, model);
    const Tracer tracer(grid, scene, options);

    const at::Tensor openness = at::full({grid.points(), 2}, 255, at::kByte);
    std::uint8_t* values = openness.data_ptr<std::uint8_t>();
    const auto groups = static_cast<std::int64_t>(grid.begin.size()) - 1;
    constexpr std::int64_t groups_a_step = 4096;
    Progress progress("occlusion", groups);
    for (std::int64_t start = 0; start < groups; start += groups_a_step) {
        if (interrupted()) throw Interrupted("occlusion was not computed to its end");
        const std::int64_t count = std::min(groups_a_step, groups - start);
        parallel_for(
            "trace occlusion", 2 * count,
            [&](std::int64_t i) {
                const auto group = static_cast<std::size_t>(start + i / 2);
                const auto value = static_cast<std::uint8_t>(
                    std::lround(255 * tracer.openness(group, i % 2 == 1)));
                for (std::int64_t m = grid.begin[group]; m < grid.begin[group + 1]; ++m)
                    values[2 * grid.member[static_cast<std::size_t>(m)] + i % 2] = value;
            },
            16);
        progress.update(start + count);
    }
    progress.finish();
    join_grids(grid, values);

    const at::Device device = geometry.positions.device();
    state_ = std::make_shared<State>(
        State{grid.positions.to(device), grid.normals.to(device), grid.triangles.to(device),
              to_tensor(grid.first, at::kLong).to(device),
              to_tensor(grid.resolution, at::kInt).to(device), openness.to(device)});
}

std::int64_t Occlusion::points() const {
    return state_->values.size(0);
}

at::Tensor Occlusion::at(const Raster& raster, const Surface& surface) const {
    constexpr const char* op = "Occlusion::at";
    const at::Device device = operation_device(op, surface.pixel);
    const State& state = *state_;
    ITEM3D_CHECK(state.values.device() == device,
                 "Occlusion::at: a surface on the device of the geometry it was made for");
    const std::int64_t count = surface.count();
    const at::Tensor triangle =
        checked(op, "raster.triangle", raster.triangle, at::kInt, {-1, -1, -1}, device);
    const at::Tensor barycentrics =
        checked(op, "raster.barycentrics", raster.barycentrics.detach(), at::kFloat,
                {raster.views(), raster.height(), raster.width(), 2}, device);
    const at::Tensor pixel =
        checked(op, "surface.pixel", surface.pixel, at::kLong, {count}, device);
    const at::Tensor normal =
        checked(op, "surface.normal", surface.normal.detach(), at::kFloat, {count, 3}, device);
    at::Tensor openness = at::empty({count}, normal.options());
    const kernels::OcclusionParameters p{state.normals.const_data_ptr<float>(),
                                         state.positions.const_data_ptr<float>(),
                                         state.triangles.const_data_ptr<std::int32_t>(),
                                         state.first.const_data_ptr<std::int64_t>(),
                                         state.resolution.const_data_ptr<std::int32_t>(),
                                         state.values.const_data_ptr<std::uint8_t>(),
                                         barycentrics.const_data_ptr<float>(),
                                         triangle.const_data_ptr<std::int32_t>(),
                                         pixel.const_data_ptr<std::int64_t>(),
                                         normal.const_data_ptr<float>(),
                                         openness.data_ptr<float>()};
    dispatch<kernels::occlusion_at>(device, "occlusion", &cuda::RenderTable::occlusion, p, count,
                                    8192);
    return openness;
}

MaterialSample Occlusion::shadowed(const MaterialSample& material, const Raster& raster,
                                   const Surface& surface) const {
    MaterialSample darker = material;
    const at::Tensor open = at(raster, surface).unsqueeze(1);
    darker.orm = at::cat({material.orm.narrow(1, 0, 1) * open, material.orm.narrow(1, 1, 2)}, 1);
    return darker;
}

}  // namespace item3d
