#include "item3d/studio/archive.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/io/load.h"
#include "item3d/studio/model_folder.h"

#include <fmt/format.h>
#include <zip.h>

#include <array>
#include <fstream>
#include <memory>
#include <string>

namespace item3d {
namespace {

namespace fs = std::filesystem;

struct CloseArchive {
    void operator()(zip_t* archive) const { zip_discard(archive); }
};
struct CloseEntry {
    void operator()(zip_file_t* entry) const { zip_fclose(entry); }
};
using Archive = std::unique_ptr<zip_t, CloseArchive>;
using Entry = std::unique_ptr<zip_file_t, CloseEntry>;

[[noreturn]] void refuse(const fs::path& archive, const std::string& problem,
                         const std::string& hint = "") {
    throw InputError(archive.filename().string(), problem, hint);
}

[[noreturn]] void refuse_size(const fs::path& archive, std::int64_t limit) {
    refuse(archive, fmt::format("unpacks to more than {} MB", limit >> 20),
           "make its textures smaller");
}

bool is_link(zip_t* archive, zip_uint64_t index) {
    constexpr zip_uint32_t type_mask = 0170000, link = 0120000;
    zip_uint8_t system = 0;
    zip_uint32_t attributes = 0;
    zip_file_get_external_attributes(archive, index, 0, &system, &attributes);
    return system == ZIP_OPSYS_UNIX && ((attributes >> 16) & type_mask) == link;
}

/// Unpacks a file and returns the number of bytes written. The archive's stated sizes are not
/// trusted.
std::int64_t unpack_entry(zip_t* archive, zip_uint64_t index, const fs::path& source,
                          const fs::path& target, std::int64_t longest, std::int64_t limit) {
    const Entry entry(zip_fopen_index(archive, index, 0));
    if (!entry) refuse(source, std::string("cannot be unpacked (") + zip_strerror(archive) + ")");
    fs::create_directories(target.parent_path());
    std::int64_t written = 0;
    write_atomically(target, [&](const fs::path& path) {
        std::ofstream file(path, std::ios::binary);
        std::array<char, 65536> piece{};
        for (;;) {
            const zip_int64_t got = zip_fread(entry.get(), piece.data(), piece.size());
            if (got < 0) refuse(source, "is damaged: a file in it cannot be unpacked");
            if (got == 0) break;
            written += got;
            if (written > longest) refuse_size(source, limit);
            file.write(piece.data(), got);
        }
        file.close();
        if (!file)
            throw ResourceError(source.filename().string() + ": the disk is full; free some space");
    });
    return written;
}

}  // namespace

fs::path unpack_model(const fs::path& source, const fs::path& folder, const ArchiveLimits& limits) {
    int error = 0;
    const Archive archive(zip_open(source.c_str(), ZIP_RDONLY | ZIP_CHECKCONS, &error));
    if (!archive) refuse(source, "is not a complete .zip archive", "pack the model's folder again");
    const zip_int64_t count = zip_get_num_entries(archive.get(), 0);
    if (count > limits.entries)
        refuse(source,
               fmt::format("has {} files, but at most {} are allowed", count, limits.entries));
    std::int64_t left = limits.bytes;
    MainModel main;
    for (zip_uint64_t i = 0; i < static_cast<zip_uint64_t>(count); ++i) {
        zip_stat_t entry;
        zip_stat_init(&entry);
        if (zip_stat_index(archive.get(), i, 0, &entry) != 0 || !(entry.valid & ZIP_STAT_NAME))
            refuse(source, "is damaged: a name in it cannot be read");
        const std::string name = entry.name;
        const fs::path path = path_in_folder(name, source.filename().string());
        if (name.ends_with('/') || is_link(archive.get(), i)) continue;
        if (!is_part_of_model(path)) continue;
        if ((entry.valid & ZIP_STAT_ENCRYPTION_METHOD) && entry.encryption_method != ZIP_EM_NONE)
            refuse(source, "is encrypted", "pack it without a password");
        if ((entry.valid & ZIP_STAT_SIZE) && entry.size > static_cast<zip_uint64_t>(left))
            refuse_size(source, limits.bytes);
        const std::int64_t size =
            unpack_entry(archive.get(), i, source, folder / path, left, limits.bytes);
        left -= size;
        main.add(path, size);
    }
    if (main.path().empty())
        refuse(source, "contains no model", "expected a " + model_extensions_text());
    return folder / main.path();
}

}  // namespace item3d
