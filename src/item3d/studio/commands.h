// Commands of item3d for the page's requests.
#pragma once

#include "item3d/studio/folders.h"
#include "item3d/studio/records.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace item3d {

/// Command to be run in the project's folder. Its paths are relative to this folder.
struct StudioCommand {
    std::string family;                  ///< the program item3d-FAMILY runs the command
    std::vector<std::string> arguments;  ///< arguments; the first is the command's name
};

/// Converter of the page's requests to commands. Values become arguments of the form
/// --option=value, so that no value can be taken for an option. No shell is involved.
class StudioCommands {
  public:
    /// settings: contents of web/settings.json.
    StudioCommands(const StudioFolders& folders, nlohmann::json settings);

    /// Returns the command that makes a result of this kind and request. parent: the result whose
    /// model is the input, or null. Throws InputError for an invalid request: a setting that is
    /// unknown or names a file of this machine, a value of another type, or a mask that the project
    /// lacks.
    StudioCommand make(const StudioProject& project, const StudioResult& result,
                       const StudioResult* parent) const;
    /// Returns the command `item3d region` for the region of a request, with `folder` as output.
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

/// Returns the command as shell input: "item3d edit 'my mug.glb' ...".
std::string shown_command(const StudioCommand& command);

/// Returns the file name of an uploaded light in the folder lights/.
std::string light_file_name(const std::string& name);

/// Returns 7 for "result-7", which is the light of result 7. Returns nullopt for other names.
std::optional<std::int64_t> result_of_light(const std::string& name);

/// Returns the model's path relative to the project's folder: "source/mug.glb", or the path of the
/// parent's model.
std::string model_path(const StudioFolders& folders, const StudioProject& project,
                       const StudioResult* parent);

}  // namespace item3d
