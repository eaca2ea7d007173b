// Adam (Kingma and Ba 2015) for parameters of which a step touches few rows.
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
    /// [rows] float32, for groups of one parameter: what each row's learning rate is multiplied by.
    /// Undefined: by 1.
    at::Tensor row_factors = {};
};

/// Groups of parameters, each with its own options. A parameter whose gradient is dense is updated
/// as usual. One whose gradient is sparse (the hash grid's table, [rows, F]) is updated lazily:
/// only the rows in the gradient, and bias correction counts the updates of each row, so a row that
/// is seen for the first time after a thousand steps moves as far as one that is seen in the first.
/// float32, contiguous parameters, on the CPU or a CUDA device. Results do not depend on the number
/// of threads.
class Adam {
  public:
    /// Each group has a name of its own. Throws std::logic_error for one that is there already.
    void add_group(const std::string& name, std::vector<at::Tensor> parameters,
                   const AdamOptions& options);
    /// Options of a group; throws std::logic_error where none has this name.
    AdamOptions& options(const std::string& group);

    std::vector<at::Tensor> parameters() const;  ///< of all groups

    /// Parameters without a gradient are left alone.
    void step();
    /// Gradients become undefined (the next backward makes new ones).
    void zero_grad();

    /// All that a resumed run needs, by name ("network.1.momentum": of the group's parameter 1).
    /// The tensors are the optimiser's own: clone them to keep them beyond the next step.
    std::map<std::string, at::Tensor> state() const;
    /// Copies values of state() back. Throws std::logic_error for a missing name or a wrong shape.
    void load_state(const std::map<std::string, at::Tensor>& state);

  private:
    struct Slot {
        at::Tensor parameter;
        at::Tensor momentum;  ///< running mean of gradients, as the parameter
        at::Tensor variance;  ///< running mean of squares, as the parameter
        at::Tensor updates;   ///< [rows] int32: how often each row was updated
    };
    struct Group {
        std::string name;
        std::vector<Slot> slots;
        AdamOptions options;
    };
    std::vector<Group> groups_;
    int max_updates_ = 0;  ///< of any row
};

}  // namespace item3d
