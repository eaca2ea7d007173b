// Training images with part labels, and the files that keep them.
#pragma once

#include "item3d/prior/data/dataset.h"
#include "item3d/prior/data/part_labels.h"
#include "item3d/tensors/tensor.h"

#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

/// Edge in pixels of the images with part labels: the input size of the embedded segmenter.
inline constexpr int part_image_size = 112;

struct PartImages {
    at::Tensor images;               ///< [N, S, S, 3] uint8 sRGB
    at::Tensor parts;                ///< [N, S, S] uint8, as from part_map_of()
    std::vector<PartLabels> labels;  ///< N

    std::int64_t count() const { return images.size(0); }
    /// Returns the images with these indices as network inputs: [R, 3, S, S] float32 in [-1, 1].
    at::Tensor pixel_values(const std::vector<std::int64_t>& rows) const;
    /// Returns the mask of a set of parts in one image, [S, S] float32, 1 on the pixels of the
    /// parts.
    at::Tensor mask(std::int64_t row, std::uint32_t parts) const;
};

/// Draws the source's first `count` examples on `threads` threads. The result is incomplete after
/// an interrupt.
PartImages draw_part_images(const ExampleSource& source, std::int64_t count, int threads);

/// Writes FOLDER/NAME.safetensors, then FOLDER/NAME.json, whose presence means that both are
/// complete.
void save_part_images(const std::filesystem::path& folder, const std::string& name,
                      const PartImages& images);
bool has_part_images(const std::filesystem::path& folder, const std::string& name);
/// Reads both files. Throws InputError if they do not belong together.
PartImages load_part_images(const std::filesystem::path& folder, const std::string& name);

}  // namespace item3d
