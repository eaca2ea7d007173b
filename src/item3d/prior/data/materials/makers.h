// Shared helpers of the files of material themes (metals.h, woods.h, ...), each of which returns
// its kinds.
//
// Scales: an object of radius 1 has a radius of 25 to 30 pixels in an image of 64 pixels, so a wave
// of frequency f (radians per unit) is 170 / f pixels long, and a cell of a pattern with f cells
// per unit is 27 / f pixels wide. Features finer than four pixels are not meant to be visible.
#pragma once

#include "item3d/prior/data/materials/colors.h"
#include "item3d/prior/data/materials/materials.h"
#include "item3d/prior/data/shapes/noise.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace item3d::paint {

struct MaterialKind {
    std::string name;
    double share;  ///< weight in the training data
    ProceduralMaterial (*make)(Random&, const MaterialWish&);
    std::vector<MaterialWord> words;
};

/// Returns the word of a kind that has only one word. If `caption` is empty, its caption is "a
/// {word} {o}".
MaterialWord word_of(const std::string& group, const std::string& kind, const std::string& word,
                     const std::vector<std::string>& spellings = {},
                     const std::string& caption = "");
inline MaterialWord material_word(const std::string& kind, const std::string& word,
                                  const std::vector<std::string>& spellings = {}) {
    return word_of("materials", kind, word, spellings);
}
inline MaterialWord pattern_word(const std::string& kind, const std::string& word,
                                 const std::vector<std::string>& spellings = {}) {
    return word_of("patterns", kind, word, spellings);
}

/// Returns the word with a caption that names its colours.
inline MaterialWord colored(MaterialWord word, const std::string& caption) {
    word.colored_caption = caption;
    return word;
}

inline float draw(Random& random, double low, double high) {
    return static_cast<float>(random.uniform(low, high));
}
inline Vec3 mix(const Vec3& a, const Vec3& b, float weight) {
    return a + (b - a) * weight;
}
inline float smooth_step(float x, float low, float high) {
    const float t = std::clamp((x - low) / (high - low), 0.0f, 1.0f);
    return t * t * (3 - 2 * t);
}
inline float fraction(float x) {
    return x - std::floor(x);
}
inline bool odd(float whole_number) {
    return fraction(whole_number * .5f) > .25f;
}
inline Vec3 limit(const Vec3& color) {
    return glm::clamp(color, Vec3(0.0f), Vec3(1.0f));
}

/// Returns a colour near the given one: brighter or darker, and each channel slightly changed.
Vec3 vary(Random& random, const Vec3& color, double spread = .12);

/// Returns the wished plain colour, or a random one.
std::string one_color(Random& random, const MaterialWish& wish);
/// Returns two different plain colours, wished or random.
std::pair<std::string, std::string> two_colors(Random& random, const MaterialWish& wish);

/// Wording of a material. Captions name its colours if these are arbitrary (`named`). They do not
/// name the usual colours of a material, so a sentence without colours means the usual ones.
struct Wording {
    std::vector<std::string> phrases, also_true;  ///< see ProceduralMaterial
};
inline Wording wording(bool named, const std::vector<std::string>& with_colors,
                       const std::vector<std::string>& without) {
    return named ? Wording{with_colors, without} : Wording{without, with_colors};
}

/// Returns a hash of the cell in 0 .. 1.
float cell_value(float x, float y, float z = 0);

/// Two nearest points, where each unit cell has one random point (Worley 1996, "A Cellular Texture
/// Basis Function").
struct NearPoints {
    float first, second;  ///< distances
    float value;          ///< cell_value of the nearest point's cell
};
NearPoints near_points(const Vec3& p);

/// Cells per unit of length, in patterns that have the same place on every object. The network can
/// learn such a pattern. A cell is half a unit, or 13 pixels, wide.
inline constexpr float cells_a_unit = 2;

/// Returns coordinates on the coordinate plane that is most perpendicular to the normal, for bricks
/// and other flat patterns.
inline Vec2 flat_coordinates(const Vec3& p, const Vec3& n) {
    const Vec3 a = glm::abs(n);
    if (a.x >= a.y && a.x >= a.z) return Vec2(p.z, p.y);
    if (a.y >= a.z) return Vec2(p.x, p.z);
    return Vec2(p.x, p.y);
}
/// Converts a slope in flat_coordinates() to one in space.
inline Vec3 flat_slope(const Vec2& slope, const Vec3& n) {
    const Vec3 a = glm::abs(n);
    if (a.x >= a.y && a.x >= a.z) return Vec3(0, slope.y, slope.x);
    if (a.y >= a.z) return Vec3(slope.x, 0, slope.y);
    return Vec3(slope.x, slope.y, 0);
}

/// Parameters of a material in which noise mixes two tones, with a relief: stone, moss, leather,
/// ...
struct Grain {
    Vec3 dark, light;
    float frequency;  ///< frequency of the noise, in radians per unit
    int octaves = 2;
    float spread = 1.3f;  ///< noise value of the light tone; -spread gives the dark one
    float rough_dark = .85f, rough_light = .85f;
    float relief = 0;    ///< approximate steepest slope
    Vec3 stretch{1.0f};  ///< factor of the noise's coordinates
};
std::function<MaterialValue(const Vec3&, const Vec3&)> grained(Random& random, const Grain& grain);

}  // namespace item3d::paint
