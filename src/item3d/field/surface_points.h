// Points on a model's surface without an image, for fitting and baking.
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

/// Returns the surface at P points. triangle: [P] int64; barycentrics: [P, 2] float32, the weights
/// of vertices 0 and 1. In the result `pixel` is the index of the point and `view` equals the
/// normal.
Surface surface_at(const Geometry& geometry, const at::Tensor& triangle,
                   const at::Tensor& barycentrics);

/// The input space of the neural texture. It is world space, except that all instances of one
/// primitive (the same mesh of the file under several nodes) coincide with the first instance.
/// Instances share a texture in the file, so they must share a material at each of their points.
/// Points that share texels coincide too, after share().
class FieldSpace {
  public:
    /// materials: indices of the edited materials. device: that of the surfaces passed later.
    FieldSpace(const Model& model, const std::vector<int>& materials, at::Device device = at::kCPU);

    /// After this call, positions() maps points that share a texel to the same position.
    void share(std::shared_ptr<const SharedTexels> shared) { shared_ = std::move(shared); }

    /// Returns surface.position, [P, 3], mapped to the first instance and then to the
    /// representative of its texel.
    at::Tensor positions(const Surface& surface) const;

    /// Returns the first instance of each primitive, which may be the primitive itself.
    const std::vector<int>& first_instance() const { return first_instance_; }
    /// True if a primitive has an edited material.
    bool edited(int primitive) const { return edited_[static_cast<std::size_t>(primitive)]; }
    /// Returns the corners of the box around all edited first instances.
    std::array<Vec3, 2> bounds() const { return bounds_; }

  private:
    std::vector<int> first_instance_;
    std::vector<bool> edited_;
    std::array<Vec3, 2> bounds_;
    bool has_instances_ = false;
    at::Tensor transforms_;  ///< [primitives, 4, 3] maps (x, y, z, 1) to the first instance
    std::shared_ptr<const SharedTexels> shared_;
};

/// Samples points uniformly by area from the first instances of edited materials. The points are
/// drawn on the CPU, so that they are the same on every device. The returned surfaces are on the
/// geometry's device.
class SurfaceSampler {
  public:
    SurfaceSampler(const Geometry& geometry, const FieldSpace& space);
    Surface sample(std::int64_t count, Random& random) const;
    double area() const { return area_; }

  private:
    const Geometry& geometry_;
    std::vector<std::int32_t> triangles_;
    std::vector<double> cumulative_;  ///< cumulative area of triangles_
    double area_ = 0.0;
};

}  // namespace item3d
