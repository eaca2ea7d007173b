#include "item3d/batch/claim.h"

#include "item3d/core/disk_full.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace item3d {
namespace {

namespace fs = std::filesystem;

constexpr const char* running_prefix = "attempt-";
constexpr const char* waiting_prefix = "waiting-";

[[noreturn]] void throw_folder_error(const fs::path& folder, int error) {
    const std::string reason = std::strerror(error);
    if (error == ENOSPC || error == EDQUOT)
        throw DiskFull(folder.string() + ": cannot be created: " + reason + "; free some space");
    throw InputError(folder.string(), "cannot be created: " + reason,
                     "choose a folder that you may write to");
}

/// Creates a folder. Returns false if it exists.
bool make_folder(const fs::path& folder) {
    if (::mkdir(folder.c_str(), 0777) == 0) return true;
    if (errno != EEXIST && errno != ENOENT) throw_folder_error(folder, errno);
    if (errno == EEXIST) return false;
    std::error_code code;
    fs::create_directories(folder.parent_path(), code);
    if (::mkdir(folder.c_str(), 0777) == 0) return true;
    if (errno != EEXIST) throw_folder_error(folder, errno);
    return false;
}

/// Renames a folder. Returns false if `from` is gone, or `to` is not empty.
bool rename_folder(const fs::path& from, const fs::path& to) {
    if (::rename(from.c_str(), to.c_str()) == 0) {
        sync_folder(to.parent_path());
        return true;
    }
    if (errno == ENOENT || errno == ENOTEMPTY || errno == EEXIST) return false;
    throw_folder_error(to, errno);
}

/// Removes temporary files of a dead process. If the process was only paused, it continues to write
/// into an unlinked file.
void remove_temporary_files(const fs::path& folder) {
    std::error_code code;
    for (const auto& entry : fs::recursive_directory_iterator(folder, code))
        if (entry.path().filename().string().find(".tmp") != std::string::npos)
            fs::remove(entry.path(), code);
}

/// Removes folders that a worker recreated after it had lost its claim.
void remove_other_folders(const fs::path& job_folder, const fs::path& kept) {
    std::error_code code;
    for (const auto& entry : fs::directory_iterator(job_folder, code))
        if (entry.path() != kept) fs::remove_all(entry.path(), code);
}

}  // namespace

fs::path result_folder(const fs::path& job_folder) {
    return job_folder / "result";
}

fs::path failed_folder(const fs::path& job_folder) {
    return job_folder / "failed";
}

FolderLook look_at(const fs::path& job_folder) {
    FolderLook look;
    std::error_code code;
    fs::directory_iterator entries(job_folder, code);
    if (code) return look;
    look.state = FolderState::empty;
    bool has_failed = false;
    for (const auto& entry : entries) {
        const std::string name = entry.path().filename().string();
        if (name == "result") return {FolderState::done, 0, "", {}};
        if (name == "failed") has_failed = true;
        const bool is_running = name.starts_with(running_prefix);
        if (!is_running && !name.starts_with(waiting_prefix)) continue;
        const char* number = name.c_str() + std::strlen(running_prefix);
        char* rest = nullptr;
        const int attempt = static_cast<int>(std::strtol(number, &rest, 10));
        if (attempt <= look.attempt) continue;
        look = {is_running ? FolderState::running : FolderState::waiting, attempt,
                is_running && *rest == '-' ? rest + 1 : "", entry.path()};
    }
    if (has_failed) return {FolderState::failed, 0, "", {}};
    return look;
}

Claim::Claim(fs::path job_folder, const std::string& worker, int attempt)
    : job_folder_(std::move(job_folder)),
      folder_(job_folder_ / fmt::format("{}{}-{}", running_prefix, attempt, worker)),
      attempt_(attempt) {}

std::optional<Claim> Claim::begin(const fs::path& job_folder, const std::string& worker) {
    if (!make_folder(job_folder)) return std::nullopt;
    Claim claim(job_folder, worker, 1);
    if (!make_folder(claim.folder_)) return std::nullopt;
    return claim;
}

std::optional<Claim> Claim::take(const fs::path& job_folder, const FolderLook& look,
                                 const std::string& worker) {
    Claim claim(job_folder, worker, look.attempt + 1);
    const bool is_ours = look.state == FolderState::empty
                             ? make_folder(claim.folder_)
                             : rename_folder(look.current, claim.folder_);
    if (!is_ours) return std::nullopt;
    remove_temporary_files(claim.folder_);
    return claim;
}

bool Claim::is_held() const {
    const FolderLook look = look_at(job_folder_);
    return look.state == FolderState::running && look.current == folder_;
}

bool Claim::publish(FolderState state) const {
    const fs::path target =
        state == FolderState::done ? result_folder(job_folder_) : failed_folder(job_folder_);
    if (!is_held() || !rename_folder(folder_, target)) return false;
    remove_other_folders(job_folder_, target);
    return true;
}

bool Claim::release() const {
    return is_held() &&
           rename_folder(folder_, job_folder_ / fmt::format("{}{}", waiting_prefix, attempt_));
}

bool retry_failed(const fs::path& job_folder, int attempts) {
    return rename_folder(failed_folder(job_folder),
                         job_folder / fmt::format("{}{}", waiting_prefix, attempts + 1));
}

}  // namespace item3d
