// How well does one edit of the study do, and how long does it take? It goes without the report and
// the pictures that an edit makes for people.
#pragma once

#include "bench/ablation_contenders.h"
#include "item3d/networks/vision_language/clip.h"
#include "item3d/networks/vocabulary.h"
#include "item3d/suite/cases.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

namespace item3d {

struct AblationOptions {
    std::filesystem::path output;
    std::filesystem::path prior;
    std::map<std::string, std::filesystem::path> meshes;  ///< by noun
    std::vector<std::string> only;                        ///< contenders; empty: all
    int rows = 800;                                       ///< of the U-Net, for each edit
    int seeds = 3;
    bool thin = false;  ///< a third of the colours, half of the materials
    bool report_only = false;
};

/// What all edits of a study share.
struct AblationJudge {
    PriorVocabulary vocabulary;
    Clip clip;
};

/// Runs the edit in `folder`, and saves a picture of the model before and after it. Returns what
/// was measured: "directional", "global", "kept", "right" where there is something to be right
/// about, "seconds", ...
nlohmann::json run_ablation_edit(const Contender& contender, const SuiteCase& test,
                                 std::uint64_t seed, const AblationOptions& options,
                                 const AblationJudge& judge, const std::filesystem::path& folder);

}  // namespace item3d
