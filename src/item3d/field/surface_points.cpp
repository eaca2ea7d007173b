#include "item3d/field/surface_points.h"

#include "item3d/core/error.h"
#include "item3d/field/atlas/shared_texels.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace item3d {
namespace {

/// Returns the [4, 3] float32 affine map from `from` to `to`, two sets of corresponding points.
at::Tensor affine_between(const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
    constexpr std::size_t maximum = 4096;  // number of points, for twelve unknowns
    const std::size_t stride = std::max<std::size_t>(1, from.size() / maximum);
    std::vector<double> a, b;
    for (std::size_t i = 0; i < from.size(); i += stride) {
        a.insert(a.end(), {from[i].x, from[i].y, from[i].z, 1.0});
        b.insert(b.end(), {to[i].x, to[i].y, to[i].z});
    }
    const at::Tensor lhs = at::tensor(a, at::kDouble).view({-1, 4});
    const at::Tensor rhs = at::tensor(b, at::kDouble).view({-1, 3});
    // The pseudo-inverse is used because a flat primitive determines the map only within its plane.
    return at::matmul(at::linalg_pinv(lhs, 1e-7), rhs).to(at::kFloat);
}

}  // namespace

Surface surface_at(const Geometry& geometry, const at::Tensor& triangle,
                   const at::Tensor& barycentrics) {
    const at::Tensor corners = geometry.triangles.index_select(0, triangle).to(at::kLong);
    const at::Tensor u = barycentrics.narrow(1, 0, 1);
    const at::Tensor v = barycentrics.narrow(1, 1, 1);
    const at::Tensor w = 1.0f - u - v;
    const auto interpolate = [&](const at::Tensor& attribute) {
        return attribute.index_select(0, corners.select(1, 0)) * u +
               attribute.index_select(0, corners.select(1, 1)) * v +
               attribute.index_select(0, corners.select(1, 2)) * w;
    };
    const auto unit = [](const at::Tensor& vector) {
        return vector / at::sqrt(vector.square().sum(1, true)).clamp_min(1e-12);
    };
    Surface surface;
    surface.pixel = at::arange(triangle.size(0), triangle.options());
    surface.position = interpolate(geometry.positions);
    surface.normal = unit(interpolate(geometry.normals));
    surface.tangent = interpolate(geometry.tangents);
    surface.uv = interpolate(geometry.uvs);
    for (const at::Tensor& further : geometry.further_uvs)
        surface.further_uvs.push_back(interpolate(further));
    surface.color = interpolate(geometry.colors);
    surface.view = surface.normal;
    surface.material = geometry.triangle_material.index_select(0, triangle).to(at::kLong);
    surface.primitive = geometry.triangle_primitive.index_select(0, triangle).to(at::kLong);
    surface.triangle = triangle;
    return surface;
}

FieldSpace::FieldSpace(const Model& model, const std::vector<int>& materials, at::Device device) {
    std::map<std::pair<int, int>, int> seen;
    std::vector<at::Tensor> transforms;
    bounds_ = {Vec3(1e30f), Vec3(-1e30f)};
    bool any = false;
    for (std::size_t i = 0; i < model.primitives.size(); ++i) {
        const Primitive& primitive = model.primitives[i];
        int first = static_cast<int>(i);
        if (primitive.source_mesh >= 0) {
            const auto [at, fresh] =
                seen.try_emplace({primitive.source_mesh, primitive.source_primitive}, first);
            if (model.primitives[static_cast<std::size_t>(at->second)].positions.size() ==
                primitive.positions.size()) {
                first = at->second;
            }
        }
        first_instance_.push_back(first);
        edited_.push_back(std::find(materials.begin(), materials.end(), primitive.material) !=
                          materials.end());
        if (first == static_cast<int>(i)) {
            transforms.push_back(at::eye(4).narrow(1, 0, 3));
            if (!edited_.back()) continue;
            any = true;
            for (const Vec3& p : primitive.positions) {
                bounds_ = {glm::min(bounds_[0], p), glm::max(bounds_[1], p)};
            }
        } else {
            has_instances_ = true;
            transforms.push_back(affine_between(
                primitive.positions, model.primitives[static_cast<std::size_t>(first)].positions));
        }
    }
    ITEM3D_CHECK(any, "no primitive has one of the edited materials");
    transforms_ = at::stack(transforms).to(device);
}

at::Tensor FieldSpace::positions(const Surface& surface) const {
    at::Tensor positions = surface.position;
    if (has_instances_) {
        const at::Tensor transform = transforms_.index_select(0, surface.primitive);  // [P, 4, 3]
        positions = at::matmul(positions.unsqueeze(1), transform.narrow(1, 0, 3)).squeeze(1) +
                    transform.select(1, 3);
    }
    return shared_ ? shared_->representatives(surface, positions) : positions;
}

SurfaceSampler::SurfaceSampler(const Geometry& geometry, const FieldSpace& space)
    : geometry_(geometry) {
    const at::Tensor positions = geometry.positions.detach().cpu().contiguous();
    const at::Tensor corners = geometry.triangles.cpu().contiguous();
    const at::Tensor owners = geometry.triangle_primitive.cpu().contiguous();
    const float* p = positions.data_ptr<float>();
    const std::int32_t* triangle = corners.data_ptr<std::int32_t>();
    const std::int32_t* primitive = owners.data_ptr<std::int32_t>();
    const auto corner = [&](std::int64_t t, int c) {
        const std::int64_t v = triangle[3 * t + c];
        return Vec3(p[3 * v], p[3 * v + 1], p[3 * v + 2]);
    };
    for (std::int64_t t = 0; t < corners.size(0); ++t) {
        const int owner = primitive[t];
        if (!space.edited(owner)) continue;
        if (space.first_instance()[static_cast<std::size_t>(owner)] != owner) continue;
        const Vec3 a = corner(t, 0), ab = corner(t, 1) - a, ac = corner(t, 2) - a;
        double area = 0.5 * glm::length(glm::cross(ab, ac));
        // In float, the square of a tiny area is 0.
        if (!(area > 0.0)) area = 0.5 * glm::length(glm::cross(glm::dvec3(ab), glm::dvec3(ac)));
        if (!(area > 0.0)) continue;
        area_ += area;
        triangles_.push_back(static_cast<std::int32_t>(t));
        cumulative_.push_back(area_);
    }
    ITEM3D_CHECK(!triangles_.empty(), "the edited materials cover no area");
}

Surface SurfaceSampler::sample(std::int64_t count, Random& random) const {
    at::Tensor triangle = at::empty({count}, at::kLong);
    at::Tensor barycentrics = at::empty({count, 2}, at::kFloat);
    std::int64_t* t = triangle.data_ptr<std::int64_t>();
    float* b = barycentrics.data_ptr<float>();
    for (std::int64_t i = 0; i < count; ++i) {
        // The sampling is stratified, with one point in each of `count` equal parts of the area.
        const double at =
            (static_cast<double>(i) + random.uniform()) / static_cast<double>(count) * area_;
        const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end() - 1, at);
        t[i] = triangles_[static_cast<std::size_t>(found - cumulative_.begin())];
        const double root = std::sqrt(random.uniform());
        const double v = random.uniform() * root;
        b[2 * i] = static_cast<float>(1.0 - root);
        b[2 * i + 1] = static_cast<float>(v);
    }
    const at::Device device = geometry_.positions.device();
    return surface_at(geometry_, triangle.to(device), barycentrics.to(device));
}

}  // namespace item3d
