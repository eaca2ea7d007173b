#include "item3d/studio/folder_upload.h"

namespace item3d {

namespace fs = std::filesystem;

FolderUpload::FolderUpload(fs::path folder, std::size_t longest)
    : folder_(std::move(folder)), left_(longest) {
    fs::create_directories(folder_);
}

void FolderUpload::begin(const fs::path& path) {
    close();
    const fs::path file = folder_ / path;
    fs::create_directories(file.parent_path());
    file_ = std::make_unique<BoundedFile>(file, left_);
}

void FolderUpload::add(const char* data, std::size_t size) {
    if (!file_) return;
    file_->add(data, size);
    left_ -= size;
}

void FolderUpload::close() {
    if (file_) file_->close();
    file_.reset();
}

}  // namespace item3d
