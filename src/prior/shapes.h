// The procedural objects that the embedded prior learns from.
#pragma once

#include "item3d/prior/signed_distance.h"

#include <string>
#include <vector>

namespace item3d {

/// Variants 0 .. training_variants - 1 of a class are for training, the others up to
/// shape_variants - 1 are held out for measuring.
inline constexpr int training_variants = 30;
inline constexpr int shape_variants = 32;

struct ShapeClass {
    std::string name;
    /// Nouns that captions use for it, the first most of the time.
    std::vector<std::string> nouns;
    /// The whole class is kept out of training.
    bool held_out = false;
};

/// "mug", "vase", ... and "teapot", which is held out. "blob" is random stuff called "object".
const std::vector<ShapeClass>& shape_classes();

/// A shape of about unit size around the origin, y up. The same (class, variant) is the same shape.
SignedDistance make_shape(const std::string& shape_class, int variant);

}  // namespace item3d
