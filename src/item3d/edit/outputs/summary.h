// The record of an edit: edit.json and report.html.
#pragma once

#include "item3d/core/stage_times.h"
#include "item3d/edit/optimize/optimize.h"
#include "item3d/edit/outputs/baked_files.h"
#include "item3d/edit/outputs/edit_images.h"
#include "item3d/edit/request.h"
#include "item3d/edit/scene.h"
#include "item3d/edit/state.h"

#include <nlohmann/json.hpp>

namespace item3d {

/// Writes report.html and edit.json. Returns the content of edit.json.
nlohmann::json write_summary(const EditRequest& request, const EditScene& scene,
                             const EditState& state, const StageTimes& times,
                             const IterationTimes& iteration_times, const EditedModel& edited,
                             const EditImages& images);

}  // namespace item3d
