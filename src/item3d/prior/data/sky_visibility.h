// Shadows that are cheap enough for millions of images. The visible parts of the sky at a point are
// traced once per shape; the brightness of each part is computed once per light. Shading multiplies
// by the fraction of the light that arrives, as `--occlusion light` does for a whole model
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

/// Returns directions spread evenly over the sphere (a Fibonacci lattice).
const std::array<Vec3, sky_parts>& sky_directions();

/// Luminance times solid angle of an equirectangular map around each direction. Parts overlap, so
/// that a sun between two directions casts a soft shadow.
using SkyLight = std::array<float, sky_parts>;
SkyLight sky_light(const Image& map);

/// Returns the fraction, 0 .. 1, of the light's irradiance at a surface of normal n that comes from
/// the directions whose bits are set.
float arriving_share(std::uint32_t visible, const Vec3& n, const SkyLight& light);

/// Ray tracer of sky visibility at points of a geometry; points close together share one result.
class SkyVisibility {
  public:
    explicit SkyVisibility(const Geometry& geometry) : scene_(geometry) {}
    /// Returns a set of directions: bit i is set if the ray from the point along
    /// sky_directions()[i] hits nothing. n: the outward normal.
    std::uint32_t at(const Vec3& p, const Vec3& n);

  private:
    RayScene scene_;
    std::unordered_map<std::uint64_t, std::uint32_t> known_;
};

}  // namespace item3d
