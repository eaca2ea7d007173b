// Tests of random points on surfaces.
#include "item3d/field/surface_points.h"

#include "tests/support/field_models.h"

#include <gtest/gtest.h>

namespace item3d {
namespace {

TEST(SurfaceSampler, DrawsFromTinyModelsAsFromLargeOnes) {
    constexpr float scale = 1e-14f;  // the square of a triangle's area is 0 in float
    Model model = testing::make_model(testing::make_sphere());
    const auto sample = [&] {
        Random random(3);
        return SurfaceSampler(Geometry::from_model(model), FieldSpace(model, {0}))
            .sample(500, random);
    };
    const Surface large = sample();
    for (Vec3& p : model.primitives[0].positions)
        p *= scale;
    const Surface tiny = sample();
    EXPECT_LT((tiny.position / scale - large.position).abs().max().item<float>(), 1e-5f);
}

}  // namespace
}  // namespace item3d
