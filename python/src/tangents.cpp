#include "python/src/tangents.h"

#include "item3d/render/tangents.h"

#include <algorithm>
#include <cstring>

namespace item3d::python {
namespace {

/// Returns the rows of a tensor [V, length of Row].
template <typename Row>
std::vector<Row> rows(const Tensor& tensor) {
    std::vector<Row> result(static_cast<std::size_t>(tensor.size(0)));
    static_assert(sizeof(Row) == sizeof(float) * Row::length());
    if (!result.empty())
        std::memcpy(static_cast<void*>(result.data()), floats(tensor), sizeof(Row) * result.size());
    return result;
}

}  // namespace

Tensor tangents(const Tensor& positions_, const Tensor& normals_, const Tensor& uvs_,
                const Tensor& triangles_) {
    const Operation call("tangents", positions_);
    const auto matrix = [&](const char* name, const Tensor& tensor, const Sizes& sizes) {
        const Tensor good = call.checked(name, tensor, ScalarType::Float, sizes);
        call.check_finite(name, good);
        return call.on_cpu(good);
    };
    const Tensor positions = matrix("positions", positions_, {-1, 3});
    const std::int64_t vertices = positions.size(0);
    Tensor triangles = call.checked("triangles", triangles_, ScalarType::Int, {-1, 3});
    call.check_indices(triangles, vertices);
    triangles = call.on_cpu(triangles);
    Primitive primitive;
    primitive.positions = rows<Vec3>(positions);
    primitive.normals = rows<Vec3>(matrix("normals", normals_, {vertices, 3}));
    primitive.uvs = rows<Vec2>(matrix("uvs", uvs_, {vertices, 2}));
    primitive.indices.assign(integers(triangles), integers(triangles) + triangles.numel());
    const std::vector<Vec4> found = corner_tangents(primitive);
    const Tensor result = call.upload(found.empty() ? nullptr : &found[0].x,
                                      std::ssize(found) * Vec4::length(), ScalarType::Float);
    return torch::stable::view(result, {triangles.size(0), 3, 4});
}

}  // namespace item3d::python
