// List of the commands of item3d and the programs that contain them.
#pragma once

#include <array>
#include <string_view>

namespace item3d {

struct CommandEntry {
    std::string_view name;
    std::string_view family;  ///< contained in item3d-FAMILY
    std::string_view description;
};

/// Commands in the order of `item3d --help`.
inline constexpr std::array commands = {
    CommandEntry{"edit", "edit", "Edit the look of a textured model from two sentences"},
    CommandEntry{"reconstruct", "reconstruct", "Make a model from photographs with poses"},
    CommandEntry{"render", "edit", "Draw pictures of a model"},
    CommandEntry{"light", "edit", "Convert, change and describe a light"},
    CommandEntry{"relight", "edit", "Show a model under another light"},
    CommandEntry{"generate", "edit", "Draw pictures from a prompt with the prior alone"},
    CommandEntry{"caption", "edit", "Describe a picture or a model in words"},
    CommandEntry{"score", "edit", "Measure by CLIP how well an edit follows its sentences"},
    CommandEntry{"region", "edit", "Show what part of a model selectors take, before an edit"},
    CommandEntry{"layers", "edit", "Apply what edits changed to a model, at any strength"},
    CommandEntry{"variants", "edit", "Put several edits of a model into one file, as looks of it"},
    CommandEntry{"provenance", "edit", "Say how a model or an image was edited, and who signed it"},
    CommandEntry{"batch", "edit", "Run many edits by as many workers as there are"},
    CommandEntry{"guidance", "edit", "Compute gradients of guidance for images of another program"},
    CommandEntry{"tensors", "edit",
                 "Write the triangles, materials and textures of a model as tensors"},
    CommandEntry{"compare", "compare", "Run methods on a list of edits; tables and a page of them"},
    CommandEntry{"study", "study",
                 "Ask people what they think of edits, and analyze what they say"},
    CommandEntry{"studio", "studio", "Edit models on a page in the browser"},
    CommandEntry{"mcp", "studio", "Serve agents over the Model Context Protocol"},
    CommandEntry{"prior", "train", "Train, fetch and inspect priors"},
    CommandEntry{"bench", "bench", "Measure how fast this machine is"},
};

/// Returns the command of this name, null if there is none.
constexpr const CommandEntry* find_command(std::string_view name) {
    for (const CommandEntry& command : commands)
        if (command.name == name) return &command;
    return nullptr;
}

}  // namespace item3d
