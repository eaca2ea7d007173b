#include "python/src/tangents.h"

#include "item3d/render/tangents.h"
#include "python/src/value_checks.h"

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
    ValueChecks checks(call, Pass::forward);
    const auto matrix = [&](const char* name, const Tensor& tensor, const Sizes& sizes) {
        const Tensor good = call.checked(name, tensor, ScalarType::Float, sizes);
        checks.finite(name, good);
        return good;
    };
    const Tensor positions = matrix("positions", positions_, {-1, 3});
    const std::int64_t vertices = positions.size(0);
    const Tensor normals = matrix("normals", normals_, {vertices, 3});
    const Tensor uvs = matrix("uvs", uvs_, {vertices, 2});
    Tensor triangles = call.checked("triangles", triangles_, ScalarType::Int, {-1, 3});
    checks.indices(triangles, vertices);
    checks.finish();
    triangles = call.on_cpu(triangles);
    Primitive primitive;
    primitive.positions = rows<Vec3>(call.on_cpu(positions));
    primitive.normals = rows<Vec3>(call.on_cpu(normals));
    primitive.uvs = rows<Vec2>(call.on_cpu(uvs));
    primitive.indices.assign(integers(triangles), integers(triangles) + triangles.numel());
    const std::vector<Vec4> found = corner_tangents(primitive);
    const Tensor result = call.upload(found.empty() ? nullptr : &found[0].x,
                                      std::ssize(found) * Vec4::length(), ScalarType::Float);
    return torch::stable::view(result, {triangles.size(0), 3, 4});
}

}  // namespace item3d::python
