#include "item3d/render/occlusion/indirect_light.h"

#include "item3d/core/error.h"
#include "item3d/core/parallel.h"
#include "item3d/core/random.h"
#include "item3d/render/kernels/interpolate.h"
#include "item3d/render/kernels/occlusion.h"
#include "item3d/render/occlusion/occlusion.h"
#include "item3d/render/occlusion/occlusion_grid.h"
#include "item3d/render/occlusion/ray_scene.h"

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

constexpr float dielectric = 0.04f;
constexpr double golden_ratio = 0.6180339887498949;

/// Orthonormal frame around a direction.
struct Frame {
    Vec3 up, side, other;
    explicit Frame(Vec3 direction) : up(direction) {
        side =
            glm::normalize(glm::cross(up, std::abs(up.x) < 0.7f ? Vec3(1, 0, 0) : Vec3(0, 1, 0)));
        other = glm::cross(up, side);
    }
    Vec3 at(float cosine, float angle) const {
        const float sine = std::sqrt(std::max(0.0f, 1 - cosine * cosine));
        return sine * std::cos(angle) * side + sine * std::sin(angle) * other + cosine * up;
    }
};

/// The three grid points around a point of a triangle, with their interpolation weights.
struct GridPlace {
    std::int64_t points[3];
    float weights[3];
};

GridPlace grid_place_of(std::int64_t first, int resolution, float b0, float b1) {
    const float x = std::max(b0, 0.0f) * static_cast<float>(resolution);
    const float y = std::max(b1, 0.0f) * static_cast<float>(resolution);
    const int i = std::min(static_cast<int>(x), resolution - 1);
    const int j = std::min(static_cast<int>(y), resolution - 1 - i);
    const float fx = std::min(x - static_cast<float>(i), 1.0f);
    const float fy = std::min(y - static_cast<float>(j), 1.0f);
    const bool lower = fx + fy <= 1 || i + j + 2 > resolution;
    const auto at = [&](int column, int row) {
        return first + kernels::grid_index(resolution, column, row);
    };
    if (lower)
        return {{at(i, j), at(i + 1, j), at(i, j + 1)}, {std::max(0.0f, 1 - fx - fy), fx, fy}};
    return {{at(i + 1, j + 1), at(i + 1, j), at(i, j + 1)}, {fx + fy - 1, 1 - fy, 1 - fx}};
}

Vec3 load_row(const float* rows, std::int64_t row) {
    return Vec3(rows[3 * row], rows[3 * row + 1], rows[3 * row + 2]);
}

/// Returns a light of radiance 1 from all directions.
const EnvironmentLight& white_light() {
    static const EnvironmentLight light = [] {
        const at::NoGradGuard no_gradient;
        return prefilter(at::ones({6, 16, 16, 3}));
    }();
    return light;
}

}  // namespace

struct IndirectLight::State {
    IndirectLightOptions options;
    OcclusionGrid grid;
    RayScene scene;
    Raster places;        ///< all grid points, as an image of one row
    Surface surfaces[2];  ///< at all grid points: seen from the normal's side, and from behind
    std::vector<Vec3> face;
    at::Tensor outgoing, bounce;  ///< [points, 2, 3]
    float offset;

