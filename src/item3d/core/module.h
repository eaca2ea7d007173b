// Parts of the project that are opened when they are asked for: shared libraries beside the
// programs.
#pragma once

#include <string>

namespace item3d {

struct Module {
    void* handle = nullptr;
    std::string problem;  ///< in words, where there is no handle
};

/// Opens FILE_NAME from the running program's folder or ../lib/item3d beside it; it stays open.
/// builder: the command that makes it, for the problem's text.
Module open_module(const std::string& file_name, const std::string& builder);

}  // namespace item3d
