// Creation of a study from a comparison.
#pragma once

#include "item3d/study/study.h"

#include <cstdint>
#include <filesystem>
#include <string>

namespace item3d {

struct MakeStudyRequest {
    std::filesystem::path comparison;  ///< folder with table.csv
    std::filesystem::path output;      ///< folder, must not contain a study
    std::string title = "Edited objects";
    std::filesystem::path consent;  ///< text file; empty: a draft text
    int practice = 2;               ///< number of items before the others, 0 to 2
    int attention = 2;              ///< number of items that ask for two given numbers, 0 to 10
    std::uint64_t seed = 0;
};

/// Writes study.json and pictures/, and returns the study. For each method the first seed of a case
/// is rated; practice shows other seeds where there are some. Cases that lack a method are left out
/// with a warning, since methods are compared within a case. Throws InputError, and leaves no
/// images, if there is only one method, no case with all of them, an image that cannot be read, a
/// study already in the output folder, or a title or consent text that is empty or not UTF-8.
Study make_study(const MakeStudyRequest& request);

}  // namespace item3d
