// A process as others on the same machine can find it.
#pragma once

#include <nlohmann/json.hpp>

#include <string>

namespace item3d {

/// This process: {"host", "pid", "start", "space"}; start is the time that the system gave it, and
/// space tells one machine, start of the machine and space of process ids from another.
nlohmann::json this_process();

/// Whether the process ran on this machine and is gone. False for those of other machines, of which
/// nothing is known.
bool has_ended(const nlohmann::json& process);

/// The machine's name without its domain.
std::string host_name();

}  // namespace item3d
