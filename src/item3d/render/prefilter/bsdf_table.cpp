// The numbers of the BSDF table are computed at build time by tools/write_bsdf_table.cpp, which
// integrates kernels/bsdf.h. Computing them at run time would take half a second at each start of a
// command (docs/journal/benchmarks.md).
#include "item3d/render/prefilter/bsdf_table.h"

#include "item3d/render/kernels/bsdf.h"

namespace item3d {
namespace {

constexpr float table_values[] = {
#include "bsdf_table_values.inc"
};
static_assert(std::size(table_values) == 2 * kernels::bsdf_table_size * kernels::bsdf_table_size);

}  // namespace

const at::Tensor& bsdf_table() {
    static const at::Tensor table =
        at::from_blob(const_cast<float*>(table_values),
                      {kernels::bsdf_table_size, kernels::bsdf_table_size, 2}, at::kFloat)
            .clone();
    return table;
}

}  // namespace item3d
