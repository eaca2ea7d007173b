// Contact sheets of training images.
#pragma once

#include "item3d/scene/image.h"

#include <cstdint>
#include <string>
#include <vector>

namespace item3d {

struct SheetOptions {
    int columns = 8;
    int rows =
        8;  ///< rows of a sheet of random examples; other sheets have as many rows as they need
    int image = 64;
    int variants = 2;  ///< shapes of each class, for random examples
    std::uint64_t seed = 1;
};

struct Sheet {
    Image image;                        ///< sRGB
    std::vector<std::string> captions;  ///< row by row
};

/// Returns a sheet of random training images.
Sheet example_sheet(const SheetOptions& options);
/// Returns a sheet of random instruction pairs. A pair is two images side by side; the second has
/// the instruction as its caption.
Sheet instruction_sheet(const SheetOptions& options);
/// Returns a sheet of all object classes, in grey, or in two colours if they have parts.
Sheet object_sheet(const SheetOptions& options);
/// Returns a sheet of all measured materials and patterns, each on two objects.
Sheet material_sheet(const SheetOptions& options);
/// Returns a sheet of all lights on objects of three materials.
Sheet light_sheet(const SheetOptions& options);

}  // namespace item3d
