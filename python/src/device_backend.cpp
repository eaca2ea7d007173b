#include "python/src/device_backend.h"

#include <algorithm>

namespace item3d::python {
namespace {

using Table = cuda::RenderTable;

Floats share(const Tensor& tensor) {
    return Floats(mutable_floats(tensor), [tensor](float*) {});
}

}  // namespace

Floats DeviceBackend::allocate(std::int64_t count) const {
    return share(call_.empty({count}));
}

Floats DeviceBackend::upload(const std::vector<float>& values) const {
    return share(call_.upload(values.data(), std::ssize(values), ScalarType::Float));
}

void DeviceBackend::fill(float* values, std::int64_t count, float value) const {
    call_.launch(&Table::fill_value, kernels::ValueParameters{nullptr, values, value}, count);
}

void DeviceBackend::copy(const float* from, std::int64_t count, float* to) const {
    copy_words(from, count, to);
}

void DeviceBackend::copy_words(const void* from, std::int64_t count, void* to) const {
    call_.launch(&Table::copy_word,
                 kernels::CopyParameters{static_cast<const std::uint32_t*>(from),
                                         static_cast<std::uint32_t*>(to)},
                 count);
}

void DeviceBackend::add(const float* terms, std::int64_t count, float* to) const {
    call_.launch(&Table::add_value, kernels::ValueParameters{terms, to, 0}, count);
}

Floats DeviceBackend::far_tables(int size) const {
    const Floats tables = HostBackend().far_tables(size);
    return share(call_.upload(tables.get(), static_cast<std::int64_t>(size) * (size + 1),
                              ScalarType::Float));
}

void DeviceBackend::sum_rows(const float* rows, std::int64_t count, std::int64_t columns, bool,
                             float* sums) const {
    const std::int64_t pieces = std::clamp<std::int64_t>(count / 64, 1, 512);
    const Tensor piece_sums = call_.empty({pieces, columns}, ScalarType::Double);
    const kernels::RowSumParameters p{
        rows, count, columns, pieces, static_cast<double*>(piece_sums.mutable_data_ptr()), sums};
    call_.launch(&Table::sum_rows_of_piece, p, pieces * columns);
    call_.launch(&Table::sum_pieces, p, columns);
}

void DeviceBackend::brightest(const float* colors, std::int64_t texels, float share_of_all,
                              std::int64_t count, std::int64_t* indices) const {
    const Tensor copied = call_.empty({texels, 3});
    copy(colors, 3 * texels, mutable_floats(copied));
    const Tensor light = call_.on_cpu(copied);
    std::vector<std::int64_t> found(static_cast<std::size_t>(count));
    HostBackend().brightest(floats(light), texels, share_of_all, count, found.data());
    const Tensor uploaded = call_.upload(found.data(), count, ScalarType::Long);
    copy_words(uploaded.const_data_ptr(), 2 * count, indices);
}

void DeviceBackend::launch(const Launch& start) const {
    call_.launch(start);
}

}  // namespace item3d::python
