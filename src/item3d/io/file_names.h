// File names made from users' names of materials.
#pragma once

#include <cstddef>
#include <set>
#include <string>

namespace item3d {

/// Returns at most `longest` bytes of the name, cut between two code points of UTF-8.
std::string shortened(const std::string& name, std::size_t longest);

/// Replaces all but ASCII letters, digits, '-' and '_' by '_'. The result has at most 80 bytes.
std::string plain_file_name(const std::string& name);

/// Makes names unique, also for case-insensitive file systems.
class FileNames {
  public:
    /// Returns `name`; appends "_1", "_2", ... if that name was returned before.
    std::string unused(const std::string& name);

  private:
    std::set<std::string> used_;
};

}  // namespace item3d
