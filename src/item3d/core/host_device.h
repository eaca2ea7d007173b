// Marks functions that run on the CPU and, when the file is compiled by nvcc, on CUDA devices too.
#pragma once

#if defined(__CUDACC__)
#define ITEM3D_HOST_DEVICE __host__ __device__
#else
#define ITEM3D_HOST_DEVICE
#endif

/// For functions of which every caller makes its own version, for its processor's vectors.
#if defined(__GNUC__)
#define ITEM3D_ALWAYS_INLINE __attribute__((always_inline))
#else
#define ITEM3D_ALWAYS_INLINE
#endif
