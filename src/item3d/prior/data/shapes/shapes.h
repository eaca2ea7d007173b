// The procedural objects that the embedded prior learns from.
#pragma once

#include "item3d/prior/data/shapes/signed_distance.h"

#include <string>
#include <vector>

namespace item3d {

/// Variants training_variants .. shape_variants - 1 of a class are held out for measuring. Those
/// before them are for training, and those after them, where more are wanted.
inline constexpr int training_variants = 30;
inline constexpr int shape_variants = 32;

struct ShapeClass {
    std::string name;
    /// Single words that captions use for it, the first most of the time.
    std::vector<std::string> nouns;
    /// The whole class is kept out of training.
    bool held_out = false;
};

/// A piece with a name of its own ("handle", "wheels"), or the rest of the object.
struct ShapePart {
    std::string noun;  ///< empty: what the class is named after
    SignedDistance distance;
};

/// Parts that touch, joined with fillets.
struct Shape {
    std::vector<ShapePart> parts;  ///< the rest first
    float fillet = 0;              ///< as the k of smooth_merge; 0: sharp joints

    float distance(const Vec3& p) const;
    /// Index of the part that is nearest to the point.
    int part_at(const Vec3& p) const;
};

/// "mug", "car", "apple", ...; "blob" is random stuff called "object".
const std::vector<ShapeClass>& shape_classes();
/// Index into shape_classes(); the class must be there.
int shape_class_index(const std::string& name);

/// The first `count` variants of a class that are for training (none of a class that is held out),
/// or those that are held out, where there are so many.
std::vector<int> shape_variants_of(const ShapeClass& shape, bool held_out, int count);

/// A shape of about unit size around the origin, y up. The same (class, variant) is the same shape.
Shape make_shape(const std::string& shape_class, int variant);

}  // namespace item3d
