// Which of the source's fine detail still has a place after an edit.
#pragma once

#include "item3d/field/bake/bake.h"
#include "item3d/field/neural_texture.h"
#include "item3d/scene/image.h"

namespace item3d {

/// Around each texel the edit is taken for a linear change of what was there (He et al. 2010,
/// "Guided Image Filtering"): now = gain * fitted + offset in the least squares of a window, with
/// gain in [0, 1]. The remainder source - fitted follows the same law. Where the edit wiped a
/// marking out the gain is near 0, and the marking's crisp outline, which the field could not hold,
/// goes with it; where the source was flat (grain, fine print) it is 1.
class RemainderGain {
  public:
    /// width, height: of the texture that is baked.
    RemainderGain(const BakeScene& scene, const TextureSet& set, int width, int height,
                  NeuralTexture& fitted, NeuralTexture& now);

    /// At the texel's centre.
    float at(int x, int y) const;

  private:
    int width_, height_;
    Image gain_;  ///< coarser than the texture
};

}  // namespace item3d
