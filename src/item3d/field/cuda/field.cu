// The kernels of the neural texture and their table.
#include "item3d/field/cuda/table.h"
#include "item3d/render/cuda/launch.h"

namespace item3d::cuda {
namespace {

/// Calls the launch that is compiled for the grid's number of features.
int by_width(const HashGridParameters& p, std::int64_t count, Stream stream,
             Kernel<HashGridParameters> one, Kernel<HashGridParameters> two,
             Kernel<HashGridParameters> four, Kernel<HashGridParameters> eight) {
    switch (p.entry_width) {
        case 1:
            return one(p, count, stream);
        case 2:
            return two(p, count, stream);
        case 4:
            return four(p, count, stream);
        case 8:
            return eight(p, count, stream);
        default:
            return cudaErrorInvalidValue;
    }
}

/// Expands a line of ITEM3D_HASH_GRID_KERNELS to one launch for each number of features, and a
/// launch that selects among them by the grid's number. The line of hash_grid becomes
///   template <int F>
///   int hash_grid_of(const HashGridParameters& p, std::int64_t count, Stream stream) {...}
///   int hash_grid(const HashGridParameters& p, std::int64_t count, Stream stream) {
///       return by_width(p, count, stream, hash_grid_of<1>, hash_grid_of<2>, hash_grid_of<4>,
///                       hash_grid_of<8>);
///   }
#define HASH_GRID_DEFINITION(entry, Parameters, body, name)                            \
    template <int F>                                                                   \
    ITEM3D_KERNEL_DEFINITION(entry##_of, Parameters, body, name)                       \
    int entry(const Parameters& p, std::int64_t count, Stream stream) {                \
        return by_width(p, count, stream, entry##_of<1>, entry##_of<2>, entry##_of<4>, \
                        entry##_of<8>);                                                \
    }

ITEM3D_HASH_GRID_KERNELS(HASH_GRID_DEFINITION)
ITEM3D_PLAIN_KERNELS(ITEM3D_KERNEL_DEFINITION)

constexpr FieldTable table{.header = {table_version, sizeof(FieldTable)},
                           ITEM3D_FIELD_KERNELS(ITEM3D_KERNEL_INITIALIZER)};

}  // namespace
}  // namespace item3d::cuda

extern "C" __attribute__((visibility("default"))) const item3d::cuda::FieldTable*
item3d_cuda_field() {
    return &item3d::cuda::table;
}
