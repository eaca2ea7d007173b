// Prefiltering on LibTorch's devices: the CPU, or CUDA.
#pragma once

#include "item3d/render/prefilter/backend.h"
#include "item3d/tensors/tensor.h"

namespace item3d {

/// Backend that allocates, sums and sorts by LibTorch on `device`. Only upload() waits until the
/// device is done.
class TensorBackend : public PrefilterBackend {
  public:
    explicit TensorBackend(at::Device device) : device_(device) {}

    bool on_device() const override { return device_.is_cuda(); }
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
    at::Device device_;
};

}  // namespace item3d
