// What LoRA and embedding files have in common: how the command line names them, and that a pickle
// is not opened.
#pragma once

#include "item3d/tensors/safetensors.h"

#include <filesystem>
#include <string>

namespace item3d {

/// "FILE" or "FILE:REST"; a file whose own name has a colon is taken whole where it is there.
struct AdapterArgument {
    std::filesystem::path file;
    std::string rest;  ///< what is behind the last colon, "" without one
};
AdapterArgument split_adapter_argument(const std::string& argument);

/// SafeTensors::open, but for PyTorch's pickles (.pt, .bin, .ckpt, .pth, or a file that begins as
/// one) an InputError that says why they are not read.
SafeTensors open_adapter(const std::filesystem::path& file);

}  // namespace item3d
