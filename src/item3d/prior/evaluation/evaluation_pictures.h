// Pictures that a prior draws and gives back, and what they say of it.
#pragma once

#include "item3d/networks/diffusion/diffusion_model.h"
#include "item3d/networks/vision_language/clip.h"
#include "item3d/prior/data/views.h"
#include "item3d/scene/image.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace item3d {

/// A grid of generated pictures, objects across and materials down.
struct SampleGrid {
    std::vector<std::string> objects;    ///< nouns
    std::vector<std::string> materials;  ///< captions, "{o}" for the noun
    std::vector<std::string> prompts;    ///< row by row
    std::vector<Image> pictures;         ///< row by row, sRGB
};

/// At most `side` by `side` of what the prior was trained on, drawn with its own defaults: from the
/// prompts alone, or in the shape of held-out objects.
SampleGrid draw_samples(const std::filesystem::path& prior, const DiffusionModel& pipeline,
                        const std::set<std::string>& words, int side, bool with_shape,
                        std::uint64_t seed);

/// How well a CLIP, the prior's own, knows the samples again, among all prompts of the grid:
/// {"pictures", "right", "object_right", "material_right", "similarity"}; parts, and the mean
/// cosine of picture and prompt.
nlohmann::json score_samples(const Clip& clip, const SampleGrid& grid);

/// Held-out pictures before and behind the autoencoder.
struct ReconstructionMeasure {
    double psnr = 0;                               ///< dB
    double object_psnr = 0;                        ///< of object pixels alone
    std::vector<Image> pictures, reconstructions;  ///< of the first few
};
ReconstructionMeasure measure_autoencoder(const DiffusionModel& pipeline,
                                          const std::vector<ShapeView>& views, int pictures,
                                          std::uint64_t seed);

}  // namespace item3d
