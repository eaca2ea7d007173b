// Editing instructions in the style of InstructPix2Pix.
#pragma once

#include "item3d/core/random.h"

#include <string>
#include <vector>

namespace item3d {

/// Draws an instruction for the whole object, such as "make it golden" or "turn the mug into a
/// wooden mug". nouns: names of the object. phrases: phrases of the object's new material, in which
/// "{o}" stands for the noun.
std::string instruction_for_object(Random& random, const std::vector<std::string>& nouns,
                                   const std::vector<std::string>& phrases);

/// Draws an instruction for one part, such as "make the handle red" or "give it a red handle".
/// phrases: phrases of the part's new material.
std::string instruction_for_part(Random& random, const std::string& part,
                                 const std::vector<std::string>& phrases);

}  // namespace item3d
