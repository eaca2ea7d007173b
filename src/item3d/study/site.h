// Request handling of a study, without sockets. It replies with pages and stores answers.
//
//   GET  /p/TOKEN         the participant's next page: consent, an item, or thanks
//   POST /p/TOKEN/agree   agrees to the consent text
//   GET  /p/TOKEN/NUMBER  an item that is answered already, or the next one
//   POST /p/TOKEN/NUMBER  stores an answer: one number from 1 to 5 for each question
//   GET  /pictures/NAME   an image of the study
//   GET  /style.css
#pragma once

#include "item3d/study/answers.h"
#include "item3d/study/study.h"

#include <filesystem>
#include <map>
#include <set>
#include <string>

namespace item3d {

struct SiteRequest {
    bool is_post = false;
    std::string path;                         ///< decoded, without a query
    std::map<std::string, std::string> form;  ///< fields of a POST
};

struct SiteReply {
    int status = 200;
    std::string type = "text/html; charset=utf-8";
    std::string body;
    std::string location;  ///< target of a redirect (303)
    /// True if browsers may cache the reply; only images and the style sheet.
    bool may_be_kept = false;
};

/// Request handler. reply() is thread-safe.
class StudySite {
  public:
    /// `study` and `answers` must outlive this object. folder: folder that has pictures/.
    StudySite(const Study& study, AnswerStore& answers, std::filesystem::path folder);

    /// Replies to a request. The reply is an error page (400, 404), and nothing changes, for an
    /// invalid answer (not a number from 1 to 5), for a page that comes later, and for an unknown
    /// link. Throws like AnswerStore.
    SiteReply reply(const SiteRequest& request);

  private:
    SiteReply reply_to(const Participant& participant, const SiteRequest& request,
                       const std::string& rest);
    SiteReply image(const std::string& name) const;

    const Study& study_;
    AnswerStore& answers_;
    std::filesystem::path folder_;
    std::set<std::string> images_;
};

/// Returns the path of a participant's link.
std::string participant_path(const Participant& participant);

}  // namespace item3d
