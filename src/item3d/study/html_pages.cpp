#include "item3d/study/html_pages.h"

#include "item3d/core/html_escape.h"

#include <fmt/format.h>

#include <algorithm>

namespace item3d {

const char* const study_style = R"css(
:root { --ink: #22211f; --soft: #66635d; --line: #d6d2c9; --card: #fff; --paper: #f5f4f0; --accent: #9a3412; }
* { box-sizing: border-box; }
body { margin: 0; background: var(--paper); color: var(--ink); font: 17px/1.5 system-ui, sans-serif; }
main { max-width: 1180px; margin: 0 auto; padding: 20px 18px 40px; }
main.narrow { max-width: 640px; padding-top: 8vh; }
h1 { font-size: 1.5rem; line-height: 1.25; margin: 0 0 16px; }
h1.sentence { font-size: 1.3rem; font-weight: 500; margin: 14px 0; }
h1.sentence b { font-weight: 700; }
p { margin: 0 0 14px; }
.top { display: flex; gap: 14px; align-items: center; color: var(--soft); font-size: .9rem; }
progress { flex: 1; height: 8px; accent-color: var(--accent); }
.note { border-left: 3px solid var(--accent); background: var(--card); padding: 10px 14px; margin: 14px 0; }
.pair { display: grid; grid-template-columns: 1fr 1fr; gap: 18px; }
figure { margin: 0; }
figcaption { font-weight: 600; margin-bottom: 6px; }
figure img { display: block; width: 100%; height: auto; border-radius: 6px; }
.pair img { border: 1px solid var(--line); }
.below { display: grid; grid-template-columns: 288px 1fr; gap: 28px; margin-top: 20px; align-items: start; }
.below.alone { grid-template-columns: 1fr; }
fieldset { border: 0; margin: 0 0 22px; padding: 0; min-width: 0; }
legend { font-weight: 600; padding: 0; margin-bottom: 8px; }
.scale { display: grid; grid-template-columns: repeat(5, 1fr); gap: 8px; max-width: 520px; }
.scale label { position: relative; display: block; }
.scale input { position: absolute; opacity: 0; width: 100%; height: 100%; margin: 0; cursor: pointer; }
.scale span { display: block; text-align: center; padding: 11px 0; border: 1px solid #8b867c; border-radius: 6px; background: var(--card); }
.scale input:checked + span { background: var(--accent); border-color: var(--accent); color: #fff; font-weight: 700; }
.scale input:focus-visible + span { outline: 3px solid var(--ink); outline-offset: 2px; }
.ends { display: flex; justify-content: space-between; max-width: 520px; color: var(--soft); font-size: .9rem; margin-top: 4px; }
.go { display: flex; gap: 20px; align-items: center; }
button { font: inherit; font-weight: 600; color: #fff; background: var(--ink); border: 0; border-radius: 6px; padding: 12px 30px; cursor: pointer; }
button:focus-visible, a:focus-visible { outline: 3px solid var(--accent); outline-offset: 2px; }
a { color: var(--accent); }
@media (max-width: 760px) {
  .pair, .below { grid-template-columns: 1fr; gap: 16px; }
  .below figure { max-width: 288px; }
  .scale { gap: 6px; }
  .go { justify-content: space-between; }
}
)css";

namespace {

std::string page_around(const std::string& title, const std::string& main) {
    return "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
           "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
           "<meta name=\"robots\" content=\"noindex\">\n<title>" +
           html_escape(title) +
           "</title>\n<link rel=\"icon\" href=\"data:,\">\n<link rel=\"stylesheet\" "
           "href=\"/style.css\">\n</head>\n<body>\n" +
           main + "</body>\n</html>\n";
}

/// Returns the text's paragraphs as HTML. Empty lines separate them in the text.
std::string study_paragraphs(const std::string& text) {
    std::string html;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find("\n\n", begin), text.size());
        const std::string paragraph = text.substr(begin, end - begin);
        if (paragraph.find_first_not_of(" \n\r\t") != std::string::npos)
            html += "<p>" + html_escape(paragraph) + "</p>\n";
        begin = end + 2;
    }
    return html;
}

std::string still(const std::string& name, const std::string& caption) {
    return fmt::format(
        "<figure><figcaption>{0}</figcaption><img src=\"/pictures/{1}\" alt=\"{0}, from six "
        "sides\"></figure>\n",
        caption, html_escape(name));
}

std::string question_field(const StudyQuestion& question, int chosen) {
    std::string html = fmt::format("<fieldset>\n<legend>{}</legend>\n<div class=\"scale\">\n",
                                   html_escape(std::string(question.text)));
    for (int value = min_rating; value <= max_rating; ++value)
        html += fmt::format(
            "<label><input type=\"radio\" name=\"{0}\" value=\"{1}\" required{2}>"
            "<span>{1}</span></label>\n",
            question.id, value, value == chosen ? " checked" : "");
    return html + fmt::format(
                      "</div>\n<div class=\"ends\"><span>{}</span><span>{}</span></div>\n"
                      "</fieldset>\n",
                      question.low, question.high);
}

/// Returns the required time, such as "5 minutes", at 30 seconds per page.
std::string needed_time(std::size_t pages) {
    const std::size_t minutes = std::max<std::size_t>(1, (pages + 1) / 2);
    return fmt::format("{} minute{}", minutes, minutes == 1 ? "" : "s");
}

std::string asked_sentence(const StudyItem& item) {
    if (item.kind == StudyItemKind::attention)
        return fmt::format(
            "<h1 class=\"sentence\">This page checks that the pages are read: please choose "
            "<b>{}</b> for the first question and <b>{}</b> for the second.</h1>\n",
            item.expected[0], item.expected[1]);
    return fmt::format("<h1 class=\"sentence\">The sentence: change <b>{}</b> to <b>{}</b>.</h1>\n",
                       html_escape(item.from), html_escape(item.to));
}

}  // namespace

std::string consent_page(const Study& study, const std::string& home, std::size_t pages) {
    return page_around(
        study.title,
        fmt::format("<main class=\"narrow\">\n<h1>{}</h1>\n{}<p>There are {} pages, about {} in "
                    "all.</p>\n<form method=\"post\" action=\"{}/agree\"><button>I agree, "
                    "begin</button></form>\n</main>\n",
                    html_escape(study.title), study_paragraphs(study.consent), pages,
                    needed_time(pages), home));
}

std::string item_page(const ItemPage& shown) {
    const StudyItem& item = *shown.page.item;
    std::string html = fmt::format(
        "<main>\n<div class=\"top\"><span>Page {0} of {1}</span><progress value=\"{2}\" "
        "max=\"{1}\" aria-label=\"Pages answered\"></progress></div>\n",
        shown.number, shown.count, shown.number - 1);
    if (!item.note.empty()) html += "<p class=\"note\">" + html_escape(item.note) + "</p>\n";
    html += asked_sentence(item);
    const std::string before = still(item.before, "Before"), after = still(item.after, "Edited");
    html += "<div class=\"pair\">\n" + (shown.page.edited_first ? after + before : before + after) +
            "</div>\n";
    if (item.turntable.empty())
        html += "<div class=\"below alone\">\n";
    else
        html += fmt::format(
            "<div class=\"below\">\n<figure><figcaption>Edited, rotating</figcaption><img "
            "src=\"/pictures/{}\" alt=\"The edited object, rotating\" width=\"288\" "
            "height=\"288\"></figure>\n",
            html_escape(item.turntable));
    html += fmt::format("<form method=\"post\" action=\"{}/{}\">\n", shown.home, shown.number);
    if (!shown.problem.empty())
        html += "<p class=\"note\" role=\"alert\">" + html_escape(shown.problem) + "</p>\n";
    for (std::size_t i = 0; i < study_questions.size(); ++i)
        html += question_field(study_questions[i], shown.chosen[i]);
    html += "<div class=\"go\"><button>Next</button>";
    if (shown.number > 1)
        html += fmt::format("<a href=\"{}/{}\">Previous page</a>", shown.home, shown.number - 1);
    html += "</div>\n</form>\n</div>\n</main>\n";
    return page_around(fmt::format("Page {} of {}", shown.number, shown.count), html);
}

std::string thanks_page(const Study& study, const std::string& home, std::size_t pages) {
    return page_around(
        study.title,
        fmt::format("<main class=\"narrow\">\n<h1>Thank you</h1>\n<p>All {0} pages are answered "
                    "and stored. You can close this page.</p>\n<p><a href=\"{1}/{0}\">Back to the "
                    "last page</a></p>\n</main>\n",
                    pages, home));
}

std::string message_page(const std::string& title, const std::string& message) {
    return page_around(title, fmt::format("<main class=\"narrow\">\n<h1>{}</h1>\n<p>{}</p>\n"
                                          "</main>\n",
                                          html_escape(title), html_escape(message)));
}

}  // namespace item3d
