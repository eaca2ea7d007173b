// The sky by time of day.
#pragma once

#include "item3d/core/math.h"
#include "item3d/scene/image.h"

namespace item3d {

/// Returns the sun's direction at `hour` (0 to 24, solar time) on an equinox at 45 degrees north:
/// it rises in the east (+X) at 6, stands 45 degrees high in the south (+Z) at 12, and sets in the
/// west at 18.
Vec3 sun_direction_at(float hour);

/// Returns a clear sky at that hour (sky_model.h). It is hazier for a lower sun, and blends through
/// dusk into the moonlit preset "night". The image is height x 2*height x 3, and scaled like the
/// presets: the brightest white surface has radiance 1 by day, 0.7 with the sun 4 degrees high, and
/// 0.15 by night. Throws InputError for hours outside [0, 24].
Image make_sky_at(float hour, int height = 256);

}  // namespace item3d
