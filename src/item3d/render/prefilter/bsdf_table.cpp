#include "item3d/render/kernels/bsdf_table_size.h"
#include "item3d/render/prefilter/environment_light.h"

namespace item3d {
namespace {

constexpr float table_values[] = {
#include "bsdf_table_values.inc"
};
static_assert(std::size(table_values) == 2 * bsdf_table_size * bsdf_table_size);

}  // namespace

const torch::Tensor& bsdf_table() {
    static const torch::Tensor table =
        torch::from_blob(const_cast<float*>(table_values), {bsdf_table_size, bsdf_table_size, 2},
                         torch::kFloat32)
            .clone();
    return table;
}

}  // namespace item3d
