// The work between two steps of an edit: checkpoints, previews, and interruption.
#pragma once

#include "item3d/core/progress.h"
#include "item3d/edit/optimize/live_textures.h"
#include "item3d/edit/request.h"
#include "item3d/edit/scene.h"
#include "item3d/edit/state.h"

#include <filesystem>
#include <vector>

namespace item3d {

/// Writes the checkpoint, on the first process, and throws Interrupted with the command that
/// resumes.
[[noreturn]] void interrupt(const EditRequest& request, const EditState& state);

/// A preview image of the edit, refreshed in the output folder while the edit runs.
class Preview {
  public:
    Preview(std::filesystem::path path, const EditScene& scene);
    /// Renders the field under `light` from three sides and replaces the image. A preview that
    /// cannot be written does not stop the edit: it warns once and disables itself.
    void update(NeuralTexture& field, const EnvironmentLight& light);
    /// Replaces the preview by the last few of these images, [1, 3, R, R] sRGB each, instead of
    /// renders.
    void show(const std::vector<at::Tensor>& images);

  private:
    void save(const std::vector<at::Tensor>& images);  ///< [H, W, 3] each, side by side

    std::filesystem::path path_;
    const EditScene& scene_;
    std::vector<Camera> cameras_;
    bool enabled_ = true;
};

/// Writes the checkpoint and refreshes the preview every few seconds.
class CheckpointWriter {
  public:
    /// fitted: field before the edit, for LiveTextures; empty with a painter.
    CheckpointWriter(const EditRequest& request, const EditScene& scene, NeuralTexture& fitted);
    /// Must be called after each step, on all processes. Throws Interrupted, with the checkpoint
    /// written, after Ctrl-C of any process, or at the request's stop_after if iterations remain.
    void after_step(EditState& state, Progress& progress);

  private:
    /// Receives the other processes' counts of evaluated U-Net rows (batch entries). Returns true
    /// if any process must stop.
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
