#include "item3d/guidance/text_direction.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace item3d {
namespace {

/// Returns all elements of a text as one row.
at::Tensor flat(const TextEmbedding& text) {
    const at::Tensor states = text.states.flatten();
    const at::Tensor all =
        text.pooled.defined() ? at::cat({states, text.pooled.flatten()}) : states;
    return all.cpu().to(at::kDouble).contiguous();
}

/// Returns the dot product, summed in order. A library's dot product splits the sum among threads,
/// and its rounding depends on the number of threads.
double dot(const at::Tensor& a, const at::Tensor& b) {
    const double* first = a.const_data_ptr<double>();
    return std::inner_product(first, first + a.numel(), b.const_data_ptr<double>(), 0.0);
}

double length_of(const at::Tensor& flat) {
    return std::sqrt(dot(flat, flat));
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
    return length_of(flat(text));
}

TextDirection compare_directions(const TextEmbedding& target, const TextEmbedding& source,
                                 const TextEmbedding& adjusted) {
    const at::Tensor first = flat(add_scaled(target, source, -1));
    const at::Tensor now = flat(add_scaled(target, adjusted, -1));
    const double first_length = length_of(first);
    const double length = length_of(now);
    if (first_length == 0 || length == 0) return {0, first_length == 0 ? 1.0 : 0.0};
    const double cosine = dot(first, now) / (first_length * length);
    return {std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi,
            length / first_length};
}

}  // namespace item3d
