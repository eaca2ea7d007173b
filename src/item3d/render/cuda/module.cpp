#include "item3d/render/cuda/module.h"

#include "item3d/core/error.h"
#include "item3d/core/module.h"

#include <ATen/Context.h>
#include <c10/core/impl/VirtualGuardImpl.h>
#include <c10/util/StringUtil.h>
#include <dlfcn.h>
#include <torch/cuda.h>

namespace item3d::cuda {
namespace {

constexpr const char* file_name = "libitem3d_cuda.so";

[[noreturn]] void cannot_use(const std::string& reason) {
    throw ResourceError(c10::str("cannot compute on CUDA: ", reason, "; use --device cpu"));
}

/// Returns the CUDA stream. LibTorch before 2.12 exposes it only through libtorch_cuda's own
/// headers. With such a LibTorch, only the default stream is accepted, which is the one that this
/// program uses.
template <typename S>
Stream native_handle(const S& stream) {
    if constexpr (requires { stream.native_handle(); }) {
        return stream.native_handle();
    } else {
        if (stream.id() != 0) cannot_use("this LibTorch only supports the default stream");
        return nullptr;
    }
}

Stream current_stream(at::Device device) {
    return native_handle(c10::impl::VirtualGuardImpl(device.type()).getStream(device));
}

}  // namespace

bool cuda_available() {
    static const bool available = [] {
        // Checks for a driver first. Without a driver, loading a gigabyte of LibTorch would be
        // useless.
        if (dlopen("libcuda.so.1", RTLD_NOW | RTLD_GLOBAL) == nullptr) return false;
        if (dlopen("libtorch_cuda.so", RTLD_NOW | RTLD_GLOBAL) == nullptr) return false;
        return torch::cuda::is_available();
    }();
    return available;
}

bool deterministic_sums() {
    return at::globalContext().deterministicAlgorithms();
}

const TableHeader* find_table(const char* symbol, std::uint32_t size) {
    static const Module module = open_module(file_name, "make cuda");
    if (module.handle == nullptr) cannot_use(module.problem);
    // POSIX guarantees that the pointer returned by dlsym can hold a function pointer.
    const auto function = reinterpret_cast<const TableHeader* (*)()>(dlsym(module.handle, symbol));
    if (function == nullptr) cannot_use(c10::str(file_name, " has no ", symbol));
    const TableHeader* table = function();
    if (table->version != table_version || table->size != size)
        cannot_use(c10::str(file_name, " belongs to another version of item3d"));
    return table;
}

const RenderTable& render_table() {
    // The header is the table's first member, so both have the same address.
    static const auto* const table =
        reinterpret_cast<const RenderTable*>(find_table("item3d_cuda_render", sizeof(RenderTable)));
    return *table;
}

Launch::Launch(at::Device device) : guard_(device), stream_(current_stream(device)) {}

void Launch::check(int error) const {
    if (error != 0) cannot_use(render_table().error_text(error));
}

}  // namespace item3d::cuda
