// Which settings does each contender of the study have, and what do its steps cost?
#include "bench/ablation_contenders.h"

namespace item3d {

std::vector<Contender> contenders() {
    const auto rdl = [](const char* adjust) {
        return nlohmann::json{{"guidance", "rdl"}, {"adjust", adjust}};
    };
    const auto method = [](const char* name) { return nlohmann::json{{"guidance", name}}; };
    return {
        {"sds", method("sds"), 2, true},
        {"learned", rdl("learned"), 1 + 4, true},  // the target's, and the source's samples
        {"off", rdl("off"), 2},
        {"caption", rdl("caption"), 2},
        {"dds", method("dds"), 4},
        {"csd", method("csd"), 3},
        {"nfsd", method("nfsd"), 3},
        {"caption-paper", rdl("caption-paper"), 2},
        {"pds", method("pds"), 4},
        // A path from noise level 0 up in steps of a fifth of the schedule, then three rows.
        {"ism", method("ism"), 4.7},
        // A path in steps of a tenth, two rows each, to levels that fall from 0.98 to 0.25.
        {"sdi", method("sdi"), 16},
    };
}

}  // namespace item3d
