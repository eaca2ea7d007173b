// Whole-file reads and atomic writes: a file that is there is whole.
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

/// Reads a whole file. Throws InputError when it is missing, not a file, unreadable, or a pointer
/// of Git LFS.
Bytes read_bytes(const std::filesystem::path& path);
std::string read_text(const std::filesystem::path& path);

/// Throws InputError for a file that begins like a pointer of Git LFS.
void check_no_lfs_pointer(const std::filesystem::path& path,
                          std::span<const std::uint8_t> first_bytes);

/// Writes to a temporary name beside `path`, flushes, renames, and flushes the folder: the file is
/// on the disk when this returns. Throws ResourceError (full disk) or InputError (unwritable
/// folder); the old file, if any, is then untouched.
void write_atomically(const std::filesystem::path& path, std::span<const std::uint8_t> bytes);
void write_atomically(const std::filesystem::path& path, std::string_view text);

/// As above for writers that want a path of their own: calls write(temporary_path), then renames.
/// The temporary name keeps the extension of `path`.
void write_atomically(const std::filesystem::path& path,
                      const std::function<void(const std::filesystem::path&)>& write);

/// Writes the names of a folder to the disk itself, as far as its file system can.
void sync_folder(const std::filesystem::path& folder);

/// Creates a folder (and its parents) and proves that files can be written there.
/// Throws ResourceError (full disk) or InputError that says why not.
void make_output_folder(const std::filesystem::path& folder);

/// A folder of make_output_folder(). The destructor removes a folder that this made and that is
/// still empty.
class OutputFolder {
  public:
    explicit OutputFolder(const std::filesystem::path& folder);
    ~OutputFolder();
    OutputFolder(const OutputFolder&) = delete;
    OutputFolder& operator=(const OutputFolder&) = delete;

  private:
    std::filesystem::path made_;  ///< empty: it was there
};

/// The folder of shipped data (prior, demo model): $ITEM3D_ASSETS, else ../assets or
/// ../share/item3d beside the running program. Throws InputError when none exists.
std::filesystem::path assets_folder();

}  // namespace item3d
