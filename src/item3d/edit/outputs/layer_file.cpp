#include "item3d/edit/outputs/layer_file.h"

#include "item3d/edit/outputs/edit_claim.h"
#include "item3d/layers/layer_field.h"
#include "item3d/layers/make_layer.h"
#include "item3d/tensors/checkpoint.h"

namespace item3d {

void write_layer_file(const EditRequest& request, const EditScene& scene, const EditState& state,
                      const ModelEdit& edit, const std::map<int, UneditedImages>& unedited) {
    EditLayer layer = make_layer({scene.file_materials, scene.model, edit, unedited});
    layer.model = request.model.filename().string();
    layer.model_hash = hash_of_file(request.model);
    layer.settings = request.plan;
    if (request.plan.provenance == SaysProvenance::on) layer.claim = claim_of(request, state);
    const ChannelMask& channels = scene.start.channels;
    layer.channels = {channels.base_color, channels.occlusion, channels.roughness,
                      channels.metallic, channels.normal};
    if (scene.region) {
        const RegionRequest& region = scene.region->request();
        layer.region = {region.include, region.exclude, region.feather};
    }
    put_fields({state.fitted, state.field}, layer);
    save_layer(request.output / "layer.safetensors", layer);
}

}  // namespace item3d
