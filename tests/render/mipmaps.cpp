// Filtered texture lookups: footprints, pyramids, and what they leave of aliasing.

#include "item3d/render/textured.h"
#include "support/render.h"

namespace item3d {
namespace {

/// A floor that runs away from the camera, its texture repeated `repeats` times.
Geometry make_floor(float repeats) {
    Geometry floor =
        testing::make_geometry(torch::tensor({-8.0f, -1.0f, -30.0f, 8.0f, -1.0f, -30.0f, 8.0f,
                                              -1.0f, 2.0f, -8.0f, -1.0f, 2.0f})
                                   .reshape({4, 3}),
                               torch::tensor({0, 1, 2, 0, 2, 3}).reshape({2, 3}));
    floor.uvs =
        torch::tensor({0.0f, 0.0f, 0.5f, 0.0f, 0.5f, 1.0f, 0.0f, 1.0f}).reshape({4, 2}) * repeats;
    return floor;
}

torch::Tensor checkerboard(int size) {
    const torch::Tensor cell = torch::arange(size).div(4, "floor");
    return ((cell.unsqueeze(0) + cell.unsqueeze(1)) % 2).to(torch::kFloat32).unsqueeze(2);
}

TEST(Footprint, IsTheDifferenceBetweenNeighbours) {
    const Geometry floor = make_floor(3);
    const std::vector<Camera> camera{testing::front_camera(3)};
    constexpr int size = 64;
    const Raster raster = rasterize(floor, camera, size, size);
    const Surface surface = interpolate_surface(floor, raster, camera);
    const torch::Tensor uv = scatter(surface.uv, surface, raster, torch::zeros({2}))[0];
    const torch::Tensor found =
        scatter(uv_footprints(floor, raster, surface), surface, raster, torch::zeros({4}))[0];
    const auto triangle = raster.triangle[0];
    int compared = 0;
    for (int y = size / 2 + 8; y + 1 < size; ++y) {
        for (int x = 1; x + 1 < size; ++x) {
            const int here = triangle[y][x].item<int>();
            bool alone = here >= 0;
            for (const auto& [dy, dx] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}})
                alone = alone && triangle[y + dy][x + dx].item<int>() == here;
            if (!alone) continue;
            ++compared;
            const torch::Tensor right = (uv[y][x + 1] - uv[y][x - 1]) / 2;
            const torch::Tensor down = (uv[y + 1][x] - uv[y - 1][x]) / 2;
            const torch::Tensor expected = torch::cat({right, down});
            // Far from the horizon the change over two pixels is nearly linear.
            EXPECT_LT((found[y][x] - expected).abs().max().item<float>(),
                      0.03f * expected.abs().max().item<float>() + 1e-5f)
                << x << ", " << y;
        }
    }
    EXPECT_GT(compared, 500);
}

TEST(TexturePyramid, KeepsTheMeanOfAnySize) {
    torch::manual_seed(5);
    for (const auto& [height, width] : {std::pair{16, 16}, {64, 8}, {33, 20}, {1, 7}}) {
        const torch::Tensor texture = torch::rand({height, width, 3});
        const auto levels = texture_pyramid(texture);
        EXPECT_EQ(levels.back().numel(), 3);
        const torch::Tensor error = levels.back().flatten() - texture.mean({0, 1});
        EXPECT_LT(error.abs().max().item<float>(), 0.03f) << height << " x " << width;
    }
}

TEST(SampleTexture, FiltersWhatIsSmallerThanAPixel) {
    const Geometry floor = make_floor(8);
    const std::vector<Camera> camera{testing::front_camera(3)};
    const torch::Tensor texture = checkerboard(64);
    const auto levels = texture_pyramid(texture);
    constexpr int size = 48, grid = 16;
    // What a pixel truly shows: 256 sharp lookups.
    const Raster fine = rasterize(floor, camera, size * grid, size * grid);
    const Surface fine_surface = interpolate_surface(floor, fine, camera);
    const torch::Tensor truth =
        scatter(sample_texture(texture, fine_surface.uv), fine_surface, fine, torch::zeros({1}))
            .reshape({size, grid, size, grid})
            .mean({1, 3});
    const Raster raster = rasterize(floor, camera, size, size);
    const Surface surface = interpolate_surface(floor, raster, camera);
    const auto picture = [&](const torch::Tensor& values) {
        return scatter(values, surface, raster, torch::zeros({1})).reshape({size, size});
    };
    const torch::Tensor inside = torch::zeros({size, size}, torch::kBool);
    inside.slice(0, size / 2 + 2, size - 2).slice(1, 4, size - 4).fill_(true);
    const auto error = [&](const torch::Tensor& found) {
        return (found - truth).masked_select(inside).square().mean().sqrt().item<double>();
    };
    const double sharp = error(picture(sample_texture(texture, surface.uv)));
    const double filtered =
        error(picture(sample_texture(levels, surface.uv, uv_footprints(floor, raster, surface))));
    EXPECT_GT(sharp, 0.2);
    EXPECT_LT(filtered, 0.25 * sharp) << "sharp lookups: " << sharp;
}

TEST(SampleTexture, GradientsThroughTheLevels) {
    torch::manual_seed(6);
    const torch::Tensor texture = torch::rand({16, 24, 3});
    const torch::Tensor uv = torch::rand({40, 2}) * 3 - 1;
    const torch::Tensor footprint = (torch::rand({40, 4}) - 0.5f) * 0.6f;
    for (const Wrap wrap : {Wrap::repeat, Wrap::mirrored_repeat, Wrap::clamp_to_edge}) {
        testing::check_gradient(
            [&](const torch::Tensor& x) {
                return sample_texture(texture_pyramid(x), uv, footprint, wrap, wrap);
            },
            texture, 0.05f, 1e-3);
        // Along u and v values are linear between texel centres, so differences are exact except
        // where a probe steps over one.
        const auto levels = texture_pyramid(texture);
        torch::Tensor leaf = uv.clone().set_requires_grad(true);
        const torch::Tensor weights = torch::randn({40, 3});
        (sample_texture(levels, leaf, footprint, wrap, wrap) * weights).sum().backward();
        constexpr float step = 1e-4f;
        for (int axis = 0; axis < 2; ++axis) {
            torch::Tensor offset = torch::zeros({1, 2});
            offset[0][axis] = step;
            const auto at = [&](const torch::Tensor& x) {
                return (sample_texture(levels, x, footprint, wrap, wrap) * weights)
                    .to(torch::kFloat64)
                    .sum(1);
            };
            const torch::Tensor numeric = (at(uv + offset) - at(uv - offset)) / (2 * step);
            const torch::Tensor error = (leaf.grad().select(1, axis) - numeric).abs();
            EXPECT_LT(error.median().item<double>(), 0.01);
            EXPECT_GT((error < 0.02).to(torch::kFloat32).mean().item<double>(), 0.7);
            EXPECT_GT(numeric.abs().mean().item<double>(), 0.2);
        }
    }
}

}  // namespace
}  // namespace item3d
