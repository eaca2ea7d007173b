#include "item3d/edit/sequence/sequence_state.h"

#include "item3d/core/files.h"
#include "item3d/core/parse_json.h"

#include <utility>

namespace item3d {

SequenceState::SequenceState(std::filesystem::path path, bool resume) : path_(std::move(path)) {
    if (!resume || !std::filesystem::exists(path_)) return;
    const nlohmann::json state = parse_json(read_text(path_));
    if (!state.is_object() || !state.contains("edits") || !state["edits"].is_array()) return;
    questions_ = state["edits"].get<std::vector<nlohmann::json>>();
    const nlohmann::json done = state.value("done", nlohmann::json(0));
    if (done.is_number_unsigned()) done_ = std::min(done.get<std::size_t>(), questions_.size());
}

bool SequenceState::was_asked(std::size_t index, const nlohmann::json& question) const {
    return index < questions_.size() && questions_[index] == question;
}

bool SequenceState::is_done(std::size_t index, const nlohmann::json& question) const {
    return index < done_ && was_asked(index, question);
}

bool SequenceState::is_begun(std::size_t index, const nlohmann::json& question) const {
    return index == done_ && was_asked(index, question);
}

void SequenceState::begin(std::size_t index, const nlohmann::json& question) {
    questions_.resize(index);
    questions_.push_back(question);
    done_ = index;
    save();
}

void SequenceState::finish(std::size_t index) {
    done_ = index + 1;
    save();
}

void SequenceState::save() const {
    write_atomically(
        path_,
        std::string_view(nlohmann::json{{"done", done_}, {"edits", questions_}}.dump(2) + "\n"));
}

nlohmann::json question_of(const EditRequest& edit, const std::string& prior_weights) {
    nlohmann::json question = edit.plan;
    question["prior_weights"] = prior_weights;
    question["precision"] = edit.precision;
    question["picture_pixels"] = edit.image_pixels;
    if (edit.plan.asks_captioner) question["captioner"] = edit.captioner.string();
    return question;
}

}  // namespace item3d
