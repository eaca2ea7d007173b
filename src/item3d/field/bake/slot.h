// One image of a material during a bake. Internal to baking.
#pragma once

#include "item3d/scene/image.h"

#include <atomic>
#include <cstdint>
#include <utility>
#include <vector>

namespace item3d {

using TextureSize = std::pair<int, int>;  ///< width and height

struct Slot {
    int texture = -1;     ///< texture of the source
    bool wanted = false;  ///< true as long as the image must be baked
    /// Size in this pass. A texture that the source lacks is tried small first, because most such
    /// textures have one colour.
    TextureSize size{0, 0};
    TextureSize full_size{0, 0};
    Image image;
    std::vector<std::uint8_t> covered;
    /// Bit mask of the channels that are baked or resampled (bit c for channel c). Their uncovered
    /// texels are filled.
    std::atomic<unsigned> filled_channels = 0;
    /// The image without the edit, if keep_source() was called; else empty.
    Image source;
    /// Weight of the edit at each texel, with one channel, if the edit has a region; else empty.
    Image weight;

    /// Starts an uncovered image of `channels` channels. in_part: true if the edit has a region,
    /// and so a weight.
    void open(int channels, bool in_part);
    /// Copies `image` to `source`.
    void keep_source();
    bool is_baked_at(TextureSize pass) const { return wanted && size == pass; }
    void cover(int x, int y, float edited);
    /// Restores the source bit for bit where nothing is edited, and blends at the region's border.
    /// Padding is treated like the texels that it extends. is_copied: true if `source` is valid in
    /// all texels and not only in covered ones; padding: number of layers for fill_uncovered().
    void blend_with_source(bool is_copied, int padding);
};

}  // namespace item3d
