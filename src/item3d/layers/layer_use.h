// A layer as it is to be applied: how much of it, and of which channels.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace item3d {

/// Channels of a layer that are applied.
struct LayerChannels {
    bool base_color = true;  ///< with its alpha
    bool occlusion = true;
    bool roughness = true;
    bool metallic = true;
    bool normal = true;
};

struct LayerUse {
    /// Strengths are whole multiples of 1 / strength_steps, so that sums do not depend on an order.
    static constexpr int strength_steps = 1 << 16;
    static constexpr double lowest = -1, highest = 2;

    std::filesystem::path layer;
    std::int64_t strength = strength_steps;  ///< 0: no change, strength_steps: as the edit
    LayerChannels channels;
};

/// "LAYER[:STRENGTH[:CHANNEL,...]]". LAYER is a file, or the folder of an edit; where it has colons
/// itself, what is there counts. Throws UsageError for a strength that is no number between lowest
/// and highest, and for a channel that there is not.
LayerUse parse_layer_use(const std::string& text);

/// What would be behind the layer's name: "0.5:roughness"; empty where it is applied as a whole.
std::string strength_text(const LayerUse& use);

}  // namespace item3d
