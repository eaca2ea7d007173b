// The progress of a plan of edits, in a file beside its results.
#pragma once

#include "item3d/edit/request.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

/// The content of OUTPUT/plan_state.json. It has the inputs of each edit that was begun, in order,
/// and the number of finished edits. The inputs of an edit, as JSON, are called its question. An
/// edit whose question has changed is run again.
class SequenceState {
  public:
    /// Reads the file if `resume`; otherwise the state starts empty.
    SequenceState(std::filesystem::path path, bool resume);

    /// True if edit `index` was run with this question and is finished, as are all edits before it.
    bool is_done(std::size_t index, const nlohmann::json& question) const;
    /// True if the edit was begun with this question and is not finished.
    bool is_begun(std::size_t index, const nlohmann::json& question) const;

    /// Records the start of edit `index`, drops all later edits, and writes the file.
    void begin(std::size_t index, const nlohmann::json& question);
    void finish(std::size_t index);

  private:
    void save() const;
    bool was_asked(std::size_t index, const nlohmann::json& question) const;

    std::filesystem::path path_;
    std::vector<nlohmann::json> questions_;
    std::size_t done_ = 0;
};

/// Returns everything that determines an edit's result except its input model.
nlohmann::json question_of(const EditRequest& edit, const std::string& prior_weights);

}  // namespace item3d
