#include "item3d/models/matrix_kernel.h"

#if defined(__AMX_BF16__)
#include <sys/syscall.h>
#include <unistd.h>
#endif

namespace item3d {

#if defined(__AVX512F__) && defined(__AVX512BW__) && defined(__AVX512VL__) && \
    defined(__AVX512BF16__) && defined(__AMX_BF16__)

template <>
bool matrix_kernel_runs<float>() {
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
           __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq");
}

template <>
bool matrix_kernel_runs<BrainFloat>() {
    return matrix_kernel_runs<float>() && __builtin_cpu_supports("avx512bf16") &&
           !matrix_units_run();
}

bool matrix_units_run() {
    static const bool runs = [] {
        const bool there = matrix_kernel_runs<float>() && __builtin_cpu_supports("avx512bf16") &&
                           __builtin_cpu_supports("amx-tile") && __builtin_cpu_supports("amx-bf16");
        // Linux saves the tiles of programs that ask for them: ARCH_REQ_XCOMP_PERM, XTILEDATA.
        return there && ::syscall(SYS_arch_prctl, 0x1023, 18) == 0;
    }();
    return runs;
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

bool matrix_units_run() {
    return false;
}

#endif

}  // namespace item3d
