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
    /// Gradient of the surface's relief: height per length, in the object's coordinates.
    Vec3 slope{0.0f};
};

struct ProceduralMaterial {
    std::string kind;   ///< "plain", "metal", "wood", ...
    std::string color;  ///< name of the (first) colour, metal or wood; may be empty
    /// Phrases of the material, such as "wooden {o}", in which "{o}" stands for the noun. A
    /// repeated phrase is drawn more often. The first phrase ends with the noun.
    std::vector<std::string> phrases;
    /// Value at a point of an object inside the unit sphere with the given unit normal.
    std::function<MaterialValue(const Vec3& position, const Vec3& normal)> at;
    /// True phrases that training captions omit.
    std::vector<std::string> also_true = {};
};

/// Requirements of a material; empty members are drawn at random.
struct MaterialWish {
    std::string kind;
    std::string color;  ///< see ProceduralMaterial::color
    std::string second_color;
    float pattern_weight = 1;  ///< weight of patterns when the kind is drawn
};

/// Word on which the accuracy of a prior is measured (classifier.h).
struct MaterialWord {
    std::string group;  ///< "materials" or "patterns"
    std::string word;
    std::string caption;                 ///< "a wooden {o}"
    std::vector<std::string> spellings;  ///< prompt words with this meaning
    MaterialWish wish;
    /// Caption that names the colours, "{c}" and "{d}", of a kind that can have any colours: "a {c}
    /// and {d} striped {o}". Empty for other kinds.
    std::string colored_caption;
};
/// Returns the words of all kinds, in a fixed order.
const std::vector<MaterialWord>& material_words();

/// Returns all kinds, in a fixed order.
const std::vector<std::string>& material_kinds();

/// Draws kind, colours and parameters from `random` alone.
ProceduralMaterial make_material(Random& random, const MaterialWish& wish = {});

/// Returns the normal of a surface with the given relief slope.
Vec3 bent_normal(const Vec3& normal, const Vec3& slope);

}  // namespace item3d
