#include "item3d/edit/optimize/checkpoint_writer.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/edit/optimize/checkpoint_state.h"
#include "item3d/guidance/noised_latents.h"

namespace item3d {
namespace {

constexpr double seconds_between_checkpoints = 12;
constexpr double seconds_between_previews = 5;

}  // namespace

void interrupt(const EditRequest& request, const EditState& state) {
    save_state(request, state);
    throw Interrupted(fmt::format("iteration {} of {} is kept; go on with: {} --resume",
                                  state.iteration, total_iterations(request.settings),
                                  request.command));
}

Safekeeping::Safekeeping(const EditRequest& request, const EditScene& scene)
    : request_(request),
      scene_(scene),
      preview_(request.output / "preview.png", scene),
      checkpointed_(seconds_now()),
      previewed_(checkpointed_) {}

void Safekeeping::update_preview(EditState& state) {
    preview_.update(state.field, light_as_it_is(scene_, state));
}

void Safekeeping::after_step(EditState& state, Progress& progress) {
    const std::int64_t total = total_iterations(request_.settings);
    const bool stop = interrupted() || state.iteration == request_.stop_after;
    if (stop && state.iteration < total) {
        progress.finish();
        interrupt(request_, state);
    }
    if (seconds_now() - checkpointed_ > seconds_between_checkpoints) {
        save_state(request_, state);
        checkpointed_ = seconds_now();
    }
    if (seconds_now() - previewed_ > seconds_between_previews) {
        update_preview(state);
        previewed_ = seconds_now();
    }
}

}  // namespace item3d
