// The guidance and the cameras of the chosen edit method, if the method optimises a neural texture.
#pragma once

#include "item3d/edit/request.h"
#include "item3d/edit/scene.h"
#include "item3d/guidance/guidance.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace item3d {

/// Returns the plan's guidance, or the method's own guidance if the method has one. Throws
/// InputError if a network that the method needs is missing.
std::unique_ptr<Guidance> guidance_of_method(const EditRequest& request, const EditScene& scene);

/// Returns the cameras of an iteration: random ones, or views of a method's fixed set.
std::vector<Camera> cameras_of_method(const EditScene& scene, const EditPlan& plan,
                                      std::int64_t iteration);

}  // namespace item3d
