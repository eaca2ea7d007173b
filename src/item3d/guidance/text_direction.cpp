#include "item3d/guidance/text_direction.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace item3d {
namespace {

/// All numbers of a text in a row.
at::Tensor flat(const TextEmbedding& text) {
    const at::Tensor states = text.states.flatten();
    const at::Tensor all =
        text.pooled.defined() ? at::cat({states, text.pooled.flatten()}) : states;
    return all.cpu().to(at::kDouble);
}

}  // namespace

TextEmbedding scaled(const TextEmbedding& text, double factor) {
    return {factor * text.states, text.pooled.defined() ? factor * text.pooled : at::Tensor()};
}

TextEmbedding add_scaled(const TextEmbedding& a, const TextEmbedding& b, double factor) {
    return {a.states + factor * b.states,
            a.pooled.defined() ? a.pooled + factor * b.pooled : at::Tensor()};
}

double length_of(const TextEmbedding& text) {
    return flat(text).norm().item<double>();
}

TextDirection compare_directions(const TextEmbedding& target, const TextEmbedding& source,
                                 const TextEmbedding& adjusted) {
    const at::Tensor first = flat(add_scaled(target, source, -1));
    const at::Tensor now = flat(add_scaled(target, adjusted, -1));
    const double first_length = first.norm().item<double>();
    const double length = now.norm().item<double>();
    if (first_length == 0 || length == 0) return {0, first_length == 0 ? 1.0 : 0.0};
    const double cosine = first.dot(now).item<double>() / (first_length * length);
    return {std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi,
            length / first_length};
}

}  // namespace item3d
