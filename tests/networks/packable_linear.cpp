#include "item3d/networks/layers/packable_linear.h"

#include "item3d/networks/vision_language/clip_model.h"
#include "support/networks.h"

namespace item3d {
namespace {

torch::Tensor exactly(const torch::Tensor& x) {
    return x.to(torch::kFloat64);
}

double error_of(const torch::Tensor& actual, const torch::Tensor& exact) {
    return (exactly(actual.detach()) - exactly(exact.detach())).abs().max().item<double>();
}

PackableLinear packed_layer(int in, int out) {
    torch::manual_seed(in + out);
    PackableLinear layer(in, out);
    for (torch::Tensor& parameter : layer->parameters())
        parameter.set_requires_grad(false);
    return layer;
}

class Packed : public ::testing::TestWithParam<torch::Dtype> {
  protected:
    void SetUp() override {
        if (!PackedMatrix::runs(torch::kCPU, GetParam()))
            GTEST_SKIP() << "the processor lacks the instructions";
    }
    torch::Tensor rounded(const torch::Tensor& x) const {
        return x.to(GetParam()).to(torch::kFloat32);
    }
    /// What weights in float16 are multiplied by is not rounded.
    torch::Dtype multiplied() const {
        return GetParam() == torch::kBFloat16 ? torch::kBFloat16 : torch::kFloat32;
    }
    double step() const { return multiplied() == torch::kFloat32 ? 6e-8 : 4e-3; }
};
INSTANTIATE_TEST_SUITE_P(Precisions, Packed,
                         ::testing::Values(torch::kFloat32, torch::kBFloat16, torch::kFloat16));

TEST_P(Packed, MultipliesTheRoundedNumbersInFloat) {
    const torch::NoGradGuard no_grad;
    // Rows and columns that fill whole tiles, cut tiles, and one row alone.
    for (const auto& [rows, in, out] : {std::tuple(12, 64, 128), std::tuple(7, 48, 70),
                                        std::tuple(1, 16, 5), std::tuple(700, 1024, 65)}) {
        PackableLinear layer = packed_layer(in, out);
        const torch::Tensor weight = layer->weight.clone(), bias = layer->bias;
        layer->pack(GetParam());
        EXPECT_EQ(layer->weight.numel(), 0);
        const torch::Tensor x = torch::randn({rows, in});
        const torch::Tensor exact =
            torch::addmm(exactly(bias), exactly(x.to(multiplied())), exactly(rounded(weight)).t());
        EXPECT_LE(error_of(layer(x), exact), 2e-6 * in) << rows << " x " << in;
        EXPECT_TRUE(layer(x).equal(layer(layer->as_read(x))));
    }
}

TEST_P(Packed, EndsAsTheLibraryDoes) {
    const torch::NoGradGuard no_grad;
    PackableLinear plain = packed_layer(32, 80), layer = packed_layer(32, 80);
    layer->pack(GetParam());
    plain->weight.set_data(rounded(plain->weight));
    const torch::Tensor x = rounded(5 * torch::randn({2, 9, 32})), added = torch::randn({2, 9, 80});
    for (const LinearActivation f :
         {LinearActivation::none, LinearActivation::gelu, LinearActivation::quick_gelu}) {
        const torch::Tensor wanted = plain->forward(x, {.activation = f, .added = added});
        EXPECT_LE(error_of(layer->forward(x, {.activation = f, .added = added}), wanted), 5e-6);
        const torch::Tensor stored = layer->forward(x, {.activation = f, .rounded = true});
        EXPECT_EQ(stored.scalar_type(), multiplied());
        EXPECT_LE(error_of(stored, wanted - added),
                  step() * wanted.abs().max().item<double>() + 5e-6);
    }
    // Far out, where an exponential overflows.
    const torch::Tensor far = rounded(torch::full({1, 32}, 1e4f));
    for (const LinearActivation f : {LinearActivation::gelu, LinearActivation::quick_gelu})
        EXPECT_LE(error_of(layer->forward(far, {.activation = f}),
                           plain->forward(far, {.activation = f})),
                  1e-2);
}

TEST_P(Packed, PassesGradientsToItsInput) {
    PackableLinear layer = packed_layer(48, 70);
    const torch::Tensor weight = rounded(layer->weight.clone());
    layer->pack(GetParam());
    const torch::Tensor x = torch::randn({3, 48}).requires_grad_(true), dy = torch::randn({3, 70});
    const torch::Tensor dx = torch::autograd::grad({layer(x)}, {x}, {dy})[0];
    EXPECT_LE(error_of(dx, dy.mm(weight)), 1e-5);
}

TEST(PackableLinear, KeepsTheHalvesOfAFile) {
    if (!PackedMatrix::runs(torch::kCPU, torch::kFloat16)) GTEST_SKIP() << "no instructions for it";
    PackableLinear layer = packed_layer(1024, 512), small = packed_layer(64, 64);
    const torch::Tensor stored = torch::randn({512, 1024}).to(torch::kFloat16);
    ASSERT_TRUE(layer->pack_stored(stored));
    EXPECT_EQ(layer->weight.numel(), 0);
    const torch::Tensor x = torch::randn({3, 1024});
    const torch::Tensor exact = torch::addmm(exactly(layer->bias), exactly(x), exactly(stored).t());
    EXPECT_LE(error_of(layer(x), exact), 1e-3);
    EXPECT_FALSE(small->pack_stored(torch::randn({64, 64}).to(torch::kFloat16)));
    EXPECT_FALSE(small->pack_stored(torch::randn({512, 1024})));
    EXPECT_EQ(small->weight.numel(), 4096);
}

TEST(PackableLinear, IsLeftAloneWhereItDoesNotFit) {
    PackableLinear layer = packed_layer(20, 8);
    layer->pack(torch::kFloat32);
    EXPECT_EQ(layer->weight.numel(), 160);
    PackableLinear learning(16, 8);
    if (PackedMatrix::runs(torch::kCPU, torch::kFloat32)) {
        EXPECT_THROW(learning->pack(torch::kFloat32), std::exception);
    }
}

}  // namespace
}  // namespace item3d
