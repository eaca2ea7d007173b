#include "tests/fuzz/fuzz.h"

#include <gtest/gtest.h>

#include <iterator>
#include <vector>

namespace item3d {
namespace {

std::vector<std::uint8_t> bytes_of(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

// corpus/TARGET has inputs each of which once failed; a failure here ends the program.
TEST(Fuzz, WhatOnceFailedIsReadOrRefused) {
    const std::filesystem::path corpus = std::filesystem::path(ITEM3D_TEST_DATA) / "../fuzz/corpus";
    ASSERT_FALSE(fuzz::all_targets().empty());
    if (!std::filesystem::exists(corpus)) return;  // nothing failed yet
    for (const auto& folder : std::filesystem::directory_iterator(corpus)) {
        const std::string name = folder.path().filename().string();
        ASSERT_TRUE(fuzz::all_targets().contains(name)) << "no target is named " << name;
        for (const auto& entry : std::filesystem::directory_iterator(folder)) {
            SCOPED_TRACE(entry.path().string());
            const auto input = bytes_of(entry.path());
            EXPECT_EQ(fuzz::all_targets().at(name)(input.data(), input.size()), 0);
        }
    }
}

// Whole files of the tests, and each cut off or with a byte changed at many places.
TEST(Fuzz, DamagedFilesAreReadOrRefused) {
    const std::filesystem::path data = ITEM3D_TEST_DATA;
    int inputs = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(data)) {
        if (!entry.is_regular_file() || entry.file_size() > 20000) continue;
        const auto whole = bytes_of(entry.path());
        for (const auto& [name, read] : fuzz::all_targets()) {
            if (!entry.path().string().ends_with("." + name)) continue;
            SCOPED_TRACE(entry.path().string());
            for (std::size_t part = 0; part < 16; ++part) {
                auto damaged = whole;
                const std::size_t place = whole.size() * part / 16;
                if (part % 2 == 0 && part > 0)
                    damaged.resize(place);
                else if (place < damaged.size() && part > 0)
                    damaged[place] ^= static_cast<std::uint8_t>(1u << part % 8);
                EXPECT_EQ(read(damaged.data(), damaged.size()), 0);
                ++inputs;
            }
        }
    }
    EXPECT_GT(inputs, 200);
}

}  // namespace
}  // namespace item3d
