#include "python/src/value_checks.h"

#include "item3d/core/error.h"

#include <algorithm>
#include <atomic>

namespace item3d::python {

using Table = cuda::RenderTable;

void ValueChecks::finite(const char* name, const Tensor& tensor, const Describe& describe) {
    if (skips()) return;
    const Describe message = describe ? describe : [name](std::int64_t) {
        return std::string(name) + " must be finite, found NaN or infinity";
    };
    const float* values = floats(tensor);
    const std::int64_t count = tensor.numel();
    if (call_.on_device()) {
        search(&Table::find_not_finite, {values, nullptr, 0, nullptr}, count, message);
        return;
    }
    std::atomic<bool> any{false};
    constexpr std::int64_t block = 65536;
    parallel_for(
        "finite", (count + block - 1) / block,
        [&](std::int64_t i) {
            std::uint32_t bad = 0;
            for (std::int64_t k = i * block; k < std::min(count, (i + 1) * block); ++k)
                bad |= kernels::is_not_finite(values[k]);
            if (bad != 0) any = true;
        },
        1);
    if (any)
        call_.fail(message(std::find_if(values, values + count, kernels::is_not_finite) - values));
}

void ValueChecks::indices(const Tensor& triangles, std::int64_t vertices) {
    if (skips()) return;
    const std::int32_t* corners = integers(triangles);
    const std::int64_t count = triangles.numel();
    const Describe message = [=, this](std::int64_t index) {
        const Tensor found = call_.on_cpu(triangles);
        return "triangles must name vertices from 0 to " + std::to_string(vertices - 1) +
               ", found " + std::to_string(integers(found)[index]);
    };
    if (call_.on_device()) {
        search(&Table::find_invalid_index, {nullptr, corners, vertices, nullptr}, count, message);
        return;
    }
    std::int32_t low = 0, high = -1;
    for (std::int64_t i = 0; i < count; ++i) {
        low = std::min(low, corners[i]);
        high = std::max(high, corners[i]);
    }
    if (low < 0 || high >= vertices)
        call_.fail(message(std::find(corners, corners + count, low < 0 ? low : high) - corners));
}

void ValueChecks::raster(const Tensor& raster, std::int64_t triangles) {
    if (skips()) return;
    const kernels::SearchParameters p{floats(raster), nullptr, triangles, nullptr};
    const std::int64_t pixels = raster.numel() / 4;
    const Describe message = [=](std::int64_t) {
        return "raster names triangles beyond the " + std::to_string(triangles) + " that are given";
    };
    if (call_.on_device()) {
        search(&Table::find_invalid_triangle, p, pixels, message);
        return;
    }
    std::atomic<bool> any{false};
    parallel_for(
        "raster", pixels,
        [&](std::int64_t pixel) {
            if (kernels::is_invalid_triangle(p, pixel)) any = true;
        },
        16384);
    if (any) call_.fail(message(0));
}

void ValueChecks::neighbours(const Tensor& neighbours) {
    if (skips()) return;
    const std::int64_t count = neighbours.numel();
    const kernels::SearchParameters p{nullptr, integers(neighbours), count, nullptr};
    const Describe message = [](std::int64_t) {
        return std::string("topology is not that of these triangles");
    };
    if (call_.on_device()) {
        search(&Table::find_invalid_neighbour, p, count, message);
        return;
    }
    for (std::int64_t i = 0; i < count; ++i)
        if (kernels::is_invalid_neighbour(p, i)) call_.fail(message(i));
}

void ValueChecks::search(Entry entry, kernels::SearchParameters p, std::int64_t count,
                         const Describe& describe) {
    if (searches_.empty()) found_ = call_.zeros({max_searches}, ScalarType::Long);
    ITEM3D_CHECK(searches_.size() < max_searches, "as many searches as slots");
    p.found = static_cast<unsigned long long*>(found_.mutable_data_ptr()) + searches_.size();
    call_.launch(entry, p, count);
    searches_.push_back(describe);
}

void ValueChecks::finish() {
    if (searches_.empty()) return;
    const Tensor result = call_.on_cpu(found_);
    const auto* found = static_cast<const std::int64_t*>(result.const_data_ptr());
    for (std::size_t i = 0; i < searches_.size(); ++i)
        if (found[i] != 0) call_.fail(searches_[i](~found[i]));
    searches_.clear();
}

}  // namespace item3d::python
