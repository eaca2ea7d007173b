// The list of item3d's commands, and of the programs that contain them.
#pragma once

#include <array>
#include <string_view>

namespace item3d {

struct CommandEntry {
    std::string_view name;
    std::string_view family;  ///< the command is in the program item3d-FAMILY
    std::string_view description;
};

/// The commands in the order of `item3d --help`.
inline constexpr std::array commands = {
    CommandEntry{"edit", "edit", "Edit the look of a textured model from two sentences"},
    CommandEntry{"reconstruct", "reconstruct", "Reconstruct a model from photographs"},
    CommandEntry{"render", "edit", "Render images of a model"},
    CommandEntry{"light", "edit", "Convert, change and describe a light"},
    CommandEntry{"relight", "edit", "Show a model under another light"},
    CommandEntry{"generate", "edit", "Generate images from a prompt"},
    CommandEntry{"caption", "edit", "Describe an image or a model in words"},
    CommandEntry{"score", "edit", "Measure with CLIP how well an edit follows its sentences"},
    CommandEntry{"region", "edit", "Show which part of a model a selector selects"},
    CommandEntry{"layers", "edit", "Apply edits to a model as layers, each at any strength"},
    CommandEntry{"variants", "edit", "Combine several edits of a model as variants in one file"},
    CommandEntry{"provenance", "edit",
                 "Show how a model or an image was edited, and who signed it"},
    CommandEntry{"batch", "edit", "Run many edits with one or more workers"},
    CommandEntry{"guidance", "edit", "Compute guidance gradients for images of another program"},
    CommandEntry{"tensors", "edit", "Write geometry, materials and textures of a model as tensors"},
    CommandEntry{"compare", "compare", "Compare methods on a list of edits, in tables and a page"},
    CommandEntry{"study", "study", "Run a user study of edits and analyze the ratings"},
    CommandEntry{"studio", "studio", "Edit models in the browser"},
    CommandEntry{"mcp", "studio", "Serve agents over the Model Context Protocol"},
    CommandEntry{"prior", "train", "Train, fetch and inspect priors"},
    CommandEntry{"bench", "bench", "Measure the speed of this machine"},
};

/// Returns the command of this name; null if there is none.
constexpr const CommandEntry* find_command(std::string_view name) {
    for (const CommandEntry& command : commands)
        if (command.name == name) return &command;
    return nullptr;
}

}  // namespace item3d
