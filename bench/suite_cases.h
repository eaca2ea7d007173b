// The edits that methods and settings are judged by, and what they start from.
#pragma once

#include "item3d/evaluate/color.h"
#include "item3d/prior/vocabulary.h"
#include "item3d/scene/model.h"

#include <string>
#include <vector>

namespace item3d {

struct SuiteCase {
    std::string group;   ///< "colors", "materials" or "stripes"
    std::string mesh;    ///< its noun
    std::string source;  ///< colour, or "red and white striped"
    std::string target;  ///< colour, "golden", "covered in grass", ...
};

/// For each noun, in this order, four colours and two materials, which differ from noun to noun;
/// then the stripes, of mugs and cows.
std::vector<SuiteCase> suite_cases(const std::vector<std::string>& nouns);

/// "a golden mug", but "a mug covered in grass".
std::string prompt_of(const std::string& look, const std::string& noun);

/// The prior's colours with their measured base colours.
std::vector<NamedColor> named_colors(const PriorVocabulary& vocabulary);

/// The mesh in the source's colour, or its stripes. Throws InputError where the prior has no such
/// colour.
Model source_model(const SuiteCase& test, const Model& mesh, const PriorVocabulary& vocabulary);

}  // namespace item3d
