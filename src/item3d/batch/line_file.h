// Files to which processes append lines while other processes read them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace item3d {

/// Appends a line by one write(), so that readers see all of the line or nothing. Returns false on
/// failure (a full disk).
bool append_line(const std::filesystem::path& path, const std::string& line);

/// Reader of the complete lines added to the files of a folder since the last call. It never
/// returns the incomplete last line of a process that was killed while writing.
class AddedLines {
  public:
    /// Watches files of `folder` whose names end in .jsonl.
    explicit AddedLines(std::filesystem::path folder) : folder_(std::move(folder)) {}

    /// Returns the new lines, in the order of the files' names.
    std::vector<std::string> new_lines();

  private:
    std::filesystem::path folder_;
    std::map<std::filesystem::path, std::uintmax_t> read_;  ///< bytes read of each file
};

}  // namespace item3d
