#include "item3d/edit/memory.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/networks/verify.h"
#include "item3d/tensors/precision.h"

#include <algorithm>
#include <fstream>

namespace item3d {
namespace {

constexpr double gigabyte = 1e9;

/// Bytes that processes may still take; no limit where the system does not say.
double free_memory() {
    std::ifstream file("/proc/meminfo");
    std::string key, unit;
    double kilobytes = 0;
    while (file >> key >> kilobytes && std::getline(file, unit))
        if (key == "MemAvailable:") return 1024 * kilobytes;
    return 1e18;
}

struct Need {
    double weights = 0, high = 0, low = 0;  ///< bytes
};

Need estimate(const EditRequest& request, at::ScalarType precision) {
    const PriorReport report = verify_prior(request.prior);
    if (!report.usable()) return {};  // loading it will say why
    const double side = static_cast<double>(request.settings.resolution) / report.resolution;
    const double pictures = request.settings.batch * side * side;
    for (const MemoryReport& memory : report.memory) {
        if (memory.precision != precision_name(precision)) continue;
        const auto all = static_cast<double>(memory.weights);
        const auto text = static_cast<double>(memory.text_encoders);
        // Sentences that are not known yet, and LoRA files, want all networks at once.
        const bool at_once = wants_captions(request.settings) || !request.settings.lora.empty();
        const double weights = at_once ? all : std::max(all - text, text);
        const double base = weights + static_cast<double>(memory.program);
        return {weights, base + pictures * static_cast<double>(memory.kept_by_gradients),
                base + pictures * static_cast<double>(memory.kept_when_low)};
    }
    ITEM3D_CHECK(false, "a precision without an estimate");
}

}  // namespace

bool wants_low_memory(const EditRequest& request, at::ScalarType precision, at::Device device) {
    if (request.memory != "auto" && request.memory != "low" && request.memory != "high")
        throw InputError("--memory", "'" + request.memory + "' is not known",
                         "choose auto, low or high");
    // A device's own memory is not looked at: LibTorch's message names what it lacked.
    if (!device.is_cpu()) return request.memory == "low";
    const Need need = estimate(request, precision);
    const double free = free_memory();
    if (need.weights > free)
        throw ResourceError(fmt::format(
            "{}: its weights take {:.1f} GB in {}, and {:.1f} GB of memory are free; close other "
            "programs{}",
            request.prior.string(), need.weights / gigabyte, precision_name(precision),
            free / gigabyte, precision == at::kFloat ? ", or try --precision bf16" : ""));
    const bool low = request.memory == "low" || (request.memory == "auto" && need.high > free);
    const double wanted = low ? need.low : need.high;
    if (wanted > free)
        warn(
            fmt::format("this edit may need {:.1f} GB, and {:.1f} GB of memory are free: {}a "
                        "smaller --resolution or --batch needs less",
                        wanted / gigabyte, free / gigabyte, low ? "" : "--memory low or "));
    else if (low && request.memory == "auto")
        note(
            fmt::format("about {:.1f} GB would not fit into the {:.1f} GB that are free: --memory "
                        "low, which takes longer",
                        need.high / gigabyte, free / gigabyte));
    return low;
}

}  // namespace item3d
