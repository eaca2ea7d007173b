#include "item3d/suite/edit_suite.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/parse_json.h"
#include "item3d/core/progress.h"
#include "item3d/edit/edit.h"
#include "item3d/hub/find_prior.h"
#include "item3d/io/load.h"
#include "item3d/io/load_light.h"
#include "item3d/io/save.h"
#include "item3d/report/html.h"
#include "item3d/report/model_images.h"
#include "item3d/suite/look_by_clip.h"
#include "item3d/tensors/checkpoint.h"

#include <algorithm>
#include <memory>

namespace item3d {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr double metal_enough = 0.6;
constexpr int judged_views = 6;
constexpr int judged_pixels = 256;

/// Data shared by all edits.
struct Judge {
    PriorVocabulary vocabulary;
    std::vector<NamedColor> colors;
    std::unique_ptr<Clip> clip;  ///< null if the prior has none
    std::string weights;         ///< checksum of the prior's weights
};

EditRequest request_of(const SuiteCase& test, const SuiteOptions& options, const fs::path& folder,
                       bool resume) {
    EditRequest request;
    request.model = folder / "source.glb";
    request.prior = options.prior;
    request.output = folder;
    request.resume = resume;
    request.image_pixels = options.image_pixels;
    const json overrides = {{"from", prompt_of(test.source, test.mesh)},
                            {"to", prompt_of(test.target, test.mesh)},
                            {"seed", options.seed}};
    request.plan = resolve_plan(options.prior, overrides);
    request.command = fmt::format("item3d edit {} --from '{}' --to '{}'", request.model.string(),
                                  request.plan.from, request.plan.to);
    return request;
}

at::Tensor images_of_model(const fs::path& model_file, const std::string& light_name) {
    const at::NoGradGuard no_grad;
    const Model model = load_model(model_file);
    const EnvironmentLight light = prefilter(load_light(light_name), 64);
    return over_white(draw_images(model, light, image_cameras(model, judged_views), judged_pixels));
}

/// Returns {"found", "right"}, or {} for a case whose result is not judged.
json verdict_of(const SuiteCase& test, const json& summary, const EditRequest& request,
                const Judge& judge) {
    const json& after = summary["scores"]["after"];
    if (test.group == "colors") {
        const json mean = after["base_color_linear"];
        const std::size_t nearest = nearest_color(
            Vec3(mean[0].get<float>(), mean[1].get<float>(), mean[2].get<float>()), judge.colors);
        const std::string& found = judge.colors[nearest].name;
        return {{"found", found}, {"right", found == test.word}};
    }
    if (test.group == "metals") {
        const double metallic = after["metallic"].get<double>();
        return {{"found", fmt::format("metallic {:.2f}", metallic)},
                {"right", metallic > metal_enough}};
    }
    if (test.word.empty() || !judge.clip) return json::object();
    const at::Tensor images = images_of_model(request.output / "model.glb", request.plan.light);
    const std::string found =
        look_by_clip(images, test.mesh, *judge.clip, judge.vocabulary, {"materials", "patterns"});
    return {{"found", found}, {"right", found == test.word}};
}

json run_edit(const SuiteCase& test, const SuiteOptions& options, const Judge& judge,
              const fs::path& folder, bool resume) {
    const EditRequest request = request_of(test, options, folder, resume);
    save_model(request.model,
               source_model(test, load_model(options.meshes.at(test.mesh)), judge.vocabulary));
    const json summary = edit_model(request);
    json result = verdict_of(test, summary, request, judge);
    result.update({{"group", test.group},
                   {"mesh", test.mesh},
                   {"from", summary["from"]},
                   {"to", summary["to"]},
                   {"scores", summary["scores"]},
                   {"seconds", summary["seconds"]["total"]},
                   {"peak_memory_bytes", summary["peak_memory_bytes"]}});
    return result;
}

constexpr const char* verdict_name = "verdict.json";

/// Returns the inputs that a verdict depends on.
json asked(const SuiteCase& test, const SuiteOptions& options, const Judge& judge) {
    return {{"model", options.meshes.at(test.mesh).string()},
            {"from", prompt_of(test.source, test.mesh)},
            {"to", prompt_of(test.target, test.mesh)},
            {"weights", judge.weights},
            {"seed", options.seed}};
}

/// Returns the verdict that an earlier run left in `folder`: {"asked", "result"?}, or {} if there
/// is none.
json verdict_before(const fs::path& folder) {
    const fs::path file = folder / verdict_name;
    if (!fs::exists(file)) return json::object();
    const json verdict = parse_json(read_text(file));
    const bool readable = verdict.is_object() && verdict.value("asked", json()).is_object();
    return readable ? verdict : json::object();
}

json run_or_keep(const SuiteCase& test, const SuiteOptions& options, const Judge& judge,
                 const fs::path& folder) {
    const json question = asked(test, options, judge);
    const json before = options.resume ? verdict_before(folder) : json::object();
    const json asked_before = before.value("asked", json::object());
    if (asked_before == question && before.contains("result")) return before["result"];

    // An edit's own checkpoint does not record the weights that made it. The verdict file therefore
    // records them before the edit starts.
    const bool resume = asked_before.value("weights", json()) == judge.weights;
    make_output_folder(folder);
    const auto write = [&](const json& verdict) {
        write_atomically(folder / verdict_name, verdict.dump(2) + "\n");
    };
    if (!resume) write({{"asked", question}});
    const json result = run_edit(test, options, judge, folder, resume);
    write({{"asked", question}, {"result", result}});
    return result;
}

std::string verdict_text(const json& result) {
    if (result.contains("right"))
        return fmt::format("{}: {}", result["right"].get<bool>() ? "right" : "wrong",
                           result["found"].get<std::string>());
    return fmt::format("detail kept {:.2f}", result["scores"]["detail_kept"].get<double>());
}

/// Returns the page. Failures come first.
std::string page_of(std::vector<json> results, const json& totals, const SuiteOptions& options) {
    std::stable_sort(results.begin(), results.end(), [](const json& a, const json& b) {
        return a.value("right", true) < b.value("right", true);
    });
    TableRows rows;
    for (const auto& [group, total] : totals["groups"].items())
        rows.emplace_back(
            group, fmt::format("{}{} edits, {:.0f} s each, {:.0f} s at most, detail kept {:.2f}",
                               total.contains("right") ? total["right"].dump() + " right of " : "",
                               total["edits"].get<int>(), total["seconds"].get<double>(),
                               total["seconds_most"].get<double>(), total["kept"].get<double>()));
    std::string body = html_header("item3d edit", fmt::format("{} edits with {}", results.size(),
                                                              options.prior.filename().string())) +
                       html_section("In numbers", html_table(rows));
    for (const auto& [group, total] : totals["groups"].items()) {
        std::vector<std::string> figures;
        for (const json& result : results) {
            if (result["group"] != group) continue;
            const auto folder = options.output / result["folder"].get<std::string>();
            figures.push_back(html_figure(
                {result["from"].get<std::string>(), read_bytes(folder / "before.png")}));
            figures.push_back(html_figure(
                {fmt::format("{} ({})", result["to"].get<std::string>(), verdict_text(result)),
                 read_bytes(folder / "after.png")}));
        }
        body += html_section(group, html_gallery(figures, 420));
    }
    return html_page("Edit suite", body);
}

}  // namespace

