#include "item3d/prior/data/materials/materials.h"

#include "item3d/core/error.h"
#include "item3d/prior/data/materials/crafts.h"
#include "item3d/prior/data/materials/fabrics.h"
#include "item3d/prior/data/materials/foods.h"
#include "item3d/prior/data/materials/furs.h"
#include "item3d/prior/data/materials/geometric.h"
#include "item3d/prior/data/materials/makers.h"
#include "item3d/prior/data/materials/metals.h"
#include "item3d/prior/data/materials/nature.h"
#include "item3d/prior/data/materials/ornaments.h"
#include "item3d/prior/data/materials/plain.h"
#include "item3d/prior/data/materials/stones.h"
#include "item3d/prior/data/materials/woods.h"

#include <algorithm>

namespace item3d {
namespace paint {
namespace {

const std::vector<MaterialKind>& all_kinds() {
    static const std::vector<MaterialKind> kinds = [] {
        std::vector<MaterialKind> all;
        for (const auto theme :
             {plain_materials, metal_materials, wood_materials, stone_materials, craft_materials,
              fabric_materials, nature_materials, food_materials, fur_patterns, geometric_patterns,
              ornament_patterns}) {
            const std::vector<MaterialKind> some = theme();
            all.insert(all.end(), some.begin(), some.end());
        }
        return all;
    }();
    return kinds;
}

}  // namespace
}  // namespace paint

const std::vector<MaterialWord>& material_words() {
    static const std::vector<MaterialWord> words = [] {
        std::vector<MaterialWord> all;
        for (const char* group : {"materials", "patterns"})
            for (const paint::MaterialKind& kind : paint::all_kinds())
                for (const MaterialWord& word : kind.words)
                    if (word.group == group) all.push_back(word);
        return all;
    }();
    return words;
}

const std::vector<std::string>& material_kinds() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> all;
        for (const paint::MaterialKind& kind : paint::all_kinds())
            all.push_back(kind.name);
        return all;
    }();
    return names;
}

ProceduralMaterial make_material(Random& random, const MaterialWish& wish) {
    const auto& kinds = paint::all_kinds();
    const auto share = [&](const paint::MaterialKind& kind) {
        const bool pattern = !kind.words.empty() && kind.words[0].group == "patterns";
        return pattern ? kind.share * wish.pattern_weight : kind.share;
    };
    double total = 0;
    for (const paint::MaterialKind& kind : kinds)
        total += share(kind);
    double at = random.uniform() * total;
    const paint::MaterialKind* chosen = nullptr;
    for (const paint::MaterialKind& kind : kinds) {
        if (wish.kind.empty() ? (at -= share(kind)) < 0 : wish.kind == kind.name) {
            chosen = &kind;
            break;
        }
    }
    if (!chosen && wish.kind.empty()) chosen = &kinds[0];
    ITEM3D_CHECK(chosen, "unknown material " + wish.kind);
    ProceduralMaterial material = chosen->make(random, wish);
    material.kind = chosen->name;
    return material;
}

Vec3 bent_normal(const Vec3& normal, const Vec3& slope) {
    const Vec3 along = slope - glm::dot(slope, normal) * normal;
    return glm::normalize(normal - along);
}

}  // namespace item3d
