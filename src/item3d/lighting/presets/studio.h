// A photographer's studio, a grey room with soft boxes, computed without noise.
#pragma once

#include "item3d/scene/image.h"

namespace item3d {

/// Returns linear RGB radiance seen from the middle of the room, height x 2*height x 3 (conventions
/// of environment.h). Walls are lit by Lambert's closed formula for polygons (1760; Baum et al.
/// 1989); interreflection between walls is approximated as uniform.
Image make_studio(int height);

}  // namespace item3d
