// Test edits of methods and settings, and their source models.
#pragma once

#include "item3d/metrics/color.h"
#include "item3d/networks/vocabulary.h"
#include "item3d/scene/model.h"

#include <string>
#include <vector>

namespace item3d {

struct SuiteCase {
    std::string group;   ///< "colors", "metals", "materials", "patterns" or "stripes"
    std::string mesh;    ///< noun of the mesh
    std::string source;  ///< colour, or "red and white striped"
    std::string target;  ///< a colour, "golden", "covered in grass", or "a golden {o}"
    /// Target's word in the prior's vocabulary, such as "gold"; empty for stripes.
    std::string word;
};

/// Returns the cases on which methods are compared. For each noun these are four colours and two
/// materials, which differ between nouns. For mugs and cows, an edit of striped models follows.
std::vector<SuiteCase> suite_cases(const std::vector<std::string>& nouns);

/// Returns the cases on which a prior is evaluated. For each noun these are four colours, two
/// metals, two materials and two patterns of the prior's vocabulary, or fewer if it has fewer. All
/// words are taken in turn. Every source is a plain colour that differs from the target. Throws
/// InputError for a prior with fewer than two colours.
std::vector<SuiteCase> prior_suite_cases(const std::vector<std::string>& nouns,
                                         const PriorVocabulary& vocabulary);

/// Returns the prompt: "a golden mug", but "a mug covered in grass". The noun replaces "{o}" in
/// `look`.
std::string prompt_of(const std::string& look, const std::string& noun);

/// Returns the prior's colours with their measured base colours.
std::vector<NamedColor> named_colors(const PriorVocabulary& vocabulary);

/// Returns the mesh in the case's source colour, or with its source stripes. Throws InputError if
/// the prior lacks the colour.
Model source_model(const SuiteCase& test, const Model& mesh, const PriorVocabulary& vocabulary);

}  // namespace item3d
