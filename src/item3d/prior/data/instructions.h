// Editing instructions in the style of InstructPix2Pix.
#pragma once

#include "item3d/core/random.h"

#include <string>
#include <vector>

namespace item3d {

/// Draws "make it golden", "turn the mug into a wooden mug". nouns: of the object; phrases: of its
/// new material, "{o}" for the noun.
std::string instruction_for_object(Random& random, const std::vector<std::string>& nouns,
                                   const std::vector<std::string>& phrases);

/// Draws "make the handle red", "give it a red handle".
std::string instruction_for_part(Random& random, const std::string& part,
                                 const std::vector<std::string>& phrases);

}  // namespace item3d
