// Lights that a page asks for.
#include "item3d/studio/light_query.h"

#include "item3d/core/error.h"
#include "item3d/lighting/description.h"
#include "item3d/lighting/environment.h"

#include <gtest/gtest.h>

#include <map>
#include <utility>
#include <vector>

namespace item3d::testing {
namespace {

LightQuery query_of(std::map<std::string, std::string> values) {
    return parse_light_query([&](const std::string& name) { return values[name]; });
}

TEST(StudioLightQuery, NothingChangesNothing) {
    EXPECT_FALSE(query_of({}).changes());
    EXPECT_FALSE(query_of({{"rotate", "0"}, {"exposure", "0"}}).changes());
    EXPECT_TRUE(query_of({{"hour", "0"}}).changes());
}

TEST(StudioLightQuery, PutsTheSunWhereItIsAskedFor) {
    const Image studio = make_light_preset("studio", 64);
    for (const auto& query :
         {query_of({{"sun", "62,40,30"}}), query_of({{"lit", "from the north 40 degrees up"}})}) {
        const SkyAngles found =
            to_sky_angles(brightest_lobe(changed_light(studio, query)).direction);
        EXPECT_NEAR(found.elevation, 40, 2);
        EXPECT_NEAR(found.azimuth, query.lit.empty() ? 62 : 0, 2);
    }
}

TEST(StudioLightQuery, TintsAndExposes) {
    const Image studio = make_light_preset("studio", 16);
    const Image red = changed_light(studio, query_of({{"tint", "#ff8080"}, {"exposure", "1"}}));
    ASSERT_EQ(red.pixels.size(), studio.pixels.size());
    EXPECT_GT(red.pixels[0], 2 * studio.pixels[0]);
    EXPECT_LT(red.pixels[1], 2 * studio.pixels[1]);
}

TEST(StudioLightQuery, RefusesWhatIsNone) {
    const Image studio = make_light_preset("studio", 16);
    EXPECT_THROW(query_of({{"hour", "25"}}), InputError);
    EXPECT_THROW(query_of({{"exposure", "1x"}}), InputError);
    EXPECT_THROW(query_of({{"rotate", "nan"}}), InputError);
    for (const auto& [name, value] :
         std::vector<std::pair<std::string, std::string>>{{"sun", "10"},
                                                          {"sun", "10,200"},
                                                          {"lit", "a mug"},
                                                          {"tint", "red"},
                                                          {"tint", "#000000"}})
        EXPECT_THROW(changed_light(studio, query_of({{name, value}})), InputError) << value;
}

}  // namespace
}  // namespace item3d::testing
