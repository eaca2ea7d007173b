// Sections of the comparison of the renderer with path-traced references.
#pragma once

#include "item3d/tensors/tensor.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace item3d::reference {

/// A section of the page: a text, a table and images.
struct Section {
    std::string title;
    std::string text;
    std::vector<std::string> columns;
    std::vector<std::vector<std::string>> rows;
    nlohmann::json numbers = nlohmann::json::object();  ///< the table's numbers as JSON
    std::vector<std::string> images;                    ///< file names in the output folder
};

struct Folders {
    std::filesystem::path data;    ///< folder of the reference data
    std::filesystem::path output;  ///< folder of the written images
};

/// Difference of `found` from `expected`, both [P, C].
struct Difference {
    double mean;    ///< mean absolute difference, divided by the mean of `expected`
    double median;  ///< median of the relative differences of single values
    double bias;    ///< sum of `found`, divided by the sum of `expected`
};
Difference difference(const at::Tensor& found, const at::Tensor& expected);

/// Loads a linear reference image [H, W, C].
at::Tensor load_reference(const std::filesystem::path& path);

/// Saves linear images [H, W, 3] as one sRGB PNG. Each inner vector is a row of tiles.
void save_tiles(const std::filesystem::path& path, const std::vector<std::vector<at::Tensor>>&);

Section sphere_section(const Folders& folders, const std::string& light);
Section view_section(const Folders& folders);
Section geometry_section(const Folders& folders);
Section bsdf_section(const Folders& folders);
Section furnace_section();
Section irradiance_section(const Folders& folders);
Section gradient_section(const Folders& folders);

}  // namespace item3d::reference
