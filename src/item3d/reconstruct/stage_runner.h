// Runs the stages of a reconstruction: progress, previews, checkpoints, and stopping when asked to.
#pragma once

#include "item3d/core/progress.h"
#include "item3d/reconstruct/outputs/stage_preview.h"
#include "item3d/reconstruct/reconstruct.h"
#include "item3d/reconstruct/stage.h"

#include <chrono>
#include <optional>
#include <string>

namespace item3d {

class StageRunner {
  public:
    /// Reads OUTPUT/checkpoint.safetensors where the request says resume and it is there. Throws
    /// InputError when it is broken, or of other photographs or settings.
    StageRunner(const ReconstructRequest& request, const Dataset& dataset);

    /// When the reconstruction began, which an interrupted one keeps: utc_date().
    const std::string& begun() const { return begun_; }

    /// The shape that the interrupted run had found already, if it had.
    std::optional<FoundShape> found_shape() const;
    /// From now on part of every checkpoint.
    void keep(const FoundShape& shape);

    /// Goes on from the checkpoint where that was made in this stage, then to the end. Throws
    /// Interrupted, with the checkpoint written, after Ctrl-C or at the request's stop_after.
    void run(Stage& stage);

  private:
    using Clock = std::chrono::steady_clock;

    void load(Stage& stage);
    void save(const Stage& stage) const;
    [[noreturn]] void interrupt(const Stage& stage) const;
    void after_step(Stage& stage, Progress& progress);
    std::int64_t total_iterations() const;

    const ReconstructRequest& request_;
    nlohmann::json identity_;
    std::string begun_;
    std::optional<CheckpointReader> reader_;  ///< of an interrupted run
    NamedTensors shape_;                      ///< of keep()
    int behind_ = 0;                          ///< iterations of the stages before
    StagePreview preview_;
    Clock::time_point checkpointed_, previewed_;
};

}  // namespace item3d
