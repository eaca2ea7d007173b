// Data-parallel training on the threads of a process, and on several processes: each replica has
// its own copy of the model, gradients are averaged in a fixed order, so that results do not depend
// on timing.
#pragma once

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

/// All parameters of some modules as views of one vector, and their gradients of another.
/// Convolution weights are laid out channels-last. The vectors are where the parameters were.
class FlatModel {
  public:
    explicit FlatModel(const std::vector<std::shared_ptr<torch::nn::Module>>& modules);
    at::Tensor values;     ///< [P] float32
    at::Tensor gradients;  ///< [P] float32; backward() adds to it
    /// Makes the modules use another vector of values from now on (for the moving average).
    void use_values(const at::Tensor& other);
    /// A weight between hidden layers, seen as a matrix: from `offset` on, row after row.
    struct Matrix {
        std::int64_t offset, rows, columns;
    };
    /// Those that are no embeddings and neither first nor last; at least 16 x 16.
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
    float clip_norm = 1.0f;  ///< largest norm of the averaged gradient
    /// Steps of FlatModel::matrices() are made orthogonal (muon.h), of the same moments.
    bool orthogonal = false;
};

/// AdamW (Loshchilov and Hutter 2019), and Muon for matrices where asked, over the replicas, with a
/// moving average of the parameters.
class ReplicaGroup {
  public:
    /// All replicas get the first one's values. Each process has a group of the same size; their
    /// values and states must be the same when they begin, and stay so, byte by byte. On a CUDA
    /// device a group has one replica.
    ReplicaGroup(std::vector<std::unique_ptr<FlatModel>> replicas, const OptimizerOptions& options,
                 ProcessGroup processes = {});

    FlatModel& replica(int rank) { return *replicas_[static_cast<std::size_t>(rank)]; }
    int size() const { return static_cast<int>(replicas_.size()); }  ///< of this process

    struct Request {
        float learning_rate = 0;
        float ema_decay = 0;
        bool stop = false;  ///< that of rank 0 of any process is what counts
    };
    struct Result {
        float gradient_norm;  ///< before clipping
        bool stop;
    };
    /// To be called by every rank, on its own thread, after its backward pass: averages the
    /// gradients of all processes, clips, steps all replicas alike, and clears the gradients. When
    /// another rank has failed, throws what that one did; when another process is gone,
    /// LostProcess, and the state is that after the step before. Between two calls rank 0 may read
    /// everything but gradients.
    Result step(int rank, const Request& request);
    /// To be called by a rank that leaves early through an exception, in its handler, so that the
    /// others do not wait.
    void fail();

    std::int64_t steps() const { return steps_; }
    const at::Tensor& average() const { return average_; }  ///< [P] moving average

    /// Everything but gradients, by name, on the CPU; load_state takes what state gave.
    std::vector<std::pair<std::string, at::Tensor>> state() const;
    void load_state(const std::vector<std::pair<std::string, at::Tensor>>& state);

  private:
    /// step() of the one replica on a CUDA device.
    Result step_on_device(const Request& request);
    void wait();
    /// Makes changes_ orthogonal, of those matrices that this rank looks after. clip: what the
    /// newest gradient was scaled by.
    void orthogonalize(int rank, float clip);

    std::vector<std::unique_ptr<FlatModel>> replicas_;
    OptimizerOptions options_;
    ProcessGroup processes_;
    at::Tensor first_moment_, second_moment_, average_;
    at::Tensor changes_;               ///< [P] of this step, before the learning rate
    at::Tensor sum_;                   ///< [P + 1] of all gradients, and of the wishes to stop
    std::vector<double> square_sums_;  ///< of the averaged gradient's blocks
    std::int64_t steps_ = 0;
    std::mutex failure_mutex_;
    std::exception_ptr failure_;  ///< the first
    std::atomic<bool> failed_ = false;
    std::barrier<> barrier_;
};

/// bfloat16 autocast of a device's operations on this thread for as long as it lives, where the
/// device computes in it; others would only convert there and back.
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
