// The named comparisons that come along: the paper's table, ablations and figures.
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
    std::vector<CompareMethod> methods;  ///< empty: all that the prior can run
    PictureWishes pictures;
    bool takes_meshes = false;  ///< its cases are of any meshes that have a noun
};

/// All of them; the first, "methods", is that of a comparison without a name. rows: of the U-Net,
/// forward, that each edit of "guidance" gets.
std::vector<CompareSuite> compare_suites(int rows);

/// The cases of a suite. Its models, in plain colours as the embedded prior knows them or with
/// stripes, are written into `folder`. meshes: by noun; empty: the demo's mug and shapes that the
/// prior never saw. Throws InputError where a mesh cannot be read, or has no UVs for stripes.
std::vector<CompareCase> cases_of_suite(const CompareSuite& suite,
                                        const std::filesystem::path& folder,
                                        const std::map<std::string, std::filesystem::path>& meshes);

}  // namespace item3d
