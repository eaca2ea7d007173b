// Methods beside the first of them, on the same cases and seeds.
#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace item3d {

/// How much more a method has than the first.
struct PairedDifference {
    double mean = 0;        ///< over all pairs
    double worst_seed = 0;  ///< the lowest of the seeds' own means
    int pairs = 0;          ///< 0: there are none
};

struct PairedMethod {
    std::string method;
    std::string prior;
    PairedDifference directional;  ///< of the directional score
    PairedDifference kept;         ///< of the structure that is kept
};

/// Each method but the first with the runs of the first that have the same case, prior and seed.
/// rows: of measured_run().
std::vector<PairedMethod> beside_first(const std::vector<nlohmann::json>& rows);

}  // namespace item3d
