// Tests of item3d light and relight: outputs and error messages.
#include "tests/support/program.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <string>
#include <vector>

namespace item3d::testing {
namespace {

using nlohmann::json;

class RelightProgram : public Program {
  protected:
    fs::path textured_ = fs::path(ITEM3D_TEST_DATA) / "scene/gltf/full_pbr.glb";

    json describe(const std::string& arguments) const {
        const Result result = run("light --json " + arguments);
        EXPECT_EQ(result.code, 0) << result.error;
        return json::parse(result.out, nullptr, false);
    }
    /// Runs item3d relight, by default without shadows, which take most of the time.
    Result relight(const std::string& arguments, const fs::path& model,
                   const std::string& shadows = "--no-shadows ") const {
        return run("relight " + quoted(model) + " -o " + quoted(folder_ / "out") +
                   " --views 2 --frames 2 --size 32 --quiet " + shadows + arguments);
    }
    /// Returns the JSON chunk and all other bytes of a .glb.
    static std::pair<json, std::string> parts(const fs::path& path) {
        const std::string bytes = read_file(path);
        std::uint32_t length = 0;
        for (int i = 3; i >= 0; --i)
            length = length << 8 | static_cast<unsigned char>(bytes[12 + i]);
        return {json::parse(bytes.substr(20, length)), bytes.substr(20 + length)};
    }
};

double angle_between(const json& angles, double azimuth, double elevation) {
    const auto radians = [](double degrees) { return degrees * M_PI / 180; };
    const double a = radians(angles["elevation"]), b = radians(elevation);
    const double turn = radians(angles["azimuth"].get<double>() - azimuth);
    const double cosine = std::sin(a) * std::sin(b) + std::cos(a) * std::cos(b) * std::cos(turn);
    return std::acos(std::min(1.0, cosine)) * 180 / M_PI;
}

TEST_F(RelightProgram, WritesEverything) {
    const Result result = relight("--lit 'from the left' --tint orange", textured_, "");
    ASSERT_EQ(result.code, 0) << result.error;
    EXPECT_EQ(result.error, "");
    for (const char* name : {"light.hdr", "light.exr", "before.png", "after.png", "sheet.png",
                             "turntable.webp", "relight.json", "model.glb"}) {
        EXPECT_GT(read_file(folder_ / "out" / name).size(), 100u) << name;
    }
    EXPECT_EQ(read_file(folder_ / "out/model.glb"), read_file(textured_));
    EXPECT_NE(read_file(folder_ / "out/before.png"), read_file(folder_ / "out/after.png"));
    const json record = json::parse(read_file(folder_ / "out/relight.json"));
    EXPECT_EQ(record["settings"]["lit"], "from the left");
    // The viewer is at 145 degrees, so the viewer's left is at 235. The light's files say the same.
    EXPECT_LT(angle_between(record["description"]["brightest_lobe"], 235, 25), 2);
    for (const char* file : {"light.exr", "light.hdr"}) {
        const json read = describe(quoted(folder_ / "out" / file));
        EXPECT_LT(angle_between(read["brightest_lobe"], 235, 25), 2) << file;
    }
}

TEST_F(RelightProgram, AddsADirectionalLightAndNothingElse) {
    ASSERT_EQ(relight("--sun 90,30 --punctual", textured_).code, 0);
    const auto [before, binary_before] = parts(textured_);
    auto [after, binary_after] = parts(folder_ / "out/model.glb");
    EXPECT_EQ(binary_before, binary_after);
    const json light = after["extensions"]["KHR_lights_punctual"]["lights"].back();
    EXPECT_EQ(light["type"], "directional");
    EXPECT_GT(light["intensity"].get<double>(), 0.1);
    // The light shines along its node's -Z, so +Z, turned by the node's rotation, must point to the
    // sun.
    const json node = after["nodes"].back();
    const std::vector<double> q = node["rotation"];
    const double x = 2 * (q[0] * q[2] + q[3] * q[1]), y = 2 * (q[1] * q[2] - q[3] * q[0]);
    EXPECT_NEAR(x, std::cos(M_PI / 6), 0.02);
    EXPECT_NEAR(y, 0.5, 0.02);
    EXPECT_EQ(after["scenes"][0]["nodes"].back(), after["nodes"].size() - 1);
    // Without the light, the document is unchanged.
    after["nodes"].erase(after["nodes"].size() - 1);
    after["scenes"][0]["nodes"].erase(after["scenes"][0]["nodes"].size() - 1);
    EXPECT_EQ(after["nodes"], before["nodes"]);
    EXPECT_EQ(after["scenes"], before["scenes"]);
    EXPECT_EQ(after["images"], before["images"]);
    EXPECT_EQ(after["materials"], before["materials"]);
}

TEST_F(RelightProgram, TakesObjAndTheSkyByTheHour) {
    const Result result = relight("--sky 9 --json", cube_);
    ASSERT_EQ(result.code, 0) << result.error;
    const json record = json::parse(result.out);
    EXPECT_EQ(record["sky"], 9);
    // At 9 o'clock the sun's hour angle is 45 degrees. The sun is between east and south, at half
    // of its highest elevation.
    EXPECT_LT(angle_between(record["description"]["brightest_lobe"], 125.26, 30), 4);
    EXPECT_EQ(read_file(folder_ / "out/model.glb").substr(0, 4), "glTF");
}

// The prior's sunset must be warmer than the studio light, and its night darker and colder. A few
// steps suffice for the direction of these changes. bench/relight_suite tests four words on three
// meshes.
TEST_F(RelightProgram, WordsFindALightAndLeaveTheModelAlone) {
    const std::string steps = " --iterations 16 --from 'a box' ";
    ASSERT_EQ(relight("--to 'a box at sunset'" + steps, textured_).code, 0);
    EXPECT_EQ(read_file(folder_ / "out/model.glb"), read_file(textured_));
    const json sunset = json::parse(read_file(folder_ / "out/relight.json"));
    EXPECT_EQ(sunset["words"]["settings"]["light_model"], "auto");
    EXPECT_LT(sunset["description"]["color_temperature"].get<double>(),
              sunset["description_before"]["color_temperature"].get<double>() - 300);
    ASSERT_EQ(relight("--to 'a box at night, lit from the left'" + steps, textured_).code, 0);
    const json night = json::parse(read_file(folder_ / "out/relight.json"));
    EXPECT_EQ(night["words"]["prompts"][1], "a box at night");
    EXPECT_LT(night["description"]["mean_radiance"].get<double>(),
              0.9 * night["description_before"]["mean_radiance"].get<double>());
    EXPECT_LT(angle_between(night["description"]["brightest_lobe"], 235, 25), 2);
}

TEST_F(RelightProgram, WordsOfDirectionAloneNeedNoPrior) {
    ASSERT_EQ(relight("--from 'a box' --to 'a box lit from behind'", textured_).code, 0);
    const json record = json::parse(read_file(folder_ / "out/relight.json"));
    EXPECT_LT(angle_between(record["description"]["brightest_lobe"], 325, 25), 2);
    EXPECT_FALSE(record["words"].contains("prior"));
}

// The viewer is at azimuth 145, so left is 235, behind 325, and two o'clock 60 degrees from there.
TEST_F(RelightProgram, DirectionsInSentences) {
    struct Spoken {
        const char* words;
        double azimuth, elevation;
    };
    for (const Spoken& spoken :
         {Spoken{"lit from the left", 235, 25}, Spoken{"lit from below", 0, -90},
          Spoken{"with the sun high in the south west", 225, 60},
          Spoken{"with light from 2 o'clock", 25, 25}}) {
        // "The sun" leaves a word for the prior. Its direction is part of the light from the first
        // step on.
        const Result result = relight(
            std::string("--from 'a box' --iterations 8 --to \"a box ") + spoken.words + "\"",
            textured_);
        ASSERT_EQ(result.code, 0) << result.error;
        const json record = json::parse(read_file(folder_ / "out/relight.json"));
        EXPECT_LT(angle_between(record["description"]["brightest_lobe"], spoken.azimuth,
                                spoken.elevation),
                  5)
            << spoken.words;
    }
}

TEST_F(RelightProgram, WritesAnImageBasedLightThatReadsBack) {
    ASSERT_EQ(relight("--light noon --image-based", textured_).code, 0);
    const fs::path lit = folder_ / "out/model.glb";
    const json noon = describe("noon"), back = describe(quoted(lit));
    const json& sun = noon["brightest_lobe"];
    EXPECT_LT(angle_between(back["brightest_lobe"], sun["azimuth"], sun["elevation"]), 2);
    EXPECT_NEAR(back["color_temperature"].get<double>(), noon["color_temperature"].get<double>(),
                0.05 * noon["color_temperature"].get<double>());
    // The image-based light and the directional light together contain the sun only once.
    ASSERT_EQ(relight("--light noon --image-based --punctual", textured_).code, 0);
    EXPECT_FALSE(describe(quoted(lit))["brightest_lobe"]["is_sun"].get<bool>());
    expect_error("light " + quoted(textured_), 3, "no image-based light");
}

TEST_F(RelightProgram, ExplainsSentencesAndContradictions) {
    const std::string model = "relight " + quoted(cube_) + " -o " + quoted(folder_ / "out") + " ";
    const std::string words = "--from 'a box' --to 'a box at sunset' ";
    expect_error(model + "--from 'a box' --to 'a red box'", 2, "contains no light");
    expect_error(model + "--from 'a box' --to 'a box by torchlight'", 2, "sunset");
    expect_error(model + "--to 'a box at sunset'", 2, "--from and --to");
    expect_error(model + words + "--light noon", 2, "--light");
    expect_error(model + words + "--sky 9", 2, "--sky");
    expect_error(model + words + "--lit left", 2, "--lit");
    expect_error(model + words + "--rotate 20", 2, "--rotate");
    expect_error(model + "--seed 3", 2, "--from and --to");
    EXPECT_EQ(run(model + words + "--light-model sphere").code, 2);
    const std::string edit = "edit " + quoted(cube_) + " -o " + quoted(folder_ / "out") +
                             " --from 'a box' --to 'a red box' ";
    expect_error(edit + "--optimize light", 2, "contains no light");
    expect_error(edit + "--optimize both --light-augment all", 2, "--light-augment");
    expect_error(edit + "--light-model texels", 2, "--light-model");
    expect_error(edit + "--optimize light --texture-size 64", 2, "--texture-size");
    expect_error(model + words + "--from-light nowhere.hdr", 3, "nowhere.hdr");
    expect_error(model + words + "--prior nowhere", 3, "nowhere");
}

TEST_F(RelightProgram, LightConvertsAndChanges) {
    const fs::path file = folder_ / "noon.exr";
    const json noon = describe("noon -o " + quoted(file));
    const json& lobe = noon["brightest_lobe"];
    EXPECT_TRUE(lobe["is_sun"].get<bool>());
    const json turned = describe(quoted(file) + " --rotate 90 --exposure 1");
    EXPECT_LT(angle_between(turned["brightest_lobe"], lobe["azimuth"].get<double>() + 90,
                            lobe["elevation"]),
              0.5);
    EXPECT_NEAR(turned["mean_radiance"].get<double>() / noon["mean_radiance"].get<double>(), 2,
                1e-3);
    const json warm = describe("noon --tint '#ffd9b0'");
    EXPECT_LT(warm["color_temperature"].get<double>(),
              noon["color_temperature"].get<double>() - 500);
    EXPECT_EQ(run("light noon -o " + quoted(folder_ / "noon.png")).code, 0);
    EXPECT_NE(run("light " + quoted(file)).out.find("a sun"), std::string::npos);
}

TEST_F(RelightProgram, ExplainsMistakes) {
    const std::string model = "relight " + quoted(cube_) + " -o " + quoted(folder_ / "out") + " ";
    expect_error(model + "--lit 'a nice mood'", 3, "contains no direction");
    expect_error(model + "--light nowhere.hdr", 3, "nowhere.hdr");
    expect_error(model + "--tint mauvish", 3, "mauvish");
    expect_error(model + "--tint black", 3, "tint");
    expect_error(model + "--sun 10,95", 2, "--sun 10,95");
    expect_error(model + "--strength 2", 2, "--strength");
    EXPECT_EQ(run(model + "--sun 1,2 --lit left").code, 2);
    expect_error("relight nothing.glb -o " + quoted(folder_ / "out"), 3, "nothing.glb");
    expect_error("light noon -o noon.jpg", 2, "noon.jpg");
    EXPECT_EQ(run("light noon --tilt nan").code, 2);
    const fs::path odd = folder_ / "odd.exr";
    ASSERT_EQ(run("render " + quoted(cube_) + " --size 70x30 -o " + quoted(odd)).code, 0);
    expect_error("light " + quoted(odd), 3, "odd.exr");
}

}  // namespace
}  // namespace item3d::testing
