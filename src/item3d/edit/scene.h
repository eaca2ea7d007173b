// The constant inputs of an edit.
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
    std::string from, to;  ///< the sentences as the prior reads them (PriorVocabulary::reading())
    Model model;
    std::vector<Material> file_materials;  ///< the model's materials before prepare_materials()
    Geometry geometry;
    BoundingSphere sphere;
    std::vector<int> materials;            ///< indices of the edited materials in model.materials
    std::map<int, MaterialLosses> losses;  ///< losses of the edited materials, by index
    bool is_prepared = false;              ///< true if prepare_materials() changed the model
    MaterialStart start;                   ///< initial values, and the edited channels
    /// The UV maps for the bake of the result. unwrap_meanwhile() computes new ones.
    Atlas atlas;
    std::unique_ptr<FieldSpace> space;
    std::unique_ptr<TexturedMaterials> textured;
    /// The model's own textures before prepare_materials(), for regions; null without a region.
    std::unique_ptr<TexturedMaterials> source_textures;
    std::unique_ptr<Region> region;  ///< null if the edit changes all of the edited materials
    std::unique_ptr<RegionViews> region_views;  ///< null without a region
    std::unique_ptr<MaterialSource> source;
    std::shared_ptr<LightRig> lights;
    /// Loads asynchronously; get() blocks and rethrows load errors.
    std::shared_future<std::shared_ptr<const DiffusionModel>> loading_prior;
    const std::shared_ptr<const DiffusionModel>& prior() const { return loading_prior.get(); }
    std::shared_future<std::string> hashing_weights;  ///< hash_of_weights() of the prior
    std::shared_ptr<const Captioner> captioner;       ///< null unless the plan uses it
    at::ScalarType precision = at::kFloat;
    at::Device device = at::kCPU;  ///< device of all tensors of the edit

    /// Frees the textures of `textured` and `source`, unless a region needs them. The report needs
    /// only the models, and large textures take gigabytes.
    void release_textures();
};

/// Loads all inputs of an edit. Returns while the prior is still loading. session: shared with
/// other edits. Throws InputError for unreadable inputs other than the prior, and ResourceError if
/// memory does not suffice.
EditScene load_scene(const EditRequest& request, EditSession& session);
EditScene load_scene(const EditRequest& request);

/// Computes scene.atlas with new UVs in the background. request and scene must outlive the returned
/// future. Its get() throws InputError if xatlas fails.
std::future<Atlas> unwrap_meanwhile(const EditRequest& request, const EditScene& scene);

}  // namespace item3d
