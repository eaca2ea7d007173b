// Who takes part in the study of guidance methods?
#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace item3d {

struct Contender {
    std::string name;          ///< also of files
    nlohmann::json overrides;  ///< of the edit's settings
    /// Rows that the U-Net predicts for a picture in a step, on average; passes back through it are
    /// not counted.
    double rows = 2;
    bool first = false;  ///< compared before the others, over all seeds
};

std::vector<Contender> contenders();

}  // namespace item3d
