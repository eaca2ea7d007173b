// Common parts of LoRA and embedding files: the command line's FILE:REST syntax, and refusal of
// pickles.
#pragma once

#include "item3d/tensors/safetensors.h"

#include <filesystem>
#include <string>

namespace item3d {

/// Argument "FILE" or "FILE:REST". An argument that is the path of an existing file is a FILE, even
/// if it contains a colon.
struct AdapterArgument {
    std::filesystem::path file;
    std::string rest;  ///< text after the last colon, "" without one
};
AdapterArgument split_adapter_argument(const std::string& argument);

/// Opens a file as SafeTensors::open does. Throws InputError for PyTorch pickles (.pt, .bin, .ckpt,
/// .pth, or a file with a pickle's first bytes), with the reason why they are not read.
SafeTensors open_adapter(const std::filesystem::path& file);

}  // namespace item3d
