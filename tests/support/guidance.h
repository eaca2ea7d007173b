// Shared helpers of the guidance tests: the tiny pipeline and images for it.
#pragma once

#include "item3d/guidance/guidance.h"
#include "item3d/networks/diffusion/pipeline.h"

#include <algorithm>
#include <filesystem>

namespace item3d::testing {

inline std::shared_ptr<const Pipeline> load_pipeline() {
    return std::make_shared<Pipeline>(
        Pipeline::load(std::filesystem::path(ITEM3D_TEST_DATA) / "models" / "pipeline_sd"));
}

/// Returns two random images, and two other images as renders of the unedited model.
inline GuidanceInput random_input(std::uint64_t seed) {
    at::manual_seed(seed);
    GuidanceInput input;
    input.images = at::rand({2, 3, 32, 32}).requires_grad_(true);
    input.reference = at::rand({2, 3, 32, 32});
    return input;
}

/// Returns the maximum error relative to the largest expected value, or to 1 if that is larger.
inline double relative_error(const at::Tensor& value, const at::Tensor& expected) {
    const double scale = std::max(1.0, expected.abs().max().item<double>());
    return (value - expected).abs().max().item<double>() / scale;
}

}  // namespace item3d::testing
