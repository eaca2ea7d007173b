#include "apps/item3d/edit/plan_file.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/edit/outputs/baked_files.h"
#include "item3d/edit/settings_table.h"
#include "item3d/report/html.h"

#include <algorithm>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* settings_file = "planned.json";
constexpr const char* example =
    R"(as {"edits": [{"from": "a cow", "to": "a golden cow", "region": ["named=black"]}]})";

json read_json(const fs::path& path) {
    return json::parse(read_text(path), nullptr, /*allow_exceptions=*/false);
}

/// Throws InputError where a value is of another type than its setting.
void check_types(const std::string& place, const json& edit) {
    for (const auto& [name, value] : edit.items()) {
        EditSettings settings;
        try {
            setting_named(name).set(settings, value);
        } catch (const json::exception&) {
            throw InputError(place, fmt::format("{} cannot be {}", name, value.dump()),
                             "its value is as " + setting_named(name).get(EditSettings()).dump());
        }
    }
}

/// Model and settings of an edit, to know it again.
json question_of(const PlannedEdit& planned) {
    return {{"model", planned.model.string()}, {"settings", planned.settings}};
}

std::string page_of(const json& record, const fs::path& output, const std::string& model) {
    std::string body =
        html_header("item3d edit", fmt::format("{} edits", record["edits"].size()),
                    fmt::format("<p><a href=\"{0}\">{0}</a> has all of them.</p>\n", model));
    for (std::size_t i = 0; i < record["edits"].size(); ++i) {
        const json& edit = record["edits"][i];
        const std::string folder = std::to_string(i + 1);
        std::string content;
        content +=
            html_gallery({html_figure({"before", read_bytes(output / folder / "before.png")}),
                          html_figure({"after", read_bytes(output / folder / "after.png")})},
                         420);
        if (edit.contains("region"))
            content += fmt::format(
                "<p>Region: {:.1f} % of the surface; outside of it {} of {} "
                "texels changed.</p>\n",
                100 * edit["region"]["share"].get<double>(),
                edit["region"]["outside"]["changed"].get<std::int64_t>(),
                edit["region"]["outside"]["texels"].get<std::int64_t>());
        content += "<p><a href=\"" + folder + "/report.html\">Report of this edit</a></p>\n";
        body += html_section(fmt::format("{}. {} \u2192 {}", i + 1, edit["from"].get<std::string>(),
                                         edit["to"].get<std::string>()),
                             content);
    }
    return html_page("item3d edit", body);
}

}  // namespace

std::vector<json> read_plan_file(const fs::path& path) {
    const json document = read_json(path);
    if (!document.is_object() || !document.contains("edits") || !document["edits"].is_array() ||
        document["edits"].empty())
        throw InputError(path.string(), "a list of edits was expected", example);
    std::vector<json> edits;
    for (const json& edit : document["edits"]) {
        const std::string place = fmt::format("{}: edit {}", path.string(), edits.size() + 1);
        if (!edit.is_object()) throw InputError(place, "an object was expected", example);
        for (const auto& [name, value] : edit.items()) {
            const auto& table = settings_table();
            if (std::none_of(table.begin(), table.end(),
                             [&, key = name](const Setting& row) { return row.name == key; }))
                throw InputError(place, "'" + name + "' is no setting",
                                 "docs/reference/settings.md lists them");
        }
        for (const char* key : {"from", "to"})
            if (!edit.contains(key))
                throw InputError(place, fmt::format("\"{}\" is missing", key), example);
        check_types(place, edit);
        edits.push_back(edit);
    }
    return edits;
}

json run_plan(const fs::path& model, const fs::path& output, const std::vector<json>& edits,
              bool resume, const std::function<json(const PlannedEdit&)>& edit) {
    make_output_folder(output);
    json record{{"edits", json::array()}};
    PlannedEdit planned;
    planned.model = model;
    bool is_kept = resume;
    for (std::size_t i = 0; i < edits.size(); ++i) {
        planned.output = output / std::to_string(i + 1);
        planned.settings = edits[i];
        const json question = question_of(planned);
        const fs::path asked = planned.output / settings_file;
        const bool is_same = is_kept && fs::exists(asked) && read_json(asked) == question;
        const fs::path result = planned.output / model_file_name(planned.model);
        const fs::path done = planned.output / "edit.json";
        if (is_same && fs::exists(result) && fs::exists(done)) {
            record["edits"].push_back(read_json(done));
            note(fmt::format("edit {} of {} is there already", i + 1, edits.size()));
        } else {
            // The edits behind it were made of another model.
            is_kept = false;
            note(fmt::format("edit {} of {}: {} -> {}", i + 1, edits.size(),
                             edits[i]["from"].get<std::string>(),
                             edits[i]["to"].get<std::string>()));
            planned.is_begun = is_same && fs::exists(planned.output / "checkpoint.safetensors");
            make_output_folder(planned.output);
            fs::remove(done);
            write_atomically(asked, std::string_view(question.dump(2)));
            record["edits"].push_back(edit(planned));
        }
        planned.model = result;
    }
    const Bytes bytes = read_bytes(planned.model);
    write_atomically(output / planned.model.filename(), std::span<const std::uint8_t>(bytes));
    write_atomically(output / "report.html",
                     std::string_view(page_of(record, output, planned.model.filename().string())));
    write_atomically(output / "edit.json", std::string_view(record.dump(2) + "\n"));
    return record;
}

}  // namespace item3d
