#include "tests/fuzz/replay.h"

namespace item3d {
namespace {

const std::filesystem::path fuzz_folder = std::filesystem::path(ITEM3D_TEST_DATA) / "../fuzz";

// The folder corpus/TARGET has inputs each of which once failed. A failure here ends the program.
TEST(FuzzTensors, WhatOnceFailedIsReadOrRefused) {
    ASSERT_FALSE(fuzz::all_targets().empty());
    fuzz::for_files_of_targets(fuzz_folder / "corpus",
                               [](const std::string& target, const std::filesystem::path& file) {
                                   SCOPED_TRACE(file.string());
                                   fuzz::replay(target, fuzz::bytes_of(file));
                               });
}

// Small files of each kind are read whole, cut off, and with a changed bit at many places.
TEST(FuzzTensors, DamagedSeedsAreReadOrRefused) {
    std::map<std::string, int> inputs;
    fuzz::for_files_of_targets(fuzz_folder / "seeds",
                               [&](const std::string& target, const std::filesystem::path& file) {
                                   inputs[target] += fuzz::replay_damaged(target, file, 16);
                               });
    for (const auto& [name, target] : fuzz::all_targets())
        EXPECT_GE(inputs[name], 16) << name << " has no seeds";
}

}  // namespace
}  // namespace item3d
