// Runner of the stages of a reconstruction. It handles progress, previews, checkpoints and
// interruption.
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
    /// Reads OUTPUT/checkpoint.safetensors if the request resumes and the file exists. Throws
    /// InputError if the file is damaged or belongs to other photographs or settings.
    StageRunner(const ReconstructRequest& request, const Dataset& dataset);

    /// Returns the start of the reconstruction, as utc_date(). A resumed run has the start of the
    /// interrupted run.
    const std::string& begun() const { return begun_; }

    /// Returns the shape that the interrupted run had found, if any.
    std::optional<FoundShape> found_shape() const;
    /// Adds the shape to every later checkpoint.
    void keep(const FoundShape& shape);

    /// Resumes from the checkpoint if it is of this stage, then runs to the end. After Ctrl-C or at
    /// the request's stop_after, writes a checkpoint and throws Interrupted.
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
    std::optional<CheckpointReader> reader_;  ///< checkpoint of an interrupted run
    NamedTensors shape_;                      ///< shape given to keep()
    int behind_ = 0;                          ///< number of iterations of finished stages
    StagePreview preview_;
    Clock::time_point checkpointed_, previewed_;
};

}  // namespace item3d
