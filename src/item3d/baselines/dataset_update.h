// Instruct-NeRF2NeRF (Haque et al. 2023): InstructPix2Pix edits a set of images of the model one
// after another while the model is fitted to them. Here the images guide the neural texture of the
// mesh, in place of a NeRF. See docs/compare.md for the differences.
#pragma once

#include "item3d/baselines/instruct.h"
#include "item3d/guidance/guidance.h"

#include <memory>
#include <string>
#include <vector>

namespace item3d {

struct DatasetUpdateOptions {
    std::string instruction;
    std::string negative_prompt;
    InstructScales scales;
    int views = 24;
    int steps = 20;                                   ///< DDIM steps for each edited image
    double min_timestep = 0.02, max_timestep = 0.98;  ///< in parts of the noise schedule
    std::uint64_t seed = 0;
    std::string subject = "--prior";  ///< begins the error for a prior without instructions
};

/// Number of iterations between two edited images.
inline constexpr std::int64_t edit_rate = 10;

/// Returns the indices of an iteration's `batch` views, which are random by (seed, iteration). In
/// an iteration that edits an image, the first view is instead the one to edit; the views are
/// edited in turn.
std::vector<std::int64_t> dataset_views(std::uint64_t seed, std::int64_t iteration, int batch,
                                        int views);

/// Returns the sum of the mean absolute difference and 1 - SSIM (Wang et al. 2004, windows of 7
/// pixels) of `images` and `targets`, [N, 3, H, W] each. The sum is differentiable with respect to
/// `images`.
at::Tensor photometric_loss(const at::Tensor& images, const at::Tensor& targets);

/// Guidance by the edited images. In its GuidanceOutput, `latents` are the rendered images
/// themselves. The views of an iteration must be dataset_views(); their light and background must
/// be constant.
class DatasetUpdate : public Guidance {
  public:
    /// Throws InputError if the model takes no instructions.
    DatasetUpdate(std::shared_ptr<const DiffusionModel> model, const DatasetUpdateOptions& options);
    GuidanceOutput step(const GuidanceInput& input, std::int64_t iteration) override;
    bool needs_reference() const override { return true; }
    NamedTensors state() const override;
    void load_state(const NamedTensors& state) override;

  private:
    std::shared_ptr<const DiffusionModel> model_;
    DatasetUpdateOptions options_;
    InstructedModel instructed_;
    /// Edited images [1, 3, R, R] by view. An image is undefined before the first edit of its view.
    std::vector<at::Tensor> images_;
};

}  // namespace item3d
