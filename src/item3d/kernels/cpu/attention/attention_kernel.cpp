// Attention, six queries at a time. A row of scores is kept whole (six rows of 1,024 keys are 24
// KB), so its maximum is known before the first exponential. The online softmax of Dao et al. 2022,
// which corrects earlier sums when it finds a larger score, is not needed.
//
//     scores  = Q K^T      multiply(), depth d; K packed as columns j
//     weights = 2^(f s - f max s)      f = log2(e) / sqrt(d), so that no other factor is applied
//     result  = weights V / sum of weights      multiply(), depth keys; division at the end
//
// Scratch memory of one head, K = keys rounded up to 32, D = width rounded up to 16:
//
//     scores         float   [6, K]      columns beyond `keys` are products with zeros
//     sums           float   [6, 64]     one block of columns of the result
//     weights        Number  [6, K]      0 beyond `keys`
//     keys_packed    Number  [K / 64, width / group, 64, group]   zeros beyond `keys`
//     values_packed  Number  [D / 64, K / group, 64, group]       zeros beyond both
//
// The last block of 64 may be narrower, in whole registers of 16. K is a multiple of 32, because a
// register has 32 numbers of BFloat16.
#include "item3d/kernels/cpu/attention/attention_kernel.h"

#include "item3d/kernels/cpu/linear/matrix_tile.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace item3d {
namespace ITEM3D_INSTRUCTIONS {
namespace {

using std::int64_t;

/// Returns the number of keys, padded to two registers of float, which are one register of
/// BFloat16.
int64_t whole_keys(int64_t keys) {
    return (keys + 2 * lanes - 1) / (2 * lanes) * (2 * lanes);
}

/// Calls f(first, columns) for each block of packed columns, `count` columns in total. The last
/// block may be narrower, but consists of whole registers.
template <typename Function>
void for_each_column(int64_t count, const Function& f) {
    for (int64_t first = 0; first < count; first += packed_columns)
        f(first, std::min(packed_columns, whole_registers(count - first)));
}

/// Scratch memory of one head. Keys and widths are rounded up to whole registers.
template <typename Number>
struct Scratch {
    int64_t keys, width;
    float *scores, *sums;  ///< [rows, keys], [rows, packed_columns]
    /// [rows, keys]; the other two are packed for multiply().
    Number *weights, *keys_packed, *values_packed;

