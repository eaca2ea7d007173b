// Tests of the page's requests for lights.
#include "item3d/studio/light_request.h"

#include "item3d/core/error.h"
#include "item3d/lighting/description.h"
#include "item3d/lighting/environment.h"

#include <gtest/gtest.h>

#include <map>
#include <utility>
#include <vector>

namespace item3d::testing {
namespace {

constexpr int width = 128;

Image light_of(std::map<std::string, std::string> values, const std::string& name = "studio") {
    return requested_light(
        name, width, [&](const std::string& key) { return values[key]; }, "no_such_file.hdr");
}

TEST(StudioLightRequest, NothingChangesNothing) {
    const Image studio = make_light_preset("studio", width / 2);
    EXPECT_EQ(light_of({}).pixels, studio.pixels);
    EXPECT_EQ(light_of({{"rotate", "0"}, {"exposure", "0"}}).pixels, studio.pixels);
}

TEST(StudioLightRequest, PutsTheSunWhereItIsAskedFor) {
    for (const auto& [name, value, azimuth] :
         {std::tuple{"sun", "62,40,30", 62.0f}, {"lit", "from the north 40 degrees up", 0.0f}}) {
        const SkyAngles found = to_sky_angles(brightest_lobe(light_of({{name, value}})).direction);
        EXPECT_NEAR(found.elevation, 40, 2) << value;
        EXPECT_NEAR(found.azimuth, azimuth, 2) << value;
    }
}

TEST(StudioLightRequest, TintsAndExposes) {
    const Image studio = make_light_preset("studio", width / 2);
    const Image red = light_of({{"tint", "#ff8080"}, {"exposure", "1"}});
    ASSERT_EQ(red.pixels.size(), studio.pixels.size());
    EXPECT_GT(red.pixels[0], 2 * studio.pixels[0]);
    EXPECT_LT(red.pixels[1], 2 * studio.pixels[1]);
}

TEST(StudioLightRequest, RefusesWhatIsNone) {
    EXPECT_THROW(light_of({{"hour", "25"}}, "sky"), InputError);
    EXPECT_THROW(light_of({}, "no_such_light"), InputError);
    for (const auto& [name, value] :
         std::vector<std::pair<std::string, std::string>>{{"exposure", "1x"},
                                                          {"rotate", "nan"},
                                                          {"sun", "10"},
                                                          {"sun", "10,200"},
                                                          {"lit", "a mug"},
                                                          {"tint", "red"},
                                                          {"tint", "#000000"}})
        EXPECT_THROW(light_of({{name, value}}), InputError) << value;
}

}  // namespace
}  // namespace item3d::testing
