// Tests of an interrupt while a region is read from views.
#include "item3d/region/surface_reading.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "tests/support/field_models.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>

namespace item3d {
namespace {

TEST(SurfaceReading, EndsAtAnInterruptBetweenViews) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");  // other tests have started threads
    const Model model = testing::make_model(testing::make_sphere());
    const Geometry geometry = Geometry::from_model(model);
    const TexturedMaterials materials(model);
    const FieldSpace space(model, {0});
    const auto interrupted_reading = [&] {
        install_interrupt_handler();
        int views = 0;
        try {
            read_surface({model, geometry, materials, space}, 16, [&](const ModelView&) {
                std::raise(SIGINT);
                ++views;
                return at::ones({1, 4, 4});
            });
        } catch (const Interrupted&) {
            std::_Exit(views);
        }
    };
    EXPECT_EXIT(interrupted_reading(), ::testing::ExitedWithCode(1), "");
}

}  // namespace
}  // namespace item3d