    Scratch(const AttentionShape& shape, void* memory)
        : keys(whole_keys(shape.keys)),
          width(whole_registers(shape.width)),
          scores(static_cast<float*>(memory)),
          sums(scores + rows * keys),
          weights(reinterpret_cast<Number*>(sums + rows * packed_columns)),
          keys_packed(weights + rows * keys),
          values_packed(keys_packed + keys * shape.width) {}
    static int64_t bytes(const AttentionShape& shape) {
        const int64_t keys = whole_keys(shape.keys);
        const int64_t width = whole_registers(shape.width);
        return static_cast<int64_t>(sizeof(float)) * rows * (keys + packed_columns) +
               static_cast<int64_t>(sizeof(Number)) * keys * (rows + shape.width + width);
    }
};

/// Packs [places, stride] as the transposed matrix [width, places], with zeros beyond `count`
/// places.
template <typename Number>
void pack_transposed(const Number* from, int64_t stride, int64_t count, int64_t places,
                     int64_t width, Number* to) {
    constexpr int group = Arithmetic<Number>::group;
    for_each_column(places, [&](int64_t first, int64_t columns) {
        Number* packed = to + first * width;
        for (int64_t j = 0; j < columns; ++j) {
            const Number* place = from + (first + j) * stride;
            const bool there = first + j < count;
            for (int64_t c = 0; c < width; ++c)
                packed[(c / group * columns + j) * group + c % group] = there ? place[c] : Number{};
        }
    });
}

/// Packs [places, stride] as the matrix [places, width], with zeros beyond `count` and `width`.
template <typename Number>
void pack_straight(const Number* from, int64_t stride, int64_t count, int64_t places, int64_t width,
                   Number* to) {
    constexpr int group = Arithmetic<Number>::group;
    for_each_column(width, [&](int64_t first, int64_t columns) {
        Number* packed = to + first * places;
        for (int64_t i = 0; i < places; ++i)
            for (int64_t j = 0; j < columns; ++j)
                packed[(i / group * columns + j) * group + i % group] =
                    i < count && first + j < width ? from[i * stride + first + j] : Number{};
    });
}

/// Returns 2^x to the precision of float, as 2^n 2^r with |r| <= 1/2 and 2^r by its Taylor series.
/// Returns 0 on underflow.
ITEM3D_INLINE Lanes power_of_two(Lanes x) {
    const Lanes n = nearest(x);
    const Lanes r = x - n;
    Lanes series = all(1.5403530e-4f);
    for (const float term :
         {1.3333558e-3f, 9.6181291e-3f, 5.5504109e-2f, 2.4022651e-1f, 6.9314718e-1f, 1.0f})
        series = multiply_add(series, r, all(term));
    return scaled(series, n);
}

/// Sets the weights to e^(scale (score - maximum)), and to zero beyond `count`. Returns their sum.
template <typename Number>
float soften(const float* scores, int64_t count, int64_t places, float scale, Number* weights) {
    const int64_t whole = count / lanes * lanes, rest = count - whole;
    const Mask last = first_lanes(rest);
    Lanes maximum = all(std::numeric_limits<float>::lowest());
    for (int64_t i = 0; i < whole; i += lanes)
        maximum = larger(maximum, load(scores + i));
    maximum = choose(last, larger(maximum, load_first(scores + whole, rest)), maximum);
    const float factor = scale * 1.44269504f;
    const Lanes slope = all(factor), top = all(factor * largest(maximum));
    Lanes sum = zero();
    for (int64_t i = 0; i < whole; i += lanes) {
        const Lanes value = power_of_two(multiply_subtract(slope, load(scores + i), top));
        sum += value;
        store(weights + i, value);
    }
    if (rest != 0) {
        const Lanes score = load_first(scores + whole, rest);
        const Lanes value =
            choose(last, power_of_two(multiply_subtract(slope, score, top)), zero());
        sum += value;
        store(weights + whole, value);
    }
    for (int64_t i = whole_registers(count); i < places; i += lanes)
        store(weights + i, zero());
    return sum_of(sum);
}

template <typename Number>
int64_t attention_scratch(const AttentionShape& shape) {
    return Scratch<Number>::bytes(shape);
}

template <typename Number>
void attend(const AttentionShape& shape, const Number* query, const Number* key,
            const Number* value, const AttentionPart& part, Number* result, void* memory) {
    const Scratch<Number> scratch(shape, memory);
    const int64_t stride = shape.heads * shape.width, keys = scratch.keys, width = shape.width;
    const int64_t offset = part.head * width;
    const int64_t keys_begin = part.row * shape.keys * stride + offset;
    pack_transposed(key + keys_begin, stride, shape.keys, keys, width, scratch.keys_packed);
    pack_straight(value + keys_begin, stride, shape.keys, keys, width, scratch.values_packed);
    const float scale = 1 / std::sqrt(static_cast<float>(width));
    for (int64_t first = part.first_query; first < part.last_query; first += rows) {
        const int64_t count = std::min<int64_t>(rows, part.last_query - first);
        const int64_t begin = (part.row * shape.queries + first) * stride + offset;
        const Number *queries[rows], *weights[rows];
        for (int i = 0; i < rows; ++i) {
            queries[i] = query + begin + std::min<int64_t>(i, count - 1) * stride;
            weights[i] = scratch.weights + i * keys;
        }
        for_each_column(keys, [&](int64_t place, int64_t columns) {
            multiply(columns, queries, width, scratch.keys_packed + place * width,
                     scratch.scores + place, keys, false);
        });
        float total[rows];
        for (int i = 0; i < rows; ++i)
            total[i] = soften(scratch.scores + i * keys, shape.keys, keys, scale,
                              scratch.weights + i * keys);
        for_each_column(width, [&](int64_t channel, int64_t columns) {
            multiply(columns, weights, keys, scratch.values_packed + channel * keys, scratch.sums,
                     packed_columns, false);
            for (int64_t i = 0; i < count; ++i) {
                const Lanes share = all(1 / total[i]);
                for (int64_t c = 0; c < columns && channel + c < width; c += lanes)
                    store_first(result + begin + i * stride + channel + c, width - channel - c,
                                share * load(scratch.sums + i * packed_columns + c));
            }
        });
    }
}

template <typename Number>
constexpr AttentionKernel<Number> attention_functions{attention_scratch<Number>, attend<Number>};

}  // namespace
}  // namespace ITEM3D_INSTRUCTIONS

template <>
AttentionKernel<float> attention_kernel<InstructionSet::ITEM3D_INSTRUCTIONS, float>() {
    return ITEM3D_INSTRUCTIONS::attention_functions<float>;
}

#ifdef __AVX512BF16__
template <>
AttentionKernel<BFloat16> attention_kernel<InstructionSet::avx512, BFloat16>() {
    return avx512::attention_functions<BFloat16>;
}
#endif

}  // namespace item3d
