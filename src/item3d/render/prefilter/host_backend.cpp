#include "item3d/render/prefilter/host_backend.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <numeric>
#include <stdexcept>

namespace item3d {

Floats HostBackend::allocate(std::int64_t count) const {
    constexpr std::align_val_t cache_line{64};
    const auto bytes = static_cast<std::size_t>(count) * sizeof(float);
    return Floats(static_cast<float*>(::operator new[](bytes, cache_line)),
                  [](float* values) { ::operator delete[](values, cache_line); });
}

Floats HostBackend::upload(const std::vector<float>& values) const {
    Floats copied = allocate(static_cast<std::int64_t>(values.size()));
    std::copy(values.begin(), values.end(), copied.get());
    return copied;
}

void HostBackend::fill(float* values, std::int64_t count, float value) const {
    std::fill_n(values, count, value);
}

void HostBackend::copy(const float* from, std::int64_t count, float* to) const {
    std::copy_n(from, count, to);
}

void HostBackend::add(const float* terms, std::int64_t count, float* to) const {
    for (std::int64_t i = 0; i < count; ++i)
        to[i] += terms[i];
}

Floats HostBackend::far_tables(int size) const {
    Floats tables = allocate(static_cast<std::int64_t>(size) * (size + 1));
    float *centres = tables.get(), *inverse_lengths = centres + size;
    for (int i = 0; i < size; ++i)
        centres[i] = kernels::texel_centre(i, size);
    for (int row = 0; row < size; ++row)
        for (int column = 0; column < size; ++column) {
            const float squared = 1 + centres[column] * centres[column];
            *inverse_lengths++ = 1 / std::sqrt(squared + centres[row] * centres[row]);
        }
    return tables;
}

void HostBackend::sum_rows(const float* rows, std::int64_t count, std::int64_t columns, bool,
                           float* sums) const {
    std::vector<double> totals(static_cast<std::size_t>(columns), 0.0);
    for (std::int64_t row = 0; row < count; ++row)
        for (double& total : totals)
            total += *rows++;
    std::transform(totals.begin(), totals.end(), sums,
                   [](double total) { return static_cast<float>(total); });
}

void HostBackend::brightest(const float* colors, std::int64_t texels, float share,
                            std::int64_t count, std::int64_t* indices) const {
    std::vector<float> light(static_cast<std::size_t>(texels));
    double sum = 0;
    for (float& value : light) {
        value = colors[0] + colors[1] + colors[2];
        colors += 3;
        sum += std::max(value, 0.0f);
    }
    std::vector<std::int64_t> order(light.size());
    std::iota(order.begin(), order.end(), 0);
    const auto at = [&](std::int64_t texel) { return light[static_cast<std::size_t>(texel)]; };
    std::partial_sort(
        order.begin(), order.begin() + count, order.end(),
        [&](std::int64_t a, std::int64_t b) { return at(a) != at(b) ? at(a) > at(b) : a < b; });
    const auto minimum = static_cast<float>(share * sum);
    for (std::int64_t i = 0; i < count; ++i)
        indices[i] = at(order[static_cast<std::size_t>(i)]) > minimum
                         ? order[static_cast<std::size_t>(i)]
                         : -1;
}

void HostBackend::launch(const Launch&) const {
    throw std::logic_error("HostBackend has no device");
}

}  // namespace item3d
