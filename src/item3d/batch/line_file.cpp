#include "item3d/batch/line_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <fstream>

namespace item3d {

namespace fs = std::filesystem;

bool append_line(const fs::path& path, const std::string& line) {
    const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    if (file < 0) return false;
    const std::string text = line + "\n";
    const bool is_whole =
        ::write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size());
    return ::close(file) == 0 && is_whole;
}

std::vector<std::string> AddedLines::new_lines() {
    std::error_code code;
    for (const auto& entry : fs::directory_iterator(folder_, code))
        if (entry.path().extension() == ".jsonl") read_.emplace(entry.path(), 0);
    std::vector<std::string> lines;
    for (auto& [path, done] : read_) {
        const std::uintmax_t size = fs::file_size(path, code);
        if (code || size <= done) continue;
        std::ifstream file(path, std::ios::binary);
        file.seekg(static_cast<std::streamoff>(done));
        std::string text(size - done, '\0');
        file.read(text.data(), static_cast<std::streamsize>(text.size()));
        text.resize(static_cast<std::size_t>(file.gcount()));
        std::size_t begin = 0;
        for (std::size_t end = 0; (end = text.find('\n', begin)) != std::string::npos;
             begin = end + 1)
            lines.push_back(text.substr(begin, end - begin));
        done += begin;
    }
    return lines;
}

}  // namespace item3d
