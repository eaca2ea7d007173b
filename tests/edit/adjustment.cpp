// Tests of direction adjustment in a whole loop: its records, the effect of a captioner on the
// source, and a failing captioner.
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/edit/optimize/initial_state.h"
#include "item3d/edit/optimize/optimize.h"
#include "item3d/edit/scene.h"
#include "tests/support/edit.h"

#include <functional>

namespace item3d {
namespace {

namespace fs = std::filesystem;

using Speech = std::function<std::vector<Caption>(int call)>;

/// Captioner with scripted captions. Each call asks for captions of four views.
class ScriptedCaptioner : public Captioner {
  public:
    explicit ScriptedCaptioner(Speech speech) : speech_(std::move(speech)) {}
    std::vector<Caption> captions(const std::vector<at::Tensor>& images,
                                  const CaptionOptions&) const override {
        EXPECT_EQ(images.size(), 4u);
        EXPECT_EQ(images.front().scalar_type(), at::kByte);
        return speech_(calls++);
    }
    mutable int calls = 0;

  private:
    Speech speech_;
};

std::vector<Caption> four_times(const std::string& text, bool ended = true) {
    return std::vector<Caption>(4, Caption{text, ended});
}

class AdjustmentTest : public testing::EditTest {
  protected:
    EditRequest captioned(const std::string& output, int iterations) const {
        EditRequest edit =
            request(output, iterations, {{"adjust", "caption"}, {"adjust_every", 2}});
        edit.captioner = fs::path(ITEM3D_TEST_DATA) / "models" / "blip";
        fs::create_directories(edit.output);
        return edit;
    }
    /// Runs only the optimisation, with the scripted captioner instead of the request's.
    static EditState run(const EditRequest& edit, const Speech& speech) {
        EditScene scene = load_scene(edit);
        scene.captioner = std::make_shared<ScriptedCaptioner>(speech);
        EditState state = begin_or_resume(edit, scene);
        optimize(edit, scene, state);
        return state;
    }
};

TEST_F(AdjustmentTest, RecordsCaptionsAndWhereTheDirectionPoints) {
    const EditState state = run(captioned("out", 5), [](int call) {
        return four_times(call < 2 ? "a red cube" : "a green cube");  // call 0: the unedited model
    });
    const auto& records = state.adjustment.records;
    ASSERT_EQ(records.size(), 4u);  // before iterations 0, 2 and 4, and at the end
    EXPECT_EQ(records[1].iteration, 2);
    EXPECT_EQ(records[3].iteration, 5);
    EXPECT_EQ(records[0].captions, std::vector<std::string>(4, "a red cube"));
    EXPECT_NEAR(records[0].text->angle, 0, 1e-5);  // of equal directions, up to rounding
    EXPECT_FALSE(records[0].direction);
    EXPECT_EQ(records[2].captions.front(), "a green cube");
    EXPECT_GT(records[2].text->angle, 1);
    EXPECT_NEAR(*records[1].direction, (state.direction_length[0] + state.direction_length[1]) / 2,
                1e-6);
    EXPECT_GT(*records[1].source_loss, 0);
    EXPECT_EQ(records[1].image.sizes(), (std::vector<std::int64_t>{144, 144, 3}));
    EXPECT_TRUE(state.adjustment.failure.empty());
}

TEST_F(AdjustmentTest, ASourceThatArrivesStopsTheEditFromGoingOn) {
    EditRequest edit = captioned("out", 4);
    const EditState state =
        run(edit, [](int call) { return four_times(call == 0 ? "a red cube" : "a blue cube"); });
    // The captions change in the same way as the sentences, so nothing of the direction remains.
    for (const float length : state.direction_length)
        EXPECT_LT(length, 1e-4);
}

TEST_F(AdjustmentTest, ACaptionerThatFailsLeavesTheSourceAsItWas) {
    const std::vector<Speech> failures = {
        [](int) -> std::vector<Caption> { throw InputError("caption", "too long"); },
        [](int) -> std::vector<Caption> { throw std::runtime_error("out of memory\nat line 3"); },
        [](int) { return four_times(""); },
        [](int) { return four_times("cube cube cube cube cube", false); }};
    const EditRequest edit = captioned("out", 6);
    EditScene scene = load_scene(edit);
    EditState state = begin_or_resume(edit, scene);
    for (const Speech& failure : failures) {
        state.iteration = 0;
        state.adjustment = {};
        state.direction_length.clear();
        state.source_loss.clear();
        const auto captioner = std::make_shared<ScriptedCaptioner>([&](int call) {
            if (call < 2) return four_times("a red cube");
            return call == 2 ? four_times("a green cube") : failure(call);
        });
        scene.captioner = captioner;
        optimize(edit, scene, state);
        EXPECT_EQ(captioner->calls, 4) << "asked again after it failed";
        EXPECT_EQ(state.iteration, 6);
        EXPECT_FALSE(state.adjustment.failure.empty());
        EXPECT_EQ(state.adjustment.failure.find('\n'), std::string::npos);
        EXPECT_GT(state.adjustment.records[1].text->angle, 1);
        EXPECT_EQ(state.adjustment.records.back().text->angle,
                  state.adjustment.records[1].text->angle);
    }
}

TEST_F(AdjustmentTest, ResumesToTheSameBytes) {
    const Speech speech = [](int) { return four_times("a green cube, on the left"); };
    EditRequest whole = captioned("whole", 5);
    EditRequest parts = captioned("parts", 5);
    const auto differently = [&](int call) {
        return call == 0 ? four_times("a red cube") : speech(call);
    };
    const EditState expected = run(whole, differently);
    const auto interrupted = [&](int call) {  // in the middle of the work before iteration 4
        return call < 3 ? differently(call) : throw Interrupted("while a text was written");
    };
    EXPECT_THROW(run(parts, interrupted), Interrupted);
    parts.resume = true;
    // The captions of the unedited model were kept, so that it is not captioned again.
    const EditState state = run(parts, speech);
    EXPECT_TRUE(at::equal(state.field->table(), expected.field->table()));
    ASSERT_EQ(state.adjustment.records.size(), expected.adjustment.records.size());
    for (std::size_t i = 0; i < state.adjustment.records.size(); ++i) {
        EXPECT_EQ(nlohmann::json(state.adjustment.records[i]),
                  nlohmann::json(expected.adjustment.records[i]));
        EXPECT_TRUE(
            at::equal(state.adjustment.records[i].image, expected.adjustment.records[i].image));
    }
    EXPECT_EQ(read_bytes(whole.output / "checkpoint.safetensors").size(),
              read_bytes(parts.output / "checkpoint.safetensors").size());
    parts.captioner = "another";
    EXPECT_THROW(load_scene(parts), InputError);
}

TEST_F(AdjustmentTest, AWholeEditWithACaptionerOfRandomWeights) {
    const EditRequest edit = captioned("out", 3);
    const nlohmann::json summary = edit_model(edit);
    const auto& adjustment = summary["adjustment"];
    EXPECT_EQ(adjustment["captions_before"].size(), 4u);
    EXPECT_EQ(adjustment["records"].size(), 3u);
    EXPECT_EQ(adjustment["records"][0]["captions"].size(), 4u);
    EXPECT_EQ(summary["iterations_done"], 3);
    EXPECT_NE(read_text(edit.output / "report.html").find("class=\"timeline\""), std::string::npos);
}

TEST_F(AdjustmentTest, CaptionsNeedACaptioner) {
    EditRequest edit = captioned("out", 1);
    edit.captioner.clear();
    EXPECT_THROW(load_scene(edit), InputError);
    change(edit, {{"guidance", "sds"}});  // SDS has no source, so it needs no captioner
    EXPECT_FALSE(load_scene(edit).captioner);
}

TEST_F(AdjustmentTest, AnEditThatHasConvergedStopsAndResumesToTheSameBytes) {
    EditRequest edit = captioned("whole", 200);
    change(edit, {{"settle", 0.99f}, {"adjust_every", 50}});
    // The direction is whole in the first window, and zero from the third record on.
    const auto speech = [](int call) {
        return four_times(call < 2 ? "a red cube" : "a blue cube");
    };
    const EditState whole = run(edit, speech);
    EXPECT_LT(whole.direction_length.size(), 200u);
    EXPECT_GE(whole.direction_length.size(), 170u);
    EXPECT_EQ(whole.iteration, 200);
    EXPECT_EQ(whole.adjustment.records.back().iteration,
              static_cast<std::int64_t>(whole.direction_length.size()));

    edit.output = folder_ / "parts";
    fs::create_directories(edit.output);
    edit.stop_after = 100;
    EXPECT_THROW(run(edit, speech), Interrupted);
    edit.stop_after = 0;
    edit.resume = true;
    const EditState resumed = run(edit, [](int) { return four_times("a blue cube"); });
    EXPECT_EQ(resumed.direction_length, whole.direction_length);
    EXPECT_TRUE(at::equal(resumed.field->table(), whole.field->table()));
    // A second resume has nothing to do.
    const EditState again = run(edit, speech);
    EXPECT_EQ(again.direction_length.size(), whole.direction_length.size());
    EXPECT_EQ(again.adjustment.records.size(), whole.adjustment.records.size());
}

}  // namespace
}  // namespace item3d
