// A study made of a comparison.
#pragma once

#include "item3d/study/study.h"

#include <cstdint>
#include <filesystem>
#include <string>

namespace item3d {

struct MakeStudyRequest {
    std::filesystem::path comparison;  ///< with table.csv
    std::filesystem::path output;      ///< a folder without a study
    std::string title = "Edited objects";
    std::filesystem::path consent;  ///< a text file; empty: a text that is a draft
    int practice = 2;               ///< items before the others, 0 to 2
    int attention = 2;              ///< items that ask for two numbers, 0 to 10
    std::uint64_t seed = 0;
};

/// Writes study.json and pictures/, and returns the study. A case's first seed is rated, for each
/// method; cases that lack a method are left out with a warning, since methods are compared within
/// a case. Throws InputError where there is only one method, no case with all of them, or a study
/// already in the output folder.
Study make_study(const MakeStudyRequest& request);

}  // namespace item3d
