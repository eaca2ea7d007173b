// Everything that an edit reads and does not change.
#pragma once

#include "item3d/edit/material_source.h"
#include "item3d/edit/material_start.h"
#include "item3d/edit/region_views.h"
#include "item3d/edit/request.h"
#include "item3d/edit/session.h"
#include "item3d/edit/source_materials.h"
#include "item3d/edit/views.h"
#include "item3d/field/atlas/atlas.h"
#include "item3d/networks/diffusion/diffusion_model.h"
#include "item3d/networks/vision_language/captioner.h"
#include "item3d/render/geometry.h"
#include "item3d/render/textured_materials.h"
#include "item3d/scene/model.h"

#include <future>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace item3d {

struct EditScene {
    std::string from, to;  ///< the sentences as the prior reads them, PriorVocabulary::reading()
    Model model;
    std::vector<Material> file_materials;  ///< of the model before they were prepared
    Geometry geometry;
    BoundingSphere sphere;
    std::vector<int> materials;            ///< edited ones, indices into model.materials
    std::map<int, MaterialLosses> losses;  ///< of the edited materials in the file
    bool is_prepared = false;              ///< some lost something, so model is not the file's
    MaterialStart start;                   ///< and which channels are edited
    /// The UV maps that the result is baked into; new ones come by unwrap_meanwhile().
    Atlas atlas;
    std::unique_ptr<FieldSpace> space;
    std::unique_ptr<TexturedMaterials> textured;
    /// The model's own before the edit prepares them, which a region may look at; null without one.
    std::unique_ptr<TexturedMaterials> source_textures;
    std::unique_ptr<Region> region;             ///< null: all of the edited materials
    std::unique_ptr<RegionViews> region_views;  ///< null with it
    std::unique_ptr<MaterialSource> source;
    std::shared_ptr<LightRig> lights;
    /// Loads asynchronously; get() blocks and rethrows load errors.
    std::shared_future<std::shared_ptr<const DiffusionModel>> loading_prior;
    const std::shared_ptr<const DiffusionModel>& prior() const { return loading_prior.get(); }
    std::shared_future<std::string> hashing_weights;  ///< hash_of_weights() of the prior
    std::shared_ptr<const Captioner> captioner;       ///< none unless the plan asks it
    at::ScalarType precision = at::kFloat;
    at::Device device = at::kCPU;  ///< where all tensors of the edit are
};

/// Returns while the prior is still being loaded. Throws InputError for what cannot be read of the
/// rest, ResourceError where memory will not do. session: of the edits around this one, if any.
EditScene load_scene(const EditRequest& request, EditSession& session);
EditScene load_scene(const EditRequest& request);

/// scene.atlas with its new UVs, made in the background; both must live until it is there.
/// get() throws InputError where xatlas cannot make them.
std::future<Atlas> unwrap_meanwhile(const EditRequest& request, const EditScene& scene);

}  // namespace item3d
