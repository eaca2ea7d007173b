// Random procedural materials with the words that describe them.
#pragma once

#include "item3d/core/math.h"
#include "item3d/core/random.h"

#include <functional>
#include <string>
#include <vector>

namespace item3d {

struct MaterialValue {
    Vec3 base_color;  ///< linear
    float roughness;
    float metallic;
    /// Gradient of the surface's relief: height by length, in the object's coordinates.
    Vec3 slope{0.0f};
};

struct ProceduralMaterial {
    std::string kind;   ///< "plain", "metal", "wood", ...
    std::string color;  ///< the (first) colour, or the metal's or wood's name; may be empty
    /// Ways to say it, "{o}" stands for the noun: "wooden {o}". Repeated ones are likelier. The
    /// first ends with the noun.
    std::vector<std::string> phrases;
    /// Value at a point of an object inside the unit sphere with that unit normal.
    std::function<MaterialValue(const Vec3& position, const Vec3& normal)> at;
    /// Phrases that training captions leave out and that hold all the same.
    std::vector<std::string> also_true = {};
};

/// What a material should be; empty members are drawn at random.
struct MaterialWish {
    std::string kind;
    std::string color;  ///< as ProceduralMaterial::color
    std::string second_color;
    float pattern_weight = 1;  ///< how often patterns come where the kind is drawn
};

/// A word that a prior is measured by (classifier.h).
struct MaterialWord {
    std::string group;  ///< "materials" or "patterns"
    std::string word;
    std::string caption;                 ///< "a wooden {o}"
    std::vector<std::string> spellings;  ///< words of prompts that mean it
    MaterialWish wish;
    /// For what comes in any colour: "a {c} and {d} striped {o}". Else empty.
    std::string colored_caption;
};
/// Those of all kinds, in a fixed order.
const std::vector<MaterialWord>& material_words();

/// All kinds, in a fixed order.
const std::vector<std::string>& material_kinds();

/// Draws kind, colours and parameters from `random` alone.
ProceduralMaterial make_material(Random& random, const MaterialWish& wish = {});

/// The normal of a surface with that relief.
Vec3 bent_normal(const Vec3& normal, const Vec3& slope);

}  // namespace item3d
