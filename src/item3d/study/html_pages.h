// The pages that participants see: plain HTML and CSS, for wide screens and telephones, without
// script.
#pragma once

#include "item3d/study/page_order.h"
#include "item3d/study/study.h"

#include <optional>
#include <string>

namespace item3d {

/// /style.css of all pages.
extern const char* const study_style;

/// The study's description and a button that agrees. home: path of the participant's link.
std::string consent_page(const Study& study, const std::string& home, std::size_t pages);

/// One item with its questions.
struct ItemPage {
    const Study* study = nullptr;
    StudyPage page;
    std::string home;        ///< path of the participant's link; the form goes to HOME/NUMBER
    std::size_t number = 1;  ///< of this page, from 1
    std::size_t count = 1;   ///< of pages
    /// What is chosen already; 0: nothing.
    StudyAnswer chosen{};
    std::string problem;  ///< above the questions; empty: none
};
std::string item_page(const ItemPage& shown);

/// After the last page.
std::string thanks_page(const Study& study, const std::string& home, std::size_t pages);

/// A page of one message.
std::string message_page(const std::string& title, const std::string& message);

}  // namespace item3d
