#include "item3d/networks/layers/packable_linear.h"

#include "item3d/core/error.h"
#include "item3d/kernels/cpu/linear/linear_kernel.h"
#include "item3d/tensors/parallel_ranges.h"
#include "item3d/tensors/tensor.h"
#include "item3d/tensors/weight_memory.h"

#include <algorithm>
#include <memory>
#include <vector>

namespace item3d {
namespace {

using std::int64_t;

template <typename Weight>
const auto& best_linear_kernel() {
    return kernel_for_this_processor<Multiplied<Weight>>(
        []<InstructionSet instructions> { return linear_kernel<instructions, Weight>(); });
}

template <typename Number>
void pack_all(const at::Tensor& weight, const at::Tensor& packed) {
    const int64_t columns = weight.size(0), depth = weight.size(1);
    const auto* from = static_cast<const Number*>(weight.data_ptr());
    auto* to = static_cast<Number*>(packed.data_ptr());
    const int64_t blocks = columns_of(columns);
    parallel_ranges(blocks, 1, [&](int64_t first, int64_t last) {
        best_linear_kernel<Number>()->pack(from, depth, first * packed_columns,
                                           std::min(columns, last * packed_columns), to);
    });
}

/// Calls f(part) for all parts of a product, on all threads.
template <typename Function>
void for_each_part(int64_t rows, int64_t columns, int64_t row_bytes, const Function& f) {
    // Maximum bytes of a part's rows, so that they stay in a core's cache beside the weights of a
    // column.
    constexpr int64_t max_bytes = 512 << 10;
    const int64_t max_rows = std::max<int64_t>(6, max_bytes / row_bytes / 6 * 6);
    const int64_t ranges = (rows + max_rows - 1) / max_rows, blocks = columns_of(columns);
    parallel_ranges(ranges * blocks, 1, [&](int64_t first, int64_t last) {
        for (int64_t task = first; task < last; ++task) {
            const int64_t row = task / blocks * max_rows, column = task % blocks * packed_columns;
            f(MatrixPart{row, std::min(rows, row + max_rows), column,
                         std::min(columns, column + packed_columns)});
        }
    });
}

template <typename Weight>
void multiply_all(const at::Tensor& x, const at::Tensor& packed, const ProductEnd& end,
                  const at::Tensor& y) {
    using Number = Multiplied<Weight>;
    const int64_t depth = x.size(1), columns = y.size(1);
    const auto* rows = static_cast<const Number*>(x.data_ptr());
    const auto* weights = static_cast<const Weight*>(packed.data_ptr());
    const auto run = [&](auto multiply, auto* to) {
        for_each_part(x.size(0), columns, depth * static_cast<int64_t>(sizeof(Number)),
                      [&](const MatrixPart& part) {
                          multiply(rows, depth, weights, end, columns, part, to);
                      });
    };
    if (y.scalar_type() == at::kFloat)
        run(best_linear_kernel<Weight>()->multiply, static_cast<float*>(y.data_ptr()));
    else
        run(best_linear_kernel<Weight>()->multiply_rounded, static_cast<Number*>(y.data_ptr()));
}

}  // namespace

bool PackedMatrix::runs(at::Device device, at::ScalarType dtype) {
    const bool as_float = dtype == at::kFloat || dtype == at::kHalf;
    // LibTorch's bfloat16 products are faster on processors with AMX.
    return device.is_cpu() &&
           ((as_float && best_linear_kernel<float>()) ||
            (dtype == at::kBFloat16 && best_linear_kernel<BFloat16>() && !amx_available()));
}

bool PackedMatrix::fits(const at::Tensor& weight) {
    return weight.dim() == 2 && weight.size(1) % register_numbers == 0 && weight.numel() > 0;
}

PackedMatrix::PackedMatrix(const at::Tensor& weight, at::ScalarType dtype)
    : columns_(weight.size(0)), depth_(weight.size(1)) {
    ITEM3D_CHECK(runs(weight.device(), dtype) && fits(weight), "these weights cannot be packed");
    const at::Tensor rounded = weight.detach().to(dtype).contiguous();
    packed_ = empty_weight({packed_size(columns_, depth_)}, dtype);
    const auto pack = dtype == at::kBFloat16 ? pack_all<BFloat16>
                      : dtype == at::kHalf   ? pack_all<Float16>
                                             : pack_all<float>;
    pack(rounded, packed_);
}

at::ScalarType PackedMatrix::multiplied_dtype() const {
    return packed_.scalar_type() == at::kBFloat16 ? at::kBFloat16 : at::kFloat;
}

at::Tensor PackedMatrix::multiply(const at::Tensor& x, const at::Tensor& bias,
                                  const LinearEnd& end) const {
    ITEM3D_CHECK(x.size(-1) == depth_, "x must be [..., I]");
    const auto floats = [](const at::Tensor& values) -> const float* {
        ITEM3D_CHECK(
            !values.defined() || (values.scalar_type() == at::kFloat && values.is_contiguous()),
            "the added tensor must be float32");
        return values.defined() ? values.const_data_ptr<float>() : nullptr;
    };
    std::vector<int64_t> sizes = x.sizes().vec();
    sizes.back() = columns_;
    const at::Tensor rows = x.detach().reshape({-1, depth_}).to(multiplied_dtype()).contiguous();
    const at::Tensor y =
        at::empty(sizes, x.options().dtype(end.rounded ? multiplied_dtype() : at::kFloat));
    const at::Tensor added = end.added.defined() ? end.added.contiguous() : end.added;
    ITEM3D_CHECK(!added.defined() || added.sizes() == y.sizes(), "added must be [..., O]");
    const ProductEnd finish{floats(bias), end.activation, floats(added)};
    const auto run = packed_.scalar_type() == at::kBFloat16 ? multiply_all<BFloat16>
                     : packed_.scalar_type() == at::kHalf   ? multiply_all<Float16>
                                                            : multiply_all<float>;
    run(rows, packed_, finish, y.view({-1, columns_}));
    return y;
}

at::Tensor PackedMatrix::unpacked() const {
    const int64_t group = packed_.scalar_type() == at::kBFloat16 ? 2 : 1;
    const int64_t whole = columns_ / packed_columns * packed_columns;
    const auto unpack = [&](int64_t first, int64_t last, int64_t width) {  // columns of that width
        return packed_.narrow(0, first * depth_, (last - first) * depth_)
            .view({-1, depth_ / group, width, group})
            .permute({0, 2, 1, 3})
            .reshape({-1, depth_});
    };
    const int64_t all = whole_registers(columns_);
    std::vector<at::Tensor> parts;
    if (whole > 0) parts.push_back(unpack(0, whole, packed_columns));
    if (all > whole) parts.push_back(unpack(whole, all, all - whole));
    return at::cat(parts).narrow(0, 0, columns_);
}

bool PackableLinearImpl::multiplies_packed(const at::Tensor& x) const {
    return packed_ && !(at::GradMode::is_enabled() && x.requires_grad());
}

at::Tensor PackableLinearImpl::as_read(const at::Tensor& x) const {
    return multiplies_packed(x) ? x.to(packed_->multiplied_dtype()) : x;
}

at::Tensor PackableLinearImpl::forward(const at::Tensor& x, const LinearEnd& end) {
    if (multiplies_packed(x)) return packed_->multiply(x, bias, end);
    at::Tensor y = packed_ ? at::linear(x, packed_->unpacked().to(x.scalar_type()), bias)
                           : LinearImpl::forward(x);
    if (end.activation == LinearActivation::gelu) y = at::gelu(y);
    if (end.activation == LinearActivation::quick_gelu) y = y * at::sigmoid(1.702 * y);
    return end.added.defined() ? end.added + y : y;
}

void PackableLinearImpl::pack(at::ScalarType dtype) {
    if (packed_ || !PackedMatrix::runs(weight.device(), dtype) || !PackedMatrix::fits(weight))
        return;
    ITEM3D_CHECK(weight.scalar_type() == at::kFloat && !weight.requires_grad(),
                 "packed weights must be float32 and cannot change");
    packed_.emplace(weight, dtype);
    weight.set_data(at::empty({0}, weight.options()));
}

bool PackableLinearImpl::pack_stored(const at::Tensor& stored) {
    constexpr int64_t fewest = 1 << 19;  // smaller weights are in a cache anyway
    if (stored.scalar_type() != at::kHalf || stored.numel() < fewest ||
        !PackedMatrix::runs(stored.device(), at::kHalf) || !PackedMatrix::fits(stored))
        return false;
    packed_.emplace(stored, at::kHalf);
    weight.set_data(at::empty({0}, at::kFloat));
    return true;
}

void pack_linear_layers(const torch::nn::Module& module, at::ScalarType dtype) {
    for (const auto& part : module.modules())
        if (const auto layer = std::dynamic_pointer_cast<PackableLinearImpl>(part))
            layer->pack(dtype);
}

}  // namespace item3d
