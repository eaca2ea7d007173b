// Changes of a light that a page asks for in its address: what the viewer shows while a sun is
// dragged.
#pragma once

#include "item3d/scene/image.h"

#include <functional>
#include <optional>
#include <string>

namespace item3d {

/// As the options of `item3d light`, and the hour of `item3d relight --sky`.
struct LightQuery {
    std::optional<float> hour;  ///< 0 to 24: a clear sky in place of the light
    float rotate = 0;           ///< degrees
    float tilt = 0;             ///< degrees
    std::string sun;            ///< "AZIMUTH,ELEVATION[,STRENGTH]"
    std::string lit;            ///< the same in words
    std::string tint;           ///< "#rrggbb"
    float exposure = 0;         ///< stops

    bool changes() const;
};

/// parameter: the value of a name, empty where it is not given. Throws InputError for values that
/// are none.
LightQuery parse_light_query(const std::function<std::string(const std::string&)>& parameter);

/// The light changed in the order of `item3d light`. Throws InputError where words name no
/// direction, and for black tints.
Image changed_light(const Image& light, const LightQuery& query);

}  // namespace item3d
