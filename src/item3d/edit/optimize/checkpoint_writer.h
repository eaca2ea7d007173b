// Between the steps of an edit: checkpoints, previews, and stopping when asked to.
#pragma once

#include "item3d/core/progress.h"
#include "item3d/edit/optimize/live_textures.h"
#include "item3d/edit/request.h"
#include "item3d/edit/scene.h"
#include "item3d/edit/state.h"

#include <filesystem>
#include <vector>

namespace item3d {

/// Writes the checkpoint, where this is the first process, and throws Interrupted with the command
/// that goes on.
[[noreturn]] void interrupt(const EditRequest& request, const EditState& state);

/// A picture of the edit so far, refreshed in the output folder while it runs.
class Preview {
  public:
    Preview(std::filesystem::path path, const EditScene& scene);
    /// Draws the field in that light from three sides and replaces the picture. A preview that
    /// cannot be written is not worth stopping an edit for: it warns once and gives up.
    void update(NeuralTexture& field, const EnvironmentLight& light);
    /// The same of the last of these pictures, [1, 3, R, R] sRGB each.
    void show(const std::vector<at::Tensor>& pictures);

  private:
    void save(const std::vector<at::Tensor>& pictures);  ///< [H, W, 3] each, side by side

    std::filesystem::path path_;
    const EditScene& scene_;
    std::vector<Camera> cameras_;
    bool enabled_ = true;
};

/// Writes the checkpoint, and refreshes the preview, every few seconds.
class CheckpointWriter {
  public:
    /// fitted: the field before the edit, for LiveTextures; none with a painter.
    CheckpointWriter(const EditRequest& request, const EditScene& scene, NeuralTexture& fitted);
    /// Call after each step, on all processes. Throws Interrupted, with the checkpoint written,
    /// after Ctrl-C of any process or at the request's stop_after unless the edit is done by then.
    void after_step(EditState& state, Progress& progress);

  private:
    /// Takes over how many rows the other processes' networks were asked; whether any process is to
    /// stop.
    bool share_progress(EditState& state) const;
    void update_preview(EditState& state);

    const EditRequest& request_;
    const EditScene& scene_;
    Preview preview_;
    LiveTextures live_;
    double checkpointed_;
    double previewed_;
};

}  // namespace item3d
