// A picture of the reconstruction so far, refreshed in the output folder while it runs.
#pragma once

#include "item3d/reconstruct/stage.h"

#include <array>
#include <filesystem>
#include <vector>

namespace item3d {

/// Photographs of three sides, the same views as they are drawn now, and their base colour.
class StagePreview {
  public:
    StagePreview(std::filesystem::path path, const Dataset& dataset);
    /// Replaces the picture. A preview that cannot be written is not worth stopping for: it warns
    /// once and gives up.
    void update(Stage& stage);

  private:
    std::filesystem::path path_;
    std::vector<TargetView> views_;
    bool enabled_ = true;
};

}  // namespace item3d
