// Runs a program's targets on inputs that once failed, and on small files of the tests that are
// damaged.
#pragma once

#include "tests/fuzz/fuzz.h"

#include <gtest/gtest.h>

#include <iterator>

namespace item3d::fuzz {

inline std::vector<std::uint8_t> bytes_of(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

inline void replay(const std::string& target, const std::vector<std::uint8_t>& input) {
    EXPECT_EQ(all_targets().at(target)(input.data(), input.size()), 0);
}

/// Reads a file whole, and cut off or with a changed bit at `parts` - 1 places. Returns the number
/// of inputs.
inline int replay_damaged(const std::string& target, const std::filesystem::path& path,
                          std::size_t parts) {
    SCOPED_TRACE(target + " of " + path.string());
    const auto whole = bytes_of(path);
    for (std::size_t part = 0; part < parts; ++part) {
        auto damaged = whole;
        const std::size_t place = whole.size() * part / parts;
        if (part % 2 == 0 && part > 0)
            damaged.resize(place);
        else if (place < damaged.size() && part > 0)
            damaged[place] ^= static_cast<std::uint8_t>(1u << part % 8);
        replay(target, damaged);
    }
    return static_cast<int>(parts);
}

/// Calls `read` for the files of `folder`/TARGET, for each target of this program.
template <class Replay>
void for_files_of_targets(const std::filesystem::path& folder, const Replay& read) {
    for (const auto& [name, target] : all_targets()) {
        std::error_code none;  // no folder means no files
        for (const auto& entry : std::filesystem::directory_iterator(folder / name, none))
            read(name, entry.path());
    }
}

/// Checks that each subfolder has the name of a target, of this program or of the other one.
inline void expect_names_of_targets(const std::filesystem::path& folder) {
    std::error_code none;  // no folder means no subfolders
    for (const auto& entry : std::filesystem::directory_iterator(folder, none)) {
        const std::string source = entry.path().filename().string() + ".cpp";
        EXPECT_TRUE(std::filesystem::exists(folder / ".." / source) ||
                    std::filesystem::exists(folder / "../../fuzz_tensors" / source))
            << "no target is named as " << entry.path();
    }
}

}  // namespace item3d::fuzz
