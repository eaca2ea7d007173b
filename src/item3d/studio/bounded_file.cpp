#include "item3d/studio/bounded_file.h"

#include "item3d/core/error.h"

namespace item3d {
namespace {

constexpr const char* disk_is_full = "upload: the disk is full; free some space";

}  // namespace

BoundedFile::BoundedFile(const std::filesystem::path& path, std::size_t longest)
    : file_(path, std::ios::binary), left_(longest) {}

void BoundedFile::add(const char* data, std::size_t size) {
    if (size > left_) throw InputError("upload", "is too large");
    left_ -= size;
    file_.write(data, static_cast<std::streamsize>(size));
    if (!file_) throw ResourceError(disk_is_full);
}

void BoundedFile::close() {
    file_.close();
    if (!file_) throw ResourceError(disk_is_full);
}

}  // namespace item3d
