// Tests of filtered texture lookups: footprints, mip levels, and the aliasing that remains.

#include "item3d/render/scatter.h"
#include "item3d/render/texture.h"
#include "tests/support/render.h"

namespace item3d {
namespace {

/// Returns a floor that recedes from the camera and repeats its texture `repeats` times.
Geometry make_floor(float repeats) {
    Geometry floor =
        testing::make_geometry(at::tensor({-8.0f, -1.0f, -30.0f, 8.0f, -1.0f, -30.0f, 8.0f, -1.0f,
                                           2.0f, -8.0f, -1.0f, 2.0f})
                                   .reshape({4, 3}),
                               at::tensor({0, 1, 2, 0, 2, 3}, at::kLong).reshape({2, 3}));
    floor.uvs =
        at::tensor({0.0f, 0.0f, 0.5f, 0.0f, 0.5f, 1.0f, 0.0f, 1.0f}).reshape({4, 2}) * repeats;
    return floor;
}

at::Tensor checkerboard(int size) {
    const at::Tensor cell = at::arange(size).div(4, "floor");
    return ((cell.unsqueeze(0) + cell.unsqueeze(1)) % 2).to(at::kFloat).unsqueeze(2);
}

TEST(Footprint, IsTheDifferenceBetweenNeighbours) {
    const Geometry floor = make_floor(3);
    const std::vector<Camera> camera{testing::front_camera(3)};
    constexpr int size = 64;
    const Raster raster = rasterize(floor, camera, size, size);
    const Surface surface = interpolate_surface(floor, raster, camera);
    const at::Tensor uv = scatter(surface.uv, surface, raster, at::zeros({2}))[0];
    const at::Tensor found =
        scatter(uv_footprints(floor, raster, surface), surface, raster, at::zeros({4}))[0];
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
            const at::Tensor right = (uv[y][x + 1] - uv[y][x - 1]) / 2;
            const at::Tensor down = (uv[y + 1][x] - uv[y - 1][x]) / 2;
            const at::Tensor expected = at::cat({right, down});
            // Far from the horizon the change over two pixels is nearly linear.
            EXPECT_LT((found[y][x] - expected).abs().max().item<float>(),
                      0.03f * expected.abs().max().item<float>() + 1e-5f)
                << x << ", " << y;
        }
    }
    EXPECT_GT(compared, 500);
}

TEST(TexturePyramid, KeepsTheMeanOfAnySize) {
    at::manual_seed(5);
    for (const auto& [height, width] : {std::pair{16, 16}, {64, 8}, {33, 20}, {1, 7}}) {
        const at::Tensor texture = at::rand({height, width, 3});
        const auto levels = texture_pyramid(texture);
        EXPECT_EQ(levels.back().numel(), 3);
        const at::Tensor error = levels.back().flatten() - texture.mean(at::IntArrayRef{0, 1});
        EXPECT_LT(error.abs().max().item<float>(), 0.03f) << height << " x " << width;
    }
}

TEST(SampleTexture, FiltersWhatIsSmallerThanAPixel) {
    const Geometry floor = make_floor(8);
    const std::vector<Camera> camera{testing::front_camera(3)};
    const at::Tensor texture = checkerboard(64);
    const auto levels = texture_pyramid(texture);
    constexpr int size = 48, grid = 16;
    // The reference for a pixel is the mean of 256 sharp lookups.
    const Raster fine = rasterize(floor, camera, size * grid, size * grid);
    const Surface fine_surface = interpolate_surface(floor, fine, camera);
    const at::Tensor truth =
        scatter(sample_texture(texture, fine_surface.uv), fine_surface, fine, at::zeros({1}))
            .reshape({size, grid, size, grid})
            .mean({1, 3});
    const Raster raster = rasterize(floor, camera, size, size);
    const Surface surface = interpolate_surface(floor, raster, camera);
    const auto image = [&](const at::Tensor& values) {
        return scatter(values, surface, raster, at::zeros({1})).reshape({size, size});
    };
    const at::Tensor inside = at::zeros({size, size}, at::kBool);
    inside.slice(0, size / 2 + 2, size - 2).slice(1, 4, size - 4).fill_(true);
    const auto error = [&](const at::Tensor& found) {
        return (found - truth).masked_select(inside).square().mean().sqrt().item<double>();
    };
    const double sharp = error(image(sample_texture(texture, surface.uv)));
    const double filtered =
        error(image(sample_texture(levels, surface.uv, uv_footprints(floor, raster, surface))));
    EXPECT_GT(sharp, 0.2);
    EXPECT_LT(filtered, 0.25 * sharp) << "sharp lookups: " << sharp;
}

TEST(SampleTexture, GradientsThroughTheLevels) {
    at::manual_seed(6);
    const at::Tensor texture = at::rand({16, 24, 3});
    const at::Tensor uv = at::rand({40, 2}) * 3 - 1;
    const at::Tensor footprint = (at::rand({40, 4}) - 0.5f) * 0.6f;
    for (const Wrap wrap : {Wrap::repeat, Wrap::mirrored_repeat, Wrap::clamp_to_edge}) {
        testing::check_gradient(
            [&](const at::Tensor& x) {
                return sample_texture(texture_pyramid(x), uv, footprint, wrap, wrap);
            },
            texture, 0.05f, 1e-3);
        // Between texel centres, values are linear in u and in v, so differences are exact unless a
        // probe crosses a texel centre.
        const auto levels = texture_pyramid(texture);
        at::Tensor leaf = uv.clone().set_requires_grad(true);
        const at::Tensor weights = at::randn({40, 3});
        (sample_texture(levels, leaf, footprint, wrap, wrap) * weights).sum().backward();
        constexpr float step = 1e-4f;
        for (int axis = 0; axis < 2; ++axis) {
            at::Tensor offset = at::zeros({1, 2});
            offset[0][axis] = step;
            const auto at = [&](const at::Tensor& x) {
                return (sample_texture(levels, x, footprint, wrap, wrap) * weights)
                    .to(at::kDouble)
                    .sum(1);
            };
            const at::Tensor numeric = (at(uv + offset) - at(uv - offset)) / (2 * step);
            const at::Tensor error = (leaf.grad().select(1, axis) - numeric).abs();
            EXPECT_LT(error.median().item<double>(), 0.01);
            EXPECT_GT((error < 0.02).to(at::kFloat).mean().item<double>(), 0.7);
            EXPECT_GT(numeric.abs().mean().item<double>(), 0.2);
        }
    }
}

}  // namespace
}  // namespace item3d
