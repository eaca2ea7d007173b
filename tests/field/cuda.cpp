// The neural texture's operations on the CPU and on a CUDA device; the comparisons are skipped
// where there is no device.
#include "item3d/core/progress.h"
#include "item3d/field/adam.h"
#include "item3d/field/bake/bake.h"
#include "item3d/field/cuda/module.h"
#include "item3d/field/fit.h"
#include "item3d/field/hash_grid.h"
#include "support/field_models.h"

#include <gtest/gtest.h>
#include <torch/types.h>

#include <cstring>

namespace item3d {
namespace {

/// Asked before any test has LibTorch look for a device, which it does once.
const bool has_device = cuda::cuda_available();

#define SKIP_WITHOUT_DEVICE() \
    if (!has_device)          \
    GTEST_SKIP() << "no CUDA device, or no libtorch_cuda.so: nothing to compare the CPU with"

double relative_error(const torch::Tensor& found, const torch::Tensor& expected) {
    const torch::Tensor difference = (found.cpu() - expected.cpu()).abs().max();
    return difference.item<double>() / std::max(1e-12, expected.abs().max().item<double>());
}

TEST(CudaFieldModule, TableIsComplete) {
#if !defined(ITEM3D_CUDA_MODULE)
    GTEST_SKIP() << "built with ITEM3D_CUDA=OFF";
#else
    const cuda::FieldTable& table = cuda::field_table();
    EXPECT_EQ(table.header.version, cuda::table_version);
    ASSERT_EQ(table.header.size, sizeof(cuda::FieldTable));
    std::vector<void*> entries((sizeof(cuda::FieldTable) - sizeof(cuda::TableHeader)) /
                               sizeof(void*));
    std::memcpy(entries.data(), &table.hash_grid, entries.size() * sizeof(void*));
    for (std::size_t i = 0; i < entries.size(); ++i)
        EXPECT_NE(entries[i], nullptr) << "entry " << i;
#endif
}

/// The functions that the device runs, run here one index after the other, against encode().
TEST(CudaFieldKernels, GiveTheCpusFeaturesAndGradients) {
    const HashGrid grid = HashGrid::make(6, 2, 9, 4, 64);
    torch::manual_seed(1);
    const std::int64_t count = 300;
    const torch::Tensor points = torch::rand({count, 3}).set_requires_grad(true);
    const torch::Tensor table = torch::randn({grid.entries(), 2}).set_requires_grad(true);
    const torch::Tensor weights = torch::randn({count, grid.output_width()});
    const torch::Tensor expected = encode(grid, points, table);
    (expected * weights).sum().backward();

    torch::Tensor features = torch::empty_like(expected), by_points = torch::empty_like(points);
    torch::Tensor by_table = torch::zeros_like(table);
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
    EXPECT_TRUE(torch::equal(features, expected));
    EXPECT_TRUE(torch::equal(by_points, points.grad()));
    EXPECT_TRUE(torch::equal(by_table, table.grad().to_dense()));
    const torch::Tensor marked =
        torch::from_blob(touched.data(), {grid.entries()}, torch::kUInt8).nonzero().squeeze(1);
    EXPECT_TRUE(torch::equal(marked, table.grad()._indices().select(0, 0)));
}

TEST(CudaFieldDevice, HashGridIsTheCpus) {
    SKIP_WITHOUT_DEVICE();
    for (const int features : {1, 2, 4, 8}) {
        const HashGrid grid = HashGrid::make(8, features, 12, 4, 256);
        torch::manual_seed(1);
        const torch::Tensor points = torch::rand({2000, 3});
        const torch::Tensor table = torch::randn({grid.entries(), features});
        const torch::Tensor weights = torch::randn({2000, grid.output_width()});
        std::vector<torch::Tensor> out, by_points, by_table;
        for (const torch::Device device :
             {torch::Device(torch::kCPU), torch::Device(torch::kCUDA, 0)}) {
            const torch::Tensor p = points.to(device).detach().clone().set_requires_grad(true);
            const torch::Tensor t = table.to(device).detach().clone().set_requires_grad(true);
            const torch::Tensor values = encode(grid, p, t);
            (values * weights.to(device)).sum().backward();
            out.push_back(values.detach());
            by_points.push_back(p.grad());
            by_table.push_back(t.grad());
        }
        EXPECT_LT(relative_error(out[1], out[0]), 1e-4);
        EXPECT_LT(relative_error(by_points[1], by_points[0]), 1e-3);
        EXPECT_TRUE(torch::equal(by_table[1]._indices().cpu(), by_table[0]._indices()));
        EXPECT_LT(relative_error(by_table[1]._values(), by_table[0]._values()), 1e-3);
    }
}

TEST(CudaFieldDevice, AdamIsTheCpus) {
    SKIP_WITHOUT_DEVICE();
    std::vector<torch::Tensor> results;
    for (const torch::Device device :
         {torch::Device(torch::kCPU), torch::Device(torch::kCUDA, 0)}) {
        torch::manual_seed(4);
        const torch::Tensor dense = torch::randn({20, 5}).to(device).set_requires_grad(true);
        const torch::Tensor sparse = torch::randn({50, 2}).to(device).set_requires_grad(true);
        Adam adam;
        adam.add_group({dense, sparse}, {});
        for (int step = 0; step < 5; ++step) {
            dense.mutable_grad() = torch::randn({20, 5}).to(device);
            const torch::Tensor rows =
                torch::tensor({{step, step + 7, step + 30}}).to(torch::kInt64);
            sparse.mutable_grad() =
                torch::sparse_coo_tensor(rows, torch::randn({3, 2}), {50, 2}).coalesce().to(device);
            adam.step();
        }
        results.push_back(torch::cat({dense.detach().flatten(), sparse.detach().flatten()}));
    }
    EXPECT_LT(relative_error(results[1], results[0]), 1e-4);
}

/// Fitted on either device, the field has the source's colours there; and what is baked from a
/// field that was not changed is the source to the bit.
TEST(CudaFieldDevice, FitsAndBakesAsTheCpu) {
    SKIP_WITHOUT_DEVICE();
    set_verbosity(Verbosity::quiet);
    const Model model = testing::make_model(testing::make_sphere());
    std::vector<double> quality;
    for (const torch::Device device :
         {torch::Device(torch::kCPU), torch::Device(torch::kCUDA, 0)}) {
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
