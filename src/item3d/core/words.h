// The words of a sentence.
#pragma once

#include <string>
#include <vector>

namespace item3d {

/// Returns the lower-case words of a prompt: runs of letters, and runs of digits.
std::vector<std::string> prompt_words(const std::string& prompt);

}  // namespace item3d
