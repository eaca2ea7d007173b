#include "item3d/prior/data/shapes/shapes.h"

#include "item3d/core/error.h"
#include "item3d/core/random.h"
#include "item3d/prior/data/shapes/animals.h"
#include "item3d/prior/data/shapes/figures.h"
#include "item3d/prior/data/shapes/food.h"
#include "item3d/prior/data/shapes/furniture.h"
#include "item3d/prior/data/shapes/makers.h"
#include "item3d/prior/data/shapes/solids.h"
#include "item3d/prior/data/shapes/things.h"
#include "item3d/prior/data/shapes/vehicles.h"
#include "item3d/prior/data/shapes/vessels.h"

#include <algorithm>

namespace item3d {
namespace {

const std::vector<ShapeMaker>& shape_makers() {
    static const std::vector<ShapeMaker> makers = [] {
        std::vector<ShapeMaker> all;
        for (const auto theme : {vessel_shapes, furniture_shapes, vehicle_shapes, food_shapes,
                                 animal_shapes, figure_shapes, thing_shapes, solid_shapes}) {
            const std::vector<ShapeMaker> some = theme();
            all.insert(all.end(), some.begin(), some.end());
        }
        return all;
    }();
    return makers;
}

}  // namespace

float Shape::distance(const Vec3& p) const {
    float result = parts[0].distance(p);
    for (std::size_t i = 1; i < parts.size(); ++i) {
        const float part = parts[i].distance(p);
        result = fillet > 0 ? sdf::smooth_merge(fillet, {result, part}) : std::min(result, part);
    }
    return result;
}

int Shape::part_at(const Vec3& p) const {
    if (parts.size() == 1) return 0;
    std::size_t nearest = 0;
    float minimum = parts[0].distance(p);
    for (std::size_t i = 1; i < parts.size(); ++i) {
        const float part = parts[i].distance(p);
        if (part < minimum) minimum = part, nearest = i;
    }
    return static_cast<int>(nearest);
}

const std::vector<ShapeClass>& shape_classes() {
    static const std::vector<ShapeClass> classes = [] {
        std::vector<ShapeClass> all;
        for (const ShapeMaker& maker : shape_makers())
            all.push_back(maker.shape);
        return all;
    }();
    return classes;
}

std::vector<int> shape_variants_of(const ShapeClass& shape, bool held_out, int count) {
    std::vector<int> variants;
    if (shape.held_out && !held_out) return variants;
    for (int i = 0; static_cast<int>(variants.size()) < count; ++i) {
        if (held_out && i >= shape_variants) break;
        const bool is_held_out = shape.held_out || (i >= training_variants && i < shape_variants);
        if (is_held_out == held_out) variants.push_back(i);
    }
    return variants;
}

int shape_class_index(const std::string& name) {
    const auto& classes = shape_classes();
    const auto known = std::find_if(classes.begin(), classes.end(),
                                    [&](const ShapeClass& each) { return each.name == name; });
    ITEM3D_CHECK(known != classes.end(), "unknown shape class " + name);
    return static_cast<int>(known - classes.begin());
}

Shape make_shape(const std::string& shape_class, int variant) {
    const ShapeMaker& maker =
        shape_makers()[static_cast<std::size_t>(shape_class_index(shape_class))];
    std::uint64_t name = 0;
    for (const char letter : shape_class)
        name = mix_bits(name ^ static_cast<unsigned char>(letter));
    Draw u(Random(name, static_cast<std::uint64_t>(variant)));
    Shape shape = maker.make(u);
    // The proportions are random: the shape is taller or flatter, and thicker or thinner, than its
    // class.
    const Vec3 scale{1.0f, u(.88, 1.14), u(.93, 1.07)};
    const float shrink = std::min(scale.x, std::min(scale.y, scale.z));
    for (ShapePart& part : shape.parts) {
        part.distance = [inner = std::move(part.distance), scale, shrink](const Vec3& p) {
            return inner(p / scale) * shrink;
        };
    }
    return shape;
}

}  // namespace item3d
