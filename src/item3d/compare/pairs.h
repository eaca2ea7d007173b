// Paired differences between the first method and the others, on the same cases and seeds.
#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace item3d {

/// Difference of a method's score from the first method's.
struct PairedDifference {
    double mean = 0;        ///< over all pairs
    double worst_seed = 0;  ///< lowest mean of a seed
    int pairs = 0;          ///< 0: there are none
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

/// Pairs each method but the first with the first's runs of equal case, prior and seed. rows: of
/// measured_run().
std::vector<PairedMethod> beside_first(const std::vector<nlohmann::json>& rows);

}  // namespace item3d
