// Prefiltering on the CPU without LibTorch, for the Python package.
#pragma once

#include "item3d/render/prefilter/backend.h"

namespace item3d {

/// Backend that sums in a fixed order in double precision. The results are the same bytes for any
/// number of threads.
class HostBackend : public PrefilterBackend {
  public:
    bool on_device() const override { return false; }
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
};

}  // namespace item3d
