// From photographs to a model that can be edited:
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

/// Photographs in a known light, to see whether materials and light were told apart.
struct RelitViews {
    std::filesystem::path folder;  ///< pictures named as test views
    std::string light = "studio";  ///< preset or file
    float exposure = 0;            ///< stops
};

struct ReconstructRequest {
    std::filesystem::path dataset;
    std::filesystem::path output;     ///< folder, made when it is not there
    std::filesystem::path mesh;       ///< a shape that is known already; empty: it is looked for
    std::filesystem::path reference;  ///< the true mesh, to compare with; empty: none
    /// Turn, scale and move that mesh to where the photographs show it, see place_mesh().
    bool place_mesh = false;
    DatasetOptions dataset_options;
    ShapeOptions shape;
    RefineOptions refine;
    CorrectionOptions corrections;
    bool move_vertices = true;  ///< of a shape that was looked for; of a given mesh only if asked
    int texture_size = 0;       ///< 0: as the photographs have detail, see texture_size_for()
    std::vector<RelitViews> relit;
    /// Pictures of the materials of test views, see compare_materials(); empty: none.
    std::filesystem::path truth;
    bool says_provenance = true;                 ///< see provenance_of()
    std::shared_ptr<const SigningKey> sign_key;  ///< null: what is said is not signed
    bool resume = false;
    /// Stop as an interrupt would when this many iterations of both stages are done; 0: run to the
    /// end.
    int stop_after = 0;
    std::string command;  ///< as typed, for reconstruct.json and the resume hint
};

/// Writes model.glb, light.hdr, report.html and reconstruct.json into the output folder and returns
/// the latter's content; preview.png and checkpoint.safetensors while it runs. Throws InputError,
/// ResourceError, and Interrupted (with the checkpoint written) as core/error.h says.
nlohmann::json reconstruct(const ReconstructRequest& request);

}  // namespace item3d
