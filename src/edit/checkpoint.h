// The state of an unfinished edit: one safetensors file, replaced atomically.
#pragma once

#include "item3d/models/safetensors.h"

#include <filesystem>
#include <optional>
#include <string>

namespace item3d {

struct Checkpoint {
    /// The settings and input that the state belongs to, as JSON text. A resume with other ones is
    /// refused: its result would be neither the one nor the other.
    std::string identity;
    std::int64_t iteration = 0;  ///< iterations done
    NamedTensors tensors;
};

void save_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint);

/// No value when there is no file. Throws InputError when it is broken.
std::optional<Checkpoint> load_checkpoint(const std::filesystem::path& path);

}  // namespace item3d
