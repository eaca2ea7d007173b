// The pages of a participant: each has an order and positions of their own.
#pragma once

#include "item3d/study/study.h"

#include <cstdint>
#include <vector>

namespace item3d {

struct StudyPage {
    const StudyItem* item = nullptr;  ///< of the study
    bool edited_first = false;        ///< the edited object is on the left, or above
};

/// Practice items as the study has them, then all others shuffled, attention items never first
/// among these. Decided by the study's seed and the participant's number. The pages point into
/// `study`.
std::vector<StudyPage> pages_of(const Study& study, std::int64_t participant);

}  // namespace item3d
