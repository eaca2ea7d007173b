#include "item3d/hub/cache.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>

namespace item3d {
namespace {

namespace fs = std::filesystem;

std::string environment(const char* name) {
    const char* value = std::getenv(name);
    return value ? value : "";
}

/// Replaces a leading "~" by the home folder, as a shell does.
fs::path expanded(const std::string& path) {
    if (path == "~" || path.starts_with("~/")) return environment("HOME") + path.substr(1);
    return path;
}

/// True for a valid "org" or "name" of "org/name".
bool is_name(const std::string& text) {
    const auto allowed = [](unsigned char c) {
        return std::isalnum(c) || c == '-' || c == '_' || c == '.';
    };
    return !text.empty() && text.size() <= 96 && std::all_of(text.begin(), text.end(), allowed) &&
           text.find("..") == std::string::npos && text.find("--") == std::string::npos &&
           text.front() != '.' && text.front() != '-' && text.back() != '.' && text.back() != '-';
}

/// Returns the advice for a missing entry of the cache.
std::string pull_hint(const std::string& name, const std::string& revision) {
    return "run: item3d prior pull " + name + (revision == "main" ? "" : " --revision " + revision);
}

}  // namespace

std::optional<RepositoryName> RepositoryName::parse(const std::string& text) {
    const std::string name = text.substr(0, text.find('@'));
    const auto slash = name.find('/');
    if (slash == std::string::npos) return std::nullopt;
    if (!is_name(name.substr(0, slash)) || !is_name(name.substr(slash + 1))) return std::nullopt;
    if (name.size() == text.size()) return RepositoryName{name, ""};
    const std::string revision = text.substr(name.size() + 1);
    if (!is_revision(revision)) return std::nullopt;
    return RepositoryName{name, revision};
}

bool is_revision(const std::string& text) {
    return text.size() <= 200 && stays_inside(text);
}

bool is_commit(const std::string& text) {
    return text.size() == 40 && std::all_of(text.begin(), text.end(), [](unsigned char c) {
               return std::isdigit(c) || (c >= 'a' && c <= 'f');
           });
}

bool stays_inside(const std::string& path) {
    if (path.empty() || path.front() == '/') return false;
    for (const char c : path)
        if (c == '\\' || static_cast<unsigned char>(c) < ' ') return false;
    for (std::size_t begin = 0; begin <= path.size();) {
        const std::size_t end = std::min(path.find('/', begin), path.size());
        const std::string part = path.substr(begin, end - begin);
        if (part.empty() || part == "." || part == "..") return false;
        begin = end + 1;
    }
    return true;
}

fs::path hub_home_folder() {
    if (const std::string home = environment("HF_HOME"); !home.empty()) return expanded(home);
    if (const std::string cache = environment("XDG_CACHE_HOME"); !cache.empty())
        return expanded(cache) / "huggingface";
    return expanded("~/.cache") / "huggingface";
}

fs::path hub_cache_folder() {
    if (const std::string cache = environment("HF_HUB_CACHE"); !cache.empty())
        return expanded(cache);
    return hub_home_folder() / "hub";
}

CachedRepository::CachedRepository(fs::path cache, const std::string& name)
    : cache_(std::move(cache)), name_(name) {
    const auto slash = name.find('/');
    ITEM3D_CHECK(slash != std::string::npos, "not org/name: " + name);
    folder_ = cache_ / ("models--" + name.substr(0, slash) + "--" + name.substr(slash + 1));
}

fs::path CachedRepository::lock(const std::string& name) const {
    return cache_ / ".locks" / folder_.filename() / (name + ".lock");
}

fs::path CachedRepository::find_snapshot(const std::string& revision) const {
    const std::string hint = pull_hint(name_, revision);
    std::string commit = revision;
    if (!is_commit(revision)) {
        if (!fs::is_regular_file(ref(revision)))
            throw InputError(
                ref(revision).string(),
                fmt::format("is missing, so revision '{}' of {} is unknown", revision, name_),
                hint);
        commit = read_text(ref(revision));
        commit.erase(commit.find_last_not_of(" \t\r\n") + 1);
        if (!is_commit(commit))
            throw InputError(ref(revision).string(),
                             "expected a commit of 40 hexadecimal digits, found something else",
                             hint);
    }
    const fs::path folder = snapshot(commit);
    if (!fs::is_directory(folder)) throw InputError(folder.string(), "no such snapshot", hint);
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_symlink() && !entry.exists())
            throw InputError(entry.path().string(), "links to a file that does not exist", hint);
    return folder;
}

void CachedRepository::link(const std::string& commit, const std::string& path,
                            const std::string& etag) const {
    ITEM3D_CHECK(stays_inside(path), "would be outside the snapshot: " + path);
    const fs::path pointer = snapshot(commit) / path;
    const fs::path target = blob(etag).lexically_relative(pointer.parent_path());
    std::error_code code;
    if (fs::read_symlink(pointer, code) == target) return;
    fs::create_directories(pointer.parent_path());
    const fs::path temporary =
        pointer.parent_path() / fmt::format(".{}.{}", pointer.filename().string(), ::getpid());
    fs::remove(temporary, code);
    fs::create_symlink(target, temporary, code);
    if (!code) fs::rename(temporary, pointer, code);
    if (code) {
        std::error_code ignored;
        fs::remove(temporary, ignored);
        if (code == std::errc::no_space_on_device)
            throw ResourceError(pointer.string() +
                                ": the link cannot be created: " + code.message() +
                                "; free some space and run the same command again");
        throw InputError(pointer.string(), "the link cannot be created: " + code.message(),
                         "set HF_HUB_CACHE to a folder on a file system that supports links");
    }
}

void CachedRepository::set_ref(const std::string& revision, const std::string& commit) const {
    if (revision == commit) return;
    fs::create_directories(ref(revision).parent_path());
    write_atomically(ref(revision), commit);
}

}  // namespace item3d
