// Reads of whole files, and atomic writes, so that a file is never half written.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace item3d {

using Bytes = std::vector<std::uint8_t>;

/// Reads a whole file. Throws InputError when it is missing, not a file, unreadable, or a Git LFS
/// pointer.
Bytes read_bytes(const std::filesystem::path& path);
std::string read_text(const std::filesystem::path& path);

/// Throws InputError for a file that begins like a Git LFS pointer.
void check_no_lfs_pointer(const std::filesystem::path& path,
                          std::span<const std::uint8_t> first_bytes);

/// Writes a file under a temporary name beside `path`, flushes it, renames it, and flushes the
/// folder. When the function returns, the file is on the disk. Throws ResourceError (full disk) or
/// InputError (unwritable folder); an existing file then stays unchanged.
void write_atomically(const std::filesystem::path& path, std::span<const std::uint8_t> bytes);
void write_atomically(const std::filesystem::path& path, std::string_view text);

/// Writes a file atomically by a function that needs a path: calls write(temporary_path), then
/// renames. The temporary name keeps the extension of `path`.
void write_atomically(const std::filesystem::path& path,
                      const std::function<void(const std::filesystem::path&)>& write);

/// Flushes a folder's list of file names to the disk, if the file system supports this.
void sync_folder(const std::filesystem::path& folder);

/// Flushes a folder and all files and folders in it to the disk, and its name in the parent folder.
/// Throws ResourceError or InputError, as write_atomically() does.
void sync_tree(const std::filesystem::path& folder);

/// Creates a folder (and its parents) and tests that files can be written there. If not, throws
/// ResourceError (full disk) or InputError with the reason.
void make_output_folder(const std::filesystem::path& folder);
/// Creates the folder of an output file by make_output_folder().
void make_folder_of(const std::filesystem::path& file);

/// Folder made by make_output_folder(). The destructor removes the folder, and the parent folders
/// created with it, if they are empty.
class OutputFolder {
  public:
    explicit OutputFolder(const std::filesystem::path& folder);
    ~OutputFolder();
    OutputFolder(const OutputFolder&) = delete;
    OutputFolder& operator=(const OutputFolder&) = delete;

  private:
    /// Folders that did not exist before: the folder itself, then its parents.
    std::vector<std::filesystem::path> made_;
};

/// Returns the folder of installed data (prior, demo model). It is $ITEM3D_ASSETS if that is set,
/// else the first existing one of ../assets, ../share/item3d and ../../share/item3d relative to
/// programs_folder(). Throws InputError if none exists.
std::filesystem::path assets_folder();

}  // namespace item3d
