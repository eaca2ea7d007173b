// Points on a model's surface without a picture: for fitting and baking.
#pragma once

#include "item3d/core/random.h"
#include "item3d/render/geometry.h"
#include "item3d/render/interpolate.h"
#include "item3d/scene/model.h"
#include "item3d/tensors/tensor.h"

#include <array>
#include <memory>
#include <utility>
#include <vector>

namespace item3d {

class SharedTexels;

/// The surface at `barycentrics` [P, 2] float32 (weights of vertices 0 and 1) of triangles [P]
/// int64. `pixel` counts the points and `view` is the normal.
Surface surface_at(const Geometry& geometry, const at::Tensor& triangle,
                   const at::Tensor& barycentrics);

/// The space in which the neural texture lives: world space, except that copies of one primitive
/// (instances: the same source mesh under several nodes) all lie where the first one is. They share
/// a texture in the file, so they must share a material at each of their points. So must places
/// that share texels: see share().
class FieldSpace {
  public:
    /// materials: indices of the materials that are edited. device: of the surfaces to come.
    FieldSpace(const Model& model, const std::vector<int>& materials, at::Device device = at::kCPU);

    /// From now on, places that share texels are one place.
    void share(std::shared_ptr<const SharedTexels> shared) { shared_ = std::move(shared); }

    /// [P, 3]: surface.position, moved from instances to their first, and from there to what
    /// represents its texel.
    at::Tensor positions(const Surface& surface) const;

    /// Of each primitive of the model: itself or the first of its instances.
    const std::vector<int>& first_instance() const { return first_instance_; }
    /// Whether a primitive has an edited material.
    bool edited(int primitive) const { return edited_[static_cast<std::size_t>(primitive)]; }
    /// Corners of the box around all edited first instances.
    std::array<Vec3, 2> bounds() const { return bounds_; }

  private:
    std::vector<int> first_instance_;
    std::vector<bool> edited_;
    std::array<Vec3, 2> bounds_;
    bool has_instances_ = false;
    at::Tensor transforms_;  ///< [primitives, 4, 3]: (x, y, z, 1) times it is the first's position
    std::shared_ptr<const SharedTexels> shared_;
};

/// Draws points uniformly by area from the first instances of edited materials: on the CPU, for the
/// same points everywhere. Surfaces are on the geometry's device.
class SurfaceSampler {
  public:
    SurfaceSampler(const Geometry& geometry, const FieldSpace& space);
    Surface sample(std::int64_t count, Random& random) const;
    double area() const { return area_; }

  private:
    const Geometry& geometry_;
    std::vector<std::int32_t> triangles_;
    std::vector<double> cumulative_;  ///< area up to and with each of them
    double area_ = 0.0;
};

}  // namespace item3d
