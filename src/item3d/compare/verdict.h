// Check of a result against its case's expectation.
#pragma once

#include "item3d/compare/runs.h"
#include "item3d/tensors/tensor.h"

#include <nlohmann/json.hpp>

namespace item3d {

/// Throws InputError that names the first case whose word one of the priors lacks; a prior without
/// a vocabulary passes.
void check_expectations(const CompareOptions& options);

/// Returns {"found", "right"}. A colour is found as the prior's colour nearest to the surface's
/// mean base colour in CIELAB, a material or pattern as the choice of the prior's own CLIP among
/// all of its colours, materials and patterns. Empty if nothing is expected, or the prior cannot
/// tell.
///
/// after: "scores"."after" of edit.json; images: [N, 3, H, W] sRGB in [0, 1], over white.
nlohmann::json verdict_of(const CompareCase& test, const nlohmann::json& after,
                          const at::Tensor& images, const std::filesystem::path& prior);

}  // namespace item3d
