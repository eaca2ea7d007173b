// Cube maps as planes with halos, on the CPU or a device, for prefiltering. kernels/cube_planes.h
// has the layout and the parabolas of resizing:
//
//     map  [6, S, S, 3]  --to_planes-->  planes [18 or 19][S + 16][S + 16]  --restricted-->  S / 2
//                        <-from_planes-                                     <--upsampled---
//
// upsampled() is U, and restricted() is its transpose, so that <a, U b> = <U^T a, b> over all
// texels.
#pragma once

#include "item3d/render/kernels/cube_planes.h"
#include "item3d/render/prefilter/backend.h"

#include <cstdint>

namespace item3d {

/// Planes of a cube map, see kernels::BasicPlanes. The constructor leaves the values uninitialised.
/// Copies share the values. `backend` must outlive the planes.
class CubePlanes {
  public:
    static constexpr int halo = kernels::Planes::halo;

    CubePlanes(int size, bool shared_plane, const PrefilterBackend& backend);

    int size() const { return size_; }
    int count() const { return count_; }
    bool shared_plane() const { return count_ == 19; }
    const PrefilterBackend& backend() const { return *backend_; }
    kernels::ConstPlanes view() const { return {origin_, size_, count_}; }
    kernels::Planes writable() { return {origin_, size_, count_}; }
    void clear() { backend_->fill(values_.get(), floats(), 0); }
    CubePlanes clone() const;
    /// Adds the planes of a map of the same kind; the halos are invalid afterwards.
    void add(const CubePlanes& map) { backend_->add(map.values_.get(), floats(), values_.get()); }

  private:
    /// Returns the number of floats, halos and padding included.
    std::int64_t floats() const { return count_ * view().plane_step(); }

    const PrefilterBackend* backend_;
    int size_, count_;
    Floats values_;
    float* origin_;  ///< texel (0, 0) of plane 0
};

/// A map [6, S, S, 3] of any strides.
struct CubeMap {
    const float* values;
    int size;              ///< S
    std::int64_t step[4];  ///< floats between neighbours along each dimension

    static CubeMap contiguous(const float* values, int size);
};

/// Returns the number of texels that each index of a kernel processes: a whole row on a CPU, one
/// texel on a device.
inline int run_length(const PrefilterBackend& backend, int size) {
    return backend.on_device() ? 1 : size;
}

/// Copies the neighbours' texels into the halo, up to `depth`.
void fill_halo(CubePlanes& planes, int depth);

/// Transpose of upsampling. The result has a full halo. `fine` must have a halo of at least two
/// texels.
CubePlanes restricted(const CubePlanes& fine);

/// Returns a map of twice the resolution, without a halo. `coarse` must have a halo of at least one
/// texel.
CubePlanes upsampled(const CubePlanes& coarse);

/// Adds an upsampled map of half the size. `coarse` must have a halo of at least one texel.
void add_upsampled(CubePlanes& to, const CubePlanes& coarse);

/// Returns map times weight [S, S], as planes with a full halo. shared_plane: true if the weights
/// are stored in the shared plane.
CubePlanes to_planes(const CubeMap& map, const float* weight, bool shared_plane,
                     const PrefilterBackend& backend);

/// Writes planes times weight [S, S] to `map` [6, S, S, 3].
void from_planes(const CubePlanes& planes, const float* weight, float* map);

}  // namespace item3d
