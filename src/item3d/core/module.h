// Optional parts of the project that are opened on demand: shared libraries beside the programs.
#pragma once

#include <string>

namespace item3d {

struct Module {
    void* handle = nullptr;
    std::string problem;  ///< reason for a null handle, in words
};

/// Opens the shared library FILE_NAME in the running program's folder or in ../lib/item3d relative
/// to that folder. The library is never closed. builder: the command that builds the library, for
/// Module::problem.
Module open_module(const std::string& file_name, const std::string& builder);

}  // namespace item3d
