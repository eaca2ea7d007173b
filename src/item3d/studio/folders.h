// Where the studio keeps things. Names of projects and results are their numbers, so that nothing
// people write becomes a path.
//
//   studio.sqlite                          projects, results
//   incoming/                              uploads that have not ended
//   projects/P/source/                     the model as it was uploaded, with what belongs to it
//   projects/P/model.glb, model.json       for the page (model_facts.h)
//   projects/P/masks/                      painted regions
//   projects/P/results/R/                  the folder of an edit (docs/formats.md)
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace item3d {

class StudioFolders {
  public:
    /// programs: where item3d-edit and the others are.
    StudioFolders(std::filesystem::path root, std::filesystem::path programs);

    const std::filesystem::path& root() const { return root_; }
    std::filesystem::path project(std::int64_t id) const;
    std::filesystem::path result(std::int64_t project, std::int64_t id) const;
    /// A name of its own in incoming/.
    std::filesystem::path incoming(const std::string& extension) const;
    /// item3d-FAMILY.
    std::filesystem::path program(const std::string& family) const;
    /// Removes what uploads left that were cut off.
    void clear_incoming() const;

    /// The text without the paths of this machine that the studio knows of: its own folder, the
    /// programs', and the shipped data's.
    std::string without_paths(std::string text) const;

  private:
    std::filesystem::path root_, programs_, assets_;
};

/// "results/R": a result's folder, seen from its project's.
std::string result_folder_name(std::int64_t result);

/// What of a name that somebody gave is shown: no folders, no control characters, valid UTF-8, at
/// most 120 bytes; `otherwise` where nothing is left.
std::string shown_name(const std::string& given, const std::string& otherwise);
/// A file's name that is safe to write: letters, digits, "-", "_" and the extension in lower case.
std::string stored_name(const std::string& given);
/// The same of each part of a relative path; those that lead up or nowhere are left out, and of
/// many the last four are kept.
std::filesystem::path stored_path(const std::string& given);

}  // namespace item3d
