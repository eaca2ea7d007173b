// The CUDA device that each of several processes on a machine uses.
#pragma once

#include <string>

namespace item3d {

/// Returns the one device that the local_rank-th process of a machine uses. Devices are assigned
/// round robin. `visible` is CUDA_VISIBLE_DEVICES ("0,2", "GPU-5a...", or empty if unset); `count`
/// is the number of the machine's devices. Returns "" if there is no device.
std::string own_device(int local_rank, const std::string& visible, int count);

/// Sets CUDA_VISIBLE_DEVICES to own_device() of LOCAL_RANK, which torchrun sets, if there are
/// several processes. Call it before CUDA is initialized, which reads the variable only once.
void take_own_device();

}  // namespace item3d
