// The built-in comparisons (suites): the paper's table, ablations and figures.
#pragma once

#include "item3d/compare/runs.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace item3d {

struct CompareSuite {
    std::string name;
    std::string description;
    std::vector<CompareMethod> methods;  ///< empty: all methods that the prior can run
    ImageWishes images;
    bool takes_meshes = false;  ///< true: the suite's cases can be made for any mesh with a noun
};

/// Returns all suites; the first, "methods", is the default. rows: budget of an edit in the suite
/// "guidance", as the number of images that the U-Net evaluates.
std::vector<CompareSuite> compare_suites(int rows);

/// Returns the cases of a suite. Its models, in plain colours of the embedded prior or with
/// stripes, are written into `folder`. meshes: files by noun; if empty, the demo's mug and shapes
/// held out from the prior's training are used. Throws InputError if a mesh cannot be read, or has
/// no UVs for stripes.
std::vector<CompareCase> cases_of_suite(const CompareSuite& suite,
                                        const std::filesystem::path& folder,
                                        const std::map<std::string, std::filesystem::path>& meshes);

}  // namespace item3d
