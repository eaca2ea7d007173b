#include "item3d/tensors/weight_memory.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"

#include <sys/mman.h>

#include <cstdint>

namespace item3d {
namespace {

constexpr std::size_t huge_page = 2 << 20, alignment = 64;

}  // namespace

struct WeightMemory::Pages {
    explicit Pages(std::size_t bytes) : size(bytes + huge_page) {
        address = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        if (address == MAP_FAILED)
            throw ResourceError(fmt::format("out of memory: the weights need {:.1f} GB",
                                            static_cast<double>(bytes) / 1e9));
        const auto start = reinterpret_cast<std::uintptr_t>(address);
        // Memory before the first large page, and after the end, is never touched.
        begin = (start + huge_page - 1) / huge_page * huge_page;
        ::madvise(reinterpret_cast<void*>(begin), bytes, MADV_HUGEPAGE);
    }
    ~Pages() { ::munmap(address, size); }
    Pages(const Pages&) = delete;
    Pages& operator=(const Pages&) = delete;

    std::size_t size;
    void* address;
    std::uintptr_t begin;
};

WeightMemory::WeightMemory(std::size_t bytes) : pages_(std::make_shared<Pages>(bytes)) {}

std::size_t WeightMemory::room_for(at::IntArrayRef sizes, at::ScalarType dtype) {
    const std::size_t bytes =
        static_cast<std::size_t>(c10::multiply_integers(sizes)) * at::elementSize(dtype);
    return (bytes + alignment - 1) / alignment * alignment;
}

at::Tensor WeightMemory::empty(at::IntArrayRef sizes, at::ScalarType dtype) {
    const std::size_t room = room_for(sizes, dtype);
    ITEM3D_CHECK(used_ + room <= pages_->size - huge_page, "more weights than expected");
    auto* place = reinterpret_cast<void*>(pages_->begin + used_);
    used_ += room;
    return at::from_blob(
        place, sizes, [pages = pages_](void*) {}, at::TensorOptions().dtype(dtype));
}

at::Tensor empty_weight(at::IntArrayRef sizes, at::ScalarType dtype) {
    const std::size_t room = WeightMemory::room_for(sizes, dtype);
    constexpr std::size_t small = 64 << 10;
    if (room < small) return at::empty(sizes, at::TensorOptions().dtype(dtype));
    return WeightMemory(room).empty(sizes, dtype);
}

}  // namespace item3d
