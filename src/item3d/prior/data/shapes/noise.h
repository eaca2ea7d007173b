// Cheap band-limited random field. It is a sum of cosines of random wave vectors, and its values
// are close to N(0, 1).
#pragma once

#include "item3d/core/math.h"
#include "item3d/core/random.h"

#include <array>
#include <vector>

namespace item3d {

class CosineNoise {
  public:
    /// frequency: mean length of the wave vectors in radians per unit; each octave multiplies it by
    /// 2.1 and halves the amplitude. stretch multiplies the coordinates.
    CosineNoise(Random& random, float frequency, int octaves = 1, const Vec3& stretch = Vec3(1.0f));
    float operator()(const Vec3& p) const;
    /// Returns the value and adds the gradient to `gradient`.
    float with_gradient(const Vec3& p, Vec3& gradient) const;

  private:
    static constexpr int waves = 12;
    struct Octave {
        std::array<float, waves> x, y, z, phase;  ///< wave vector and phase in turns, not radians
        float amplitude;
    };
    std::vector<Octave> octaves_;
};

}  // namespace item3d
