// Folders of the studio. Projects and results are named by number, so that no user input becomes a
// path.
//
//   studio.sqlite                          projects, results
//   incoming/                              uploads that have not ended
//   projects/P/source/                     the uploaded model, with its files
//   projects/P/model.glb, model.json       for the page (model_summary.h)
//   projects/P/masks/                      painted regions
//   projects/P/results/R/                  the folder of an edit (docs/formats.md)
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace item3d {

class StudioFolders {
  public:
    /// programs: folder of item3d-edit and the other programs.
    StudioFolders(std::filesystem::path root, std::filesystem::path programs);

    const std::filesystem::path& root() const { return root_; }
    std::filesystem::path project(std::int64_t id) const;
    std::filesystem::path result(std::int64_t project, std::int64_t id) const;
    /// Returns a new unique path in incoming/.
    std::filesystem::path incoming(const std::string& extension) const;
    /// Returns the path of item3d-FAMILY.
    std::filesystem::path program(const std::string& family) const;
    /// Removes the remains of interrupted uploads.
    void clear_incoming() const;

    /// Returns the text without the paths of this machine that the studio knows. These are its own
    /// folder, the folders of models in it, the folder of the programs, and the folder of the
    /// shipped data.
    std::string without_paths(std::string text) const;

  private:
    std::filesystem::path root_, programs_, assets_;
};

/// Returns "results/R", a result's folder relative to the folder of its project.
std::string result_folder_name(std::int64_t result);

/// Returns a displayable form of a given name. It is valid UTF-8 of at most 120 bytes, without
/// folders or control characters. Returns `otherwise` if nothing is left.
std::string shown_name(const std::string& given, const std::string& otherwise);
/// Returns a file name that is safe to write. It has letters, digits, "-", "_", and the extension
/// in lower case.
std::string stored_name(const std::string& given);
/// Applies stored_name() to each part of a relative path. ".", ".." and empty parts are dropped,
/// and at most the last four are kept.
std::filesystem::path stored_path(const std::string& given);

}  // namespace item3d
