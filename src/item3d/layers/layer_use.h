// The use of a layer: its strength and channels.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace item3d {

/// Channels of a layer to apply.
struct LayerChannels {
    bool base_color = true;  ///< including alpha
    bool occlusion = true;
    bool roughness = true;
    bool metallic = true;
    bool normal = true;
};

struct LayerUse {
    /// Strengths are integral multiples of 1 / strength_steps, so that sums do not depend on their
    /// order.
    static constexpr int strength_steps = 1 << 16;
    static constexpr double lowest = -1, highest = 2;

    std::filesystem::path layer;
    std::int64_t strength = strength_steps;  ///< 0 for no change, strength_steps for the full edit
    LayerChannels channels;
};

/// Parses "LAYER[:STRENGTH[:CHANNEL,...]]". LAYER is a file, or the folder of an edit; it may
/// contain colons if it exists. Throws UsageError for a strength that is not a number between
/// lowest and highest, and for an unknown channel.
LayerUse parse_layer_use(const std::string& text);

/// Returns the text after the layer's name: "0.5:roughness"; empty for the whole layer.
std::string strength_text(const LayerUse& use);

}  // namespace item3d
