// Messages for failed comparisons of tensors.
#pragma once

#include "item3d/tensors/tensor.h"

#include <algorithm>
#include <sstream>
#include <string>

namespace item3d::testing {

/// Returns a text with the first values of two tensors and the position of their largest
/// difference, or with their shapes if these differ.
inline std::string difference(const at::Tensor& found, const at::Tensor& expected) {
    std::ostringstream text;
    if (found.sizes() != expected.sizes()) {
        text << "shape " << found.sizes() << " instead of " << expected.sizes();
        return text.str();
    }
    if (found.numel() == 0) return "no values";
    const auto flat = [](const at::Tensor& tensor) {
        return tensor.detach().to(at::kCPU).to(at::kDouble).reshape({-1}).contiguous();
    };
    const at::Tensor ours = flat(found), theirs = flat(expected);
    const auto* a = ours.data_ptr<double>();
    const auto* b = theirs.data_ptr<double>();
    const auto worst = (ours - theirs).abs().argmax().item<std::int64_t>();
    std::vector<std::int64_t> place(static_cast<std::size_t>(found.dim()));
    std::int64_t rest = worst;
    for (std::int64_t axis = found.dim(); axis-- > 0; rest /= found.size(axis))
        place[static_cast<std::size_t>(axis)] = rest % found.size(axis);
    text << "largest error at [";
    for (std::size_t axis = 0; axis < place.size(); ++axis)
        text << (axis ? ", " : "") << place[axis];
    text << "] of " << found.sizes() << ": " << a[worst] << " instead of " << b[worst]
         << "; first values";
    const std::int64_t count = std::min<std::int64_t>(6, found.numel());
    for (std::int64_t i = 0; i < count; ++i)
        text << ' ' << a[i];
    text << " instead of";
    for (std::int64_t i = 0; i < count; ++i)
        text << ' ' << b[i];
    return text.str();
}

}  // namespace item3d::testing
