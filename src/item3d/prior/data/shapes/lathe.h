// Solids of revolution around the y axis from a few radii.
#pragma once

#include "item3d/core/math.h"

#include <array>
#include <vector>

namespace item3d {

struct LatheOptions {
    float wall = 0.0f;  ///< wall thickness; 0 for a solid
    /// Factor of the radial distance, at most 1. It keeps this distance a lower bound where the
    /// profile is steep.
    float steepness = 0.6f;
};

/// Profile of radii at heights, joined by a monotone cubic (Fritsch and Carlson 1980), which does
/// not overshoot.
class Lathe {
  public:
    Lathe(const std::vector<float>& heights, const std::vector<float>& radii,
          const LatheOptions& options = {});
    float distance(const Vec3& p) const;

  private:
    static constexpr int samples = 128;
    std::array<float, samples> radius_;
    float bottom_;
    float top_;
    LatheOptions options_;
};

/// Interpolates the points (x, y) at `at` by a monotone cubic. x must be ascending, with at least
/// two points.
float interpolate_monotone(const std::vector<float>& x, const std::vector<float>& y, float at);

}  // namespace item3d
