// The images of runs for the page.
#pragma once

#include "item3d/compare/runs.h"
#include "item3d/scene/camera.h"
#include "item3d/scene/image.h"
#include "item3d/scene/model.h"
#include "item3d/tensors/tensor.h"

#include <nlohmann/json.hpp>

#include <vector>

namespace item3d {

inline constexpr int run_view_count = 6;
inline constexpr int run_view_pixels = 256;

/// Models before and after a run, each with its light.
struct RunModels {
    Model before, after;
    Image light_before, light_after;
};

/// Draws the images listed by images_of_run() into the run's folder. cameras: run_view_count
/// cameras around the model; views: [N, 3, H, W] renders of `after` by these cameras, in sRGB over
/// white; painted: files in the folder that the method itself drew, empty for most methods.
void write_run_images(const CompareRun& run, const RunModels& models,
                      const std::vector<Camera>& cameras, const at::Tensor& views,
                      const std::vector<std::string>& painted, const ImageWishes& wishes);

/// Returns the images, [{"file", "caption"}], of the model before the edit or of the result. The
/// two views in the edit's light come first.
nlohmann::json images_of_run(const ImageWishes& wishes, bool before);

}  // namespace item3d
