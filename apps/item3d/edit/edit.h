// The edit command, for `item3d edit` and the jobs of a batch.
#pragma once

#include "apps/item3d/command.h"
#include "apps/item3d/sign_key_option.h"
#include "item3d/edit/request.h"
#include "item3d/edit/session.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>

namespace item3d {

struct EditCommandOptions : CommonOptions {
    EditRequest request;
    std::string prior;                ///< folder or name, as for find_prior()
    std::filesystem::path plan_file;  ///< file of several edits; empty: one edit with the settings
    /// Settings given on the command line; others come from the prior.
    nlohmann::json overrides = nlohmann::json::object();
    SignKeyOption sign_key;
};

/// Adds MODEL and all options except the common ones.
void add_edit_options(CLI::App& command, EditCommandOptions& options);

/// Throws UsageError for contradictory options, and InputError for a value out of range. Makes all
/// checks that need no loading.
void check_edit_options(const EditCommandOptions& options);

/// Applies the common options and runs the edit, or each edit of the plan file. The edits of a plan
/// file do not use `session` but a session of their own. Returns the content of edit.json. Throws
/// like check_edit_options() and edit_model().
nlohmann::json perform_edit(EditCommandOptions& options, EditSession& session);

}  // namespace item3d
