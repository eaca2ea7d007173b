#include "item3d/kernels/cpu/dispatch.h"

#if defined(__x86_64__)
#include <sys/syscall.h>
#include <unistd.h>
#endif

namespace item3d {

#if defined(__x86_64__)

template <>
Instructions instructions_for<float>() {
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
        __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq"))
        return Instructions::avx512;
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
        __builtin_cpu_supports("f16c"))
        return Instructions::avx2;
    return Instructions::none;
}

template <>
Instructions instructions_for<BrainFloat>() {
    return instructions_for<float>() == Instructions::avx512 && __builtin_cpu_supports("avx512bf16")
               ? Instructions::avx512
               : Instructions::none;
}

bool matrix_units_run() {
    static const bool runs = [] {
        const bool there = instructions_for<BrainFloat>() == Instructions::avx512 &&
                           __builtin_cpu_supports("amx-tile") && __builtin_cpu_supports("amx-bf16");
        // Linux saves the tiles of programs that ask for them: ARCH_REQ_XCOMP_PERM, XTILEDATA.
        return there && ::syscall(SYS_arch_prctl, 0x1023, 18) == 0;
    }();
    return runs;
}

#else

template <>
Instructions instructions_for<float>() {
    return Instructions::none;
}

template <>
Instructions instructions_for<BrainFloat>() {
    return Instructions::none;
}

bool matrix_units_run() {
    return false;
}

#endif

}  // namespace item3d
