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
    /// the first edit's model is `model`, that of the others the result of the previous edit.
    std::vector<EditRequest> edits;
    std::filesystem::path model;
    std::filesystem::path output;  ///< folder, created if missing
    bool resume = false;
};

/// Runs the edits in the folders OUTPUT/1, OUTPUT/2, ...: each gives the bytes of a separate edit
/// of OUTPUT/N-1/model.glb. Networks, lights, and the model between two edits are loaded once
/// (session.h), and regions are checked before the first begins (region_check.h).
/// OUTPUT/plan_state.json and OUTPUT/checkpoint.safetensors hold the progress. resume: finished
/// edits are kept, up to the first whose settings or model differ, and an interrupted one
/// continues. Then writes the last edit's model, report.html, which shows all edits, and edit.json
/// ("edits": that of each) to OUTPUT. Returns the content of edit.json. Throws as edit_model();
/// InputError names the edit: "PLAN: edit N: ...".
nlohmann::json edit_in_sequence(const EditSequence& sequence);

}  // namespace item3d
