#include "item3d/core/module.h"

#include "item3d/core/program.h"

#include <dlfcn.h>

#include <filesystem>

namespace item3d {

Module open_module(const std::string& file_name, const std::string& builder) {
    const std::filesystem::path folder = running_program().parent_path();
    std::error_code error;
    for (const std::filesystem::path& path :
         {folder / file_name, folder / ".." / "lib" / "item3d" / file_name}) {
        if (!std::filesystem::exists(path, error)) continue;
        void* handle = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
        return handle != nullptr ? Module{handle, ""} : Module{nullptr, dlerror()};
    }
    return {nullptr,
            file_name + " (built by `" + builder + "`) was not found in " + folder.string()};
}

}  // namespace item3d
