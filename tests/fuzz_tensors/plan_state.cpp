#include "item3d/edit/sequence/sequence_state.h"
#include "tests/fuzz/mutate.h"

ITEM3D_FUZZ_MUTATOR(item3d::fuzz::mutate_json<0>(data, size, maximum, seed))

/// Reads plan_state.json, asks for the state of its edits, and begins and finishes one.
ITEM3D_FUZZ_TARGET(plan_state, data, size) {
    using namespace item3d;
    return fuzz::read_or_refuse([&] {
        SequenceState state(fuzz::as_file("plan_state.json", fuzz::as_text(data, size)), true);
        const nlohmann::json question = {{"to", "a blue mug"}};
        for (const std::size_t index : {0, 1, 1000}) {
            state.is_done(index, question);
            state.is_begun(index, question);
        }
        state.begin(1, question);
        state.finish(1);
    });
}
