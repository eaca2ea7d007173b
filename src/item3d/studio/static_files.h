// Static files of the page, compressed once.
#pragma once

#include "item3d/studio/http.h"

#include <filesystem>
#include <map>
#include <mutex>
#include <string>

namespace item3d {

/// Serves the files of a folder, text with gzip if the browser accepts it: httplib's own
/// compression takes seconds for the page's files. Thread-safe.
class StaticFiles {
  public:
    explicit StaticFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}
    /// Replies a file. name: a path within the folder; paths that lead out of it, or to a hidden
    /// file, are not found.
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

/// Returns the text as a gzip file. level: 1 (fast) to 9 (small).
std::string gzip(const std::string& text, int level);

}  // namespace item3d
