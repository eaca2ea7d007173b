// The identity of a process, by which other processes on the same machine can find out whether it
// still runs.
#pragma once

#include <nlohmann/json.hpp>

#include <string>

namespace item3d {

/// Returns this process's identity, {"host", "pid", "start", "space"}. "start" is the time at which
/// the process started, as the system reports it. "space" identifies the machine, its boot and its
/// PID namespace.
nlohmann::json this_process();

/// True if the process ran on this machine and has ended. False for processes of other machines,
/// about which nothing is known.
bool has_ended(const nlohmann::json& process);

/// Returns the machine's name without its domain.
std::string host_name();

}  // namespace item3d
