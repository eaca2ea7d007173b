#include "item3d/tensors/sparse_rows.h"

namespace item3d {
namespace {

/// True if the rows are known to be in rising order. Always false for tensors on a GPU: their order
/// is not checked, and they are sorted again.
bool rows_rise(const at::Tensor& indices) {
    if (!indices.is_cpu() || indices.size(0) != 1 || !indices.is_contiguous()) return false;
    const std::int64_t* index = indices.const_data_ptr<std::int64_t>();
    for (std::int64_t i = 1; i < indices.size(1); ++i)
        if (index[i] <= index[i - 1]) return false;
    return true;
}

}  // namespace

at::Tensor coalesce_rows(const at::Tensor& gradient) {
    if (gradient.is_coalesced() || !rows_rise(gradient._indices())) return gradient.coalesce();
    return at::_sparse_coo_tensor_unsafe(gradient._indices(), gradient._values(), gradient.sizes(),
                                         gradient.options(), true);
}

}  // namespace item3d
