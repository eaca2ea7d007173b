#include "item3d/study/site.h"

#include "item3d/core/files.h"
#include "item3d/core/progress.h"
#include "item3d/study/html_pages.h"
#include "item3d/study/page_order.h"

#include <fmt/format.h>

#include <charconv>
#include <optional>

namespace item3d {
namespace {

SiteReply redirect(const std::string& location) {
    SiteReply reply;
    reply.status = 303;
    reply.location = location;
    return reply;
}

SiteReply html_reply(std::string body, int status = 200) {
    SiteReply reply;
    reply.status = status;
    reply.body = std::move(body);
    return reply;
}

SiteReply not_found() {
    return html_reply(
        message_page("Nothing here",
                     "This link is unknown. Please open the complete link that was sent to you."),
        404);
}

/// Parses a text that has digits only.
std::optional<std::size_t> study_number(const std::string& text) {
    std::size_t value = 0;
    const char* end = text.data() + text.size();
    const auto parsed = std::from_chars(text.data(), end, value);
    if (parsed.ec != std::errc() || parsed.ptr != end) return std::nullopt;
    return value;
}

/// Returns the chosen numbers. A number that is missing or outside min_rating to max_rating becomes
/// 0.
StudyAnswer read_choice(const std::map<std::string, std::string>& form) {
    StudyAnswer answer{};
    for (std::size_t i = 0; i < study_questions.size(); ++i) {
        const auto field = form.find(std::string(study_questions[i].id));
        const auto value = field == form.end() ? std::nullopt : study_number(field->second);
        if (value && *value >= min_rating && *value <= max_rating)
            answer[i] = static_cast<int>(*value);
    }
    return answer;
}

bool is_whole(const StudyAnswer& answer) {
    for (const int value : answer)
        if (value == 0) return false;
    return true;
}

/// Returns the index of the first page without an answer, or the number of pages if all have
/// answers.
std::size_t first_open(const std::vector<StudyPage>& pages, const AnswersByItem& answers) {
    std::size_t place = 0;
    while (place < pages.size() && answers.contains(pages[place].item->id))
        ++place;
    return place;
}

}  // namespace

std::string participant_path(const Participant& participant) {
    return "/p/" + participant.token;
}

StudySite::StudySite(const Study& study, AnswerStore& answers, std::filesystem::path folder)
    : study_(study), answers_(answers), folder_(std::move(folder)) {
    for (const StudyItem& item : study.items)
        images_.insert({item.before, item.after, item.turntable});
    images_.erase("");
}

SiteReply StudySite::reply(const SiteRequest& request) {
    constexpr std::string_view images = "/pictures/", home = "/p/";
    const std::string& path = request.path;
    if (path == "/style.css" && !request.is_post)
        return {200, "text/css; charset=utf-8", study_style, "", true};
    if (path.starts_with(images) && !request.is_post) return image(path.substr(images.size()));
    if (path.starts_with(home)) {
        const std::size_t end = std::min(path.find('/', home.size()), path.size());
        const auto participant = answers_.find(path.substr(home.size(), end - home.size()));
        if (participant) return reply_to(*participant, request, path.substr(end));
    }
    return not_found();
}

SiteReply StudySite::image(const std::string& name) const {
    if (!images_.contains(name)) return not_found();
    const Bytes bytes = read_bytes(folder_ / "pictures" / name);
    return {200, name.ends_with(".webp") ? "image/webp" : "image/png",
            std::string(bytes.begin(), bytes.end()), "", true};
}

/// Replies to a participant's request. rest: path after the link: "", "/agree" or "/NUMBER".
SiteReply StudySite::reply_to(const Participant& participant, const SiteRequest& request,
                              const std::string& rest) {
    const std::string home = participant_path(participant);
    const std::vector<StudyPage> pages = pages_of(study_, participant.number);
    if (rest == "/agree") {
        if (request.is_post) answers_.agree(participant.number);
        return redirect(home);
    }
    if (!participant.has_agreed)
        return rest.empty() ? html_reply(consent_page(study_, home, pages.size())) : redirect(home);
    const AnswersByItem answers = answers_.answers(participant.number);
    const std::size_t open = first_open(pages, answers);
    if (rest.empty() || rest == "/") {
        if (open == pages.size()) return html_reply(thanks_page(study_, home, pages.size()));
        return redirect(fmt::format("{}/{}", home, open + 1));
    }
    const auto number = study_number(rest.substr(1));
    if (!number || *number < 1 || *number > pages.size()) return not_found();
    if (*number > open + 1) return redirect(home);

    ItemPage shown;
    shown.study = &study_;
    shown.page = pages[*number - 1];
    shown.home = home;
    shown.number = *number;
    shown.count = pages.size();
    const std::string& item = shown.page.item->id;
    if (!request.is_post) {
        if (const auto given = answers.find(item); given != answers.end())
            shown.chosen = given->second;
        return html_reply(item_page(shown));
    }
    shown.chosen = read_choice(request.form);
    if (!is_whole(shown.chosen)) {
        shown.problem = fmt::format(
            "Your answer was not stored yet. Please choose a number from {} to {} for each "
            "question.",
            min_rating, max_rating);
        return html_reply(item_page(shown), 400);
    }
    answers_.store(participant.number, item, shown.chosen);
    if (open + 1 == pages.size() && *number == pages.size())
        note(fmt::format("participant {} has answered all pages", participant.number));
    return *number == pages.size() ? redirect(home)
                                   : redirect(fmt::format("{}/{}", home, *number + 1));
}

}  // namespace item3d
