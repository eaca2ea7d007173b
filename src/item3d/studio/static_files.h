// Static files of the page, which are compressed once.
#pragma once

#include "item3d/studio/http.h"

#include <filesystem>
#include <map>
#include <mutex>
#include <string>

namespace item3d {

/// Server of the files of a folder. Text is sent with gzip if the browser accepts that. It is
/// compressed here because httplib's own compression takes seconds for the page's files.
/// Thread-safe.
class StaticFiles {
  public:
    explicit StaticFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}
    /// Replies with a file. name: a path within the folder. A path that leads out of the folder, or
    /// to a hidden file, gives the reply "not found".
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
