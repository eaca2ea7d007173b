// Adam (Kingma and Ba 2015) for parameters of which a step touches few rows.
#pragma once

#include <torch/types.h>

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
    torch::Tensor row_factors = {};
};

/// Groups of parameters, each with its own options. A parameter whose gradient is dense is updated
/// as usual. One whose gradient is sparse (the hash grid's table, [rows, F]) is updated lazily:
/// only the rows in the gradient, and bias correction counts the updates of each row, so a row that
/// is seen for the first time after a thousand steps moves as far as one that is seen in the first.
/// float32, contiguous parameters, on the CPU or a CUDA device. Results do not depend on the number
/// of threads.
class Adam {
  public:
    /// Returns the group's index. Parameters keep their order; names in state() follow it.
    std::size_t add_group(std::vector<torch::Tensor> parameters, const AdamOptions& options);
    AdamOptions& options(std::size_t group) { return groups_.at(group).options; }
    std::size_t group_count() const { return groups_.size(); }

    /// Parameters without a gradient are left alone.
    void step();
    /// Gradients become undefined (the next backward makes new ones).
    void zero_grad();

    /// All that a resumed run needs, by name ("0.1.momentum": group 0, parameter 1). The tensors
    /// are the optimiser's own: clone them to keep them beyond the next step.
    std::map<std::string, torch::Tensor> state() const;
    /// Copies values of state() back. Throws std::logic_error for a missing name or a wrong shape.
    void load_state(const std::map<std::string, torch::Tensor>& state);

  private:
    struct Slot {
        torch::Tensor parameter;
        torch::Tensor momentum;  ///< running mean of gradients, as the parameter
        torch::Tensor variance;  ///< running mean of squares, as the parameter
        torch::Tensor updates;   ///< [rows] int32: how often each row was updated
    };
    struct Group {
        std::vector<Slot> slots;
        AdamOptions options;
    };
    std::vector<Group> groups_;
    int most_updates_ = 0;  ///< of any row
};

}  // namespace item3d
