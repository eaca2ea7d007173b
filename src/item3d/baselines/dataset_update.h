// Instruct-NeRF2NeRF (Haque et al. 2023): InstructPix2Pix edits a set of images of the model one
// after another while the model is fitted to them. Here as guidance of the neural texture on the
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
    int steps = 20;                                   ///< of DDIM, for each edited image
    double min_timestep = 0.02, max_timestep = 0.98;  ///< relative to the schedule
    std::uint64_t seed = 0;
    std::string subject = "--prior";  ///< subject of errors for a prior that takes no instructions
};

/// Number of iterations between two edited images.
inline constexpr std::int64_t edit_rate = 10;

/// Returns the views [batch] of an iteration. The first is the view to edit, if the iteration edits
/// one; these take turns. All others are random by (seed, iteration).
std::vector<std::int64_t> dataset_views(std::uint64_t seed, std::int64_t iteration, int batch,
                                        int views);

/// Returns the mean absolute difference plus, with equal weight, 1 - SSIM (Wang et al. 2004,
/// windows of 7 pixels), of images [N, 3, H, W]; differentiable in the first.
at::Tensor photometric_loss(const at::Tensor& images, const at::Tensor& targets);

/// Guidance whose output's "latents" are the images. Views are dataset_views(); their light and
/// background must be constant.
class DatasetUpdate : public Guidance {
  public:
    /// Throws InputError as InstructedModel().
    DatasetUpdate(std::shared_ptr<const DiffusionModel> model, const DatasetUpdateOptions& options);
    GuidanceOutput step(const GuidanceInput& input, std::int64_t iteration) override;
    bool needs_reference() const override { return true; }
    NamedTensors state() const override;
    void load_state(const NamedTensors& state) override;

  private:
    std::shared_ptr<const DiffusionModel> model_;
    DatasetUpdateOptions options_;
    InstructedModel instructed_;
    std::vector<at::Tensor> images_;  ///< [1, 3, R, R] by view; undefined: the unedited model
};

}  // namespace item3d
