// Visibility rays against a model's triangles.
#pragma once

#include "item3d/render/geometry.h"

#include <cstdint>
#include <memory>

namespace item3d {

/// A bounding volume hierarchy (Embree) over the triangles of a geometry on the CPU. Triangles are
/// two-sided, as in rendering.
class RayScene {
  public:
    /// model: model whose materials make triangles transparent. A masked material lets a ray
    /// through where the texture's alpha is below the cutoff. A blended material lets it through at
    /// random, with the probability 1 - alpha. If the model is null, all triangles are opaque. The
    /// model need not outlive the constructor.
    explicit RayScene(const Geometry& geometry, const Model* model = nullptr);

    /// True if a triangle is hit anywhere along the ray. chance: random seed for blended triangles.
    /// The result depends on the ray and `chance` alone. Thread-safe.
    bool blocked(Vec3 origin, Vec3 direction, std::uint64_t chance = 0) const;

    struct Hit {
        std::int32_t triangle = -1;   ///< -1 if nothing is hit
        float first = 0, second = 0;  ///< barycentrics of the triangle's vertices 0 and 1
    };
    /// Returns the nearest hit along the ray.
    Hit nearest(Vec3 origin, Vec3 direction, std::uint64_t chance = 0) const;

  private:
    struct State;
    std::shared_ptr<const State> state_;
};

}  // namespace item3d
