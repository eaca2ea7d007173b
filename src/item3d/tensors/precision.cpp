#include "item3d/tensors/precision.h"

#include "item3d/core/error.h"

namespace item3d {

const std::vector<std::string>& precision_names() {
    static const std::vector<std::string> names{"auto", "fp32", "bf16", "fp16"};
    return names;
}

at::ScalarType choose_precision(const std::string& name, at::Device device) {
    if (name == "fp32") return at::kFloat;
    if (name == "bf16") return at::kBFloat16;
    if (name == "auto") {
#if defined(__x86_64__)
        const bool fast_bf16 = device.is_cuda() || __builtin_cpu_supports("avx512bf16");
#else
        const bool fast_bf16 = device.is_cuda();
#endif
        return fast_bf16 ? at::kBFloat16 : at::kFloat;
    }
    if (name == "fp16") {
        if (device.is_cuda()) return at::kHalf;
        throw InputError("--precision", "fp16 is for CUDA devices",
                         "choose auto, fp32 or bf16 on the CPU");
    }
    throw InputError("--precision", "'" + name + "' is not known",
                     "choose auto, fp32, bf16 or fp16");
}

std::string precision_name(at::ScalarType dtype) {
    switch (dtype) {
        case at::kHalf:
            return "fp16";
        case at::kBFloat16:
            return "bf16";
        default:
            return "fp32";
    }
}

}  // namespace item3d
