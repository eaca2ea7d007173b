#include "item3d/render/occlusion/ray_scene.h"

#include "item3d/core/error.h"
#include "item3d/core/random.h"
#include "item3d/render/checks.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <new>
#include <vector>

namespace item3d {
namespace {

/// Transparency of one material's triangles.
struct Transparency {
    Material::Alpha mode = Material::Alpha::opaque;
    float factor = 1, cutoff = 0.5f;
    int width = 0, height = 0;
    Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
    bool nearest = false;
    std::vector<float> alpha;  ///< [height, width]; alpha is 1 if empty

    float texel(int x, int y) const {
        return alpha[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                     static_cast<std::size_t>(x)];
    }
    float at(Vec2 uv) const;
};

int wrapped(int i, int size, Wrap wrap) {
    if (wrap == Wrap::clamp_to_edge) return std::clamp(i, 0, size - 1);
    const int period = wrap == Wrap::mirrored_repeat ? 2 * size : size;
    const int k = (i % period + period) % period;
    return k < size ? k : period - 1 - k;
}

/// Returns the alpha at uv, interpolated bilinearly or of the nearest texel, like the renderer.
float Transparency::at(Vec2 uv) const {
    if (alpha.empty()) return factor;
    // Coordinates are clamped, because far outside the image a float has no fractional part, and an
    // int would overflow.
    const float x = std::clamp(uv.x * static_cast<float>(width) - 0.5f, -1e6f, 1e6f);
    const float y = std::clamp(uv.y * static_cast<float>(height) - 0.5f, -1e6f, 1e6f);
    if (!std::isfinite(x) || !std::isfinite(y)) return factor;
    const float left = std::floor(x), top = std::floor(y);
    const int x0 = wrapped(static_cast<int>(left), width, wrap_u);
    const int x1 = wrapped(static_cast<int>(left) + 1, width, wrap_u);
    const int y0 = wrapped(static_cast<int>(top), height, wrap_v);
    const int y1 = wrapped(static_cast<int>(top) + 1, height, wrap_v);
    const float fx = x - left, fy = y - top;
    if (nearest) return factor * texel(fx < 0.5f ? x0 : x1, fy < 0.5f ? y0 : y1);
    return factor * ((1 - fy) * ((1 - fx) * texel(x0, y0) + fx * texel(x1, y0)) +
                     fy * ((1 - fx) * texel(x0, y1) + fx * texel(x1, y1)));
}

std::vector<Transparency> read_transparency(const Model& model) {
    std::vector<Transparency> all;
    for (const Material& material : model.materials) {
        Transparency& one = all.emplace_back();
        one.mode = material.alpha;
        one.factor = material.base_color_factor.w;
        one.cutoff = material.alpha_cutoff;
        const int index = material.base_color_texture;
        if (one.mode == Material::Alpha::opaque || index < 0 ||
            index >= static_cast<int>(model.textures.size()))
            continue;
        const Texture& texture = model.textures[static_cast<std::size_t>(index)];
        const Image& image = texture.image;
        if (image.empty() || (image.channels != 2 && image.channels < 4)) continue;
        const auto channels = static_cast<std::size_t>(image.channels);
        one.width = image.width;
        one.height = image.height;
        one.wrap_u = texture.wrap_u;
        one.wrap_v = texture.wrap_v;
        one.nearest = texture.nearest;
        one.alpha.resize(image.pixels.size() / channels);
        for (std::size_t i = 0; i < one.alpha.size(); ++i)
            one.alpha[i] = image.pixels[i * channels + (channels == 2 ? 1 : 3)];
    }
    return all;
}

struct Context {
    RTCIntersectContext base;
    std::uint64_t chance;
};

struct TransparentTriangles {
    std::vector<std::int32_t> triangle;  ///< triangle of each primitive of Embree's geometry
    std::vector<Transparency> materials;
    at::Tensor uvs, colors, corners, material;

