// Pages of the participants. They are plain HTML and CSS without script, for wide and narrow
// screens.
#pragma once

#include "item3d/study/page_order.h"
#include "item3d/study/study.h"

#include <optional>
#include <string>

namespace item3d {

/// Style sheet of all pages, which is served as /style.css.
extern const char* const study_style;

/// Returns the study's description with a consent button. home: path of the participant's link.
std::string consent_page(const Study& study, const std::string& home, std::size_t pages);

/// Item page with its questions.
struct ItemPage {
    const Study* study = nullptr;
    StudyPage page;
    std::string home;        ///< path of the participant's link; the form goes to HOME/NUMBER
    std::size_t number = 1;  ///< number of this page, from 1
    std::size_t count = 1;   ///< number of pages
    /// Current choice; 0 for a question without an answer.
    StudyAnswer chosen{};
    std::string problem;  ///< message above the questions; may be empty
};
std::string item_page(const ItemPage& shown);

/// Returns the page after the last item.
std::string thanks_page(const Study& study, const std::string& home, std::size_t pages);

/// Returns a page with one message.
std::string message_page(const std::string& title, const std::string& message);

}  // namespace item3d
