// The words of a sentence.
#pragma once

#include <string>
#include <vector>

namespace item3d {

/// Returns the words of a prompt in lower case. A word is a run of letters or a run of digits.
std::vector<std::string> prompt_words(const std::string& prompt);

}  // namespace item3d
