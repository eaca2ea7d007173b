#include "item3d/reconstruct/outputs/outputs.h"

#include "item3d/core/version.h"
#include "item3d/field/bake/bake.h"
#include "item3d/io/load.h"
#include "item3d/io/save.h"
#include "item3d/reconstruct/surface/plain_model.h"
#include "item3d/scene/far_origin.h"

#include <ATen/Parallel.h>

namespace item3d {

namespace {

nlohmann::json score_json(const std::vector<ScoredView>& views) {
    if (views.empty()) return nullptr;
    const auto one = [](const ViewScore& score) {
        return nlohmann::json{
            {"psnr", score.psnr}, {"ssim", score.ssim}, {"mask_overlap", score.mask_overlap}};
    };
    nlohmann::json result = one(mean_score(views));
    for (const ScoredView& view : views) {
        nlohmann::json entry = one(view.score);
        entry["name"] = view.score.name;
        result["views"].push_back(std::move(entry));
    }
    return result;
}

}  // namespace

Model bake_and_save(const std::filesystem::path& file, const Model& model, Appearance& appearance,
                    const ReconstructRequest& request, int texture_size,
                    const Provenance& provenance) {
    const at::NoGradGuard no_gradient;
    Model neutral = model;
    set_constant_material(neutral, appearance.field->options().ranges);
    NeuralTexture fitted = constant_field(appearance.field->options());
    const Geometry geometry = Geometry::from_model(neutral);
    const TexturedMaterials materials(neutral);
    const FieldSpace space(neutral, {0});
    const Atlas atlas = make_atlas(neutral, space, {0}, texture_size);
    BakeOptions options;
    options.texture_size = texture_size;
    // Renderers compute shadows themselves, so a baked occlusion would darken the model twice.
    options.channels = {.base_color = true,
                        .occlusion = false,
                        .roughness = true,
                        .metallic = true,
                        .normal = request.refine.normal_map};
    const ModelEdit edit =
        bake({neutral, geometry, materials, space, atlas}, fitted, appearance.field, options);
    save_model(file, neutral, edit, provenance);
    Model written = load_model(file);
    move_origin(written, glm::dvec3(0.0));  // back to the frame of the dataset's cameras
    return written;
}

nlohmann::json corrections_json(const Dataset& dataset, const ViewCorrections& corrections) {
    const at::Tensor gains = corrections.gains();
    nlohmann::json views = nlohmann::json::array();
    for (std::size_t i = 0; i < dataset.train.size(); ++i) {
        const Photograph& view = dataset.train[i];
        const Mat4 pose = corrections.corrected_camera(view.camera, i).camera_to_world;
        nlohmann::json rows = nlohmann::json::array();
        for (int row = 0; row < 4; ++row)
            rows.push_back({pose[0][row], pose[1][row], pose[2][row], pose[3][row]});
        const at::Tensor gain = gains[static_cast<std::int64_t>(i)];
        views.push_back(
            {{"name", view.name},
             {"gain", {gain[0].item<float>(), gain[1].item<float>(), gain[2].item<float>()}},
             {"weight", corrections.weight(i)},
             {"camera_to_world", rows}});
    }
    return {{"largest_turn_degrees", corrections.largest_turn()},
            {"largest_shift", corrections.largest_shift()},
            {"least_gain", gains.min().item<float>()},
            {"greatest_gain", gains.max().item<float>()},
            {"views", views}};
}

nlohmann::json summary_json(const Reconstruction& result) {
    const ReconstructRequest& request = result.request;
    nlohmann::json rotation = nlohmann::json::array();
    for (int row = 0; row < 3; ++row)
        rotation.push_back({result.dataset.world_from_dataset[0][row],
                            result.dataset.world_from_dataset[1][row],
                            result.dataset.world_from_dataset[2][row]});
    nlohmann::json seconds;
    for (const auto& [stage, value] : result.times.stages())
        seconds[stage] = value;
    seconds["total"] = result.times.total();
    nlohmann::json summary{{"version", version()},
                           {"command", request.command},
                           {"dataset",
                            {{"path", request.dataset.string()},
                             {"kind", dataset_kind_name(result.dataset.kind)},
                             {"train", result.dataset.train.size()},
                             {"test", result.dataset.test.size()},
                             {"masks", result.dataset.masks},
                             {"views_cut_off", result.dataset.cut_off},
                             {"world_from_dataset", rotation}}},
                           {"settings",
                            {{"mesh", request.mesh.string()},
                             {"extraction", request.shape.extraction},
                             {"cells", request.shape.cells},
                             {"shape_iterations", request.shape.iterations},
                             {"refine_iterations", request.refine.iterations},
                             {"move_vertices", request.move_vertices},
                             {"shadows", request.refine.shadows},
                             {"normal_map", request.refine.normal_map},
                             {"poses", pose_refinement_name(request.corrections.poses)},
                             {"matched_exposure", request.corrections.exposure},
                             {"texture_size", result.texture_size},
                             {"seed", request.refine.seed},
                             {"threads", at::get_num_threads()}}},
                           {"model",
                            {{"triangles", result.model.triangle_count()},
                             {"vertices", result.model.primitives.front().positions.size()}}},
                           {"scores",
                            {{"train", score_json(result.train)},
                             {"test", score_json(result.test)},
                             {"test_without_shadows", score_json(result.test_without_shadows)},
                             {"test_scaled", score_json(result.test_scaled)},
                             {"test_aligned", score_json(result.test_aligned)}}},
                           {"corrections", result.corrections},
                           {"warnings", result.warnings},
                           {"seconds", seconds},
                           {"peak_memory_bytes", peak_memory_bytes()}};
    if (result.shape)
        summary["scores"]["outline_disagreement_pixels"] = result.shape->outline_disagreement;
    if (result.mesh_placed) {
        const Mat4& m = *result.mesh_placed;
        for (int row = 0; row < 4; ++row)
            summary["model"]["mesh_placed_by"].push_back(
                {m[0][row], m[1][row], m[2][row], m[3][row]});
    }
    if (result.chamfer) summary["scores"]["chamfer"] = *result.chamfer;
    for (std::size_t i = 0; i < result.relit.size(); ++i) {
        const RelitScores& relit = result.relit[i];
        summary["scores"]["relit"].push_back(
            {{"folder", request.relit[i].folder.string()},
             {"light", request.relit[i].light},
             {"as_it_is", score_json(relit.as_it_is)},
             {"scaled", score_json(relit.scaled)},
             {"gain", {relit.gain.x, relit.gain.y, relit.gain.z}}});
    }
    if (result.materials) {
        const MaterialTruth& truth = *result.materials;
        const Vec3 gain = truth.base_color_gain;
        summary["scores"]["materials"] = {{"base_color_psnr", truth.base_color_psnr},
                                          {"base_color_gain", {gain.x, gain.y, gain.z}},
                                          {"metallic_right", truth.metallic_right},
                                          {"roughness_error", truth.roughness_error}};
    }
    return summary;
}

}  // namespace item3d
