// Tests of one edit by several processes: equal to one process up to the order of sums.
#include "tests/support/processes.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "tests/support/edit.h"

#include <gtest/gtest.h>

namespace item3d::testing {
namespace {

/// Allowed mean absolute difference of texels between runs with different numbers of processes, in
/// fp32. Sums in another order differ in their last bits, and sampling in the detail stage
/// amplifies that.
constexpr double tolerance = 0.5 / 255;

class EditProcesses : public EditTest {
  protected:
    void SetUp() override {
        EditTest::SetUp();
        if (is_process()) processes_ = ProcessGroup::from_environment();
    }

    /// Returns a request of two views per iteration, with a detail stage. It is the same in all
    /// processes.
    EditRequest shared_request(const std::string& output) const {
        EditRequest edit = request(
            output, 4,
            {{"batch", 2}, {"adjust_samples", 2}, {"detail", "always"}, {"detail_views", 2}});
        if (is_process()) {
            edit.model = process_folder() / "cube.glb";
            edit.output = process_folder() / output;
            edit.processes = processes_;
            change(edit, {{"light", (process_folder() / "light.exr").string()}});
        }
        return edit;
    }

    /// Runs the current test in `count` processes that share a folder.
    fs::path run(int count) const {
        const fs::path folder = folder_ / std::to_string(count);
        fs::create_directories(folder);
        for (const char* name : {"cube.glb", "light.exr"})
            fs::copy_file(folder_ / name, folder / name);
        for (const auto& result : run_as_processes(folder, count))
            EXPECT_EQ(result.code, 0) << result.output;
        return folder;
    }

    void expect_alike(const fs::path& model, const fs::path& other) const {
        EXPECT_LT(mean_difference(base_color_of(model), base_color_of(other)), tolerance) << other;
    }

    ProcessGroup processes_;
};

/// Three processes divide the points of the two views among themselves.
TEST_F(EditProcesses, TwoAndThreeMakeWhatOneMakes) {
    if (is_process()) {
        const nlohmann::json summary = edit_model(shared_request("out"));
        EXPECT_EQ(summary.is_null(), !processes_.first());
        return;
    }
    const EditRequest alone = shared_request("out");
    const nlohmann::json summary = edit_model(alone);
    const Image before = base_color_of(alone.model);
    EXPECT_GT(mean_difference(before, base_color_of(alone.output / "model.glb")), 4 * tolerance);
    for (const int count : {2, 3}) {
        const fs::path folder = run(count);
        expect_alike(alone.output / "model.glb", folder / "out" / "model.glb");
        const auto shared = nlohmann::json::parse(read_text(folder / "out" / "edit.json"));
        EXPECT_EQ(shared["processes"], count);
        EXPECT_EQ(shared["unet_rows"], summary["unet_rows"]);
        EXPECT_GT(shared["seconds_per_iteration"]["exchange"], 0);
    }
}

TEST_F(EditProcesses, WhatTwoBeganOneEnds) {
    if (is_process()) {
        EditRequest edit = shared_request("out");
        edit.stop_after = 2;
        EXPECT_THROW(edit_model(edit), Interrupted);
        return;
    }
    const EditRequest alone = shared_request("alone");
    edit_model(alone);
    EditRequest resumed = shared_request("out");
    const fs::path folder = run(2);
    resumed.model = folder / "cube.glb";
    resumed.output = folder / "out";
    resumed.resume = true;
    change(resumed, {{"light", (folder / "light.exr").string()}});
    edit_model(resumed);
    expect_alike(alone.output / "model.glb", resumed.output / "model.glb");
}

/// The error is one line from each process.
TEST_F(EditProcesses, AnotherSettingEndsAllBeforeAnythingIsWritten) {
    if (is_process()) {
        EditRequest edit = shared_request("out");
        if (!processes_.first()) change(edit, {{"seed", 9}});
        try {
            edit_model(edit);
            FAIL() << "nobody noticed";
        } catch (const Error& error) {
            const std::string message = error.what();
            EXPECT_EQ(message.find('\n'), std::string::npos) << message;
            const char* wanted = processes_.first()
                                     ? "another process has different files or options"
                                     : "'seed' differs from process 0: 9";
            EXPECT_NE(message.find(wanted), std::string::npos) << message;
        }
        return;
    }
    EXPECT_FALSE(fs::exists(run(2) / "out"));
}

TEST_F(EditProcesses, MethodsThatPaintPictureAfterPictureRunOnOne) {
    if (!is_process()) {
        run(2);
        return;
    }
    EditRequest edit = shared_request("out");
    change(edit, {{"method", "texture"}});
    EXPECT_THROW(edit_model(edit), InputError);
    processes_.barrier();
}

}  // namespace
}  // namespace item3d::testing
