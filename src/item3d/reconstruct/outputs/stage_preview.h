// Preview image of a running reconstruction, updated in the output folder.
#pragma once

#include "item3d/reconstruct/stage.h"

#include <array>
#include <filesystem>
#include <vector>

namespace item3d {

/// Preview image: photographs from three sides, the current renders of the same views, and the base
/// colour in these views.
class StagePreview {
  public:
    StagePreview(std::filesystem::path path, const Dataset& dataset);
    /// Replaces the image. If it cannot be written, warns once and disables the preview.
    void update(Stage& stage);

  private:
    std::filesystem::path path_;
    std::vector<TargetView> views_;
    bool enabled_ = true;
};

}  // namespace item3d
