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

/// Writes the checkpoint on the first process, and throws Interrupted. The message has the command
/// that resumes the edit.
[[noreturn]] void interrupt(const EditRequest& request, const EditState& state);

/// A preview image in the output folder, which is refreshed while the edit runs.
class Preview {
  public:
    Preview(std::filesystem::path path, const EditScene& scene);
    /// Renders the neural texture in `light` from three sides and replaces the image. If the image
    /// cannot be written, warns once, and writes no further previews; the edit continues.
    void update(NeuralTexture& field, const EnvironmentLight& light);
    /// Replaces the image by the last few of these images, which are [1, 3, R, R] sRGB each.
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
    /// fitted: neural texture before the edit, for LiveTextures; empty if the method paints views.
    CheckpointWriter(const EditRequest& request, const EditScene& scene, NeuralTexture& fitted);
    /// Must be called after each step, on all processes. Writes the checkpoint and throws
    /// Interrupted if any process has received Ctrl-C, or at the request's stop_after if iterations
    /// remain.
    void after_step(EditState& state, Progress& progress);

  private:
    /// Receives from the other processes how many U-Net rows (batch entries) they have evaluated.
    /// Returns true if any process must stop.
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
