#include "item3d/networks/layers/packable_linear.h"

#include "tests/support/networks.h"

namespace item3d {
namespace {

at::Tensor exactly(const at::Tensor& x) {
    return x.to(at::kDouble);
}

double error_of(const at::Tensor& actual, const at::Tensor& exact) {
    return (exactly(actual.detach()) - exactly(exact.detach())).abs().max().item<double>();
}

PackableLinear packed_layer(int in, int out) {
    at::manual_seed(in + out);
    PackableLinear layer(in, out);
    for (at::Tensor& parameter : layer->parameters())
        parameter.set_requires_grad(false);
    return layer;
}

class Packed : public ::testing::TestWithParam<at::ScalarType> {
  protected:
    void SetUp() override {
        if (!PackedMatrix::runs(at::kCPU, GetParam()))
            GTEST_SKIP() << "the processor lacks the instructions";
    }
    at::Tensor rounded(const at::Tensor& x) const { return x.to(GetParam()).to(at::kFloat); }
    /// Type in which products are computed. Weights of float16 multiply activations that are not
    /// rounded.
    at::ScalarType multiplied() const {
        return GetParam() == at::kBFloat16 ? at::kBFloat16 : at::kFloat;
    }
    double step() const { return multiplied() == at::kFloat ? 6e-8 : 4e-3; }
};
INSTANTIATE_TEST_SUITE_P(Precisions, Packed,
                         ::testing::Values(at::kFloat, at::kBFloat16, at::kHalf));

TEST_P(Packed, MultipliesTheRoundedNumbersInFloat) {
    const at::NoGradGuard no_grad;
    // Rows and columns fill whole tiles or part of a tile, and there is a single row.
    for (const auto& [rows, in, out] : {std::tuple(12, 64, 128), std::tuple(7, 48, 70),
                                        std::tuple(1, 16, 5), std::tuple(700, 1024, 65)}) {
        PackableLinear layer = packed_layer(in, out);
        const at::Tensor weight = layer->weight.clone(), bias = layer->bias;
        layer->pack(GetParam());
        EXPECT_EQ(layer->weight.numel(), 0);
        const at::Tensor x = at::randn({rows, in});
        const at::Tensor exact =
            at::addmm(exactly(bias), exactly(x.to(multiplied())), exactly(rounded(weight)).t());
        EXPECT_LE(error_of(layer(x), exact), 2e-6 * in) << rows << " x " << in;
        EXPECT_TRUE(layer(x).equal(layer(layer->as_read(x))));
    }
}

TEST_P(Packed, EndsAsTheLibraryDoes) {
    const at::NoGradGuard no_grad;
    PackableLinear plain = packed_layer(32, 80), layer = packed_layer(32, 80);
    layer->pack(GetParam());
    plain->weight.set_data(rounded(plain->weight));
    const at::Tensor x = rounded(5 * at::randn({2, 9, 32})), added = at::randn({2, 9, 80});
    for (const LinearActivation f :
         {LinearActivation::none, LinearActivation::gelu, LinearActivation::quick_gelu}) {
        const at::Tensor wanted = plain->forward(x, {.activation = f, .added = added});
        EXPECT_LE(error_of(layer->forward(x, {.activation = f, .added = added}), wanted), 5e-6);
        const at::Tensor stored = layer->forward(x, {.activation = f, .rounded = true});
        EXPECT_EQ(stored.scalar_type(), multiplied());
        EXPECT_LE(error_of(stored, wanted - added),
                  step() * wanted.abs().max().item<double>() + 5e-6);
    }
    // The values are so large that an exponential overflows.
    const at::Tensor far = rounded(at::full({1, 32}, 1e4f));
    for (const LinearActivation f : {LinearActivation::gelu, LinearActivation::quick_gelu})
        EXPECT_LE(error_of(layer->forward(far, {.activation = f}),
                           plain->forward(far, {.activation = f})),
                  1e-2);
}

TEST_P(Packed, PassesGradientsToItsInput) {
    PackableLinear layer = packed_layer(48, 70);
    const at::Tensor weight = rounded(layer->weight.clone());
    layer->pack(GetParam());
    const at::Tensor x = at::randn({3, 48}).requires_grad_(true), dy = at::randn({3, 70});
    const at::Tensor dx = torch::autograd::grad({layer(x)}, {x}, {dy})[0];
    EXPECT_LE(error_of(dx, dy.mm(weight)), 1e-5);
}

TEST(PackableLinear, KeepsTheHalvesOfAFile) {
    if (!PackedMatrix::runs(at::kCPU, at::kHalf)) GTEST_SKIP() << "no instructions for it";
    PackableLinear layer = packed_layer(1024, 512), small = packed_layer(64, 64);
    const at::Tensor stored = at::randn({512, 1024}).to(at::kHalf);
    ASSERT_TRUE(layer->pack_stored(stored));
    EXPECT_EQ(layer->weight.numel(), 0);
    const at::Tensor x = at::randn({3, 1024});
    const at::Tensor exact = at::addmm(exactly(layer->bias), exactly(x), exactly(stored).t());
    EXPECT_LE(error_of(layer(x), exact), 1e-3);
    EXPECT_FALSE(small->pack_stored(at::randn({64, 64}).to(at::kHalf)));
    EXPECT_FALSE(small->pack_stored(at::randn({512, 1024})));
    EXPECT_EQ(small->weight.numel(), 4096);
}

TEST(PackableLinear, IsLeftAloneWhereItDoesNotFit) {
    PackableLinear layer = packed_layer(20, 8);
    layer->pack(at::kFloat);
    EXPECT_EQ(layer->weight.numel(), 160);
    PackableLinear learning(16, 8);
    if (PackedMatrix::runs(at::kCPU, at::kFloat)) {
        EXPECT_THROW(learning->pack(at::kFloat), std::exception);
    }
}

}  // namespace
}  // namespace item3d
