// Check of a prior's folder that reads only configurations and the headers of weight files.
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
    std::string stored_as;         ///< types of its tensors, for example "fp16"; "" without weights
    std::uint64_t file_bytes = 0;  ///< size of its weights on disk
};

/// Bytes that an edit needs at one precision of the networks.
struct MemoryReport {
    std::string precision;            ///< "fp32", "bf16" or "fp16"
    std::uint64_t weights = 0;        ///< exact; the text encoders stay fp32
    std::uint64_t text_encoders = 0;  ///< text encoders' part of `weights`
    // The members below are approximate.
    /// Memory, besides the weights, that does not grow with the number of images.
    std::uint64_t program = 0;
    /// Activations that gradients need, for one image of the size that the U-Net was trained on.
    std::uint64_t kept_by_gradients = 0;
    /// The same, if the activations of the autoencoder's encoder are recomputed.
    std::uint64_t kept_when_low = 0;

    /// Peak memory of an edit with one image per step, of the size that the U-Net was trained on.
    /// Text encoders are released before the other networks load.
    std::uint64_t edit_peak_estimate() const {
        return std::max(weights - text_encoders + program + kept_by_gradients, text_encoders);
    }
};

struct PriorReport {
    std::string folder;
    std::string pipeline_class;  ///< "StableDiffusionPipeline"
    std::vector<PartReport> parts;
    std::vector<MemoryReport> memory;  ///< empty when there are problems
    int resolution = 0;  ///< pixels along one side of the images that the U-Net was trained on
    int condition_channels = 0;   ///< U-Net inputs beyond the latents (shape_condition.h)
    std::string prediction_type;  ///< "epsilon", "v_prediction", "sample"
    /// One line for each missing, misshapen or unsupported part; it names the file.
    std::vector<std::string> problems;

    bool usable() const { return problems.empty(); }
    std::int64_t parameters() const;
};

/// Reads configurations and weight headers, but no weights, so that a folder of gigabytes takes as
/// long as one of kilobytes. Throws InputError if `folder` has no readable model_index.json; all
/// other errors go to `problems`.
PriorReport verify_prior(const std::filesystem::path& folder);

}  // namespace item3d
