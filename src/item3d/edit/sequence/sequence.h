// Several edits of one model, each of what the one before left: item3d edit --plan.
#pragma once

#include "item3d/edit/request.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

struct EditSequence {
    std::string plan;  ///< its file, for messages
    /// In order, not empty. model, output, resume, checkpoint and draws_turntable are set anew: the
    /// first is of `model`, the others of the model that the one before made.
    std::vector<EditRequest> edits;
    std::filesystem::path model;
    std::filesystem::path output;  ///< folder, made when it is not there
    bool resume = false;
};

/// Makes the edits in the folders OUTPUT/1, OUTPUT/2, ...: each with the bytes that it has when it
/// is made by itself of OUTPUT/N-1/model.glb. Networks, lights, and the model between two edits
/// are loaded once (session.h), and regions are checked before the first begins (region_check.h).
/// OUTPUT/plan_state.json and OUTPUT/checkpoint.safetensors hold how far the plan is; resume: edits
/// that are done stay, until the first that was made with other settings or of another model, and
/// one that was interrupted goes on. Then writes the last one's model, report.html, which shows
/// all, and edit.json ("edits": that of each) to OUTPUT. Returns the latter. Throws as edit_model()
/// does; InputError names the edit: "PLAN: edit N: ...".
nlohmann::json edit_in_sequence(const EditSequence& sequence);

}  // namespace item3d
