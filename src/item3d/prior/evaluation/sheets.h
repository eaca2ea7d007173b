// Contact sheets of training pictures, to look at what the prior is taught.
#pragma once

#include "item3d/scene/image.h"

#include <cstdint>
#include <string>
#include <vector>

namespace item3d {

struct SheetOptions {
    int columns = 8;
    int rows = 8;  ///< of random examples; the other sheets have as many as they need
    int picture = 64;
    int variants = 2;  ///< shapes of each class, of random examples
    std::uint64_t seed = 1;
};

struct Sheet {
    Image image;                        ///< sRGB
    std::vector<std::string> captions;  ///< row by row
};

/// Training pictures as they come.
Sheet example_sheet(const SheetOptions& options);
/// Pairs as they come: two pictures beside each other, and what changes between them.
Sheet instruction_sheet(const SheetOptions& options);
/// Every class of objects, in grey, or in two colours where it has parts.
Sheet object_sheet(const SheetOptions& options);
/// Every material and pattern that is measured, each on two objects.
Sheet material_sheet(const SheetOptions& options);
/// Every light on objects of three materials.
Sheet light_sheet(const SheetOptions& options);

}  // namespace item3d
