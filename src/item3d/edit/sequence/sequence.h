// A sequence of edits, each applied to the result of the previous one: item3d edit --plan.
#pragma once

#include "item3d/edit/request.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

struct EditSequence {
    std::string plan;  ///< file of the plan, for messages
    /// In order, not empty. model, output, resume, checkpoint and draws_turntable are overwritten:
    /// the first edit's model becomes `model`; the model of each later edit becomes the result of
    /// the previous edit.
    std::vector<EditRequest> edits;
    std::filesystem::path model;
    std::filesystem::path output;  ///< folder, created if missing
    bool resume = false;
};

/// Runs the edits in the folders OUTPUT/1, OUTPUT/2, ... Edit N writes the same bytes as a separate
/// edit of OUTPUT/N-1/model.glb. Afterwards writes to OUTPUT: the last edit's model, report.html
/// with all edits, and edit.json, whose "edits" are the edit.json of each edit. Returns the content
/// of edit.json. Networks, lights, and the model between two edits are loaded once (session.h).
/// Regions are checked before the first edit begins (region_check.h). OUTPUT/plan_state.json and
/// OUTPUT/checkpoint.safetensors store the progress. resume: keeps finished edits up to the first
/// whose settings or model differ, and continues an interrupted edit. Throws as edit_model();
/// InputError names the edit: "PLAN: edit N: ...".
nlohmann::json edit_in_sequence(const EditSequence& sequence);

}  // namespace item3d
