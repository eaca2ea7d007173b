#include "item3d/batch/content_hash.h"

#include "item3d/core/digest.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/named_files.h"

#include <algorithm>
#include <fstream>
#include <vector>

namespace item3d {
namespace {

namespace fs = std::filesystem;

/// Hashes a file in pieces, because the file of a prior or a model may be larger than memory.
std::string hash_of_bytes(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::error_code code;
    const std::uintmax_t size = fs::file_size(path, code);
    if (!file || code) return "";
    Digest digest(DigestKind::sha256, size);
    std::vector<char> piece(1 << 16);
    while (file.read(piece.data(), static_cast<std::streamsize>(piece.size())) || file.gcount() > 0)
        digest.update({reinterpret_cast<const std::uint8_t*>(piece.data()),
                       static_cast<std::size_t>(file.gcount())});
    return digest.finish();
}

std::string hash_of_folder(const fs::path& folder) {
    std::vector<fs::path> files;
    std::error_code code;
    fs::recursive_directory_iterator entry(folder, code);
    for (; !code && entry != fs::recursive_directory_iterator(); entry.increment(code)) {
        std::error_code ignored;  // an entry that has just been removed is not a file
        if (entry->is_regular_file(ignored)) files.push_back(entry->path());
    }
    if (code)
        throw InputError(folder.string(), "cannot be read: " + code.message(),
                         "check the permissions of its folders");
    std::sort(files.begin(), files.end());
    std::string all;
    for (const fs::path& file : files)
        all += file.lexically_relative(folder).string() + '\0' + hash_of_bytes(file) + '\n';
    return sha256(all);
}

}  // namespace

const std::string& ContentHashes::of(const fs::path& path) {
    const auto [place, is_new] = known_.try_emplace(path);
    if (!is_new) return place->second;
    std::error_code code;
    if (fs::is_regular_file(path, code))
        place->second = hash_of_bytes(path);
    else if (fs::is_directory(path, code))
        place->second = hash_of_folder(path);
    return place->second;
}

const std::string& ContentHashes::of_model(const fs::path& path) {
    const auto [place, is_new] = models_.try_emplace(path);
    if (!is_new) return place->second;
    std::error_code code;
    if (!fs::is_regular_file(path, code)) return place->second;
    const std::string own = of(path);
    if (own.empty()) return place->second;  // the file cannot be read, which its job reports
    const std::vector<std::string> names = files_named_by(path);
    std::string all = own;
    for (const std::string& name : names) {
        const fs::path file = path.parent_path() / name;
        all += '\n' + name + '\0' + (fs::is_regular_file(file, code) ? of(file) : "");
    }
    place->second = names.empty() ? own : sha256(all);
    return place->second;
}

}  // namespace item3d
