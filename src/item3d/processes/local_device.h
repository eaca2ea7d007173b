// CUDA device of each of several processes on a machine.
#pragma once

#include <string>

namespace item3d {

/// Returns the device of CUDA_VISIBLE_DEVICES (`visible`: "0,2", "GPU-5a...", or empty if unset)
/// for the local_rank-th process of a machine of `count` devices, round robin. Empty: there is no
/// choice.
std::string own_device(int local_rank, const std::string& visible, int count);

/// Sets CUDA_VISIBLE_DEVICES to own_device() of LOCAL_RANK, which torchrun sets, if there are
/// several processes. Call it before CUDA is initialized, which reads the variable only once.
void take_own_device();

}  // namespace item3d
