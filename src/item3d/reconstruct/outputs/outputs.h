// What a reconstruction leaves in its folder.
#pragma once

#include "item3d/core/stage_times.h"
#include "item3d/provenance/provenance.h"
#include "item3d/reconstruct/outputs/scores.h"
#include "item3d/reconstruct/outputs/truth.h"
#include "item3d/reconstruct/reconstruct.h"

#include <optional>
#include <vector>

namespace item3d {

/// Bakes the field into the model's UV map, writes model.glb and reads it back: scores and pictures
/// are of what was written.
Model bake_and_save(const std::filesystem::path& file, const Model& model, Appearance& appearance,
                    const ReconstructRequest& request, int texture_size,
                    const Provenance& provenance);

/// Of one of RelitViews.
struct RelitScores {
    std::vector<ScoredView> as_it_is, scaled;
    Vec3 gain{1.0f};  ///< of the scaled ones
};

/// All that is known in the end.
struct Reconstruction {
    Reconstruction(const ReconstructRequest& asked, const Dataset& photographs,
                   const StageTimes& begun)
        : request(asked), dataset(photographs), times(begun) {}

    const ReconstructRequest& request;
    const Dataset& dataset;
    Model model;  ///< as written
    Image light;
    int texture_size = 0;
    std::optional<FoundShape> shape;  ///< none for a given mesh
    std::optional<Mat4> mesh_placed;  ///< what a given mesh was transformed by
    RefineCurves refine;
    std::vector<ScoredView> train, test;  ///< a few of the former
    std::vector<ScoredView> test_without_shadows;
    std::vector<ScoredView> test_scaled;   ///< with a gain for each view and channel
    std::vector<ScoredView> test_aligned;  ///< and moved, where poses were refined
    nlohmann::json corrections;            ///< of the training views, see corrections_json()
    std::vector<RelitScores> relit;
    std::optional<MaterialTruth> materials;
    std::optional<double> chamfer;  ///< part of the reference's diagonal
    StageTimes times;
    std::vector<std::string> warnings;
};

/// What was found of the training views' poses and exposures: {"largest_turn_degrees",
/// "largest_shift" (of dataset.radius), "views": [{"name", "gain", "weight", "camera_to_world"}]}.
nlohmann::json corrections_json(const Dataset& dataset, const ViewCorrections& corrections);

/// The content of reconstruct.json.
nlohmann::json summary_json(const Reconstruction& result);

}  // namespace item3d
