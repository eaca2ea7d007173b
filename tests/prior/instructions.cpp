// Tests of the image pairs that instructions describe.
#include "item3d/prior/data/instructions.h"

#include "item3d/prior/data/dataset.h"
#include "item3d/prior/data/lights.h"

#include <gtest/gtest.h>

#include <set>

namespace item3d {
namespace {

TEST(PriorInstructions, AreSaidInManyWays) {
    std::set<std::string> objects, parts;
    for (std::uint64_t i = 0; i < 300; ++i) {
        Random random(4, i);
        objects.insert(instruction_for_object(random, {"mug"}, {"orange {o}", "{o} with dots"}));
        parts.insert(instruction_for_part(random, "handle", {"{o} of oak", "orange {o}"}));
    }
    for (const char* text : {"make it orange", "make the mug orange", "turn it into an orange mug",
                             "turn it into a mug with dots", "make it an orange object"})
        EXPECT_TRUE(objects.count(text)) << text;
    EXPECT_EQ(parts, (std::set<std::string>{"make the handle orange", "give it an orange handle"}));
}

/// Returns a view of a mug that shows enough of its handle.
ShapeView view_with_a_handle() {
    for (const ShapeView& view : make_views("mug", 0, 4, 5, 32))
        if (!visible_parts(view).empty()) return view;
    ADD_FAILURE() << "no view shows the handle";
    return {};
}

TEST(PriorInstructions, APairDiffersWhereTheInstructionSays) {
    const std::vector<TrainingLight> lights = make_training_lights(3, 4, 1);
    const ShapeView view = view_with_a_handle();
    int of_parts = 0;
    for (std::uint64_t i = 0; i < 12; ++i) {
        Random random(8, i), again(8, i);
        const InstructionPair pair = draw_instruction_pair(random, view, lights);
        const at::Tensor change = (pair.after - pair.before).abs().amax(2);
        EXPECT_GT(change.max().item<float>(), 0.02f) << pair.instruction;
        // The corners are background, which is unchanged.
        EXPECT_EQ(change[0][0].item<float>(), 0) << pair.instruction;
        const bool of_a_part = pair.instruction.find("handle") != std::string::npos;
        of_parts += of_a_part;
        if (of_a_part) {
            EXPECT_LT(change.gt(0.02).to(at::kFloat).mean().item<float>(), 0.35f)
                << pair.instruction;
        }
        const InstructionPair same = draw_instruction_pair(again, view, lights);
        EXPECT_EQ(same.instruction, pair.instruction);
        EXPECT_TRUE(same.after.equal(pair.after));
    }
    EXPECT_GT(of_parts, 0);
    EXPECT_LT(of_parts, 12);
}

}  // namespace
}  // namespace item3d
