#include "item3d/study/page_order.h"

#include "tests/support/study.h"

#include <set>

namespace item3d::testing {
namespace {

std::string order_of(const std::vector<StudyPage>& pages) {
    std::string order;
    for (const StudyPage& page : pages)
        order += page.item->id.back();
    return order;
}

TEST(StudyPages, EachParticipantHasAnOrderAndPositionsOfTheirOwn) {
    const Study study = small_study();
    std::set<std::string> orders;
    int edited_first = 0;
    std::map<char, int> second;  // letter of the page after the practice page
    constexpr int participants = 300;
    for (int participant = 1; participant <= participants; ++participant) {
        const auto pages = pages_of(study, participant);
        ASSERT_EQ(pages.size(), study.items.size());
        EXPECT_EQ(pages[0].item->kind, StudyItemKind::practice);
        EXPECT_EQ(pages[1].item->kind, StudyItemKind::rating);
        std::set<const StudyItem*> shown;
        for (const StudyPage& page : pages) {
            shown.insert(page.item);
            edited_first += page.edited_first;
        }
        EXPECT_EQ(shown.size(), study.items.size());
        orders.insert(order_of(pages));
        ++second[pages[1].item->id.back()];
        EXPECT_EQ(order_of(pages), order_of(pages_of(study, participant)));
    }
    // There are 6! * 6 = 4,320 orders, and 300 draws have about 290 different ones.
    EXPECT_GT(orders.size(), 260u);
    // The 2,400 choices are like coins, for which five standard deviations are 122.
    EXPECT_NEAR(edited_first, 1200, 122);
    // The 300 choices are like dice, for which five standard deviations are 32.
    ASSERT_EQ(second.size(), 6u);
    for (const auto& [item, count] : second)
        EXPECT_NEAR(count, 50, 32) << item;
}

}  // namespace
}  // namespace item3d::testing
