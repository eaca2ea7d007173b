// Adam (Kingma and Ba 2015) with lazy updates for parameters whose gradients are sparse.
#pragma once

#include "item3d/tensors/tensor.h"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace item3d {

struct AdamOptions {
    double learning_rate = 0.01;
    double beta1 = 0.9;
    double beta2 = 0.99;
    double epsilon = 1e-15;
    /// [rows] float32 factors of the rows' learning rates, for groups of one parameter. Undefined:
    /// 1.
    at::Tensor row_factors = {};
};

/// Groups of parameters, each with its own options. A parameter with a dense gradient is updated as
/// usual. One with a sparse gradient (the hash grid's table, [rows, F]) is updated lazily: only the
/// rows in the gradient, with bias correction by each row's number of updates, so a row whose first
/// update comes after a thousand steps moves as far as one in the first step. float32, contiguous
/// parameters, on the CPU or a CUDA device. Results do not depend on the number of threads.
class Adam {
  public:
    /// Names of groups are unique. Throws std::logic_error for a name in use.
    void add_group(const std::string& name, std::vector<at::Tensor> parameters,
                   const AdamOptions& options);
    /// Returns a group's options; throws std::logic_error for an unknown name.
    AdamOptions& options(const std::string& group);

    std::vector<at::Tensor> parameters() const;  ///< of all groups

    /// Skips parameters without a gradient.
    void step();
    /// Makes the gradients undefined (the next backward pass creates new ones).
    void zero_grad();

    /// Returns the complete state by name ("network.1.momentum": of the group's parameter 1). The
    /// tensors are the optimiser's own: clone them to keep them beyond the next step.
    std::map<std::string, at::Tensor> state() const;
    /// Copies values of state() back. Throws std::logic_error for a missing name or a wrong shape.
    void load_state(const std::map<std::string, at::Tensor>& state);

  private:
    struct Slot {
        at::Tensor parameter;
        at::Tensor momentum;  ///< running mean of gradients, in the parameter's shape
        at::Tensor variance;  ///< running mean of squared gradients, in the parameter's shape
        at::Tensor updates;   ///< [rows] int32: number of updates of each row
    };
    struct Group {
        std::string name;
        std::vector<Slot> slots;
        AdamOptions options;
    };
    std::vector<Group> groups_;
    int max_updates_ = 0;  ///< largest entry of all `updates`
};

}  // namespace item3d
