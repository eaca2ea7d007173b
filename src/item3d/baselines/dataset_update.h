// Instruct-NeRF2NeRF (Haque et al. 2023): a set of pictures of the model that InstructPix2Pix edits
// one after another while the model is fitted to them. Here as guidance of the neural texture on
// the mesh, in place of a NeRF. See docs/compare.md for what differs.
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
    int steps = 20;                                   ///< of DDIM, for each picture that is edited
    double min_timestep = 0.02, max_timestep = 0.98;  ///< parts of the schedule
    std::uint64_t seed = 0;
    std::string subject = "--prior";  ///< what a prior without instructions is called
};

/// Iterations between two pictures that are edited.
inline constexpr std::int64_t edit_rate = 10;

/// The views [batch] of an iteration: the first is the one to be edited next where one is (they
/// come in turn), all others are drawn from (seed, iteration).
std::vector<std::int64_t> dataset_views(std::uint64_t seed, std::int64_t iteration, int batch,
                                        int views);

/// Mean absolute difference and, weighed as much, 1 - SSIM (Wang et al. 2004, means of squares of 7
/// pixels), of pictures [N, 3, H, W]: differentiable in the first.
at::Tensor photometric_loss(const at::Tensor& images, const at::Tensor& targets);

/// The output's "latents" are the images. The views of the pictures are dataset_views(); their
/// light and background must be the same each time.
class DatasetUpdate : public Guidance {
  public:
    /// Throws InputError as InstructedModel.
    DatasetUpdate(std::shared_ptr<const DiffusionModel> model, const DatasetUpdateOptions& options);
    GuidanceOutput step(const GuidanceInput& input, std::int64_t iteration) override;
    bool needs_reference() const override { return true; }
    NamedTensors state() const override;
    void load_state(const NamedTensors& state) override;

  private:
    std::shared_ptr<const DiffusionModel> model_;
    DatasetUpdateOptions options_;
    InstructedModel instructed_;
    std::vector<at::Tensor> pictures_;  ///< [1, 3, R, R] by view; undefined: the unedited model
};

}  // namespace item3d
