#include "item3d/study/page_order.h"

#include "item3d/core/random.h"

#include <algorithm>
#include <utility>

namespace item3d {

std::vector<StudyPage> pages_of(const Study& study, std::int64_t participant) {
    Random random(study.seed ^ mix_bits(static_cast<std::uint64_t>(participant)),
                  IndexedStream::study_pages);
    std::vector<const StudyItem*> practice, ratings, attention;
    for (const StudyItem& item : study.items) {
        auto& list = item.kind == StudyItemKind::practice ? practice
                     : item.kind == StudyItemKind::rating ? ratings
                                                          : attention;
        list.push_back(&item);
    }
    for (std::size_t i = ratings.size(); i > 1; --i)
        std::swap(ratings[i - 1],
                  ratings[static_cast<std::size_t>(random.index(static_cast<std::int64_t>(i)))]);
    // Each equal part of the ratings gets one attention page, so that there are never two in a row,
    // and none at the end.
    const auto parts = static_cast<std::int64_t>(attention.size());
    const auto rated = static_cast<std::int64_t>(ratings.size());
    for (std::int64_t part = 0; part < parts; ++part) {
        const std::int64_t first = 1 + part * rated / parts, end = (part + 1) * rated / parts;
        const std::int64_t place =
            part + first + random.index(std::max<std::int64_t>(1, end - first));
        ratings.insert(ratings.begin() + std::min(place, rated + part),
                       attention[static_cast<std::size_t>(part)]);
    }
    std::vector<StudyPage> pages;
    for (const auto* list : {&practice, &ratings})
        for (const StudyItem* item : *list)
            pages.push_back({item, random.chance(0.5)});
    return pages;
}

}  // namespace item3d
