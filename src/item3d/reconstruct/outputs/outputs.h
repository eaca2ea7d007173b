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

/// Bakes the field into textures for the model's UV map and writes model.glb. Returns the model as
/// read back from this file, so that scores and images describe the file.
Model bake_and_save(const std::filesystem::path& file, const Model& model, Appearance& appearance,
                    const ReconstructRequest& request, int texture_size,
                    const Provenance& provenance);

/// Scores in the light of one element of ReconstructRequest::relit.
struct RelitScores {
    std::vector<ScoredView> as_it_is, scaled;
    Vec3 gain{1.0f};  ///< gain of the views in `scaled`
};

/// Complete result of a reconstruction.
struct Reconstruction {
    Reconstruction(const ReconstructRequest& asked, const Dataset& photographs,
                   const StageTimes& begun)
        : request(asked), dataset(photographs), times(begun) {}

    const ReconstructRequest& request;
    const Dataset& dataset;
    Model model;  ///< model as read back from model.glb
    Image light;
    int texture_size = 0;
    std::optional<FoundShape> shape;  ///< unset for a given mesh
    std::optional<Mat4> mesh_placed;  ///< transform of a given mesh, if any
    RefineCurves refine;
    std::vector<ScoredView> train, test;  ///< `train` has only a few of the training views
    std::vector<ScoredView> test_without_shadows;
    std::vector<ScoredView> test_scaled;  ///< scores with a gain per view and channel
    /// Scores with gains, and with aligned cameras if poses were refined.
    std::vector<ScoredView> test_aligned;
    nlohmann::json corrections;  ///< corrections of the training views, see corrections_json()
    std::vector<RelitScores> relit;
    std::optional<MaterialTruth> materials;
    std::optional<double> chamfer;  ///< Chamfer distance, as a fraction of the reference's diagonal
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
