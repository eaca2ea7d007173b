// Training loop that all networks of the prior use. It handles the replicas, the order of the data,
// the learning rate, checkpoints and progress.
#pragma once

#include "item3d/prior/training/replicas.h"
#include "item3d/processes/process_group.h"
#include "item3d/tensors/tensor.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace item3d {

struct TrainSettings;

struct LoopOptions {
    std::string label;                 ///< name of the training in progress and messages
    std::filesystem::path checkpoint;  ///< path of the checkpoint file
    std::int64_t samples = 0;          ///< number of samples to be seen, repetitions counted
    std::int64_t rows = 0;             ///< number of distinct samples
    int batch = 32;                    ///< samples per step and replica
    std::string objective;             ///< name of the loss, if a network has a choice of several
    bool orthogonal = false;           ///< OptimizerOptions::orthogonal
    float learning_rate = 1e-3f;
    double rise = 6000;  ///< samples until the maximum learning rate
    std::uint64_t seed = 1;
    bool resume = false;
    std::int64_t stop_after = 0;  ///< stops like an interrupt after so many samples; 0 for never
    double checkpoint_seconds = 120;
    double export_seconds = 600;
    /// Processes that train together, each with the same number of replicas.
    ProcessGroup processes;
};

/// Returns the options that all training loops share. The caller sets `samples` and `rows`.
/// checkpoint: name of the checkpoint file.
LoopOptions loop_options(const TrainSettings& settings, const std::string& label,
                         const std::string& checkpoint);

/// One replica. `loss` returns the loss of the samples with the indices `rows`; its random numbers
/// depend on the step and the replica's rank alone. Ranks are counted over all processes, from
/// process 0 on.
struct LoopReplica {
    std::vector<std::shared_ptr<torch::nn::Module>> modules;
    std::function<at::Tensor(const std::vector<std::int64_t>& rows, std::int64_t step)> loss;
};

/// Loss and training time of the run, stored in checkpoints.
struct LoopRecord {
    std::int64_t seen = 0;
    double seconds = 0;
    double loss = 0;  ///< mean of about the last 100 steps
};

class TrainingLoop {
  public:
    /// Copies the first replica's values to the others; when resuming, reads the checkpoint if
    /// there is one. Other processes receive the values and the checkpoint from process 0. Throws
    /// InputError for a checkpoint that is damaged, or of another network or other settings.
    TrainingLoop(const LoopOptions& options, std::vector<LoopReplica> replicas);

    std::int64_t parameters() const { return group_->average().numel(); }
    /// Trains to the end. Process 0 calls write_export periodically and at the end, with the moving
    /// average of the parameters in FlatModel's order. Throws Interrupted after a checkpoint and an
    /// export, and LostProcess after a checkpoint.
    using Export = std::function<void(const at::Tensor& average, const LoopRecord& record)>;
    void run(const Export& write_export);

  private:
    void train(int rank, const Export& write_export);
    bool should_stop(std::int64_t seen) const;
    NamedTensors state() const;
    void load_state(const NamedTensors& state);
    nlohmann::json checkpoint_settings() const;
    void save_checkpoint() const;
    void load_checkpoint();

    LoopOptions options_;
    std::vector<LoopReplica> replicas_;
    std::unique_ptr<ReplicaGroup> group_;
    LoopRecord record_;
};

/// Returns the learning rate after `seen` of `total` samples, as a fraction of the maximum: a short
/// rise, a plateau, and a linear fall over the last 30 %. It depends on counts alone, so that a
/// longer training can continue a shorter one's plateau.
double learning_rate_part(std::int64_t seen, std::int64_t total, double rise = 6000);

}  // namespace item3d
