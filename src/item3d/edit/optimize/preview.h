// A picture of the edit so far, refreshed in the output folder while it runs.
#pragma once

#include "item3d/edit/scene.h"

#include <filesystem>
#include <vector>

namespace item3d {

class Preview {
  public:
    Preview(std::filesystem::path path, const EditScene& scene);
    /// Draws the field in that light from three sides and replaces the picture. A preview that
    /// cannot be written is not worth stopping an edit for: it warns once and gives up.
    void update(NeuralTexture& field, const EnvironmentLight& light);

  private:
    std::filesystem::path path_;
    const EditScene& scene_;
    std::vector<Camera> cameras_;
    bool enabled_ = true;
};

}  // namespace item3d
