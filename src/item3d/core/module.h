// Optional parts of the project: shared libraries beside the programs, which are opened on demand.
#pragma once

#include <string>

namespace item3d {

struct Module {
    void* handle = nullptr;
    std::string problem;  ///< if the handle is null, the reason in words
};

/// Opens the shared library FILE_NAME in the running program's folder or in ../lib/item3d relative
/// to that folder. The library is never closed. builder: the command that builds the library, for
/// Module::problem.
Module open_module(const std::string& file_name, const std::string& builder);

}  // namespace item3d
