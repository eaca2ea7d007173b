// Training images with their facts, and the files that keep them.
#pragma once

#include "item3d/prior/data/dataset.h"
#include "item3d/prior/data/labels.h"
#include "item3d/tensors/tensor.h"

#include <filesystem>
#include <vector>

namespace item3d {

struct LabeledImages {
    at::Tensor images;                ///< [N, prior_image_size, prior_image_size, 3] uint8 sRGB
    std::vector<ImageLabels> labels;  ///< one per image

    std::int64_t count() const { return images.size(0); }
    /// Returns the images with these indices as network inputs: [R, 3, prior_image_size,
    /// prior_image_size] float32 in [-1, 1].
    at::Tensor pixel_values(const std::vector<std::int64_t>& rows) const;
};

/// Draws the source's first `count` examples on `threads` threads. The result is incomplete after
/// an interrupt.
LabeledImages draw_labeled(const ExampleSource& source, std::int64_t count, int threads);

/// Writes FOLDER/NAME.safetensors, then FOLDER/NAME.json, whose presence means that both are
/// complete.
void save_labeled(const std::filesystem::path& folder, const std::string& name,
                  const LabeledImages& images);
bool has_labeled(const std::filesystem::path& folder, const std::string& name);
/// Reads both files. Throws InputError if they do not belong together.
LabeledImages load_labeled(const std::filesystem::path& folder, const std::string& name);

}  // namespace item3d
