#include "item3d/compare/runs.h"

#include "item3d/core/digest.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/names.h"
#include "item3d/core/parse_json.h"
#include "item3d/core/version.h"
#include "item3d/hub/find_prior.h"
#include "item3d/tensors/checkpoint.h"

#include <algorithm>
#include <map>
#include <set>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// Options that `item3d edit` takes with only one method.
const std::map<std::string, std::string> owners = {
    {"guidance", "item3d"}, {"clip-loss", "clip"}, {"instruction", "in2n"}, {"image-cfg", "in2n"}};

std::string settings_of(const fs::path& prior) {
    const fs::path file = prior / "prior.json";
    return fs::exists(file) ? read_text(file) : "";
}

}  // namespace

CompareMethod plain_method(const std::string& name) {
    return {name, {{"method", name}}};
}

nlohmann::json options_of(const CompareCase& test, const CompareMethod& method) {
    Json options = test.options;
    for (const auto& [option, owner] : owners)
        if (owner != method.edit_method()) options.erase(option);
    // By default an edit of a colour would select the region of that colour. Methods are compared
    // as published, which is on the whole surface.
    if (!options.contains("region")) options["region"] = "all";
    options.update(method.options);
    options["method"] = method.edit_method();
    return options;
}

std::vector<std::string> methods_of_prior(const fs::path& prior,
                                          const std::vector<std::string>& methods) {
    const fs::path config = prior / "unet" / "config.json";
    const Json unet = fs::exists(config) ? parse_json(read_text(config)) : Json();
    // A U-Net of InstructPix2Pix reads an image's latents in addition to the noisy latents.
    const bool instructed = unet.is_object() && unet.value("in_channels", Json(4)) ==
                                                    Json(2 * unet.value("out_channels", 4));
    std::vector<std::string> able;
    for (const std::string& method : methods) {
        if (method == "in2n" && !instructed && find_in_prior(prior, "instruct").empty()) continue;
        if (method == "clip" && find_in_prior(prior, "clip").empty()) continue;
        able.push_back(method);
    }
    return able;
}

std::vector<CompareRun> plan_runs(const CompareOptions& options) {
    std::vector<CompareRun> runs;
    std::vector<std::string> bytes;  // checksum of each case's model
    for (const CompareCase& test : options.cases)
        bytes.push_back(sha256(read_text(test.model)));
    std::map<std::string, std::size_t> case_of_folder;
    for (const auto& prior : options.priors) {
        const std::string decides =
            version() + hash_of_weights(prior.folder) + sha256(settings_of(prior.folder));
        for (const std::uint64_t seed : options.seeds) {
            for (std::size_t i = 0; i < options.cases.size(); ++i) {
                const CompareCase& test = options.cases[i];
                for (const CompareMethod& method : options.methods) {
                    CompareRun run;
                    run.case_index = i;
                    run.method = method.name;
                    run.edit_method = method.edit_method();
                    run.prior = prior.name;
                    run.prior_folder = prior.folder;
                    run.seed = seed;
                    run.arguments = {"--from", test.from, "--to",
                                     test.to,  "--seed",  std::to_string(seed)};
                    for (const std::string& argument : option_arguments(options_of(test, method)))
                        run.arguments.push_back(argument);
                    std::string asked = decides + bytes[i];
                    for (const std::string& argument : run.arguments)
                        asked += '\0' + argument;
                    const std::string name =
                        fmt::format("{}-{}-{}-{}", slug(test.name), slug(method.name), seed,
                                    sha256(asked).substr(0, 10));
                    const auto [found, is_new] = case_of_folder.emplace(name, i);
                    if (!is_new && found->second != i)
                        throw InputError(fmt::format("case {} ('{}')", i + 1, test.name),
                                         fmt::format("is the same as case {}", found->second + 1),
                                         "leave one of them out");
                    run.folder = options.output / "runs" / name;
                    // Added after the hash, because paths do not affect the result.
                    run.arguments.insert(run.arguments.begin(), {"edit", test.model.string()});
                    run.arguments.insert(
                        run.arguments.end(),
                        {"--prior", prior.folder.string(), "-o", run.folder.string(), "--json"});
                    if (is_new) runs.push_back(std::move(run));
                }
            }
        }
    }
    return runs;
}

bool is_done(const CompareRun& run) {
    return fs::exists(run.folder / "edit.json") && error_of(run).empty();
}

bool was_resumed(const CompareRun& run) {
    return fs::exists(run.folder / resumed_name);
}

std::string error_of(const CompareRun& run) {
    const fs::path file = run.folder / "failed.txt";
    return fs::exists(file) ? read_text(file) : "";
}

}  // namespace item3d
