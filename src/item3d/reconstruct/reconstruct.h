// Reconstruction of an editable model from photographs:
//   load dataset -> hull -> shape, with first materials and light -> UVs -> refine -> bake ->
//   scores.
#pragma once

#include "item3d/provenance/signing.h"
#include "item3d/reconstruct/dataset/dataset.h"
#include "item3d/reconstruct/shape/find_shape.h"
#include "item3d/reconstruct/surface/refine.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace item3d {

/// Photographs of the test views in a known light. They show how well the reconstruction separates
/// materials and light.
struct RelitViews {
    std::filesystem::path folder;  ///< images named like the test views
    std::string light = "studio";  ///< preset or file
    float exposure = 0;            ///< exposure of the light in stops
};

struct ReconstructRequest {
    std::filesystem::path dataset;
    std::filesystem::path output;  ///< folder, created if missing
    /// Mesh of a known shape; if empty, the shape is reconstructed.
    std::filesystem::path mesh;
    std::filesystem::path reference;  ///< true mesh for comparison; may be empty
    /// True if `mesh` is to be rotated, scaled and moved to match the photographs, see
    /// place_mesh().
    bool place_mesh = false;
    DatasetOptions dataset_options;
    ShapeOptions shape;
    RefineOptions refine;
    CorrectionOptions corrections;
    /// True for a reconstructed shape; true for a given mesh only on request.
    bool move_vertices = true;
    /// If 0, the photographs' resolution decides, see texture_size_for().
    int texture_size = 0;
    std::vector<RelitViews> relit;
    /// Folder with images of the test views' true materials, see compare_materials(). May be empty.
    std::filesystem::path truth;
    bool says_provenance = true;                 ///< see provenance_of()
    std::shared_ptr<const SigningKey> sign_key;  ///< if null, the provenance is not signed
    bool resume = false;
    /// Number of iterations, counted over both stages, after which the run stops as after Ctrl-C.
    /// With 0, it runs to the end.
    int stop_after = 0;
    std::string command;  ///< command line as typed, for reconstruct.json and the resume hint
};

/// Writes model.glb, light.hdr, report.html and reconstruct.json into the output folder. During the
/// run it also writes preview.png and checkpoint.safetensors. Returns the content of
/// reconstruct.json. Throws InputError, ResourceError and Interrupted as in core/error.h. A
/// checkpoint is written before Interrupted is thrown.
nlohmann::json reconstruct(const ReconstructRequest& request);

}  // namespace item3d
