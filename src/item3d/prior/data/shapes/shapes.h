// Procedural objects of the embedded prior's training data.
#pragma once

#include "item3d/prior/data/shapes/signed_distance.h"

#include <string>
#include <vector>

namespace item3d {

/// Variants training_variants .. shape_variants - 1 of a class are held out for evaluation. All
/// other variants are for training: the lower ones, and the higher ones if more are needed.
inline constexpr int training_variants = 30;
inline constexpr int shape_variants = 32;

struct ShapeClass {
    std::string name;
    /// Single-word nouns of captions, the most frequent first.
    std::vector<std::string> nouns;
    /// True if the whole class is kept out of training.
    bool held_out = false;
};

/// Named part ("handle", "wheels"), or the object's main part, which has no name.
struct ShapePart {
    std::string noun;  ///< empty for the part that the class is named after
    SignedDistance distance;
};

/// Shape of touching parts that are joined with fillets.
struct Shape {
    std::vector<ShapePart> parts;  ///< the unnamed part first
    float fillet = 0;              ///< k of smooth_merge; 0 gives sharp joints

    float distance(const Vec3& p) const;
    /// Returns the index of the part nearest to the point.
    int part_at(const Vec3& p) const;
};

/// Returns all classes: "mug", "car", "apple", ...; "blob" is a random shape called "object".
const std::vector<ShapeClass>& shape_classes();
/// Returns an index into shape_classes(); the class must exist.
int shape_class_index(const std::string& name);

/// Returns the first `count` training variants of a class (none of a held-out class), or up to
/// `count` held-out ones.
std::vector<int> shape_variants_of(const ShapeClass& shape, bool held_out, int count);

/// Returns a shape of about unit size around the origin, y up; deterministic in (class, variant).
Shape make_shape(const std::string& shape_class, int variant);

}  // namespace item3d
