// How far a plan of edits is, in a file beside its results.
#pragma once

#include "item3d/edit/request.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

/// OUTPUT/plan_state.json: what each edit was asked, in order, of those that were begun, and how
/// many are done. Questions are compared: an edit that is asked another thing is made anew.
class SequenceState {
  public:
    /// resume: takes what the file says.
    SequenceState(std::filesystem::path path, bool resume);

    /// Whether edit `index` was asked this and is done, and so are all before it.
    bool is_done(std::size_t index, const nlohmann::json& question) const;
    /// Whether it was asked this and is the one that was interrupted.
    bool is_begun(std::size_t index, const nlohmann::json& question) const;

    /// Forgets what was behind it, and writes the file.
    void begin(std::size_t index, const nlohmann::json& question);
    void finish(std::size_t index);

  private:
    void save() const;
    bool was_asked(std::size_t index, const nlohmann::json& question) const;

    std::filesystem::path path_;
    std::vector<nlohmann::json> questions_;
    std::size_t done_ = 0;
};

/// All that decides an edit's result but the model that it is made of.
nlohmann::json question_of(const EditRequest& edit, const std::string& prior_weights);

}  // namespace item3d
