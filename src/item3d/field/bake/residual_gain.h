// The factor by which the source's fine detail is kept in an edit.
#pragma once

#include "item3d/field/bake/bake.h"
#include "item3d/field/neural_texture.h"
#include "item3d/scene/image.h"

namespace item3d {

/// Fits the edit around each texel by a linear function of the previous colour (He et al. 2010,
/// "Guided Image Filtering"). The function is now = gain * fitted + offset, by least squares over a
/// window, with the gain in [0, 1]. The bake multiplies the residual, source - fitted, by the gain.
/// Where the edit removed a marking the gain is near 0, and the marking's crisp outline, which the
/// field cannot represent, disappears too. Where `fitted` is flat, so that only the residual has
/// detail (grain, fine print), the gain is 1.
class ResidualGain {
  public:
    /// width, height: size of the baked texture.
    ResidualGain(const BakeScene& scene, const TextureSet& set, int width, int height,
                 NeuralTexture& fitted, NeuralTexture& now);

    /// Returns the gain at the texel's centre.
    float at(int x, int y) const;

  private:
    int width_, height_;
    Image gain_;  ///< coarser than the texture
};

}  // namespace item3d
