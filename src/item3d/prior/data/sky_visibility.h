// Shadows that are cheap enough for millions of pictures: which parts of the sky a point sees,
// found once a shape with rays, and how bright these parts are, found once a light. Shading
// multiplies by the share that arrives, as `--occlusion light` does for a whole model
// (render/occlusion.h).
#pragma once

#include "item3d/core/math.h"
#include "item3d/render/occlusion/ray_scene.h"
#include "item3d/scene/image.h"

#include <array>
#include <cstdint>
#include <unordered_map>

namespace item3d {

inline constexpr std::size_t sky_parts = 32;

/// Spread evenly over the sphere (a Fibonacci lattice).
const std::array<Vec3, sky_parts>& sky_directions();

/// Luminance times solid angle of an equirectangular map around each direction. Parts overlap, so
/// that a sun between two directions casts a shadow with a soft edge.
using SkyLight = std::array<float, sky_parts>;
SkyLight sky_light(const Image& map);

/// The part of the light's irradiance at a surface that faces n, 0 .. 1, that comes from the
/// directions whose bits are set.
float arriving_share(std::uint32_t visible, const Vec3& n, const SkyLight& light);

/// Traces rays from points of a geometry; points that are near each other share theirs.
class SkyVisibility {
  public:
    explicit SkyVisibility(const Geometry& geometry) : scene_(geometry) {}
    /// Bit i: nothing stands between the point and sky_directions()[i]. n: the outward normal.
    std::uint32_t at(const Vec3& p, const Vec3& n);

  private:
    RayScene scene_;
    std::unordered_map<std::uint64_t, std::uint32_t> known_;
};

}  // namespace item3d