    State(const Geometry& geometry, const Model* model, const IndirectLightOptions& asked)
        : options(asked),
          grid(make_occlusion_grid(geometry, asked.spacing, asked.max_points)),
          scene(geometry, model) {
        offset = std::max(5e-5f * grid.diagonal, 1e-6f * grid.farthest);
        const std::int64_t count = grid.points();
        at::Tensor barycentrics = at::empty({1, 1, count, 2});
        at::Tensor triangle = at::empty({1, 1, count}, at::kInt);
        at::Tensor normals = at::empty({count, 3});
        face.resize(static_cast<std::size_t>(count));
        for (std::size_t t = 0; t + 1 < grid.first.size(); ++t) {
            const int steps = grid.resolution[t];
            std::int64_t index = grid.first[t];
            for (int j = 0; j <= steps; ++j) {
                for (int i = 0; i + j <= steps; ++i, ++index) {
                    const OcclusionGrid::Point point = grid.point(index);
                    face[static_cast<std::size_t>(index)] = point.face;
                    float* b = barycentrics.data_ptr<float>() + 2 * index;
                    b[0] = static_cast<float>(i) / static_cast<float>(steps);
                    b[1] = static_cast<float>(j) / static_cast<float>(steps);
                    triangle.data_ptr<std::int32_t>()[index] = static_cast<std::int32_t>(t);
                    kernels::store3(normals.data_ptr<float>() + 3 * index, point.normal);
                }
            }
        }
        places.barycentrics = barycentrics;
        places.triangle = triangle;
        places.depth = at::ones({1, 1, count});
        places.positions_clip = at::zeros({1, geometry.positions.size(0), 4});
        const at::NoGradGuard no_gradient;
        surfaces[0] = interpolate_surface(geometry, places, {Camera{}});
        surfaces[0].normal = surfaces[0].view = normals;
        surfaces[1] = surfaces[0];
        surfaces[1].normal = surfaces[1].view = -normals;
        outgoing = at::zeros({count, 2, 3});
        bounce = at::zeros({count, 2, 3});
    }

    /// Returns the position that a point of a triangle had when this object was constructed.
    Vec3 position(std::size_t triangle, const float* barycentrics) const {
        const float* points = surfaces[0].position.const_data_ptr<float>();
        const int steps = grid.resolution[triangle];
        const auto corner = [&](int i, int j) {
            return load_row(points, grid.first[triangle] + kernels::grid_index(steps, i, j));
        };
        const float b0 = barycentrics[0], b1 = barycentrics[1];
        return b0 * corner(steps, 0) + b1 * corner(0, steps) + (1 - b0 - b1) * corner(0, 0);
    }

    /// Returns the radiance that arrives at the ray's origin; red is negative if nothing is hit.
    Vec3 seen(Vec3 origin, Vec3 direction, std::uint64_t chance) const {
        const RayScene::Hit hit = scene.nearest(origin, direction, chance);
        if (hit.triangle < 0) return Vec3(-1.0f);
        const auto t = static_cast<std::size_t>(hit.triangle);
        const GridPlace place =
            grid_place_of(grid.first[t], grid.resolution[t], hit.first, hit.second);
        const int behind =
            glm::dot(face[static_cast<std::size_t>(place.points[0])], direction) > 0 ? 1 : 0;
        Vec3 sum(0.0f);
        for (int k = 0; k < 3; ++k)
            sum += place.weights[k] *
                   load_row(outgoing.const_data_ptr<float>(), 2 * place.points[k] + behind);
        return sum;
    }

    void trace_bounce() {
        float* out = bounce.data_ptr<float>();
        const auto groups = static_cast<std::int64_t>(grid.begin.size()) - 1;
        parallel_for(
            "trace bounce", 2 * groups,
            [&](std::int64_t i) {
                const bool behind = i % 2 == 1;
                const auto group = static_cast<std::size_t>(i / 2);
                const std::int64_t member =
                    grid.member[static_cast<std::size_t>(grid.begin[group])];
                const OcclusionGrid::Point point = grid.point(member);
                Random random(options.seed,
                              grid.key[static_cast<std::size_t>(member)] ^ (behind ? 1u : 0u));
                const Frame frame(behind ? -point.normal : point.normal);
                const Vec3 up = glm::dot(frame.up, point.face) < 0 ? -point.face : point.face;
                Vec3 sum(0.0f);
                bool is_open = false;
                int traced = 0;
                // For any k, the first k rays are evenly distributed.
                const double first = random.uniform();
                for (int ray = 0; ray < options.rays; ++ray) {
                    // If no direction was open so far, the point is inside a closed shape and never
                    // seen.
                    if (ray == options.rays / 4 && ray >= 16 && !is_open) break;
                    ++traced;
                    const double share = std::fmod(first + golden_ratio * ray, 1.0);
                    const auto turn = static_cast<float>(random.uniform());
                    const Vec3 direction =
                        frame.at(std::sqrt(static_cast<float>(1 - share)), 2 * pi * turn);
                    if (!(glm::dot(direction, up) > 0)) continue;
                    const Vec3 radiance =
                        seen(point.position + offset * up, direction, random.bits());
                    if (radiance.x >= 0)
                        sum += radiance;
                    else
                        is_open = true;
                }
                sum /= static_cast<float>(traced);
                for (std::int64_t m = grid.begin[group]; m < grid.begin[group + 1]; ++m)
                    kernels::store3(
                        out + 3 * (2 * grid.member[static_cast<std::size_t>(m)] + (behind ? 1 : 0)),
                        sum);
            },
            16);
    }
};