json suite_totals(const std::vector<json>& results) {
    json groups = json::object();
    double memory = 0;
    for (const json& result : results) {
        json& total = groups[result["group"].get<std::string>()];
        if (total.is_null()) total = json::object();
        const auto add = [&](const char* name, double value) {
            total[name] = total.value(name, 0.0) + value;
        };
        const double seconds = result["seconds"].get<double>();
        total["edits"] = total.value("edits", 0) + 1;
        if (result.contains("right"))
            total["right"] = total.value("right", 0) + (result["right"].get<bool>() ? 1 : 0);
        add("kept", result["scores"]["detail_kept"].get<double>());
        add("seconds", seconds);
        total["seconds_most"] = std::max(total.value("seconds_most", 0.0), seconds);
        memory = std::max(memory, result["peak_memory_bytes"].get<double>());
    }
    for (json& total : groups)
        for (const char* mean : {"kept", "seconds"})
            total[mean] = total[mean].get<double>() / total["edits"].get<double>();
    return {{"groups", groups}, {"edits", results.size()}, {"peak_memory_bytes", memory}};
}

json run_edit_suite(const std::vector<SuiteCase>& cases, const SuiteOptions& options) {
    Judge judge{PriorVocabulary::load(options.prior), {}, nullptr, hash_of_weights(options.prior)};
    judge.colors = named_colors(judge.vocabulary);
    const fs::path clip = find_in_prior(options.prior, "clip");
    if (!clip.empty()) judge.clip = std::make_unique<Clip>(Clip::load(clip));
    std::vector<std::string> names;
    for (const SuiteCase& test : cases) {
        names.push_back(fmt::format("{:02}-{}-{}", names.size(), test.group, test.mesh));
        if (!options.resume) fs::remove(options.output / names.back() / verdict_name);
    }
    std::vector<json> results;
    for (const SuiteCase& test : cases) {
        const std::string& name = names[results.size()];
        json result;
        try {
            result = run_or_keep(test, options, judge, options.output / name);
        } catch (const Interrupted&) {
            throw Interrupted(fmt::format(
                "{} of {} edits are done; run the same command with --resume to continue",
                results.size(), cases.size()));
        }
        result["folder"] = name;
        note(fmt::format("{} of {}: {} -> {}: {}", results.size() + 1, cases.size(),
                         result["from"].get<std::string>(), result["to"].get<std::string>(),
                         verdict_text(result)));
        results.push_back(result);
    }
    const json totals = suite_totals(results);
    const json summary = {{"totals", totals}, {"seed", options.seed}, {"edits", results}};
    write_atomically(options.output / "suite.json", summary.dump(2) + "\n");
    write_atomically(options.output / "suite.html", page_of(results, totals, options));
    return summary;
}

}  // namespace item3d
