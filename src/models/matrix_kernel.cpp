#include "item3d/models/matrix_kernel.h"

namespace item3d {

#if defined(__AVX512F__) && defined(__AVX512BW__) && defined(__AVX512VL__) && \
    defined(__AVX512BF16__)

template <>
bool matrix_kernel_runs<float>() {
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
           __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq");
}

template <>
bool matrix_kernel_runs<BrainFloat>() {
    return matrix_kernel_runs<float>() && __builtin_cpu_supports("avx512bf16") &&
           !__builtin_cpu_supports("amx-bf16");
}

#else

template <>
bool matrix_kernel_runs<float>() {
    return false;
}

template <>
bool matrix_kernel_runs<BrainFloat>() {
    return false;
}

#endif

}  // namespace item3d
