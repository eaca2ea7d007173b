// Order of a participant's pages, and the side of each image.
#pragma once

#include "item3d/study/study.h"

#include <cstdint>
#include <vector>

namespace item3d {

struct StudyPage {
    const StudyItem* item = nullptr;  ///< item of the study
    bool edited_first = false;        ///< true if the edited object is on the left, or above
};

/// Returns the practice items in the study's order, then all other items shuffled. The first of the
/// other items is no attention item. The order is deterministic in the study's seed and the
/// participant's number. The pages point into `study`.
std::vector<StudyPage> pages_of(const Study& study, std::int64_t participant);

}  // namespace item3d
