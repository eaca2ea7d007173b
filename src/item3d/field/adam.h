// Adam (Kingma and Ba 2015) with lazy updates for parameters whose gradients are sparse.
#pragma once

#include "item3d/core/failed_steps.h"
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
    /// [rows] float32 factors of the rows' learning rates, for groups of one parameter. If
    /// undefined, all factors are 1.
    at::Tensor row_factors = {};
};

/// Optimiser of groups of parameters, each with its own options. A parameter with a dense gradient
/// is updated as usual. A parameter with a sparse gradient (the hash grid's table, [rows, F]) is
/// updated lazily: only the rows in the gradient change, and the bias correction counts each row's
/// own updates. So a row whose first update comes after a thousand steps moves as far as a row that
/// is updated in the first step. Parameters must be contiguous float32 tensors, on the CPU or a
/// CUDA device. Results do not depend on the number of threads.
class Adam {
  public:
    /// Adds a group. Throws std::logic_error for a name in use.
    void add_group(const std::string& name, std::vector<at::Tensor> parameters,
                   const AdamOptions& options);
    /// Returns a group's options. Throws std::logic_error for an unknown name.
    AdamOptions& options(const std::string& group);

    std::vector<at::Tensor> parameters() const;  ///< those of all groups

    /// Does one step for all parameters that have a gradient. If a gradient has a number that is
    /// not finite, the step is skipped. Throws InputError if ten steps in a row are skipped.
    void step();
    /// Makes the gradients undefined. The next backward pass creates new ones.
    void zero_grad();

    /// Returns the complete state by name. "network.1.momentum" is the momentum of parameter 1 of
    /// the group "network". The tensors are the optimiser's own; to keep them beyond the next step,
    /// clone them.
    std::map<std::string, at::Tensor> state() const;
    /// Restores a result of state(). Throws std::logic_error for a missing name or a wrong shape.
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
    /// True if all gradients are finite.
    bool has_finite_gradients() const;

    std::vector<Group> groups_;
    FailedSteps failed_;
    int max_updates_ = 0;  ///< largest entry of all `updates`
};

}  // namespace item3d
