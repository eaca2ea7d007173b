// A sequence of edits, each of which is applied to the result of the previous one (`item3d edit
// --plan`).
#pragma once

#include "item3d/edit/request.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

struct EditSequence {
    std::string plan;  ///< the plan's file, for messages
    /// The edits in order; not empty. Their members model, output, resume, checkpoint and
    /// draws_turntable are overwritten. The first edit gets `model` below; each later edit gets the
    /// result of the previous edit.
    std::vector<EditRequest> edits;
    std::filesystem::path model;
    std::filesystem::path output;  ///< folder, created if missing
    bool resume = false;
};

/// Runs the edits in the folders OUTPUT/1, OUTPUT/2, ... Edit N writes the same bytes as a separate
/// edit of OUTPUT/N-1/model.glb. Afterwards writes to OUTPUT the last edit's model, report.html
/// with all edits, and edit.json, in which "edits" has the edit.json of each edit. Returns the
/// content of that edit.json. Networks, lights, and the model between two edits are loaded once
/// (session.h). Regions are checked before the first edit begins (region_check.h).
/// OUTPUT/plan_state.json and OUTPUT/checkpoint.safetensors store the progress. If `resume`, keeps
/// the finished edits before the first edit whose settings or model differ, and continues an
/// interrupted edit. Throws as edit_model(). The message of an InputError names the edit: "PLAN:
/// edit N: ...".
nlohmann::json edit_in_sequence(const EditSequence& sequence);

}  // namespace item3d
