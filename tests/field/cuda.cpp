// Tests of the neural texture's operations on the CPU and on a CUDA device; the comparisons are
// skipped without a device.
#include "item3d/core/progress.h"
#include "item3d/field/adam.h"
#include "item3d/field/bake/bake.h"
#include "item3d/field/cuda/module.h"
#include "item3d/field/fit.h"
#include "item3d/field/hash_grid.h"
#include "item3d/tensors/tensor.h"
#include "tests/support/field_models.h"

#include <gtest/gtest.h>

namespace item3d {
namespace {

/// Must be queried first: LibTorch looks for devices only once.
const bool has_device = cuda::cuda_available();

#define SKIP_WITHOUT_DEVICE() \
    if (!has_device)          \
    GTEST_SKIP() << "no CUDA device, or no libtorch_cuda.so: nothing to compare the CPU with"

double relative_error(const at::Tensor& found, const at::Tensor& expected) {
    const at::Tensor difference = (found.cpu() - expected.cpu()).abs().max();
    return difference.item<double>() / std::max(1e-12, expected.abs().max().item<double>());
}

TEST(CudaFieldModule, TableIsComplete) {
#if !defined(ITEM3D_CUDA_MODULE)
    GTEST_SKIP() << "built with ITEM3D_CUDA=OFF";
#else
    const cuda::FieldTable& table = cuda::field_table();
    EXPECT_EQ(table.header.version, cuda::table_version);
    ASSERT_EQ(table.header.size, sizeof(cuda::FieldTable));
#define EXPECT_ENTRY(entry, ...) EXPECT_NE(table.entry, nullptr);
    ITEM3D_FIELD_KERNELS(EXPECT_ENTRY)
#undef EXPECT_ENTRY
#endif
}

/// Runs the functions that a device runs on the CPU, one index after another, and compares them
/// with encode().
TEST(CudaFieldKernels, GiveTheCpusFeaturesAndGradients) {
    const HashGrid grid = HashGrid::make(6, 2, 9, 4, 64);
    at::manual_seed(1);
    const std::int64_t count = 300;
    const at::Tensor points = at::rand({count, 3}).set_requires_grad(true);
    const at::Tensor table = at::randn({grid.entries(), 2}).set_requires_grad(true);
    const at::Tensor weights = at::randn({count, grid.output_width()});
    const at::Tensor expected = encode(grid, points, table);
    (expected * weights).sum().backward();

    at::Tensor features = at::empty_like(expected), by_points = at::empty_like(points);
    at::Tensor by_table = at::zeros_like(table);
    std::vector<std::uint8_t> touched(static_cast<std::size_t>(grid.entries()), 0);
    HashGridParameters p{};
    std::copy(grid.levels.begin(), grid.levels.end(), p.levels);
    p.level_count = 6;
    p.entry_width = 2;
    p.count = count;
    p.points = points.const_data_ptr<float>();
    p.table = table.const_data_ptr<float>();
    p.features = features.data_ptr<float>();
    p.feature_gradient = weights.const_data_ptr<float>();
    p.point_gradient = by_points.data_ptr<float>();
    p.table_gradient.values = by_table.data_ptr<float>();
    p.touched = touched.data();
    for (std::int64_t i = 0; i < 6 * count; ++i) {
        hash_grid_forward<2>(p, i);
        hash_grid_table_backward<2>(p, i);
    }
    for (std::int64_t i = 0; i < count; ++i)
        hash_grid_points_backward<2>(p, i);
    EXPECT_TRUE(at::equal(features, expected));
    EXPECT_TRUE(at::equal(by_points, points.grad()));
    EXPECT_TRUE(at::equal(by_table, table.grad().to_dense()));
    const at::Tensor marked =
        at::from_blob(touched.data(), {grid.entries()}, at::kByte).nonzero().squeeze(1);
    EXPECT_TRUE(at::equal(marked, table.grad()._indices().select(0, 0)));
}

TEST(CudaFieldDevice, HashGridIsTheCpus) {
    SKIP_WITHOUT_DEVICE();
    for (const int features : {1, 2, 4, 8}) {
        const HashGrid grid = HashGrid::make(8, features, 12, 4, 256);
        at::manual_seed(1);
        const at::Tensor points = at::rand({2000, 3});
        const at::Tensor table = at::randn({grid.entries(), features});
        const at::Tensor weights = at::randn({2000, grid.output_width()});
        std::vector<at::Tensor> out, by_points, by_table;
        for (const at::Device device : {at::Device(at::kCPU), at::Device(at::kCUDA, 0)}) {
            const at::Tensor p = points.to(device).detach().clone().set_requires_grad(true);
            const at::Tensor t = table.to(device).detach().clone().set_requires_grad(true);
            const at::Tensor values = encode(grid, p, t);
            (values * weights.to(device)).sum().backward();
            out.push_back(values.detach());
            by_points.push_back(p.grad());
            by_table.push_back(t.grad());
        }
        EXPECT_LT(relative_error(out[1], out[0]), 1e-4);
        EXPECT_LT(relative_error(by_points[1], by_points[0]), 1e-3);
        EXPECT_TRUE(at::equal(by_table[1]._indices().cpu(), by_table[0]._indices()));
        EXPECT_LT(relative_error(by_table[1]._values(), by_table[0]._values()), 1e-3);
    }
}

TEST(CudaFieldDevice, AdamIsTheCpus) {
    SKIP_WITHOUT_DEVICE();
    std::vector<at::Tensor> results;
    for (const at::Device device : {at::Device(at::kCPU), at::Device(at::kCUDA, 0)}) {
        at::manual_seed(4);
        const at::Tensor dense = at::randn({20, 5}).to(device).set_requires_grad(true);
        const at::Tensor sparse = at::randn({50, 2}).to(device).set_requires_grad(true);
        Adam adam;
        adam.add_group("both", {dense, sparse}, {});
        for (int step = 0; step < 5; ++step) {
            dense.mutable_grad() = at::randn({20, 5}).to(device);
            const at::Tensor rows =
                at::tensor({step, step + 7, step + 30}, at::kLong).view({1, 3}).to(at::kLong);
            sparse.mutable_grad() =
                at::sparse_coo_tensor(rows, at::randn({3, 2}), {50, 2}).coalesce().to(device);
            adam.step();
        }
        results.push_back(at::cat({dense.detach().flatten(), sparse.detach().flatten()}));
    }
    EXPECT_LT(relative_error(results[1], results[0]), 1e-4);
}

/// A field that is fitted on either device has the source's colours. Baking an unchanged field
/// returns the source bit by bit.
TEST(CudaFieldDevice, FitsAndBakesAsTheCpu) {
    SKIP_WITHOUT_DEVICE();
    set_verbosity(Verbosity::quiet);
    const Model model = testing::make_model(testing::make_sphere());
    std::vector<double> quality;
    for (const at::Device device : {at::Device(at::kCPU), at::Device(at::kCUDA, 0)}) {
        const Geometry geometry = Geometry::from_model(model, device);
        const TexturedMaterials materials(model, device);
        const FieldSpace space(model, {0}, device);
        const Atlas atlas = make_atlas(model, space, {0}, 64);
        NeuralTexture field(suggest_field_options(geometry, space, 64));
        field->to(device);
        FitOptions fit;
        fit.steps = 40;
        fit.batch = 1024;
        fit.show_progress = false;
        quality.push_back(fit_to_materials(field, geometry, space, materials, fit).base_color_psnr);
        NeuralTexture before = snapshot(field);
        EXPECT_EQ(before->table().device(), device);
        BakeOptions bake_options;
        bake_options.show_progress = false;
        const ModelEdit edit =
            bake({model, geometry, materials, space, atlas}, before, field, bake_options);
        const int texture = model.materials[0].base_color_texture;
        EXPECT_EQ(edit.materials.at(0).base_color->pixels,
                  model.textures[static_cast<std::size_t>(texture)].image.pixels);
    }
    EXPECT_NEAR(quality[1], quality[0], 1.0);
}

}  // namespace
}  // namespace item3d
