// Data-parallel training on threads of one or several processes: each replica has its own copy of
// the model, and gradients are averaged in a fixed order, so that results do not depend on timing.
#pragma once

#include "item3d/core/failed_steps.h"
#include "item3d/processes/process_group.h"
#include "item3d/tensors/tensor.h"

#include <torch/nn/module.h>

#include <atomic>
#include <barrier>
#include <cstdint>
#include <exception>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace item3d {

/// Parameters of some modules, all of them views of one vector. The gradients are views of a second
/// vector. Convolution weights are channels-last. The vectors are on the parameters' device.
class FlatModel {
  public:
    explicit FlatModel(const std::vector<std::shared_ptr<torch::nn::Module>>& modules);
    at::Tensor values;     ///< [P] float32
    at::Tensor gradients;  ///< [P] float32; backward() adds to it
    /// Makes the modules use another vector of values, such as the moving average.
    void use_values(const at::Tensor& other);
    /// Weight between hidden layers as a matrix, stored row after row from `offset` on.
    struct Matrix {
        std::int64_t offset, rows, columns;
    };
    /// Returns the matrices of at least 16 x 16 that are neither embeddings nor of the first or
    /// last layer.
    const std::vector<Matrix>& matrices() const { return matrices_; }
    std::int64_t size() const { return values.numel(); }

  private:
    std::vector<at::Tensor> parameters_;
    std::vector<Matrix> matrices_;
};

struct OptimizerOptions {
    float beta1 = 0.9f;
    float beta2 = 0.99f;
    float epsilon = 1e-8f;
    float weight_decay = 0.01f;
    float clip_norm = 1.0f;  ///< maximum norm of the averaged gradient
    /// Makes orthogonalized steps (muon.h) for FlatModel::matrices(), from AdamW's first moments.
    bool orthogonal = false;
};

/// Optimizer of the replicas: AdamW (Loshchilov and Hutter 2019), optionally with Muon for
/// matrices. It also keeps a moving average of the parameters.
class ReplicaGroup {
  public:
    /// Copies the first replica's values to all replicas. Each process has a group of the same
    /// size. The values and states of all processes must be equal at the beginning; they stay
    /// equal, byte by byte. On a CUDA device a group has one replica.
    ReplicaGroup(std::vector<std::unique_ptr<FlatModel>> replicas, const OptimizerOptions& options,
                 ProcessGroup processes = {});

    FlatModel& replica(int rank) { return *replicas_[static_cast<std::size_t>(rank)]; }
    int size() const {
        return static_cast<int>(replicas_.size());
    }  ///< number of replicas in this process

    struct Request {
        float learning_rate = 0;
        float ema_decay = 0;
        /// Request to stop; from rank 0 of any process it stops all, from other ranks it is
        /// ignored.
        bool stop = false;
    };
    struct Result {
        float gradient_norm;  ///< before clipping; if it is not finite, the step was skipped
        bool stop;
    };
    /// Averages the gradients of all processes, clips them, steps all replicas equally, and clears
    /// the gradients. Every rank calls step() on its own thread after its backward pass. If another
    /// rank failed, throws that rank's exception. If another process is gone, throws LostProcess;
    /// the state is then that of the previous step. Throws InputError if ten steps in a row were
    /// skipped. Between two calls rank 0 may read everything but gradients.
    Result step(int rank, const Request& request);
    /// Wakes all other ranks. A rank that throws an exception calls fail() in its handler.
    void fail();

    std::int64_t steps() const { return steps_; }
    const at::Tensor& average() const { return average_; }  ///< [P] moving average

    /// Returns everything but gradients, by name, on the CPU; the input of load_state().
    std::vector<std::pair<std::string, at::Tensor>> state() const;
    void load_state(const std::vector<std::pair<std::string, at::Tensor>>& state);

  private:
    /// Performs step() for the one replica on a CUDA device.
    Result step_on_device(const Request& request);
    void wait();
    void end_step(bool succeeded);
    /// Orthogonalizes those parts of changes_ that belong to this rank's matrices. clip: scale
    /// factor of the newest gradient.
    void orthogonalize(int rank, float clip);

    std::vector<std::unique_ptr<FlatModel>> replicas_;
    OptimizerOptions options_;
    ProcessGroup processes_;
    at::Tensor first_moment_, second_moment_, average_;
    at::Tensor changes_;               ///< [P] changes of this step, before the learning rate
    at::Tensor sum_;                   ///< [P + 1] sums of all gradients, and of the stop requests
    std::vector<double> square_sums_;  ///< sum over each block of the averaged gradient
    std::int64_t steps_ = 0;
    FailedSteps failed_steps_;
    std::mutex failure_mutex_;
    std::exception_ptr failure_;  ///< first failure
    std::atomic<bool> failed_ = false;
    std::barrier<> barrier_;
};

/// RAII guard that turns on bfloat16 autocast for a device's operations on this thread. It has no
/// effect if the device does not compute in bfloat16: autocast would only convert back and forth.
class Autocast {
  public:
    explicit Autocast(at::Device device);
    ~Autocast();
    Autocast(const Autocast&) = delete;
    Autocast& operator=(const Autocast&) = delete;

  private:
    at::DeviceType device_;
    bool enabled_before_;
    bool cache_before_;
};

}  // namespace item3d
