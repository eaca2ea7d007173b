// One image of a material while it is baked. Internal to baking.
#pragma once

#include "item3d/scene/image.h"

#include <atomic>
#include <cstdint>
#include <utility>
#include <vector>

namespace item3d {

using TextureSize = std::pair<int, int>;  ///< width, height

struct Slot {
    int texture = -1;     ///< of the source
    bool wanted = false;  ///< in this pass
    /// In this pass. A texture that the source lacks is tried small first: most are of one colour.
    TextureSize size{0, 0};
    TextureSize full_size{0, 0};
    Image image;
    std::vector<std::uint8_t> covered;
    /// Bit c: channel c is baked or resampled, so texels beyond the triangles are filled too.
    std::atomic<unsigned> filled_channels = 0;
    /// The image without the edit, where it is kept; else empty.
    Image source;
    /// Where a part of the surface alone is edited: how much of the edit each texel takes, one
    /// channel. Else empty.
    Image weight;

    /// An image of `channels` channels; nothing is covered. in_part: with a weight.
    void open(int channels, bool in_part);
    /// The image as it is becomes what there is without the edit.
    void keep_source();
    bool is_baked_at(TextureSize pass) const { return wanted && size == pass; }
    void cover(int x, int y, float edited);
    /// Puts the source back where nothing is edited, to the bit, and blends at the border. Texels
    /// beyond the triangles go with those that they continue. is_copied: source has all texels of a
    /// picture, not only covered ones. padding: see fill_uncovered().
    void blend_with_source(bool is_copied, int padding);
};

}  // namespace item3d