IndirectLight::IndirectLight(const Geometry& geometry, const Model* model,
                             const IndirectLightOptions& options)
    : state_(std::make_shared<State>(geometry, model, options)) {}

void IndirectLight::update(const Outgoing& outgoing) {
    const at::NoGradGuard no_gradient;
    State& state = *state_;
    state.bounce.zero_();
    for (int bounce = 0; bounce < state.options.bounces; ++bounce) {
        for (std::int64_t side = 0; side < 2; ++side)
            state.outgoing.select(1, side).copy_(
                outgoing(state.places, state.surfaces[side], state.bounce.select(1, side)));
        state.trace_bounce();
    }
}

at::Tensor IndirectLight::bounce(const Raster& raster, const Surface& surface) const {
    const State& state = *state_;
    const at::Tensor barycentrics = raster.barycentrics.detach().contiguous();
    const at::Tensor triangle = raster.triangle.contiguous();
    const at::Tensor normal = surface.normal.detach().contiguous();
    at::Tensor result = at::empty({surface.count(), 3});
    const float* b = barycentrics.const_data_ptr<float>();
    const float* values = state.bounce.const_data_ptr<float>();
    const float* outward = state.surfaces[0].normal.const_data_ptr<float>();
    parallel_for(
        "look up bounce", surface.count(),
        [&](std::int64_t i) {
            const std::int64_t pixel = surface.pixel.const_data_ptr<std::int64_t>()[i];
            const auto t = static_cast<std::size_t>(triangle.const_data_ptr<std::int32_t>()[pixel]);
            const GridPlace place = grid_place_of(state.grid.first[t], state.grid.resolution[t],
                                                  b[2 * pixel], b[2 * pixel + 1]);
            Vec3 normal_there(0.0f), sum(0.0f);
            for (int k = 0; k < 3; ++k)
                normal_there += place.weights[k] * load_row(outward, place.points[k]);
            const int behind =
                glm::dot(normal_there, load_row(normal.const_data_ptr<float>(), i)) < 0 ? 1 : 0;
            for (int k = 0; k < 3; ++k)
                sum += place.weights[k] * load_row(values, 2 * place.points[k] + behind);
            kernels::store3(result.data_ptr<float>() + 3 * i, sum);
        },
        4096);
    return result;
}

