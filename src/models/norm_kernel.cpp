#include "item3d/models/norm_kernel.h"

#if defined(__AVX512F__) && defined(__AVX512BW__) && defined(__AVX512VL__) && \
    defined(__AVX512BF16__)
#define ITEM3D_NORM 1
#include "item3d/models/avx512_numbers.h"
#endif

#include <algorithm>

namespace item3d {

#ifdef ITEM3D_NORM

namespace {

using avx512::exponential;
using avx512::lanes;
using avx512::load;
using avx512::store;
using std::int64_t;

static_assert(norm_lanes == lanes);

/// Pixels whose sums are kept in float, before they go into double.
constexpr int64_t float_pixels = 32;

__m512 sigmoid(__m512 x) {
    // Beyond 80 either way nothing changes, and e^80 is still a float.
    const __m512 most = _mm512_set1_ps(80);
    const __m512 negative = _mm512_max_ps(_mm512_min_ps(-x, most), -most);
    const __m512 one = _mm512_set1_ps(1);
    return one / (one + exponential(negative));
}

__m512 silu_of(__m512 x) {
    return x * sigmoid(x);
}

__m512 silu_slope(__m512 x) {
    const __m512 one = _mm512_set1_ps(1), s = sigmoid(x);
    return s * (one + x * (one - s));
}

void add_to(double* to, __m512 value) {
    const __m512d low = _mm512_cvtps_pd(_mm512_castps512_ps256(value));
    const __m512d high = _mm512_cvtps_pd(_mm512_extractf32x8_ps(value, 1));
    _mm512_storeu_pd(to, _mm512_loadu_pd(to) + low);
    _mm512_storeu_pd(to + 8, _mm512_loadu_pd(to + 8) + high);
}

/// The gradient of scale x + offset.
template <typename Number>
__m512 inner_gradient(const Number* x, const Number* dy, __m512 scale, __m512 offset, bool silu) {
    const __m512 gradient = load(dy);
    if (!silu) return gradient;
    return gradient * silu_slope(_mm512_fmadd_ps(scale, load(x), offset));
}

}  // namespace

template <>
bool norm_kernel_runs<float>() {
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
           __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq");
}

template <>
bool norm_kernel_runs<BrainFloat>() {
    return norm_kernel_runs<float>() && __builtin_cpu_supports("avx512bf16");
}

template <typename Number>
void add_channel_sums(const Number* x, int64_t pixels, int64_t channels, const float* shift,
                      double* sum, double* square) {
    for (int64_t first = 0; first < pixels; first += float_pixels) {
        const int64_t last = std::min(pixels, first + float_pixels);
        for (int64_t c = 0; c < channels; c += lanes) {
            const __m512 middle = load(shift + c);
            __m512 sums = _mm512_setzero_ps(), squares = _mm512_setzero_ps();
            for (int64_t i = first; i < last; ++i) {
                const __m512 value = load(x + i * channels + c) - middle;
                sums += value;
                squares = _mm512_fmadd_ps(value, value, squares);
            }
            add_to(sum + c, sums);
            add_to(square + c, squares);
        }
    }
}

template <typename Number>
void apply_norm(const Number* x, int64_t pixels, int64_t channels, const float* scale,
                const float* offset, bool silu, Number* y) {
    for (int64_t i = 0; i < pixels * channels; i += channels) {
        for (int64_t c = 0; c < channels; c += lanes) {
            const __m512 value =
                _mm512_fmadd_ps(load(scale + c), load(x + i + c), load(offset + c));
            store(y + i + c, silu ? silu_of(value) : value);
        }
    }
}

template <typename Number>
void add_gradient_sums(const Number* x, const Number* dy, int64_t pixels, int64_t channels,
                       const float* scale, const float* offset, const float* shift, bool silu,
                       double* sum, double* product) {
    for (int64_t first = 0; first < pixels; first += float_pixels) {
        const int64_t last = std::min(pixels, first + float_pixels);
        for (int64_t c = 0; c < channels; c += lanes) {
            const __m512 a = load(scale + c), b = load(offset + c), middle = load(shift + c);
            __m512 sums = _mm512_setzero_ps(), products = _mm512_setzero_ps();
            for (int64_t i = first * channels + c; i < last * channels; i += channels) {
                const __m512 gradient = inner_gradient(x + i, dy + i, a, b, silu);
                sums += gradient;
                products = _mm512_fmadd_ps(gradient, load(x + i) - middle, products);
            }
            add_to(sum + c, sums);
            add_to(product + c, products);
        }
    }
}

template <typename Number>
void apply_norm_gradient(const Number* x, const Number* dy, int64_t pixels, int64_t channels,
                         const float* scale, const float* offset, const float* constant,
                         const float* slope, bool silu, Number* dx) {
    for (int64_t i = 0; i < pixels * channels; i += channels) {
        for (int64_t c = 0; c < channels; c += lanes) {
            const __m512 a = load(scale + c);
            const __m512 gradient =
                inner_gradient(x + i + c, dy + i + c, a, load(offset + c), silu);
            const __m512 common =
                _mm512_fmadd_ps(load(slope + c), load(x + i + c), load(constant + c));
            store(dx + i + c, _mm512_fmadd_ps(a, gradient, common));
        }
    }
}

#else

template <>
bool norm_kernel_runs<float>() {
    return false;
}

template <>
bool norm_kernel_runs<BrainFloat>() {
    return false;
}

template <typename Number>
void add_channel_sums(const Number*, std::int64_t, std::int64_t, const float*, double*, double*) {}

template <typename Number>
void apply_norm(const Number*, std::int64_t, std::int64_t, const float*, const float*, bool,
                Number*) {}

template <typename Number>
void add_gradient_sums(const Number*, const Number*, std::int64_t, std::int64_t, const float*,
                       const float*, const float*, bool, double*, double*) {}

template <typename Number>
void apply_norm_gradient(const Number*, const Number*, std::int64_t, std::int64_t, const float*,
                         const float*, const float*, const float*, bool, Number*) {}

#endif

#define ITEM3D_INSTANTIATE(Number)                                                              \
    template void add_channel_sums(const Number*, std::int64_t, std::int64_t, const float*,     \
                                   double*, double*);                                           \
    template void apply_norm(const Number*, std::int64_t, std::int64_t, const float*,           \
                             const float*, bool, Number*);                                      \
    template void add_gradient_sums(const Number*, const Number*, std::int64_t, std::int64_t,   \
                                    const float*, const float*, const float*, bool, double*,    \
                                    double*);                                                   \
    template void apply_norm_gradient(const Number*, const Number*, std::int64_t, std::int64_t, \
                                      const float*, const float*, const float*, const float*,   \
                                      bool, Number*);
ITEM3D_INSTANTIATE(float)
ITEM3D_INSTANTIATE(BrainFloat)
#undef ITEM3D_INSTANTIATE

}  // namespace item3d
