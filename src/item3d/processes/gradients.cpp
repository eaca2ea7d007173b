#include "item3d/processes/gradients.h"

#include "item3d/tensors/sparse_rows.h"

#include <algorithm>
#include <cstring>

namespace item3d {
namespace {

/// Rows of a table, in ascending order.
struct SparseRows {
    std::vector<std::int32_t> index;
    std::vector<float> values;  ///< `width` values for each row
};

SparseRows rows_of(const at::Tensor& gradient) {
    const at::Tensor index = gradient.indices().select(0, 0).to(at::kCPU, at::kInt).contiguous();
    const at::Tensor values = gradient.values().cpu().contiguous();
    const auto* first = index.const_data_ptr<std::int32_t>();
    const auto* value = values.const_data_ptr<float>();
    return {{first, first + index.numel()}, {value, value + values.numel()}};
}

SparseRows merged(const SparseRows& a, const SparseRows& b, std::size_t width) {
    SparseRows sum;
    sum.index.resize(a.index.size() + b.index.size());
    sum.values.resize(sum.index.size() * width);
    std::size_t i = 0, j = 0, rows = 0;
    const auto take = [&](const SparseRows& from, std::size_t row) {
        sum.index[rows] = from.index[row];
        std::copy_n(from.values.data() + row * width, width, sum.values.data() + rows * width);
        ++rows;
    };
    while (i < a.index.size() && j < b.index.size()) {
        if (a.index[i] < b.index[j]) {
            take(a, i++);
        } else if (b.index[j] < a.index[i]) {
            take(b, j++);
        } else {
            float* value = sum.values.data() + rows * width;
            take(a, i++);
            for (std::size_t k = 0; k < width; ++k)
                value[k] += b.values[j * width + k];
            ++j;
        }
    }
    while (i < a.index.size())
        take(a, i++);
    while (j < b.index.size())
        take(b, j++);
    sum.index.resize(rows);
    sum.values.resize(rows * width);
    return sum;
}

/// Packs index and values into one message, [maximum * (1 + width)] float32, which has the same
/// length in all processes. Its first `maximum` elements hold the bits of the index.
at::Tensor to_message(const SparseRows& rows, std::int64_t maximum, std::int64_t width) {
    at::Tensor message = at::zeros({maximum * (1 + width)}, at::kFloat);
    float* data = message.data_ptr<float>();
    if (rows.index.empty()) return message;
    std::memcpy(data, rows.index.data(), rows.index.size() * sizeof(std::int32_t));
    std::copy(rows.values.begin(), rows.values.end(), data + maximum);
    return message;
}

SparseRows from_message(const at::Tensor& message, std::int64_t maximum, std::int64_t count,
                        std::int64_t width) {
    const float* data = message.const_data_ptr<float>();
    SparseRows rows;
    if (count == 0) return rows;
    rows.index.resize(static_cast<std::size_t>(count));
    std::memcpy(rows.index.data(), data, rows.index.size() * sizeof(std::int32_t));
    rows.values.assign(data + maximum, data + maximum + count * width);
    return rows;
}

void sum_sparse(const ProcessGroup& processes, at::Tensor parameter,
                const std::vector<std::int64_t>& counts) {
    const std::int64_t width = parameter.size(1);
    const std::int64_t maximum = *std::max_element(counts.begin(), counts.end());
    const at::Tensor& own = parameter.grad();
    const auto messages =
        processes.gather(to_message(own.defined() ? rows_of(own) : SparseRows(), maximum, width));
    SparseRows sum;
    for (std::size_t rank = 0; rank < messages.size(); ++rank)
        sum = merged(sum, from_message(messages[rank], maximum, counts[rank], width),
                     static_cast<std::size_t>(width));
    const auto rows = static_cast<std::int64_t>(sum.index.size());
    const at::Device device = parameter.device();
    const at::Tensor index =
        at::from_blob(sum.index.data(), {1, rows}, at::kInt).to(at::kLong).to(device);
    const at::Tensor values =
        at::from_blob(sum.values.data(), {rows, width}, at::kFloat).clone().to(device);
    parameter.mutable_grad() = at::_sparse_coo_tensor_unsafe(
        index, values, parameter.sizes(), values.options().layout(at::kSparse), true);
}

void sum_dense(const ProcessGroup& processes, const std::vector<at::Tensor>& parameters) {
    if (parameters.empty()) return;
    std::vector<at::Tensor> flat;
    for (const at::Tensor& parameter : parameters)
        flat.push_back(parameter.grad().defined()
                           ? parameter.grad().flatten()
                           : at::zeros({parameter.numel()}, parameter.options()));
    at::Tensor all = at::cat(flat);
    processes.sum(all);
    std::int64_t first = 0;
    for (at::Tensor parameter : parameters) {
        parameter.mutable_grad() =
            all.narrow(0, first, parameter.numel()).view(parameter.sizes()).clone();
        first += parameter.numel();
    }
}

}  // namespace

void sum_gradients(const ProcessGroup& processes, const std::vector<at::Tensor>& parameters) {
    if (!processes.several()) return;
    const at::NoGradGuard no_grad;
    // Kind of each parameter's gradient: the number of rows if it is sparse, -1 if it is dense, -2
    // if there is none.
    at::Tensor kinds = at::full({static_cast<std::int64_t>(parameters.size())}, -2, at::kLong);
    for (std::size_t i = 0; i < parameters.size(); ++i) {
        at::Tensor parameter = parameters[i];
        at::Tensor& gradient = parameter.mutable_grad();
        if (!gradient.defined()) continue;
        if (gradient.is_sparse()) gradient = coalesce_rows(gradient);
        kinds[static_cast<std::int64_t>(i)] = gradient.is_sparse() ? gradient._nnz() : -1;
    }
    const std::vector<at::Tensor> all = processes.gather(kinds);
    std::vector<at::Tensor> dense;
    for (std::size_t i = 0; i < parameters.size(); ++i) {
        std::vector<std::int64_t> counts;
        for (const at::Tensor& each : all)
            counts.push_back(each.const_data_ptr<std::int64_t>()[i]);
        const std::int64_t kind = *std::max_element(counts.begin(), counts.end());
        for (std::int64_t& count : counts)
            count = std::max<std::int64_t>(count, 0);
        if (kind >= 0) sum_sparse(processes, parameters[i], counts);
        if (kind == -1) dense.push_back(parameters[i]);
    }
    sum_dense(processes, dense);
}

}  // namespace item3d
