// Helpers of all fuzz targets. Reading any bytes must end with a result or with an InputError.
#pragma once

#include "item3d/core/error.h"
#include "item3d/core/files.h"

#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace item3d::fuzz {

using Target = int (*)(const std::uint8_t* data, std::size_t size);

/// All targets of this program by name. The map is empty in the program of a single target.
inline std::map<std::string, Target>& all_targets() {
    static std::map<std::string, Target> targets;
    return targets;
}

/// Calls a reader. InputError and UsageError are accepted. Any other exception ends the program,
/// which counts as a finding.
template <class Read>
int read_or_refuse(Read&& read) {
    try {
        read();
    } catch (const InputError&) {
    } catch (const UsageError&) {
    }
    return 0;
}

inline Bytes as_bytes(const std::uint8_t* data, std::size_t size) {
    return {data, data + size};
}

inline std::string as_text(const std::uint8_t* data, std::size_t size) {
    return {reinterpret_cast<const char*>(data), size};
}

/// Temporary folder for the program's lifetime, in memory if possible.
class TemporaryFolder {
  public:
    TemporaryFolder() {
        std::filesystem::path parent = "/dev/shm";
        if (!std::filesystem::exists(parent)) parent = std::filesystem::temp_directory_path();
        path_ = parent / ("item3d_fuzz_" + std::to_string(::getpid()));
        std::filesystem::create_directories(path_);
    }
    ~TemporaryFolder() {
        std::error_code code;
        std::filesystem::remove_all(path_, code);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
};

/// Writes a file for readers that take paths, and returns its path. Equal names give equal paths.
inline std::filesystem::path as_file(const std::string& name, std::string_view content) {
    static const TemporaryFolder folder;
    std::ofstream(folder.path() / name, std::ios::binary) << content;
    return folder.path() / name;
}

/// Divides `all` at lines of "====" into files with the given names, and returns their folder.
/// Names for which no part is left have no file.
inline std::filesystem::path as_files(const std::string& folder,
                                      const std::vector<std::string>& names, std::string_view all) {
    static constexpr std::string_view border = "\n====\n";
    const std::filesystem::path path = as_file(folder + ".name", "").replace_extension("folder");
    std::filesystem::create_directories(path);
    bool is_there = true;
    for (const std::string& name : names) {
        const std::size_t end = std::min(all.find(border), all.size());
        if (is_there)
            std::ofstream(path / name, std::ios::binary) << all.substr(0, end);
        else
            std::filesystem::remove(path / name);
        is_there = end < all.size();
        all.remove_prefix(is_there ? end + border.size() : end);
    }
    return path;
}

}  // namespace item3d::fuzz

/// Begins the function of a target, which reads `data` and returns 0. If ITEM3D_FUZZ_ALONE is
/// defined, the source file is a libFuzzer program of its own. Otherwise the function is added to
/// all_targets().
#ifdef ITEM3D_FUZZ_ALONE
#define ITEM3D_FUZZ_TARGET(name, data, size) \
    extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
#else
#define ITEM3D_FUZZ_TARGET(name, data, size)                            \
    static int fuzz_##name(const std::uint8_t* data, std::size_t size); \
    static const bool fuzz_##name##_is_listed =                         \
        item3d::fuzz::all_targets().emplace(#name, fuzz_##name).second; \
    static int fuzz_##name(const std::uint8_t* data, std::size_t size)
#endif
