// Output files of a reconstruction.
#pragma once

#include "item3d/core/stage_times.h"
#include "item3d/provenance/provenance.h"
#include "item3d/reconstruct/outputs/scores.h"
#include "item3d/reconstruct/outputs/truth.h"
#include "item3d/reconstruct/reconstruct.h"

#include <optional>
#include <vector>

namespace item3d {

/// Bakes the field into the model's UV map, writes model.glb and reads it back, so that scores and
/// images are of the file.
Model bake_and_save(const std::filesystem::path& file, const Model& model, Appearance& appearance,
                    const ReconstructRequest& request, int texture_size,
                    const Provenance& provenance);

/// Scores of one of RelitViews.
struct RelitScores {
    std::vector<ScoredView> as_it_is, scaled;
    Vec3 gain{1.0f};  ///< gain of the scaled ones
};

/// Complete result of a reconstruction.
struct Reconstruction {
    Reconstruction(const ReconstructRequest& asked, const Dataset& photographs,
                   const StageTimes& begun)
        : request(asked), dataset(photographs), times(begun) {}

    const ReconstructRequest& request;
    const Dataset& dataset;
    Model model;  ///< model as written
    Image light;
    int texture_size = 0;
    std::optional<FoundShape> shape;  ///< unset for a given mesh
    std::optional<Mat4> mesh_placed;  ///< transform of a given mesh, if any
    RefineCurves refine;
    std::vector<ScoredView> train, test;  ///< train: a few views only
    std::vector<ScoredView> test_without_shadows;
    std::vector<ScoredView> test_scaled;   ///< with a gain per view and channel
    std::vector<ScoredView> test_aligned;  ///< scaled, and also moved if poses were refined
    nlohmann::json corrections;  ///< corrections of the training views, see corrections_json()
    std::vector<RelitScores> relit;
    std::optional<MaterialTruth> materials;
    std::optional<double> chamfer;  ///< fraction of the reference's diagonal
    StageTimes times;
    std::vector<std::string> warnings;
};

/// Returns the poses and exposures found for the training views: {"largest_turn_degrees",
/// "largest_shift" (in units of dataset.radius), "views": [{"name", "gain", "weight",
/// "camera_to_world"}]}.
nlohmann::json corrections_json(const Dataset& dataset, const ViewCorrections& corrections);

/// Returns the content of reconstruct.json.
nlohmann::json summary_json(const Reconstruction& result);

}  // namespace item3d
