// What happens between the steps of an edit: checkpoints, previews, and stopping when asked to.
#pragma once

#include "item3d/core/progress.h"
#include "item3d/edit/optimize/optimize.h"
#include "item3d/edit/optimize/preview.h"

namespace item3d {

/// Writes the checkpoint and throws Interrupted with the command that goes on.
[[noreturn]] void interrupt(const EditRequest& request, const EditState& state);

class Safekeeping {
  public:
    Safekeeping(const EditRequest& request, const EditScene& scene);
    /// Call after each step. Throws Interrupted, with the checkpoint written, after Ctrl-C or at
    /// the request's stop_after unless the edit is done by then.
    void after_step(EditState& state, Progress& progress);

  private:
    void update_preview(EditState& state);

    const EditRequest& request_;
    const EditScene& scene_;
    Preview preview_;
    double checkpointed_;
    double previewed_;
};

}  // namespace item3d
