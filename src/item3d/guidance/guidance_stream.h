// Guidance for the images of another program, which exchanges requests and replies with item3d on
// two pipes. Both programs run on one machine, so numbers have the machine's byte order.
//
// A request is one line of JSON. Right behind its newline follow float32 arrays in this order:
//
//     {"iteration": 0, "views": N, "height": H, "width": W,
//      "depth": true, "surface": true, "reference": true}     the last three are false unless given
//     images [N, 3, H, W] sRGB in [0, 1]
//     depth [N, H, W] z-depth, 0 for background                                  if "depth"
//     position [N, H, W, 3] in the unit sphere, normal [N, H, W, 3] unit         if "surface"
//     reference [N, 3, H, W] the unedited images of the same cameras             if "reference"
//
// A reply is one line of JSON (write_guidance_reply()). Behind it follows the gradient with respect
// to the images, float32 [N, 3, H, W].
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

/// Reads up to `size` bytes. Blocks until there are some. Returns their number; 0 at the end of the
/// stream.
using ReadBytes = std::function<std::size_t(char* to, std::size_t size)>;
/// Writes all bytes. Throws ResourceError.
using WriteBytes = std::function<void(const char* from, std::size_t size)>;

/// Reads one request. Returns no value at the end of the stream. Throws InputError for a broken
/// line, for sizes out of range (1 to 1024 views, sides of 8 to 4096 pixels, 1 GB in total), for a
/// stream that ends within a request, and for numbers that are not finite.
std::optional<GuidanceRequest> read_guidance_request(const ReadBytes& read);

/// Writes a reply: the JSON line, then the gradient [N, 3, H, W]. line: {"iteration",
/// "direction_length", "source_loss", "timestep", "noise_seed", "unet_rows", "direction": {"angle",
/// "length"}}. "unet_rows" is the number of U-Net evaluations; "direction" is
/// Guidance::text_direction(), with the angle in degrees.
void write_guidance_reply(const WriteBytes& write, const nlohmann::json& line,
                          const at::Tensor& gradient);

}  // namespace item3d
