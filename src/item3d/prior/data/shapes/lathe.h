// Solids of revolution around the y axis from a few radii.
#pragma once

#include "item3d/core/math.h"

#include <array>
#include <vector>

namespace item3d {

struct LatheOptions {
    float wall = 0.0f;       ///< thickness of the wall; 0: solid
    float steepness = 0.6f;  ///< at most 1; scales radial distance so that slopes stay a bound
};

/// Radii at heights, joined by a monotone cubic (Fritsch and Carlson 1980), so that no bulge
/// appears that the radii do not have.
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

/// Monotone cubic interpolation of (x, y) at `at`; x ascending, at least two points.
float interpolate_monotone(const std::vector<float>& x, const std::vector<float>& y, float at);

}  // namespace item3d
