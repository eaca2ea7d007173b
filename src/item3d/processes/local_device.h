// Which of a machine's CUDA devices a process of several takes.
#pragma once

#include <string>

namespace item3d {

/// The device of CUDA_VISIBLE_DEVICES (`visible`: "0,2", "GPU-5a...", or empty where it is not set)
/// that the local_rank-th process of a machine of `count` devices takes: they take turns. Empty:
/// nothing to choose from.
std::string own_device(int local_rank, const std::string& visible, int count);

/// Sets CUDA_VISIBLE_DEVICES to own_device() of LOCAL_RANK, which torchrun sets, where there are
/// several processes. Call it before CUDA begins: afterwards nobody looks at the variable.
void take_own_device();

}  // namespace item3d
