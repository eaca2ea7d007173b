#include "item3d/kernels/cpu/dispatch.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string_view>

#if defined(ITEM3D_HAS_VECTOR_KERNELS)
#include <sys/syscall.h>
#include <unistd.h>
#endif

namespace item3d {

#if defined(ITEM3D_HAS_VECTOR_KERNELS)
namespace {

constexpr std::array<std::string_view, 5> levels{"none", "avx2", "avx512", "bf16", "amx"};

/// True if kernels of this level may run. If ITEM3D_CPU names a level, it is the highest allowed
/// level.
bool is_allowed(std::string_view level) {
    static const auto highest = [] {
        const char* wanted = std::getenv("ITEM3D_CPU");
        const auto found = std::find(levels.begin(), levels.end(), wanted ? wanted : "amx");
        return found == levels.end() ? levels.end() - 1 : found;
    }();
    return std::find(levels.begin(), levels.end(), level) <= highest;
}

}  // namespace

template <>
InstructionSet instruction_set_for<float>() {
    if (is_allowed("avx512") && __builtin_cpu_supports("avx512f") &&
        __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl") &&
        __builtin_cpu_supports("avx512dq"))
        return InstructionSet::avx512;
    if (is_allowed("avx2") && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
        __builtin_cpu_supports("f16c"))
        return InstructionSet::avx2;
    return InstructionSet::none;
}

template <>
InstructionSet instruction_set_for<BFloat16>() {
    return is_allowed("bf16") && instruction_set_for<float>() == InstructionSet::avx512 &&
                   __builtin_cpu_supports("avx512bf16")
               ? InstructionSet::avx512
               : InstructionSet::none;
}

bool amx_available() {
    static const bool runs = [] {
        const bool there = is_allowed("amx") &&
                           instruction_set_for<BFloat16>() == InstructionSet::avx512 &&
                           __builtin_cpu_supports("amx-tile") && __builtin_cpu_supports("amx-bf16");
        // Linux saves the tiles only of programs that request it, with ARCH_REQ_XCOMP_PERM and
        // XTILEDATA.
        return there && ::syscall(SYS_arch_prctl, 0x1023, 18) == 0;
    }();
    return runs;
}

#else

template <>
InstructionSet instruction_set_for<float>() {
    return InstructionSet::none;
}

template <>
InstructionSet instruction_set_for<BFloat16>() {
    return InstructionSet::none;
}

bool amx_available() {
    return false;
}

#endif

}  // namespace item3d
