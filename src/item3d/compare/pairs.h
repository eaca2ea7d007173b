// The paired differences between the first method and the other methods, on the same cases and
// seeds.
#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace item3d {

/// The differences between a method's scores and the first method's.
struct PairedDifference {
    double mean = 0;        ///< mean over all pairs
    double worst_seed = 0;  ///< lowest of the means over the pairs of one seed
    int pairs = 0;          ///< number of pairs; if 0, there are no differences
};

struct PairedMethod {
    std::string method;
    std::string prior;
    PairedDifference directional;  ///< difference of the directional score
    PairedDifference kept;         ///< difference of the preserved structure
    PairedDifference right;        ///< difference of the fraction of right results
    PairedDifference view_difference;
    PairedDifference seconds;
};

/// Pairs the runs of each further method with the first method's runs of the same case, prior and
/// seed. rows: from measured_run().
std::vector<PairedMethod> beside_first(const std::vector<nlohmann::json>& rows);

}  // namespace item3d
