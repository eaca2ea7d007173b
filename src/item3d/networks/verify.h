// What a prior's folder holds and whether it can be used, told by configurations and headers alone.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

/// One sub-folder of a pipeline.
struct PartReport {
    std::string name;              ///< "unet"
    std::string class_name;        ///< "UNet2DConditionModel"
    std::int64_t parameters = 0;   ///< 0 for parts without weights, and for those with problems
    std::string stored_as;         ///< types of its tensors, as in "fp16"; "" without weights
    std::uint64_t file_bytes = 0;  ///< of its weights on the disk
};

/// Bytes that an edit needs when the networks compute in this precision.
struct MemoryReport {
    std::string precision;            ///< "fp32", "bf16" or "fp16"
    std::uint64_t weights = 0;        ///< exact; the text encoders stay fp32
    std::uint64_t text_encoders = 0;  ///< their part of it
    // Estimates, of the right order:
    std::uint64_t program = 0;            ///< all else that does not grow with pictures
    std::uint64_t kept_by_gradients = 0;  ///< of one picture of the U-Net's own size
    std::uint64_t kept_when_low = 0;      ///< the same with the encoder's values computed again

    /// With one such picture in each step. The text encoders go before the others come.
    std::uint64_t edit_peak_estimate() const {
        return std::max(weights - text_encoders + program + kept_by_gradients, text_encoders);
    }
};

struct PriorReport {
    std::string folder;
    std::string pipeline_class;  ///< "StableDiffusionPipeline"
    std::vector<PartReport> parts;
    std::vector<MemoryReport> memory;  ///< empty when there are problems
    int resolution = 0;                ///< pixels of a side that the U-Net was trained on
    int condition_channels = 0;   ///< U-Net inputs beyond the latents (models/shape_condition.h)
    std::string prediction_type;  ///< "epsilon", "v_prediction", "sample"
    /// One line each, naming the file: what is missing, misshapen or unsupported.
    std::vector<std::string> problems;

    bool usable() const { return problems.empty(); }
    std::int64_t parameters() const;
};

/// Reads configurations and the headers of weights; no weight is read, so that it takes as long for
/// gigabytes as for kilobytes. Throws InputError when `folder` has no readable model_index.json;
/// all else is told in `problems`.
PriorReport verify_prior(const std::filesystem::path& folder);

}  // namespace item3d
