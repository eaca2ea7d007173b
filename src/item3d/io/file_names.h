// Names for files that are made of what users call their materials.
#pragma once

#include <cstddef>
#include <set>
#include <string>

namespace item3d {

/// At most `longest` bytes of the name, cut between two code points of UTF-8.
std::string shortened(const std::string& name, std::size_t longest);

/// ASCII letters, digits, '-' and '_' stay, other bytes become '_'; at most 80 bytes.
std::string plain_file_name(const std::string& name);

/// Gives each name once, also where a file system does not tell cases of letters apart.
class FileNames {
  public:
    /// `name` itself, or with "_1", "_2", ... where that was given before.
    std::string unused(const std::string& name);

  private:
    std::set<std::string> used_;
};

}  // namespace item3d
