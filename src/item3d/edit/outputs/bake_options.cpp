#include "item3d/edit/outputs/bake_options.h"

namespace item3d {
namespace {

/// BakeOptions::blotch for an edit that makes the same change everywhere.
constexpr float recoloured_blotch = 10.0f / 255;

}  // namespace

BakeOptions bake_options(const EditPlan& plan, const ChannelMask& channels) {
    BakeOptions options;
    options.texture_size = plan.texture_size;
    if (plan.regularizes_color) options.blotch = recoloured_blotch;
    options.channels = {channels.base_color, channels.occlusion, channels.roughness,
                        channels.metallic, channels.normal};
    return options;
}

UvPolicy baked_uvs(const EditPlan& plan) {
    const bool recolors = plan.uv == UvPolicy::automatic && plan.regularizes_color;
    return recolors ? UvPolicy::recolored : plan.uv;
}

}  // namespace item3d
