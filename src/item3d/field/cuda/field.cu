// Kernels of the neural texture and their table.
#include "item3d/field/cuda/table.h"
#include "item3d/render/cuda/launch.h"

namespace item3d::cuda {
namespace {

template <int F>
int launch_forward(const HashGridParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "hash_grid_encode", count,
        [=] __device__(std::int64_t i) { item3d::hash_grid_forward<F>(p, i); }, stream);
}

template <int F>
int launch_points_backward(const HashGridParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "hash_grid_points_backward", count,
        [=] __device__(std::int64_t i) { item3d::hash_grid_points_backward<F>(p, i); }, stream);
}

template <int F>
int launch_table_backward(const HashGridParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "hash_grid_table_backward", count,
        [=] __device__(std::int64_t i) { item3d::hash_grid_table_backward<F>(p, i); }, stream);
}

/// The one of four launches that is for the grid's number of features.
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

int hash_grid(const HashGridParameters& p, std::int64_t count, Stream stream) {
    return by_width(p, count, stream, launch_forward<1>, launch_forward<2>, launch_forward<4>,
                    launch_forward<8>);
}

int hash_grid_points_backward(const HashGridParameters& p, std::int64_t count, Stream stream) {
    return by_width(p, count, stream, launch_points_backward<1>, launch_points_backward<2>,
                    launch_points_backward<4>, launch_points_backward<8>);
}

int hash_grid_table_backward(const HashGridParameters& p, std::int64_t count, Stream stream) {
    return by_width(p, count, stream, launch_table_backward<1>, launch_table_backward<2>,
                    launch_table_backward<4>, launch_table_backward<8>);
}

int adam_step(const AdamParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "adam_step", count, [=] __device__(std::int64_t i) { adam_step_row(p, i); }, stream);
}

constexpr FieldTable table{{table_version, sizeof(FieldTable)},
                           hash_grid,
                           hash_grid_points_backward,
                           hash_grid_table_backward,
                           adam_step};

}  // namespace
}  // namespace item3d::cuda

extern "C" __attribute__((visibility("default"))) const item3d::cuda::FieldTable*
item3d_cuda_field() {
    return &item3d::cuda::table;
}
