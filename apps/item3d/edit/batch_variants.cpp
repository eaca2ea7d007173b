#include "apps/item3d/edit/batch_variants.h"

#include "item3d/batch/claim.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/progress.h"
#include "item3d/io/file_names.h"
#include "item3d/io/variants.h"

#include <map>
#include <string>

namespace item3d {
namespace {

namespace fs = std::filesystem;

/// Returns requests by model path, in the order of the models' first jobs.
std::vector<VariantsRequest> requests_of(const BatchFolder& folder, const BatchView& view) {
    std::vector<VariantsRequest> requests;
    std::map<std::string, std::size_t> of_model;
    for (const BatchEntry& entry : view.entries()) {
        const BatchJob& job = entry.job;
        const bool is_edit = job.command == "edit" && !job.model.empty();
        if (!is_edit || !entry.is_current() || entry.state != JobState::done) continue;
        const auto [at, is_new] = of_model.emplace(job.model, requests.size());
        if (is_new) requests.emplace_back().model = job.model;
        requests[at->second].edits.push_back(result_folder(folder.folder_of(job)));
    }
    return requests;
}

}  // namespace

std::vector<fs::path> write_batch_variants(const BatchFolder& folder, const BatchView& view) {
    std::vector<VariantsRequest> requests = requests_of(folder, view);
    const fs::path output = folder.path() / "variants";
    if (!requests.empty()) make_output_folder(output);
    FileNames names;
    std::vector<fs::path> files;
    for (VariantsRequest& request : requests) {
        request.output = output / (names.unused(request.model.stem().string()) + ".glb");
        try {
            write_variants(request);
            files.push_back(request.output);
        } catch (const InputError& error) {
            warn(std::string("no variants: ") + error.what());
        }
    }
    return files;
}

}  // namespace item3d
