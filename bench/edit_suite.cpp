// Edits of real meshes that the prior never saw, judged by numbers and by a page to look at.
//
//   edit_suite -o DIR --mesh cow=spot.obj --mesh object=teapot.obj [--prior DIR] [--only colors]
//
// The demo mug is always among the meshes. Colour edits go from one plain colour to another and
// count as right when the surface's mean base colour is nearest, in CIELAB, to the named target
// among the prior's colours. Material edits are for looking at, with metallic before and after.
// Stripe edits compare the adjusted direction with plain RDL and SDS by the luminance detail that
// they keep.
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/edit/edit.h"
#include "item3d/edit/surface_means.h"
#include "item3d/evaluate/html.h"
#include "item3d/hub/find_prior.h"
#include "item3d/prior/vocabulary.h"
#include "item3d/scene/io/load.h"
#include "item3d/scene/io/save.h"
#include "suite_cases.h"
#include "suite_models.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace item3d {
namespace {

using nlohmann::json;

/// A case and how it is edited: "learned", "off" or "sds".
struct SuiteEdit {
    SuiteCase test;
    std::string method = "learned";
};

struct SuiteOptions {
    std::filesystem::path output;
    std::filesystem::path prior;
    std::map<std::string, std::filesystem::path> meshes;
    std::string only;
    std::uint64_t seed = 0;
};

std::vector<SuiteEdit> suite_edits(const std::vector<std::string>& nouns) {
    std::vector<SuiteEdit> edits;
    for (const SuiteCase& test : suite_cases(nouns)) {
        edits.push_back({test});
        if (test.group != "stripes") continue;
        edits.push_back({test, "off"});
        edits.push_back({test, "sds"});
    }
    return edits;
}

json run_edit(const SuiteEdit& edit, const SuiteOptions& options, const PriorVocabulary& vocabulary,
              const std::filesystem::path& folder) {
    const SuiteCase& test = edit.test;
    make_output_folder(folder);
    const Model mesh = load_model(options.meshes.at(test.mesh));
    EditRequest request;
    request.model = folder / "source.glb";
    save_model(request.model, source_model(test, mesh, vocabulary));
    request.prior = options.prior;
    request.output = folder;
    json overrides = {{"from", prompt_of(test.source, test.mesh)},
                      {"to", prompt_of(test.target, test.mesh)},
                      {"seed", options.seed}};
    if (edit.method == "sds") overrides["guidance"] = "sds";
    if (edit.method == "off") overrides["adjust"] = "off";
    request.settings = resolve_settings(options.prior, overrides);
    request.command = fmt::format("item3d edit {} --from '{}' --to '{}'", request.model.string(),
                                  request.settings.from, request.settings.to);
    const json summary = edit_model(request);

    json result = {{"group", test.group},
                   {"mesh", test.mesh},
                   {"from", summary["from"]},
                   {"to", summary["to"]},
                   {"method", edit.method},
                   {"scores", summary["scores"]},
                   {"seconds", summary["seconds"]["total"]},
                   {"peak_memory_bytes", summary["peak_memory_bytes"]}};
    if (test.group == "colors") {
        const json mean = summary["scores"]["after"]["base_color_linear"];
        const auto colors = named_colors(vocabulary);
        const std::size_t nearest = nearest_color(
            Vec3(mean[0].get<float>(), mean[1].get<float>(), mean[2].get<float>()), colors);
        result["nearest"] = colors[nearest].name;
        result["right"] = colors[nearest].name == test.target;
    }
    return result;
}

std::string verdict(const json& result) {
    const json& scores = result["scores"];
    if (result["group"] == "colors") {
        return fmt::format("{}: {}", result["right"].get<bool>() ? "right" : "wrong",
                           result["nearest"].get<std::string>());
    }
    if (result["group"] == "materials") {
        return fmt::format("metallic {:.2f}", scores["after"]["metallic"].get<double>());
    }
    return fmt::format("{}, detail kept {:.2f}", result["method"].get<std::string>(),
                       scores["detail_kept"].get<double>());
}

std::string page_of(const std::vector<json>& results, const SuiteOptions& options) {
    std::map<std::string, std::vector<std::string>> figures;
    for (const json& result : results) {
        const auto folder = options.output / result["folder"].get<std::string>();
        const std::string caption = fmt::format("{} -> {} ({})", result["from"].get<std::string>(),
                                                result["to"].get<std::string>(), verdict(result));
        auto& group = figures[result["group"].get<std::string>()];
        group.push_back(html_figure({"", read_bytes(folder / "before.png")}));
        group.push_back(html_figure({caption, read_bytes(folder / "after.png")}));
    }
    std::string body;
    for (const auto& [title, group] : figures) {
        body += html_section(title, html_gallery(group, 420));
    }
    return html_page("Edit suite", body);
}

json totals(const std::vector<json>& results) {
    int colors = 0;
    int right = 0;
    for (const json& result : results) {
        if (result["group"] != "colors") continue;
        ++colors;
        right += result["right"].get<bool>() ? 1 : 0;
    }
    return {{"color_edits", colors}, {"color_edits_right", right}, {"edits", results.size()}};
}

void run_suite(const SuiteOptions& options) {
    const PriorVocabulary vocabulary = PriorVocabulary::load(options.prior);
    std::vector<std::string> nouns;
    for (const auto& [noun, path] : options.meshes)
        nouns.push_back(noun);
    std::vector<json> results;
    for (const SuiteEdit& edit : suite_edits(nouns)) {
        const SuiteCase& test = edit.test;
        if (!options.only.empty() && test.group != options.only) continue;
        const std::string name = fmt::format("{:02}-{}-{}", results.size(), test.group, test.mesh);
        json result = run_edit(edit, options, vocabulary, options.output / name);
        result["folder"] = name;
        note(fmt::format("{} -> {}: {}", result["from"].get<std::string>(),
                         result["to"].get<std::string>(), verdict(result)));
        results.push_back(result);
    }
    const json summary = {{"totals", totals(results)}, {"seed", options.seed}, {"edits", results}};
    write_atomically(options.output / "suite.json", summary.dump(2) + "\n");
    write_atomically(options.output / "suite.html", page_of(results, options));
    fmt::print("{}\n", summary["totals"].dump());
}

}  // namespace
}  // namespace item3d

int main(int argc, char** argv) {
    item3d::SuiteOptions options;
    std::vector<std::string> meshes;
    CLI::App app("Runs the edits that item3d is judged by.");
    app.add_option("-o,--output", options.output, "Folder for all results")->required();
    app.add_option("--prior", options.prior,
                   "Prior, a folder or a name; without it, the embedded one");
    app.add_option("--mesh", meshes, "NOUN=FILE; the demo mug is always there");
    app.add_option("--only", options.only, "colors, materials or stripes");
    app.add_option("--seed", options.seed, "Seed of the edits");
    CLI11_PARSE(app, argc, argv);
    try {
        options.prior = item3d::find_prior(options.prior.string());
        options.meshes = item3d::suite_meshes(meshes);
        item3d::run_suite(options);
    } catch (const item3d::Error& error) {
        fmt::print(stderr, "edit_suite: error: {}\n", error.what());
        return static_cast<int>(error.code());
    }
    return 0;
}
