// Cube maps as planes with halos, on the CPU or a device: what prefiltering works on.
#pragma once

#include "item3d/render/kernels/cube_planes.h"
#include "item3d/tensors/tensor.h"

namespace item3d {

/// See kernels::BasicPlanes. The values are not set.
class CubePlanes {
  public:
    static constexpr int halo = kernels::Planes::halo;

    CubePlanes(int size, bool shared_plane, at::Device device);

    int size() const { return size_; }
    int count() const { return count_; }
    bool shared_plane() const { return count_ == 19; }
    at::Device device() const { return values_.device(); }
    /// float32 on the device.
    at::TensorOptions options() const { return values_.options(); }
    kernels::ConstPlanes view() const { return {origin_, size_, count_}; }
    kernels::Planes writable() { return {origin_, size_, count_}; }
    void clear() { values_.zero_(); }
    CubePlanes clone() const;
    /// Adds the planes of a map of the same kind; halos are then as good as nothing.
    void add(const CubePlanes& map) { values_.add_(map.values_); }

  private:
    int size_, count_;
    at::Tensor values_;
    float* origin_;  ///< of plane 0, texel (0, 0)
};

/// Texels that one index of a kernel stands for: whole rows for a processor, few for a device.
inline int run_length(at::Device device, int size) {
    return device.is_cuda() ? 1 : size;
}

/// Copies the neighbours' texels into the halo, `depth` deep.
void fill_halo(CubePlanes& planes, int depth);

/// The transpose of upsampling, with a full halo. fine: its halo at least two texels deep.
CubePlanes restricted(const CubePlanes& fine);

/// Twice as fine a map, without a halo. coarse: its halo at least one texel deep.
CubePlanes upsampled(const CubePlanes& coarse);

/// Adds a map of half the size; its halo at least one texel deep.
void add_upsampled(CubePlanes& to, const CubePlanes& coarse);

/// map [6, S, S, 3], any strides, times weight [S, S] -> planes with a full halo; shared_plane: the
/// weights are there too.
CubePlanes to_planes(const at::Tensor& map, const at::Tensor& weight, bool shared_plane);

/// Planes times weight [S, S] -> [6, S, S, 3].
at::Tensor from_planes(const CubePlanes& planes, const at::Tensor& weight);

}  // namespace item3d
