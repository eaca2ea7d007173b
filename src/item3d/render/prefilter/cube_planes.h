// Cube maps as planes with halos, on the CPU or a device, for prefiltering. kernels/cube_planes.h
// has the layout and the parabolas of resizing:
//
//     map  [6, S, S, 3]  --to_planes-->  planes [18 or 19][S + 16][S + 16]  --restricted-->  S / 2
//                        <-from_planes-                                     <--upsampled---
//
// upsampled() is U and restricted() its transpose, so that <a, U b> = <U^T a, b> over all texels.
#pragma once

#include "item3d/render/kernels/cube_planes.h"
#include "item3d/tensors/tensor.h"

namespace item3d {

/// See kernels::BasicPlanes. The constructor leaves the values uninitialised.
class CubePlanes {
  public:
    static constexpr int halo = kernels::Planes::halo;

    CubePlanes(int size, bool shared_plane, at::Device device);

    int size() const { return size_; }
    int count() const { return count_; }
    bool shared_plane() const { return count_ == 19; }
    at::Device device() const { return values_.device(); }
    /// Returns the options of float32 on the device.
    at::TensorOptions options() const { return values_.options(); }
    kernels::ConstPlanes view() const { return {origin_, size_, count_}; }
    kernels::Planes writable() { return {origin_, size_, count_}; }
    void clear() { values_.zero_(); }
    CubePlanes clone() const;
    /// Adds the planes of a map of the same kind; the halos are invalid afterwards.
    void add(const CubePlanes& map) { values_.add_(map.values_); }

  private:
    int size_, count_;
    at::Tensor values_;
    float* origin_;  ///< texel (0, 0) of plane 0
};

/// Returns the number of texels for each index of a kernel: a whole row on a processor, one on a
/// device.
inline int run_length(at::Device device, int size) {
    return device.is_cuda() ? 1 : size;
}

/// Copies the neighbours' texels into the halo, up to `depth`.
void fill_halo(CubePlanes& planes, int depth);

/// Transpose of upsampling; the result has a full halo. fine: with a halo of at least two texels.
CubePlanes restricted(const CubePlanes& fine);

/// Returns a map of twice the resolution, without a halo. coarse: with a halo of at least one
/// texel.
CubePlanes upsampled(const CubePlanes& coarse);

/// Adds an upsampled map of half the size. coarse: with a halo of at least one texel.
void add_upsampled(CubePlanes& to, const CubePlanes& coarse);

/// Returns map [6, S, S, 3], any strides, times weight [S, S], as planes with a full halo.
/// shared_plane: adds the weights as the shared plane.
CubePlanes to_planes(const at::Tensor& map, const at::Tensor& weight, bool shared_plane);

/// Returns planes times weight [S, S], [6, S, S, 3].
at::Tensor from_planes(const CubePlanes& planes, const at::Tensor& weight);

}  // namespace item3d
