// Random procedural materials with the words that describe them.
#pragma once

#include "item3d/core/math.h"
#include "item3d/core/random.h"

#include <functional>
#include <string>
#include <vector>

namespace item3d {

struct PlainColor {
    std::string name;
    Vec3 linear;  ///< base colour, linear RGB
};
/// The twelve plain colours: "red" ... "cyan".
const std::vector<PlainColor>& plain_colors();
/// Base colours (normal reflectance) of "gold", "silver", "copper", "bronze".
const std::vector<PlainColor>& metal_colors();

struct MaterialValue {
    Vec3 base_color;  ///< linear
    float roughness;
    float metallic;
};

struct ProceduralMaterial {
    std::string kind;   ///< "plain", "metal", "wood", ...
    std::string color;  ///< the (first) colour or the metal's name; empty where it has none
    /// Ways to say it, "{o}" stands for the noun: "wooden {o}". Repeated ones are likelier.
    std::vector<std::string> phrases;
    /// Value at a point of an object inside the unit sphere with that unit normal.
    std::function<MaterialValue(const Vec3& position, const Vec3& normal)> at;
};

/// What a material should be; empty members are drawn at random.
struct MaterialWish {
    std::string kind;
    std::string color;
    std::string second_color;
};

/// All kinds, in a fixed order.
const std::vector<std::string>& material_kinds();

/// Draws kind, colours and parameters from `random` alone.
ProceduralMaterial make_material(Random& random, const MaterialWish& wish = {});

}  // namespace item3d
