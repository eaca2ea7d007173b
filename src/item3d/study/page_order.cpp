#include "item3d/study/page_order.h"

#include "item3d/core/random.h"

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
    for (const StudyItem* item : attention) {
        const auto places = static_cast<std::int64_t>(ratings.size());
        const std::int64_t place = places > 0 ? 1 + random.index(places) : 0;
        ratings.insert(ratings.begin() + place, item);
    }
    std::vector<StudyPage> pages;
    for (const auto* list : {&practice, &ratings})
        for (const StudyItem* item : *list)
            pages.push_back({item, random.chance(0.5)});
    return pages;
}

}  // namespace item3d
