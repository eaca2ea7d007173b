// Checks of tensors' values: NaN, indices without a vertex, triangles that do not exist.
#pragma once

#include "python/src/operation.h"

#include <functional>

namespace item3d::python {

/// Pass of automatic differentiation that an operator belongs to.
enum class Pass { forward, backward };

/// The checks of one call. On the CPU, a check throws std::runtime_error like Operation::fail().
/// On a device, a check starts a search for invalid values; finish() waits for all searches and
/// throws. On a device, the backward pass checks nothing, because the forward pass has checked the
/// same tensors.
class ValueChecks {
  public:
    ValueChecks(const Operation& call, Pass pass) : call_(call), pass_(pass) {}

    /// Checks that no value of a float32 tensor is NaN or infinite. describe: returns the message
    /// for the index of the first such value; by default, the message has only the name.
    using Describe = std::function<std::string(std::int64_t index)>;
    void finite(const char* name, const Tensor& tensor, const Describe& describe = {});
    /// Checks that all indices of triangles [T, 3] are in [0, vertices).
    void indices(const Tensor& triangles, std::int64_t vertices);
    /// Checks that a raster [N, H, W, 4] contains no triangle beyond the first `triangles`.
    void raster(const Tensor& raster, std::int64_t triangles);
    /// Checks that all values of a topology [T, 3] are in [-1, 3 T).
    void neighbours(const Tensor& neighbours);

    /// Must be called after the last check, before other kernels read the tensors.
    void finish();

  private:
    static constexpr std::int64_t max_searches = 8;
    using Entry = Operation::Entry<kernels::SearchParameters>;

    bool skips() const { return call_.on_device() && pass_ == Pass::backward; }
    void search(Entry entry, kernels::SearchParameters p, std::int64_t count,
                const Describe& describe);

    const Operation& call_;
    Pass pass_;
    Tensor found_;                    ///< [max_searches] on the device, see SearchParameters::found
    std::vector<Describe> searches_;  ///< for each search, its message
};

}  // namespace item3d::python
