#include "item3d/render/prefilter/tensor_backend.h"

#include "item3d/render/cuda/module.h"

namespace item3d {

namespace {

Floats share(const at::Tensor& tensor) {
    return Floats(tensor.data_ptr<float>(), [tensor](float*) {});
}

at::Tensor view_of(const void* values, at::IntArrayRef sizes, at::ScalarType type,
                   at::Device device) {
    return at::from_blob(const_cast<void*>(values), sizes,
                         at::TensorOptions().dtype(type).device(device));
}

}  // namespace

Floats TensorBackend::allocate(std::int64_t count) const {
    return share(at::empty({count}, at::TensorOptions().dtype(at::kFloat).device(device_)));
}

Floats TensorBackend::upload(const std::vector<float>& values) const {
    const auto count = static_cast<std::int64_t>(values.size());
    const at::Tensor host = view_of(values.data(), {count}, at::kFloat, at::kCPU);
    return share(device_.is_cpu() ? host.clone() : host.to(device_));
}

void TensorBackend::fill(float* values, std::int64_t count, float value) const {
    view_of(values, {count}, at::kFloat, device_).fill_(value);
}

void TensorBackend::copy(const float* from, std::int64_t count, float* to) const {
    view_of(to, {count}, at::kFloat, device_).copy_(view_of(from, {count}, at::kFloat, device_));
}

void TensorBackend::add(const float* terms, std::int64_t count, float* to) const {
    view_of(to, {count}, at::kFloat, device_).add_(view_of(terms, {count}, at::kFloat, device_));
}

Floats TensorBackend::far_tables(int size) const {
    const at::Tensor steps =
        at::arange(size, at::TensorOptions().dtype(at::kFloat).device(device_));
    const at::Tensor centres = (2 * steps + 1) / static_cast<float>(size) - 1.0f;
    const at::Tensor squares = centres.square();
    const at::Tensor inverse_lengths = (1 + squares + squares.unsqueeze(1)).rsqrt();
    return share(at::cat({centres, inverse_lengths.flatten()}));
}

void TensorBackend::sum_rows(const float* rows, std::int64_t count, std::int64_t columns,
                             bool precise, float* sums) const {
    const at::Tensor terms = view_of(rows, {count, columns}, at::kFloat, device_);
    view_of(sums, {columns}, at::kFloat, device_)
        .copy_(precise ? terms.sum(0, false, at::kDouble) : terms.sum(0));
}

void TensorBackend::brightest(const float* colors, std::int64_t texels, float share_of_all,
                              std::int64_t count, std::int64_t* indices) const {
    const at::Tensor light = view_of(colors, {texels, 3}, at::kFloat, device_).sum(-1);
    const at::Tensor minimum = share_of_all * light.clamp_min(0).sum();
    const auto [brightest, places] = at::topk(light, count);
    view_of(indices, {count}, at::kLong, device_).copy_(at::where(brightest > minimum, places, -1));
}

void TensorBackend::launch(const Launch& start) const {
    const cuda::Launch guard(device_);
    guard.check(start(cuda::render_table(), guard.stream()));
}

}  // namespace item3d
