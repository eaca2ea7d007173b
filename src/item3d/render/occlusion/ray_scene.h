// Rays against a model's triangles: does anything stand in the way?
#pragma once

#include "item3d/render/geometry.h"

#include <cstdint>
#include <memory>

namespace item3d {

/// A bounding volume hierarchy (Embree) over the triangles of a geometry on the CPU. Both sides of
/// a triangle stop rays, as both sides are drawn.
class RayScene {
  public:
    /// model: whose materials make triangles transparent (a texture's alpha against the cutoff for
    /// masked materials; by chance, with the probability 1 - alpha, for blended ones). Null: all
    /// triangles are opaque. The model is not needed afterwards.
    explicit RayScene(const Geometry& geometry, const Model* model = nullptr);

    /// Whether a triangle is hit anywhere along the ray. chance: seeds what blended triangles let
    /// through; the same ray and chance give the same answer. Safe to call from many threads.
    bool blocked(Vec3 origin, Vec3 direction, std::uint64_t chance = 0) const;

    struct Hit {
        std::int32_t triangle = -1;   ///< -1: nothing is hit
        float first = 0, second = 0;  ///< barycentrics of the triangle's vertices 0 and 1
    };
    /// The nearest triangle along the ray.
    Hit nearest(Vec3 origin, Vec3 direction, std::uint64_t chance = 0) const;

  private:
    struct State;
    std::shared_ptr<const State> state_;
};

}  // namespace item3d
