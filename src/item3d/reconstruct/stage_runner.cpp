#include "item3d/reconstruct/stage_runner.h"

#include "item3d/core/date.h"
#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/stage_times.h"

#include <cstring>

namespace item3d {

namespace {

/// The interval is long, because a checkpoint of a fine lattice has a hundred megabytes.
constexpr std::chrono::seconds between_checkpoints{30};
constexpr std::chrono::seconds between_previews{10};

std::filesystem::path checkpoint_path(const ReconstructRequest& request) {
    return request.output / "checkpoint.safetensors";
}

std::string hash_of_views(const std::vector<Photograph>& views) {
    std::uint64_t hash = 0;
    const auto add = [&](float value) {
        std::uint32_t bits = 0;
        std::memcpy(&bits, &value, sizeof bits);
        hash = mix_bits(hash ^ bits);
    };
    for (const Photograph& view : views) {
        for (int k = 0; k < 16; ++k)
            add(view.camera.camera_to_world[k / 4][k % 4]);
        add(view.camera.field_of_view_x);
        add(static_cast<float>(view.exposure));
        for (const float value : view.image.pixels)
            add(value);
    }
    return fmt::format("{:016x}", hash);
}

/// Returns everything that the bytes of model.glb depend on.
nlohmann::json identity_of(const ReconstructRequest& request, const Dataset& dataset) {
    nlohmann::json identity{{"photographs", hash_of_views(dataset.train)},
                            {"iterations", request.refine.iterations},
                            {"texture size", request.texture_size},
                            {"move vertices", request.move_vertices},
                            {"shadows", request.refine.shadows},
                            {"normal map", request.refine.normal_map},
                            {"poses", pose_refinement_name(request.corrections.poses)},
                            {"matched exposure", request.corrections.exposure},
                            {"seed", request.refine.seed},
                            {"mesh", nullptr}};
    if (!request.mesh.empty()) {
        identity["mesh"] = hash_of_file(request.mesh);
        identity["place mesh"] = request.place_mesh;
        return identity;
    }
    identity["extraction"] = request.shape.extraction;
    identity["cells"] = request.shape.cells;
    identity["shape iterations"] = request.shape.iterations;
    identity["triangles"] = request.shape.triangles;
    return identity;
}

std::string stage_prefix(const Stage& stage) {
    return "stage." + stage.name() + ".";
}

}  // namespace

StageRunner::StageRunner(const ReconstructRequest& request, const Dataset& dataset)
    : request_(request),
      identity_(identity_of(request, dataset)),
      begun_(utc_date()),
      preview_(request.output / "preview.png", dataset),
      checkpointed_(Clock::now()),
      previewed_(checkpointed_) {
    if (!request.resume) return;
    const auto path = checkpoint_path(request);
    const auto checkpoint = load_checkpoint(path);
    if (!checkpoint) {
        note("no checkpoint in " + request.output.string() + ": starting from the beginning");
        return;
    }
    require_same_identity(
        path, checkpoint->identity, identity_,
        {{"photographs", "was made for other photographs, or for these with other options"},
         {"mesh", "was made for another --mesh"}});
    begun_ = checkpoint->identity.value("begun", begun_);
    reader_.emplace(path.string(), checkpoint->tensors);
    note(fmt::format("resuming after iteration {} of {}", checkpoint->iteration,
                     total_iterations()));
}

std::int64_t StageRunner::total_iterations() const {
    return request_.refine.iterations + (request_.mesh.empty() ? request_.shape.iterations : 0);
}

std::optional<FoundShape> StageRunner::found_shape() const {
    if (!reader_ || !reader_->has("shape.positions")) return std::nullopt;
    return FoundShape{{reader_->get("shape.positions"), reader_->get("shape.triangles")},
                      {curve_values(reader_->get("shape.curve.picture")),
                       curve_values(reader_->get("shape.curve.mask"))},
                      curve_values(reader_->get("shape.curve.triangles")),
                      reader_->get("shape.outline_disagreement").item<double>()};
}

void StageRunner::keep(const FoundShape& shape) {
    shape_ = {{"shape.positions", shape.mesh.positions},
              {"shape.triangles", shape.mesh.triangles},
              {"shape.curve.picture", curve_tensor(shape.curves.image)},
              {"shape.curve.mask", curve_tensor(shape.curves.mask)},
              {"shape.curve.triangles", curve_tensor(shape.triangles)},
              {"shape.outline_disagreement", curve_tensor({shape.outline_disagreement})}};
    behind_ = request_.shape.iterations;
}

void StageRunner::load(Stage& stage) {
    if (!reader_) return;
    const auto own = reader_->with_prefix(stage_prefix(stage));
    if (own.empty()) return;
    stage.load_state(
        CheckpointReader(checkpoint_path(request_).string(), NamedTensors(own.begin(), own.end())));
    reader_.reset();
}

void StageRunner::save(const Stage& stage) const {
    Checkpoint checkpoint{identity_, behind_ + stage.iteration(), shape_};
    checkpoint.identity["begun"] = begun_;
    for (const auto& [name, tensor] : stage.state())
        checkpoint.tensors.emplace_back(stage_prefix(stage) + name, tensor);
    save_checkpoint(checkpoint_path(request_), checkpoint);
}

void StageRunner::interrupt(const Stage& stage) const {
    save(stage);
    const bool said = request_.command.find(" --resume") != std::string::npos;
    throw Interrupted(
        fmt::format("a checkpoint was saved at iteration {} of {}; continue with: {}{}",
                    behind_ + stage.iteration(), total_iterations(), request_.command,
                    said ? "" : " --resume"));
}

void StageRunner::run(Stage& stage) {
    load(stage);
    Progress progress(stage.name(), stage.iterations(), stage.iteration());
    while (!stage.is_done()) {
        try {
            stage.step();
        } catch (const Interrupted&) {  // thrown during the tracing of shadows
            progress.finish();
            interrupt(stage);
        }
        progress.update(stage.iteration(), stage.detail());
        after_step(stage, progress);
    }
    progress.finish();
    save(stage);
}

void StageRunner::after_step(Stage& stage, Progress& progress) {
    const std::int64_t done = behind_ + stage.iteration();
    const bool stop = interrupted() || done == request_.stop_after;
    if (stop && done < total_iterations()) {
        progress.finish();
        interrupt(stage);
    }
    if (Clock::now() - checkpointed_ > between_checkpoints) {
        save(stage);
        checkpointed_ = Clock::now();
    }
    if (Clock::now() - previewed_ > between_previews) {
        preview_.update(stage);
        previewed_ = Clock::now();
    }
}

}  // namespace item3d
