// Samples and reconstructions of a prior, and their scores.
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

/// Grid of generated images. A column is an object, and a row is a material.
struct SampleGrid {
    std::vector<std::string> objects;    ///< nouns
    std::vector<std::string> materials;  ///< captions, in which "{o}" stands for the noun
    std::vector<std::string> prompts;    ///< row by row
    std::vector<Image> images;           ///< row by row, sRGB
};

/// Generates images for at most `side` x `side` combinations of trained words, with the prior's own
/// defaults. The images depend on the prompts alone or, if `with_shape` is true, on the shapes of
/// held-out objects too.
SampleGrid draw_samples(const std::filesystem::path& prior, const DiffusionModel& pipeline,
                        const std::set<std::string>& words, int side, bool with_shape,
                        std::uint64_t seed);

/// Scores how well the prior's own CLIP finds the prompt of each sample among all prompts of the
/// grid. Returns {"pictures", "right", "object_right", "material_right", "similarity"}: a number of
/// images, three fractions, and the mean cosine of image and prompt.
nlohmann::json score_samples(const Clip& clip, const SampleGrid& grid);

/// Quality of the autoencoder on held-out images.
struct ReconstructionMeasure {
    double psnr = 0;                             ///< dB
    double object_psnr = 0;                      ///< dB on object pixels only
    std::vector<Image> images, reconstructions;  ///< first few of each
};
ReconstructionMeasure measure_autoencoder(const DiffusionModel& pipeline,
                                          const std::vector<ShapeView>& views, int images,
                                          std::uint64_t seed);

}  // namespace item3d
