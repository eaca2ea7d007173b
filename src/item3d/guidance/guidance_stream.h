// Guidance for images of another program, as frames on two pipes. Both ends run on one machine, so
// numbers have its byte order.
//
// A request is one line of JSON and, right behind its newline, float32 arrays in this order:
//
//     {"iteration": 0, "views": N, "height": H, "width": W,
//      "depth": true, "surface": true, "reference": true}     the last three: false unless given
//     images [N, 3, H, W] sRGB in [0, 1]
//     depth [N, H, W] z-depth, 0 for background                                  with "depth"
//     position [N, H, W, 3] in the unit sphere, normal [N, H, W, 3] unit         with "surface"
//     reference [N, 3, H, W] the unedited images of the same cameras             with "reference"
//
// A reply is one line of JSON, see write_guidance_reply(), and float32 [N, 3, H, W], the gradient
// with respect to the images.
#pragma once

#include "item3d/guidance/guidance.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>

namespace item3d {

struct GuidanceRequest {
    std::int64_t iteration = 0;
    GuidanceInput input;  ///< float32 on the CPU
};

/// Reads up to `size` bytes, blocking; returns their number, 0 at the end of the stream.
using ReadBytes = std::function<std::size_t(char* to, std::size_t size)>;
/// Writes all bytes. Throws ResourceError.
using WriteBytes = std::function<void(const char* from, std::size_t size)>;

/// Reads one request; no value at the end of the stream. Throws InputError for a broken line, sizes
/// out of range (views 1 to 1024, sides 8 to 4096, 1 GB in all), a stream that ends within a
/// request, and numbers that are not finite.
std::optional<GuidanceRequest> read_guidance_request(const ReadBytes& read);

/// Writes a reply: {"iteration", "direction_length", "source_loss", "timestep", "noise_seed",
/// "unet_rows": int, "direction": {"angle": degrees, "length"} of text_direction()}, then the
/// gradient [N, 3, H, W].
void write_guidance_reply(const WriteBytes& write, const nlohmann::json& line,
                          const at::Tensor& gradient);

}  // namespace item3d
