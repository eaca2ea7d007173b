#include "item3d/edit/optimize/checkpoint_writer.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/edit/optimize/checkpoint_state.h"
#include "item3d/edit/optimize/render_view.h"
#include "item3d/guidance/noised_latents.h"
#include "item3d/io/save.h"
#include "item3d/render/image_tensor.h"

#include <cmath>

namespace item3d {
namespace {

constexpr double seconds_between_checkpoints = 12;
constexpr double seconds_between_previews = 5;
constexpr int preview_size = 256;  ///< pixels

}  // namespace

void interrupt(const EditRequest& request, const EditState& state) {
    save_state(request, state);
    const bool said = request.command.find(" --resume") != std::string::npos;
    throw Interrupted(fmt::format(
        "a checkpoint was saved at iteration {} of {}; continue with: {}{}", state.iteration,
        request.plan.total_iterations, request.command, said ? "" : " --resume"));
}

Preview::Preview(std::filesystem::path path, const EditScene& scene)
    : path_(std::move(path)), scene_(scene), cameras_(field_cameras(scene, 3)) {}

void Preview::update(NeuralTexture& field, const EnvironmentLight& light) {
    if (!enabled_) return;
    save(draw_field(scene_, field, light, cameras_, preview_size).unbind(0));
}

void Preview::show(const std::vector<at::Tensor>& images) {
    if (!enabled_ || images.empty()) return;
    std::vector<at::Tensor> last;
    for (std::size_t i = images.size() - std::min(images.size(), cameras_.size());
         i < images.size(); ++i)
        last.push_back(images[i][0].permute({1, 2, 0}));
    save(last);
}

void Preview::save(const std::vector<at::Tensor>& images) {
    try {
        save_image(path_, to_image(at::cat(images, 1)));
    } catch (const Error& error) {
        warn(std::string("previews stop: ") + error.what());
        enabled_ = false;
    }
}

CheckpointWriter::CheckpointWriter(const EditRequest& request, const EditScene& scene,
                                   NeuralTexture& fitted)
    : request_(request),
      scene_(scene),
      preview_(request.output / "preview.png", scene),
      live_(request.live, scene, fitted),
      checkpointed_(seconds_now()),
      previewed_(checkpointed_) {}

void CheckpointWriter::update_preview(EditState& state) {
    if (state.painter) {
        preview_.show(state.painter->images());
        return;
    }
    preview_.update(state.field, current_light(scene_, state));
}

bool CheckpointWriter::share_progress(EditState& state) const {
    const ProcessGroup& processes = request_.processes;
    if (!processes.several()) return interrupted();
    const std::int64_t own = state.own_unet_rows();
    at::Tensor message =
        at::tensor({interrupted() ? 1.0f : 0.0f, static_cast<float>(own)}, at::kFloat);
    processes.sum(message);
    state.unet_rows_elsewhere =
        static_cast<std::int64_t>(std::lround(message[1].item<float>())) - own;
    return message[0].item<float>() > 0;
}

void CheckpointWriter::after_step(EditState& state, Progress& progress) {
    const std::int64_t total = request_.plan.total_iterations;
    const ProcessGroup& processes = request_.processes;
    const bool stop = share_progress(state) || state.iteration == request_.stop_after;
    if (stop && state.iteration < total) {
        progress.finish();
        interrupt(request_, state);
    }
    if (!processes.first()) return;
    if (seconds_now() - checkpointed_ > seconds_between_checkpoints) {
        save_state(request_, state);
        checkpointed_ = seconds_now();
    }
    live_.update(state, state.iteration == total);
    if (seconds_now() - previewed_ > seconds_between_previews) {
        update_preview(state);
        previewed_ = seconds_now();
    }
}

}  // namespace item3d
