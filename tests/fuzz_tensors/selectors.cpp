#include "item3d/layers/layer_use.h"
#include "item3d/region/region.h"
#include "item3d/region/selector.h"
#include "tests/fuzz/fuzz.h"

namespace {

/// Returns a square of one material.
item3d::Model square_model() {
    using namespace item3d;
    Primitive square;
    square.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    square.normals.assign(4, Vec3(0, 0, 1));
    square.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    square.indices = {0, 1, 2, 0, 2, 3};
    Model model;
    model.materials.resize(1);
    model.materials[0].name = "glaze";
    model.primitives = {square};
    return model;
}

}  // namespace

/// Parses a text as a layer with its strength, and selects a region with the same text as selector.
ITEM3D_FUZZ_TARGET(selectors, data, size) {
    using namespace item3d;
    static const Model model = square_model();
    static const Geometry geometry = Geometry::from_model(model);
    static const TexturedMaterials textured(model);
    static const FieldSpace space(model, {0});
    const std::string text = fuzz::as_text(data, size);
    fuzz::read_or_refuse([&] { parse_layer_use(text); });
    return fuzz::read_or_refuse([&] {
        is_independent_of_textures(text);
        RegionRequest request;
        request.include = {text};
        const Region region(request, {model, geometry, textured, space});
        region.share();
    });
}
