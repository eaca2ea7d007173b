// Files of lines that grow: one process appends, others read what is new.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace item3d {

/// Appends a line by one write(), so that readers see all of it or none. Returns false where that
/// fails (a full disk).
bool append_line(const std::filesystem::path& path, const std::string& line);

/// Whole lines that were added to the files of a folder since the last call. Of a process that was
/// killed while it wrote, the broken last line is never told.
class AddedLines {
  public:
    /// Files of `folder` whose names end in .jsonl.
    explicit AddedLines(std::filesystem::path folder) : folder_(std::move(folder)) {}

    /// In the order of files' names, then of lines.
    std::vector<std::string> new_lines();

  private:
    std::filesystem::path folder_;
    std::map<std::filesystem::path, std::uintmax_t> read_;  ///< bytes
};

}  // namespace item3d
