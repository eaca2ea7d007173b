// Tests of edits in sequence: the state that edits share changes no byte of their results, errors
// appear before the first edit, and an interrupted plan resumes.
#include "item3d/edit/sequence/sequence.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/edit/sequence/region_check.h"
#include "tests/support/edit.h"

#include <gtest/gtest.h>

namespace item3d {
namespace {

namespace fs = std::filesystem;

class SequenceTest : public testing::EditTest {
  protected:
    EditSequence sequence(const std::vector<nlohmann::json>& settings) const {
        EditSequence all;
        all.plan = "plan.json";
        all.model = folder_ / "cube.glb";
        all.output = folder_ / "out";
        for (const nlohmann::json& one : settings)
            all.edits.push_back(request("unused", 2, one));
        return all;
    }
    /// Returns the settings of two edits. The prior encodes another number of sentences for the
    /// second.
    static std::vector<nlohmann::json> two() {
        return {{{"region", {"box=-1,-1,-1,0,1,1"}}, {"iterations", 1}, {"fit_steps", 10}},
                {{"from", "a blue cube"},
                 {"to", "a metal cube"},
                 {"negative_prompt", "a cup"},
                 {"fit_steps", 10}}};
    }
    /// Checks that the results are those of separate edits.
    void expect_as_by_hand(const EditSequence& all) const {
        fs::path model = all.model;
        for (std::size_t i = 0; i < all.edits.size(); ++i) {
            EditRequest one = all.edits[i];
            one.model = model;
            one.output = folder_ / ("hand" + std::to_string(i + 1));
            one.draws_turntable = false;
            edit_model(one);
            model = one.output / "model.glb";
            const fs::path planned = all.output / std::to_string(i + 1);
            for (const char* file : {"model.glb", "before.png", "after.png"})
                EXPECT_EQ(read_bytes(planned / file), read_bytes(one.output / file)) << i << file;
            EXPECT_EQ(read_bytes(planned / "layer.safetensors"),
                      read_bytes(one.output / "layer.safetensors"))
                << i;
        }
    }
    /// Interrupts the sequence in the second edit, then runs it to the end.
    static void run_in_two_parts(EditSequence all) {
        all.edits[1].stop_after = 1;
        try {
            edit_in_sequence(all);
            FAIL() << "an edit was not stopped";
        } catch (const Interrupted& stop) {
            EXPECT_NE(std::string(stop.what())
                          .find("edit 2 of 2: a checkpoint was saved at iteration 1 of 2"),
                      std::string::npos)
                << stop.what();
        }
        EXPECT_TRUE(fs::exists(all.output / "checkpoint.safetensors"));
        EXPECT_FALSE(fs::exists(all.output / "report.html"));
        const auto first = fs::last_write_time(all.output / "1" / "model.glb");
        all.edits[1].stop_after = 0;
        all.resume = true;
        ::testing::internal::CaptureStderr();
        const nlohmann::json record = edit_in_sequence(all);
        const std::string said = ::testing::internal::GetCapturedStderr();
        EXPECT_NE(said.find("resuming after iteration 1 of 2"), std::string::npos) << said;
        EXPECT_EQ(record["edits"].size(), 2u);
        EXPECT_EQ(fs::last_write_time(all.output / "1" / "model.glb"), first);
    }
    /// Checks that a change of the second edit leaves the first one's result alone.
    void expect_change_is_made(EditSequence all) const {
        const auto first = fs::last_write_time(all.output / "1" / "model.glb");
        const Bytes before = read_bytes(all.output / "model.glb");
        all.edits[1].plan = request("unused", 0).plan;
        all.resume = true;
        edit_in_sequence(all);
        EXPECT_NE(read_bytes(all.output / "model.glb"), before);
        EXPECT_EQ(fs::last_write_time(all.output / "1" / "model.glb"), first);
    }
    /// Returns the error of check_regions() for the cube, or "".
    std::string refusal(const std::vector<nlohmann::json>& settings) const {
        try {
            check_regions("plan.json", sequence(settings).edits, load_model(folder_ / "cube.glb"));
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    }
};

TEST_F(SequenceTest, GivesTheBytesOfItsEditsByHandAndGoesOn) {
    const EditSequence all = sequence(two());
    run_in_two_parts(all);
    expect_as_by_hand(all);
    EXPECT_EQ(read_bytes(all.output / "model.glb"), read_bytes(all.output / "2" / "model.glb"));
    EXPECT_TRUE(fs::exists(all.output / "2" / "turntable.webp"));
    EXPECT_FALSE(fs::exists(all.output / "1" / "turntable.webp"));
    EXPECT_FALSE(fs::exists(all.output / "checkpoint.safetensors"));
    EXPECT_NE(read_text(all.output / "report.html").find("a metal cube"), std::string::npos);
    expect_change_is_made(all);
}

TEST_F(SequenceTest, MistakesAreToldBeforeTheFirstEdit) {
    const nlohmann::json good = {{"region", {"box=-1,-1,-1,0,1,1"}}};
    const auto second = [&](const std::string& selector) {
        return refusal({good, {{"region", {selector}}}});
    };
    EXPECT_EQ(refusal({good, good}), "");
    // These are allowed, because the first edit may create something purple or wheel-like.
    EXPECT_EQ(second("named=purple"), "");
    EXPECT_EQ(second("words=wheel"), "");
    EXPECT_EQ(second("auto"), "");
    EXPECT_NE(second("material=wood").find("plan.json: edit 2: material=wood"), std::string::npos);
    EXPECT_NE(second("node=wheel").find("edit 2"), std::string::npos);
    EXPECT_NE(second("group=wheel").find("edit 2"), std::string::npos);
    EXPECT_NE(second("attribute=_A").find("edit 2"), std::string::npos);
    EXPECT_NE(second("sphere=0,0,9,1").find("outside the model"), std::string::npos);
    EXPECT_NE(second("sphere=0,0,0,0.2").find("nothing of the edited materials"),
              std::string::npos);
    EXPECT_NE(second("mask=/nowhere.png").find("edit 2: /nowhere.png"), std::string::npos);
    EXPECT_NE(second("view=/nowhere.png@20,30").find("edit 2"), std::string::npos);
    EXPECT_NE(second("named=mauve").find("edit 2: named=mauve"), std::string::npos);
    EXPECT_NE(second("color=mauve").find("edit 2: color=mauve: is not a colour"), std::string::npos)
        << second("color=mauve");
    EXPECT_NE(refusal({good, {{"material", {"wood"}}}}).find("edit 2: --material"),
              std::string::npos);
    const EditSequence all = sequence({good, {{"region", {"material=wood"}}}});
    EXPECT_THROW(edit_in_sequence(all), InputError);
    EXPECT_FALSE(fs::exists(all.output / "1"));
}

TEST_F(SequenceTest, GroupsOfAnObjAreKnownToAllEdits) {
    const EditRequest edit = request("out", 1);
    Model model = load_model(edit.model);
    model.groups = {{"left"}, {"right", "chair"}};
    std::vector<int>& groups = model.primitives.at(0).triangle_groups;
    groups.assign(model.primitives.at(0).indices.size() / 3, 1);
    groups.front() = 0;
    EditSession session;
    EXPECT_TRUE(session.take_model(edit).groups.empty());
    session.keep_groups(model);
    const Model taken = session.take_model(edit);
    EXPECT_EQ(taken.groups, model.groups);
    EXPECT_EQ(taken.primitives.at(0).triangle_groups, groups);
    groups.push_back(0);  // now the groups are those of another mesh
    session.keep_groups(model);
    EXPECT_TRUE(session.take_model(edit).groups.empty());
}

TEST_F(SequenceTest, OverlapsAreNoted) {
    const auto said = [&](const std::string& other) {
        ::testing::internal::CaptureStderr();
        refusal({{{"region", {"box=-1,-1,-1,0,1,1"}}}, {{"region", {other}}}});
        return ::testing::internal::GetCapturedStderr();
    };
    EXPECT_NE(said("box=-1,0,-1,1,1,1").find("edits 1 and 2 overlap"), std::string::npos);
    EXPECT_EQ(said("box=0.01,-1,-1,1,1,1"), "");
    EXPECT_EQ(said("named=red"), "");
}

}  // namespace
}  // namespace item3d
