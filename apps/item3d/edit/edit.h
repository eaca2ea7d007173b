// An edit as `item3d edit` and the jobs of a batch ask for it.
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
    std::string prior;                ///< folder or name, see find_prior()
    std::filesystem::path plan_file;  ///< of several edits; empty: one, by the settings
    /// Settings given on the command line; what is absent comes from the prior.
    nlohmann::json overrides = nlohmann::json::object();
    SignKeyOption sign_key;
};

/// Adds MODEL and all options but the common ones.
void add_edit_options(CLI::App& command, EditCommandOptions& options);

/// Throws UsageError for options that contradict each other, and InputError for a value out of
/// range: what can be told before anything is loaded.
void check_edit_options(const EditCommandOptions& options);

/// Applies the common options, decides the plan and runs the edit, or those of the plan's file (in
/// a session of their own). Returns the content of edit.json. Throws as check_edit_options() and
/// edit_model().
nlohmann::json perform_edit(EditCommandOptions& options, EditSession& session);

}  // namespace item3d
