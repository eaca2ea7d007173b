// Optional parts of the project that are opened on demand: shared libraries beside the programs.
#pragma once

#include <string>

namespace item3d {

struct Module {
    void* handle = nullptr;
    std::string problem;  ///< reason for a null handle, in words
};

/// Opens FILE_NAME from the running program's folder or ../lib/item3d beside it; it stays open.
/// builder: command that builds it, for the problem's text.
Module open_module(const std::string& file_name, const std::string& builder);

}  // namespace item3d
