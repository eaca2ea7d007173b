// Prefiltering on a CUDA device, for the Python package.
#pragma once

#include "item3d/render/prefilter/host_backend.h"
#include "python/src/operation.h"

namespace item3d::python {

/// Backend with the memory and the kernels of a call's device. far_tables() and brightest() compute
/// on the CPU. These and upload() wait until the device is done.
class DeviceBackend : public PrefilterBackend {
  public:
    explicit DeviceBackend(const Operation& call) : call_(call) {}

    bool on_device() const override { return true; }
    Floats allocate(std::int64_t count) const override;
    Floats upload(const std::vector<float>& values) const override;
    void fill(float* values, std::int64_t count, float value) const override;
    void copy(const float* from, std::int64_t count, float* to) const override;
    void add(const float* terms, std::int64_t count, float* to) const override;
    Floats far_tables(int size) const override;
    void sum_rows(const float* rows, std::int64_t count, std::int64_t columns, bool precise,
                  float* sums) const override;
    void brightest(const float* colors, std::int64_t texels, float share, std::int64_t count,
                   std::int64_t* indices) const override;
    void launch(const Launch& start) const override;

  private:
    /// Copies words of four bytes between two places on the device.
    void copy_words(const void* from, std::int64_t count, void* to) const;

    const Operation& call_;
};

}  // namespace item3d::python
