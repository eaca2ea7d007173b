// The edits that methods and settings are judged by, and what they start from.
#pragma once

#include "item3d/metrics/color.h"
#include "item3d/networks/vocabulary.h"
#include "item3d/scene/model.h"

#include <string>
#include <vector>

namespace item3d {

struct SuiteCase {
    std::string group;   ///< "colors", "metals", "materials", "patterns" or "stripes"
    std::string mesh;    ///< its noun
    std::string source;  ///< colour, or "red and white striped"
    std::string target;  ///< colour, "golden", "covered in grass", ..., or "a golden {o}"
    std::string word;    ///< the target in the prior's vocabulary: "gold"; empty for stripes
};

/// What methods are compared by. For each noun, in this order, four colours and two materials,
/// which differ from noun to noun; then the stripes, of mugs and cows.
std::vector<SuiteCase> suite_cases(const std::vector<std::string>& nouns);

/// What a prior is judged by: for each noun four colours, two metals, two materials and two
/// patterns of its vocabulary (as many of them as it has), all of them taken in turn. Every source
/// is a plain colour that is not the target. Throws InputError for a prior with fewer than two
/// colours.
std::vector<SuiteCase> prior_suite_cases(const std::vector<std::string>& nouns,
                                         const PriorVocabulary& vocabulary);

/// "a golden mug", but "a mug covered in grass"; a look with "{o}" is filled in.
std::string prompt_of(const std::string& look, const std::string& noun);

/// The prior's colours with their measured base colours.
std::vector<NamedColor> named_colors(const PriorVocabulary& vocabulary);

/// The mesh in the source's colour, or its stripes. Throws InputError where the prior has no such
/// colour.
Model source_model(const SuiteCase& test, const Model& mesh, const PriorVocabulary& vocabulary);

}  // namespace item3d
