// Pictures of what runs made, for the page.
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

/// The models before and after a run, each with the light that it is shown in.
struct RunModels {
    Model before, after;
    Image light_before, light_after;
};

/// Draws into the run's folder what pictures_of_run() lists. cameras: run_view_count around the
/// model; views: [N, 3, H, W] of `after` from there, sRGB over white; painted: files in the folder
/// that the method drew itself, none of most.
void write_run_pictures(const CompareRun& run, const RunModels& models,
                        const std::vector<Camera>& cameras, const at::Tensor& views,
                        const std::vector<std::string>& painted, const PictureWishes& wishes);

/// [{"file", "caption"}] of the result, or of the model before; two views of it come first.
nlohmann::json pictures_of_run(const PictureWishes& wishes, bool before);

}  // namespace item3d
