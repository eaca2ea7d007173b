#include "item3d/core/files.h"

#include "item3d/core/disk_full.h"
#include "item3d/core/program.h"
#include "item3d/core/replaceable.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>

namespace item3d {
namespace fs = std::filesystem;
namespace {

fs::path temporary_beside(const fs::path& path) {
    fs::path name = path.stem();
    name += ".tmp" + std::to_string(::getpid());
    name += path.extension();
    return path.parent_path() / name;
}

bool is_full(int error) {
    return error == ENOSPC || error == EDQUOT || error == EFBIG;
}

[[noreturn]] void throw_write_error(const fs::path& path, int error) {
    const std::string reason = std::strerror(error);
    if (is_full(error)) {
        throw DiskFull(path.string() + ": cannot be written: " + reason +
                       "; free some space or choose another folder");
    }
    throw InputError(path.string(), "cannot be written: " + reason,
                     "choose a folder that you may write to");
}

/// Writes a file and flushes it. shown: path for messages, because a temporary name is meaningless
/// to users.
void write_all(const fs::path& path, std::span<const std::uint8_t> bytes, const fs::path& shown) {
    const int file = ::open(path.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0644);
    if (file < 0) throw_write_error(shown, errno);
    std::size_t done = 0;
    while (done < bytes.size()) {
        const ssize_t wrote = ::write(file, bytes.data() + done, bytes.size() - done);
        if (wrote < 0 && errno == EINTR) continue;
        if (wrote < 0) {
            const int error = errno;
            ::close(file);
            throw_write_error(shown, error);
        }
        done += static_cast<std::size_t>(wrote);
    }
    if (::close(file) != 0) throw_write_error(shown, errno);
}

/// Flushes a file to the disk. Throws for errors that the system found only after write() had
/// returned.
void sync_file(const fs::path& path, const fs::path& shown) {
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0) throw_write_error(shown, errno);
    const bool synced = ::fsync(file) == 0 || errno == EINVAL;
    const int error = errno;
    ::close(file);
    if (!synced) throw_write_error(shown, error);
}

}  // namespace

void check_no_lfs_pointer(const fs::path& path, std::span<const std::uint8_t> first_bytes) {
    constexpr std::string_view magic = "version https://git-lfs.github.com/spec/";
    if (first_bytes.size() < magic.size() ||
        std::memcmp(first_bytes.data(), magic.data(), magic.size()) != 0)
        return;
    throw InputError(path.string(), "is a Git LFS pointer instead of the file",
                     "download the file with 'git lfs pull'");
}

Bytes read_bytes(const fs::path& path) {
    std::error_code code;
    const auto status = fs::status(path, code);
    if (!fs::exists(status)) {
        throw InputError(path.string(), "no such file", "check the path");
    }
    if (fs::is_directory(status)) {
        throw InputError(path.string(), "is a folder; expected a file", "give a file in it");
    }
    if (!fs::is_regular_file(status))
        throw InputError(path.string(), "is not a regular file", "give the name of a file");
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    if (!file) throw InputError(path.string(), "cannot be opened", "check its permissions");
    const std::streamoff size = file.tellg();
    if (size < 0) throw InputError(path.string(), "could not be read", "check the disk");
    Bytes bytes(static_cast<std::size_t>(size));
    file.seekg(0);
    file.read(reinterpret_cast<char*>(bytes.data()), size);
    if (!file)
        throw InputError(path.string(), "could not be read completely",
                         "check the disk, and that no program is writing the file");
    check_no_lfs_pointer(path, bytes);
    return bytes;
}

std::string read_text(const fs::path& path) {
    const Bytes bytes = read_bytes(path);
    return std::string(bytes.begin(), bytes.end());
}

void write_atomically(const fs::path& path, std::span<const std::uint8_t> bytes) {
    write_atomically(path, [&](const fs::path& temporary) { write_all(temporary, bytes, path); });
}

void write_atomically(const fs::path& path, std::string_view text) {
    write_atomically(path,
                     std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
}

void write_atomically(const fs::path& path, const std::function<void(const fs::path&)>& write) {
    check_replaceable(path);
    const fs::path temporary = temporary_beside(path);
    try {
        write(temporary);
        sync_file(temporary, path);
        std::error_code code;
        fs::rename(temporary, path, code);
        if (code) throw_write_error(path, code.value());
        sync_folder(path.parent_path());
    } catch (...) {
        std::error_code ignored;
        fs::remove(temporary, ignored);
        throw;
    }
}

void sync_folder(const fs::path& folder) {
    const int file =
        ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (file < 0) return;
    ::fsync(file);
    ::close(file);
}

void sync_tree(const fs::path& folder) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
        if (entry.is_directory())
            sync_folder(entry.path());
        else if (entry.is_regular_file())
            sync_file(entry.path(), entry.path());
    }
    sync_folder(folder);
    sync_folder(folder.parent_path());
}

namespace {

/// Returns those of the folder and its parents that do not exist, the innermost first.
std::vector<fs::path> missing_folders(const fs::path& folder) {
    std::error_code code;
    std::vector<fs::path> missing;
    for (fs::path each = folder; !each.empty() && !fs::exists(each, code);
         each = each.parent_path())
        missing.push_back(each);
    return missing;
}

}  // namespace

void make_output_folder(const fs::path& folder) {
    if (folder.empty()) throw InputError("-o", "is empty", "give a folder");
    std::error_code code, other;
    const std::vector<fs::path> made = missing_folders(folder);
    fs::create_directories(folder, code);
    if (!fs::is_directory(folder, other)) {
        if (is_full(code.value()))
            throw DiskFull(folder.string() + ": cannot be created: " + code.message() +
                           "; free some space or choose another folder");
        throw InputError(folder.string(),
                         "cannot be created: " +
                             (code ? code.message() : std::string("a file of that name exists")),
                         "choose another -o");
    }
    const fs::path probe = folder / (".write-test-" + std::to_string(::getpid()));
    write_all(probe, {}, folder);
    fs::remove(probe, code);
    for (const fs::path& each : made)
        sync_folder(each.parent_path());
}

void make_folder_of(const fs::path& file) {
    if (file.has_parent_path()) make_output_folder(file.parent_path());
}

OutputFolder::OutputFolder(const fs::path& folder) : made_(missing_folders(folder)) {
    make_output_folder(folder);
}

OutputFolder::~OutputFolder() {
    std::error_code code;
    for (const fs::path& folder : made_) {
        if (!fs::is_empty(folder, code) || code) return;
        fs::remove(folder, code);
    }
}

fs::path assets_folder() {
    if (const char* set = std::getenv("ITEM3D_ASSETS"); set && *set) return set;
    const fs::path programs = programs_folder();
    for (const char* relative : {"../assets", "../share/item3d", "../../share/item3d"}) {
        const fs::path candidate = programs / relative;
        if (fs::is_directory(candidate)) return candidate.lexically_normal();
    }
    throw InputError(programs.string(), "its assets folder was not found next to it",
                     "set ITEM3D_ASSETS to the folder that holds the prior");
}

}  // namespace item3d