IndirectLight::Reflection IndirectLight::reflect(const Raster& raster, const Surface& surface,
                                                 const at::Tensor& roughness, int rays,
                                                 std::uint64_t seed) const {
    const State& state = *state_;
    const auto plain = [](const at::Tensor& tensor) { return tensor.detach().contiguous(); };
    const at::Tensor view = plain(surface.view), normals = plain(surface.normal);
    const at::Tensor rough = plain(roughness), triangle = plain(raster.triangle);
    const at::Tensor barycentrics = plain(raster.barycentrics);
    Reflection result{at::empty({surface.count(), 3}), at::empty({surface.count(), 1})};
    parallel_for(
        "reflect", surface.count(),
        [&](std::int64_t i) {
            const std::int64_t pixel = surface.pixel.const_data_ptr<std::int64_t>()[i];
            const auto t = static_cast<std::size_t>(triangle.const_data_ptr<std::int32_t>()[pixel]);
            const Vec3 to_view = load_row(view.const_data_ptr<float>(), i);
            Vec3 up = state.face[static_cast<std::size_t>(state.grid.first[t])];
            if (glm::dot(up, to_view) < 0) up = -up;
            const Frame frame(load_row(normals.const_data_ptr<float>(), i));
            // The ray starts from the position at construction. If the surface has moved since
            // then, its new position may lie below the traced triangles.
            const Vec3 origin =
                state.position(t, barycentrics.const_data_ptr<float>() + 2 * pixel) +
                state.offset * up;
            const float width = rough.const_data_ptr<float>()[i] * rough.const_data_ptr<float>()[i];
            Random random(seed, static_cast<std::uint64_t>(pixel));
            Vec3 sum(0.0f);
            float open = 0;
            for (int ray = 0; ray < rays; ++ray) {
                const float share =
                    (static_cast<float>(ray) + static_cast<float>(random.uniform())) /
                    static_cast<float>(rays);
                const auto turn = static_cast<float>(random.uniform());
                const float cosine = std::sqrt((1 - share) / (1 + (width * width - 1) * share));
                const Vec3 half = frame.at(cosine, 2 * pi * turn);
                const Vec3 direction = 2 * glm::dot(half, to_view) * half - to_view;
                // A direction of the specular lobe that points below the triangle does not count as
                // occluded.
                const Vec3 radiance = glm::dot(direction, up) > 0
                                          ? state.seen(origin, direction, random.bits())
                                          : Vec3(-1.0f);
                if (radiance.x < 0)
                    open += 1;
                else
                    sum += radiance;
            }
            kernels::store3(result.radiance.data_ptr<float>() + 3 * i,
                            sum / static_cast<float>(rays));
            result.open.data_ptr<float>()[i] = open / static_cast<float>(rays);
        },
        256);
    return result;
}

at::Tensor IndirectLight::stored() const {
    return at::stack({state_->outgoing, state_->bounce});
}

void IndirectLight::restore(const at::Tensor& stored) {
    state_->outgoing.copy_(stored[0]);
    state_->bounce.copy_(stored[1]);
}

at::Tensor outgoing_radiance(const Surface& surface, MaterialSample material,
                             const EnvironmentLight& light, const at::Tensor& bounce) {
    material.normal = at::Tensor();
    return shade(surface, material, light) +
           material.base_color * (1 - material.orm.narrow(1, 2, 1)) * bounce;
}

std::shared_ptr<const IndirectLight> trace_indirect_light(const Geometry& geometry,
                                                          const Model& model,
                                                          const TexturedMaterials& materials,
                                                          const EnvironmentLight& light,
                                                          const Occlusion& occlusion) {
    auto indirect =
        std::make_shared<IndirectLight>(geometry, &model, IndirectLightOptions{.rays = 128});
    indirect->update([&](const Raster& raster, const Surface& surface, const at::Tensor& bounce) {
        return outgoing_radiance(
            surface, occlusion.shadowed(materials.sample(surface), raster, surface), light, bounce);
    });
    return indirect;
}

at::Tensor shade_indirect(const Surface& surface, const MaterialSample& material,
                          const EnvironmentLight& light, const at::Tensor& bounce,
                          const IndirectLight::Reflection& reflection,
                          const ShadeOptions& options) {
    const at::Tensor ones = at::ones_like(material.orm.narrow(1, 0, 1));
    const at::Tensor occlusion = material.orm.narrow(1, 0, 1);
    const at::Tensor roughness = material.orm.narrow(1, 1, 1);
    const at::Tensor metallic = material.orm.narrow(1, 2, 1);
    MaterialSample open = material, mirror = material;
    open.emissive = mirror.emissive = at::Tensor();
    open.orm = at::cat({ones, roughness, metallic}, 1);
    // A metal with the material's F0 has the same specular part, and no diffuse part.
    mirror.base_color = dielectric + (material.base_color - dielectric) * metallic;
    mirror.orm = at::cat({ones, roughness, ones}, 1);
    const at::Tensor mirrored = shade(surface, mirror, light, options);
    const at::Tensor diffuse = shade(surface, open, light, options) - mirrored;
    const at::Tensor reflectance = shade(surface, mirror, white_light(), options);
    at::Tensor radiance = diffuse * occlusion + material.base_color * (1 - metallic) * bounce +
                          mirrored * reflection.open + reflectance * reflection.radiance;
    if (material.emissive.defined()) radiance = radiance + material.emissive;
    return radiance;
}

}  // namespace item3d
