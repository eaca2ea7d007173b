// The words of a sentence, and names made of them.
#pragma once

#include <string>
#include <vector>

namespace item3d {

/// Lower-case words of a prompt: runs of letters, and runs of digits.
std::vector<std::string> prompt_words(const std::string& prompt);

/// Lower-case letters and digits, at most 40, words joined by dashes; "case" where there are none.
std::string slug(const std::string& text);

/// The one of `known`, which is not empty, that takes the fewest insertions, deletions and
/// replacements of letters (Levenshtein) to become `name`.
std::string nearest_name(const std::string& name, const std::vector<std::string>& known);

}  // namespace item3d
