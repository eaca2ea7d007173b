// Names: of files made of sentences, of counted things, and the one that somebody meant.
#pragma once

#include <string>
#include <vector>

namespace item3d {

/// Lower-case letters and digits, at most 40, words joined by dashes; "case" where there are none.
std::string slug(const std::string& text);

/// "1 job", "3 jobs": a count with a noun whose plural ends in s.
std::string counted(std::size_t count, const std::string& noun);

/// The one of `known`, which is not empty, that takes the fewest insertions, deletions and
/// replacements of letters (Levenshtein) to become `name`.
std::string nearest_name(const std::string& name, const std::vector<std::string>& known);

}  // namespace item3d
