// Tests that prefiltering without LibTorch, as in the Python package, gives the same as with
// LibTorch.
#include "item3d/render/prefilter/environment_light.h"
#include "item3d/render/prefilter/host_backend.h"
#include "item3d/render/prefilter/prefilter_chain.h"
#include "tests/support/render.h"

namespace item3d {
namespace {

CubeMap contiguous(const at::Tensor& map) {
    return CubeMap::contiguous(map.const_data_ptr<float>(), static_cast<int>(map.size(1)));
}

void expect_near(const at::Tensor& found, const at::Tensor& expected) {
    const double largest = expected.abs().max().item<double>();
    ASSERT_GT(largest, 0);
    EXPECT_LT((found - expected).abs().max().item<double>(), 1e-5 * largest);
}

TEST(PrefilterBackends, HostIsLibTorchs) {
    for (const int size : {16, 32, 128}) {
        at::Tensor cube = testing::smooth_cube(size);
        cube[2][size / 3][size / 2] = 4000.0f;
        cube[4][1][size - 1] = 2000.0f;
        cube.set_requires_grad(true);
        const EnvironmentLight light = prefilter(cube);
        std::vector<at::Tensor> expected{light.diffuse};
        expected.insert(expected.end(), light.specular.begin(), light.specular.end());

        const HostBackend host;
        const ChainPlan plan = plan_chain(size);
        ASSERT_EQ(expected.size(), plan.lobes.size() + 1);
        std::vector<at::Tensor> maps, weights;
        std::vector<MeanMap> means;
        for (const at::Tensor& map : expected) {
            const auto edge = static_cast<int>(map.size(1));
            maps.push_back(at::empty({6, edge, edge, 3}));
            weights.push_back(at::empty({edge, edge}));
            means.push_back(
                {edge, maps.back().data_ptr<float>(), weights.back().data_ptr<float>()});
        }
        std::vector<std::int64_t> bright(max_bright);
        const at::Tensor values = cube.detach();
        prefilter_forward(host, plan, contiguous(values), means, bright.data());

        at::Tensor loss = at::zeros({});
        std::vector<at::Tensor> gradients;
        std::vector<MeanGradient> mean_gradients;
        for (std::size_t i = 0; i < maps.size(); ++i) {
            expect_near(maps[i], expected[i].detach());
            gradients.push_back(at::randn_like(maps[i]));
            mean_gradients.push_back(
                {contiguous(gradients.back()), weights[i].const_data_ptr<float>()});
            loss = loss + (expected[i] * gradients.back()).sum();
        }
        loss.backward();
        const at::Tensor by_cube = at::empty_like(values);
        prefilter_backward(host, plan, mean_gradients, bright.data(), by_cube.data_ptr<float>());
        expect_near(by_cube, cube.grad());
    }
}

}  // namespace
}  // namespace item3d
