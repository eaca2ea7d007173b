#include "item3d/tensors/tensor_memory.h"

#include <c10/core/Allocator.h>
#include <c10/core/CPUAllocator.h>
#include <c10/core/impl/alloc_cpu.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <map>
#include <mutex>

namespace item3d {
namespace {

constexpr std::size_t page = 4096, region_page = 2 << 20;
constexpr std::size_t large_tensor = 128 << 10;
/// Bytes of free pages that the region keeps for reuse.
constexpr std::size_t kept = 512 << 20;

std::size_t round_up(std::size_t bytes, std::size_t step) {
    return (bytes + step - 1) / step * step;
}

/// A region with first-fit allocation from the lowest addresses, which keeps used blocks together.
class Region {
  public:
    Region() {
        const auto pages = ::sysconf(_SC_PHYS_PAGES), bytes = ::sysconf(_SC_PAGESIZE);
        if (pages <= 0 || bytes <= 0) return;
        const std::size_t size = round_up(
            static_cast<std::size_t>(pages) * static_cast<std::size_t>(bytes), region_page);
        void* address = ::mmap(nullptr, size + region_page, PROT_READ | PROT_WRITE,
                               MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
        if (address == MAP_FAILED) return;
        begin_ = round_up(reinterpret_cast<std::uintptr_t>(address), region_page);
        end_ = begin_ + size;
        ::madvise(reinterpret_cast<void*>(begin_), size, MADV_HUGEPAGE);
        free_[begin_] = size;
    }

    /// Returns null if no hole is large enough.
    void* take(std::size_t bytes) {
        const std::size_t size = round_up(bytes, page);
        const std::lock_guard lock(mutex_);
        for (auto hole = free_.begin(); hole != free_.end(); ++hole) {
            if (hole->second < size) continue;
            const std::uintptr_t place = hole->first;
            const std::size_t rest = hole->second - size;
            free_.erase(hole);
            if (rest > 0) free_[place + size] = rest;
            used_[place] = size;
            touched_ = std::max(touched_, place + size);
            return reinterpret_cast<void*>(place);
        }
        return nullptr;
    }

    bool holds(void* address) const {
        const auto place = reinterpret_cast<std::uintptr_t>(address);
        return place >= begin_ && place < end_;
    }

    void give_back(void* address) {
        const std::lock_guard lock(mutex_);
        const auto block = used_.find(reinterpret_cast<std::uintptr_t>(address));
        auto hole = free_.emplace(*block).first;
        used_.erase(block);
        if (const auto next = std::next(hole);
            next != free_.end() && hole->first + hole->second == next->first) {
            hole->second += next->second;
            free_.erase(next);
        }
        if (hole != free_.begin()) {
            const auto before = std::prev(hole);
            if (before->first + before->second == hole->first) {
                before->second += hole->second;
                free_.erase(hole);
                hole = before;
            }
        }
        // Returns excess memory at the end of the touched range to the system.
        const std::uintptr_t first = round_up(hole->first + kept, region_page);
        if (hole->first + hole->second == end_ && first < touched_) {
            ::madvise(reinterpret_cast<void*>(first), touched_ - first, MADV_DONTNEED);
            touched_ = first;
        }
    }

  private:
    std::mutex mutex_;
    std::uintptr_t begin_ = 0, end_ = 0, touched_ = 0;
    std::map<std::uintptr_t, std::size_t> free_, used_;
};

/// Returns the region, which is never destroyed, because tensors may outlive everything else.
Region& region() {
    static Region& only = *new Region;
    return only;
}

void release(void* address) {
    if (region().holds(address))
        region().give_back(address);
    else
        c10::free_cpu(address);
}

class TensorAllocator final : public c10::Allocator {
  public:
    c10::DataPtr allocate(std::size_t bytes) override {
        void* address = bytes >= large_tensor ? region().take(bytes) : nullptr;
        if (!address) address = c10::alloc_cpu(bytes);
        return {address, address, &release, c10::Device(c10::DeviceType::CPU)};
    }
    c10::DeleterFnPtr raw_deleter() const override { return &release; }
    void copy_data(void* to, const void* from, std::size_t bytes) const override {
        std::memcpy(to, from, bytes);
    }
};

}  // namespace

void give_large_tensors_a_region() {
    static TensorAllocator allocator;
    c10::SetCPUAllocator(&allocator);
}

}  // namespace item3d
