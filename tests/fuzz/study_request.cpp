#include "item3d/study/answers.h"
#include "item3d/study/server.h"
#include "item3d/study/site.h"
#include "tests/fuzz/http_request.h"

namespace {

/// A study of one item with two participants.
struct FuzzedStudy {
    std::filesystem::path folder = item3d::fuzz::as_file("style.css", "").parent_path() / "study";
    item3d::Study study = small();
    item3d::AnswerStore answers;
    item3d::StudySite site;
    item3d::fuzz::OpenServer server;

    FuzzedStudy() : answers(made(folder), study), site(study, answers, folder) {
        answers.add_participants(2);
        add_study_routes(server, site);
    }
    static std::filesystem::path made(const std::filesystem::path& folder) {
        std::filesystem::create_directories(folder / "pictures");
        return folder;
    }
    static item3d::Study small() {
        item3d::Study study;
        study.methods = {"plain", "clip"};
        item3d::StudyItem item;
        item.id = "0000000000001000";
        item.case_name = "mug";
        item.method = "plain";
        study.items = {item};
        return study;
    }
};

}  // namespace

/// Answers a request. /p/1 and /p/2 in its path are replaced by the paths of the two participants.
ITEM3D_FUZZ_TARGET(study_request, data, size) {
    using namespace item3d;
    static FuzzedStudy fuzzed;
    static const auto participants = fuzzed.answers.participants();
    return fuzz::read_or_refuse([&] {
        std::string request = fuzz::as_text(data, size);
        for (const Participant& participant : participants) {
            const std::string short_path = "/p/" + std::to_string(participant.number);
            if (const auto at = request.find(short_path); at != std::string::npos)
                request.replace(at, short_path.size(), participant_path(participant));
        }
        fuzzed.server.answer(request, {});
    });
}
