// Test of resuming a suite of edits whose prior has random weights.
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/suite/edit_suite.h"
#include "tests/support/edit.h"

#include <gtest/gtest.h>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class SuiteResume : public testing::EditTest {
  protected:
    void SetUp() override {
        EditTest::SetUp();
        options_.output = folder_ / "suite";
        options_.prior = folder_ / "prior";
        options_.image_pixels = 32;
        options_.meshes = {{"cube", folder_ / "cube.glb"}};
        fs::copy(fs::path(ITEM3D_TEST_DATA) / "models" / "pipeline_sd", options_.prior,
                 fs::copy_options::recursive);
        const json colors = {{{"word", "red"}, {"base_color", {.7, .02, .02}}},
                             {{"word", "blue"}, {"base_color", {.02, .08, .65}}}};
        const json defaults = {{"iterations", 2},
                               {"batch", 1},
                               {"resolution", 32},
                               {"fit_steps", 20},
                               {"light", (folder_ / "light.exr").string()},
                               {"light_augment", "off"},
                               {"texture_size", 64}};
        write_atomically(options_.prior / "prior.json",
                         json{{"vocabulary", {{"colors", colors}}}, {"defaults", defaults}}.dump());
    }

    const SuiteCase to_blue_{"colors", "cube", "red", "blue", "blue"};
    const SuiteCase to_red_{"colors", "cube", "blue", "red", "red"};
    SuiteOptions options_;
};

TEST_F(SuiteResume, WhatIsDoneIsKeptAndTheRestIsRun) {
    const json first = run_edit_suite({to_blue_}, options_);
    const fs::path done = options_.output / first["edits"][0]["folder"].get<std::string>();
    const auto written = fs::last_write_time(done / "model.glb");

    options_.resume = true;
    const json both = run_edit_suite({to_blue_, to_red_}, options_);
    ASSERT_EQ(both["edits"].size(), 2u);
    EXPECT_EQ(both["edits"][0], first["edits"][0]);
    EXPECT_EQ(fs::last_write_time(done / "model.glb"), written);
    EXPECT_EQ(both["edits"][1]["to"], "a red cube");
    EXPECT_EQ(both["totals"]["groups"]["colors"]["edits"], 2);

    // A result for another seed does not count, and the edit refuses to resume from that seed's
    // checkpoint.
    options_.seed = 1;
    EXPECT_THROW(run_edit_suite({to_blue_}, options_), InputError);
}

TEST_F(SuiteResume, WhatOtherWeightsMadeIsMadeAgain) {
    const json first = run_edit_suite({to_blue_}, options_);
    const fs::path done = options_.output / first["edits"][0]["folder"].get<std::string>();
    const auto written = fs::last_write_time(done / "model.glb");

    // Only one bit of the last weight changes, so that the file can still be read.
    const fs::path weights = options_.prior / "vae" / "diffusion_pytorch_model.safetensors";
    Bytes bytes = read_bytes(weights);
    bytes.back() ^= 1;
    write_atomically(weights, bytes);
    options_.resume = true;
    run_edit_suite({to_blue_}, options_);
    EXPECT_NE(fs::last_write_time(done / "model.glb"), written);
}

}  // namespace
}  // namespace item3d
