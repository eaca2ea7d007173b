// Creation of a study from a comparison.
#pragma once

#include "item3d/study/study.h"

#include <cstdint>
#include <filesystem>
#include <string>

namespace item3d {

struct MakeStudyRequest {
    std::filesystem::path comparison;  ///< folder with table.csv
    std::filesystem::path output;      ///< folder, which must not contain a study
    std::string title = "Edited objects";
    std::filesystem::path consent;  ///< text file; if empty, a draft text is used
    int practice = 2;               ///< number of practice items before all others, 0 to 2
    /// Number of attention items, which ask for two given numbers, 0 to 10.
    int attention = 2;
    std::uint64_t seed = 0;
};

/// Writes study.json and pictures/, and returns the study. Of each case and method, the first seed
/// is rated. Practice items show other seeds where there are some. Cases that lack a method are
/// left out with a warning, because methods are compared within a case. Throws InputError, and
/// leaves no images, if there is only one method, no case with all methods, an image that cannot be
/// read, a study in the output folder already, or a title or consent text that is empty or not
/// UTF-8.
Study make_study(const MakeStudyRequest& request);

}  // namespace item3d
