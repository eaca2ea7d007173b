// Functions for names: file names from sentences, counted nouns, and the nearest known name.
#pragma once

#include <string>
#include <vector>

namespace item3d {

/// Returns the words of a text in lower case, joined by dashes, without other characters, in at
/// most 40 characters. Returns "case" if nothing is left.
std::string slug(const std::string& text);

/// Returns a count with a noun whose plural ends in s: "1 job", "3 jobs".
std::string counted(std::size_t count, const std::string& noun);

/// Returns the element of `known` with the smallest Levenshtein distance from `name`, which is the
/// smallest number of insertions, deletions and replacements of letters. `known` must not be empty.
std::string nearest_name(const std::string& name, const std::vector<std::string>& known);

/// Returns nearest_name() if `name` is probably a misspelling of it, else "". The distance may be
/// at most two letters, or a third of the name's length if that is more.
std::string similar_name(const std::string& name, const std::vector<std::string>& known);

}  // namespace item3d
