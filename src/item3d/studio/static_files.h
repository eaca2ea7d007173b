// Files of the page, compressed once.
#pragma once

#include "item3d/studio/http.h"

#include <filesystem>
#include <map>
#include <mutex>
#include <string>

namespace item3d {

/// Answers with the files of a folder. Text is sent compressed by gzip where the browser takes it:
/// httplib's own compression takes seconds for what a page loads. Thread-safe.
class StaticFiles {
  public:
    explicit StaticFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}
    /// name: a path within the folder; one that leads out of it, or to a hidden file, is not there.
    void answer(const HttpRequest& request, HttpResponse& response, const std::string& name);

  private:
    struct Compressed {
        std::filesystem::file_time_type time;
        std::string bytes;
    };
    std::string compressed(const std::filesystem::path& file);

    std::filesystem::path folder_;
    std::mutex mutex_;
    std::map<std::string, Compressed> files_;
};

/// A gzip file of the text. level: 1 (fast) to 9 (small).
std::string gzip(const std::string& text, int level);

}  // namespace item3d
