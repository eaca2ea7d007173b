// The check of a result against its case's expectation.
#pragma once

#include "item3d/compare/runs.h"
#include "item3d/tensors/tensor.h"

#include <nlohmann/json.hpp>

namespace item3d {

/// Throws InputError that names the first case whose expected word is missing in the vocabulary of
/// a prior. A prior without a vocabulary passes.
void check_expectations(const CompareOptions& options);

/// Returns {"found", "right"}: the word found in the result, and whether it is the expected one. If
/// a colour is expected, "found" is the prior's colour nearest in CIELAB to the mean base colour of
/// the surface. If a material or a pattern is expected, "found" is what the prior's own CLIP
/// chooses among all of the prior's colours, materials and patterns. Empty if nothing is expected,
/// or the prior cannot tell.
///
/// after: "scores"."after" of edit.json; images: [N, 3, H, W] sRGB in [0, 1], over white.
nlohmann::json verdict_of(const CompareCase& test, const nlohmann::json& after,
                          const at::Tensor& images, const std::filesystem::path& prior);

}  // namespace item3d