    /// True if a ray passes through triangle `primitive` at (u, v), the barycentrics of its last
    /// two corners.
    bool lets_through(unsigned primitive, float u, float v, std::uint64_t chance) const;
};

bool TransparentTriangles::lets_through(unsigned primitive, float u, float v,
                                        std::uint64_t chance) const {
    const std::int64_t t = triangle[primitive];
    const std::int32_t* vertices = corners.const_data_ptr<std::int32_t>() + 3 * t;
    const float weights[3] = {1 - u - v, u, v};
    Vec2 uv(0.0f);
    float color_alpha = 0;
    for (int k = 0; k < 3; ++k) {
        const float* at = uvs.const_data_ptr<float>() + 2 * static_cast<std::int64_t>(vertices[k]);
        uv += weights[k] * Vec2(at[0], at[1]);
        color_alpha +=
            weights[k] *
            colors.const_data_ptr<float>()[4 * static_cast<std::int64_t>(vertices[k]) + 3];
    }
    const Transparency& one =
        materials[static_cast<std::size_t>(material.const_data_ptr<std::int32_t>()[t])];
    const float alpha = color_alpha * one.at(uv);
    if (one.mode == Material::Alpha::mask) return alpha < one.cutoff;
    // Each triangle has its own random number, so that the order of hits does not matter.
    return Random(chance, static_cast<std::uint64_t>(t)).uniform() >= static_cast<double>(alpha);
}

void let_through(const RTCFilterFunctionNArguments* arguments) {
    const auto& triangles = *static_cast<const TransparentTriangles*>(arguments->geometryUserPtr);
    const auto* context = reinterpret_cast<const Context*>(arguments->context);
    for (unsigned i = 0; i < arguments->N; ++i) {
        if (arguments->valid[i] == 0) continue;
        if (triangles.lets_through(RTCHitN_primID(arguments->hit, arguments->N, i),
                                   RTCHitN_u(arguments->hit, arguments->N, i),
                                   RTCHitN_v(arguments->hit, arguments->N, i), context->chance))
            arguments->valid[i] = 0;
    }
}

RTCRay ray_from(Vec3 origin, Vec3 direction) {
    RTCRay ray{};
    ray.org_x = origin.x;
    ray.org_y = origin.y;
    ray.org_z = origin.z;
    ray.dir_x = direction.x;
    ray.dir_y = direction.y;
    ray.dir_z = direction.z;
    ray.tfar = std::numeric_limits<float>::infinity();
    ray.mask = 0xffffffffu;
    return ray;
}

/// Throws on an error of Embree since the last call.
void check_embree(RTCDevice device) {
    const RTCError error = rtcGetDeviceError(device);
    if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
    if (error == RTC_ERROR_UNKNOWN)
        throw ResourceError(
            "Embree cannot trace rays, probably because no thread could be started; close other "
            "programs and try again");
    ITEM3D_CHECK(error == RTC_ERROR_NONE, "Embree: error " + std::to_string(error));
}

}  // namespace

struct RayScene::State {
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;
    TransparentTriangles transparent;
    std::vector<std::vector<std::int32_t>> triangles;  ///< one list for each of Embree's geometries

    State() = default;
    State(const State&) = delete;
    State& operator=(const State&) = delete;
    ~State() {
        if (scene != nullptr) rtcReleaseScene(scene);
        if (device != nullptr) rtcReleaseDevice(device);
    }

