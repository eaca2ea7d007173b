// What the page asks for, as commands of item3d.
#pragma once

#include "item3d/studio/folders.h"
#include "item3d/studio/records.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace item3d {

/// A command that is run in the project's folder, with paths relative to that.
struct StudioCommand {
    std::string family;                  ///< item3d-FAMILY has it
    std::vector<std::string> arguments;  ///< from the command's name on
};

/// Turns requests of the page into commands. Values become arguments of the form --option=value, so
/// that none can be taken for an option; no shell reads them.
class StudioCommands {
  public:
    /// settings: web/settings.json.
    StudioCommands(const StudioFolders& folders, nlohmann::json settings);

    /// The command that makes the result of this kind and request. parent: the result whose model
    /// is changed, if any. Throws InputError for a request that cannot be understood: a setting
    /// that there is not or that names a file of this machine, a value of another type, a mask that
    /// the project does not have.
    StudioCommand make(const StudioProject& project, const StudioResult& result,
                       const StudioResult* parent) const;
    /// `item3d region` for the same request, into that folder.
    StudioCommand region(const StudioProject& project, const nlohmann::json& request,
                         const StudioResult* parent, const std::string& folder) const;

    const nlohmann::json& settings() const { return settings_; }

  private:
    using Arguments = std::vector<std::string>;
    Arguments edit(const StudioProject& project, const nlohmann::json& request) const;
    Arguments relight(const StudioProject& project, const nlohmann::json& request) const;
    Arguments reconstruct(const StudioProject& project, const nlohmann::json& request) const;
    void add_settings(const StudioProject& project, const nlohmann::json& given,
                      Arguments& arguments) const;
    void add_region(const StudioProject& project, const nlohmann::json& request,
                    Arguments& arguments) const;
    std::string light(const StudioProject& project, const std::string& name) const;

    const StudioFolders& folders_;
    nlohmann::json settings_;
};

/// "item3d edit 'my mug.glb' ...": as a shell takes it.
std::string shown_command(const StudioCommand& command);

/// The file of an uploaded light in the folder lights/.
std::string light_file_name(const std::string& name);

/// 7, of "result-7": the light that result 7 was made in, or found.
std::optional<std::int64_t> result_of_light(const std::string& name);

/// "source/mug.glb", or the parent's model, seen from the project's folder.
std::string model_path(const StudioFolders& folders, const StudioProject& project,
                       const StudioResult* parent);

}  // namespace item3d
