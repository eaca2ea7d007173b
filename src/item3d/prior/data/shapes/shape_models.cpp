#include "item3d/prior/data/shapes/shape_models.h"

#include "item3d/core/words.h"
#include "item3d/prior/data/shapes/polygonize.h"
#include "item3d/prior/data/shapes/shapes.h"

#include <algorithm>

namespace item3d {

Model shape_model(const std::string& shape_class, int variant) {
    constexpr int cells_a_side = 96;
    const Shape shape = make_shape(shape_class, variant);
    const auto distance = [&](const Vec3& point) { return shape.distance(point); };
    Model model;
    model.materials.resize(1);
    model.primitives.push_back(polygonize(distance, cells_a_side).primitive);
    return model;
}

std::optional<std::string> shape_named(const std::string& sentence) {
    for (const std::string& word : prompt_words(sentence))
        for (const ShapeClass& shape : shape_classes())
            if (word != "object" &&
                std::find(shape.nouns.begin(), shape.nouns.end(), word) != shape.nouns.end())
                return shape.name;
    return std::nullopt;
}

}  // namespace item3d