    /// Adds the triangles in `chosen`, with a copy of the vertices.
    void add(const at::Tensor& positions, const at::Tensor& corners,
             const std::vector<std::int32_t>& chosen, TransparentTriangles* filtered) {
        if (chosen.empty()) return;
        const auto vertices = static_cast<std::size_t>(positions.size(0));
        const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
        void* to = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                           3 * sizeof(float), vertices);
        check_embree(device);
        std::memcpy(to, positions.const_data_ptr<float>(), 3 * sizeof(float) * vertices);
        auto* indices = static_cast<std::uint32_t*>(
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                    3 * sizeof(std::uint32_t), chosen.size()));
        check_embree(device);
        for (const std::int32_t t : chosen)
            for (int k = 0; k < 3; ++k)
                *indices++ = static_cast<std::uint32_t>(
                    corners.const_data_ptr<std::int32_t>()[3 * static_cast<std::int64_t>(t) + k]);
        if (filtered != nullptr) {
            rtcSetGeometryUserData(geometry, filtered);
            rtcSetGeometryOccludedFilterFunction(geometry, let_through);
            rtcSetGeometryIntersectFilterFunction(geometry, let_through);
        }
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene, geometry);
        triangles.push_back(chosen);
        rtcReleaseGeometry(geometry);
    }
};

RayScene::RayScene(const Geometry& geometry, const Model* model) {
    constexpr const char* op = "RayScene";
    const auto on_cpu = [](const at::Tensor& tensor) { return tensor.detach().cpu(); };
    const at::Tensor positions =
        checked(op, "positions", on_cpu(geometry.positions), at::kFloat, {-1, 3});
    const std::int64_t vertices = positions.size(0);
    auto state = std::make_shared<State>();
    TransparentTriangles& transparent = state->transparent;
    transparent.corners = checked(op, "triangles", on_cpu(geometry.triangles), at::kInt, {-1, 3});
    const std::int64_t triangles = transparent.corners.size(0);
    transparent.material =
        checked(op, "triangle_material", on_cpu(geometry.triangle_material), at::kInt, {triangles});
    transparent.uvs = checked(op, "uvs", on_cpu(geometry.uvs), at::kFloat, {vertices, 2});
    transparent.colors = checked(op, "colors", on_cpu(geometry.colors), at::kFloat, {vertices, 4});
    if (model != nullptr) transparent.materials = read_transparency(*model);

    std::vector<std::int32_t> opaque;
    for (std::int32_t t = 0; t < triangles; ++t) {
        const std::int32_t material = transparent.material.const_data_ptr<std::int32_t>()[t];
        const bool filtered = material >= 0 &&
                              material < static_cast<std::int32_t>(transparent.materials.size()) &&
                              transparent.materials[static_cast<std::size_t>(material)].mode !=
                                  Material::Alpha::opaque;
        (filtered ? transparent.triangle : opaque).push_back(t);
    }
    state->device = rtcNewDevice(nullptr);
    if (state->device == nullptr) throw ResourceError("occlusion: Embree finds no usable CPU");
    state->scene = rtcNewScene(state->device);
    // Without robust intersection, a ray could pass between two triangles that share an edge.
    rtcSetSceneFlags(state->scene, RTC_SCENE_FLAG_ROBUST);
    state->add(positions, transparent.corners, opaque, nullptr);
    state->add(positions, transparent.corners, transparent.triangle, &transparent);
    rtcCommitScene(state->scene);
    check_embree(state->device);
    state_ = std::move(state);
}

bool RayScene::blocked(Vec3 origin, Vec3 direction, std::uint64_t chance) const {
    Context context;
    rtcInitIntersectContext(&context.base);
    context.chance = chance;
    RTCRay ray = ray_from(origin, direction);
    rtcOccluded1(state_->scene, &context.base, &ray);
    return ray.tfar < 0;
}

RayScene::Hit RayScene::nearest(Vec3 origin, Vec3 direction, std::uint64_t chance) const {
    Context context;
    rtcInitIntersectContext(&context.base);
    context.chance = chance;
    RTCRayHit found{};
    found.ray = ray_from(origin, direction);
    found.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(state_->scene, &context.base, &found);
    if (found.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
    return {state_->triangles[found.hit.geomID][found.hit.primID], 1 - found.hit.u - found.hit.v,
            found.hit.u};
}

}  // namespace item3d
