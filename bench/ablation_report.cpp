// What did the study find?
#include "bench/ablation_report.h"

#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/io/load.h"
#include "item3d/io/save.h"
#include "item3d/report/contact_sheet.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>

namespace item3d {
namespace {

using nlohmann::json;
using Results = std::vector<json>;

Results matching(const Results& results, const std::string& key, const json& value) {
    Results some;
    std::copy_if(results.begin(), results.end(), std::back_inserter(some),
                 [&](const json& result) { return result.contains(key) && result[key] == value; });
    return some;
}

/// None where no result has the number.
std::optional<double> mean(const Results& results, const std::string& key) {
    double sum = 0;
    int count = 0;
    for (const json& result : results) {
        if (!result.contains(key)) continue;
        sum += result[key].is_boolean() ? (result[key].get<bool>() ? 1.0 : 0.0)
                                        : result[key].get<double>();
        ++count;
    }
    if (count == 0) return std::nullopt;
    return sum / count;
}

std::string number(std::optional<double> value, int digits = 3) {
    return value ? fmt::format("{:.{}f}", *value, digits) : "";
}

std::string rights(const Results& results) {
    const auto part = mean(results, "right");
    if (!part) return "";
    const auto count = static_cast<double>(results.size());
    return fmt::format("{} of {}", std::lround(*part * count), results.size());
}

/// How much more one has than another, over the cases and seeds that both have.
struct Margin {
    double mean = 0;
    double least = 0;  ///< of the seeds' means
    int seeds = 0;
    int edits = 0;
};

std::optional<Margin> margin(const Results& ours, const Results& theirs, const std::string& key) {
    std::map<std::uint64_t, std::vector<double>> by_seed;
    for (const json& one : ours) {
        for (const json& other : theirs) {
            if (one["case"] == other["case"] && one["seed"] == other["seed"])
                by_seed[one["seed"]].push_back(one[key].get<double>() - other[key].get<double>());
        }
    }
    if (by_seed.empty()) return std::nullopt;
    Margin result;
    result.least = 1e9;
    double sum = 0;
    for (const auto& [seed, values] : by_seed) {
        double of_seed = 0;
        for (const double value : values)
            of_seed += value;
        sum += of_seed;
        result.least = std::min(result.least, of_seed / static_cast<double>(values.size()));
        result.edits += static_cast<int>(values.size());
    }
    result.seeds = static_cast<int>(by_seed.size());
    result.mean = sum / result.edits;
    return result;
}

json row_of(const std::string& name, const Results& results, const Results& baseline) {
    json row{{"contender", name}, {"edits", results.size()}};
    for (const char* key : {"directional", "global", "kept", "seconds", "iterations"})
        row[key] = mean(results, key).value_or(0);
    for (const char* group : {"colors", "materials", "stripes"}) {
        const Results of_group = matching(results, "group", group);
        if (of_group.empty()) continue;
        json& part = row[group];
        part["edits"] = of_group.size();
        part["directional"] = *mean(of_group, "directional");
        part["kept"] = *mean(of_group, "kept");
        if (const auto right = mean(of_group, "right")) part["right"] = *right;
        part["verdict"] = rights(of_group);
    }
    for (const char* key : {"directional", "kept"}) {
        if (const auto found = margin(results, baseline, key))
            row["beside_sds"][key] = {{"mean", found->mean},
                                      {"least_seed", found->least},
                                      {"seeds", found->seeds},
                                      {"edits", found->edits}};
    }
    return row;
}

std::string markdown(const json& rows) {
    std::string text =
        "| method | edits | directional | beside sds (worst seed) | structure kept | beside sds "
        "(worst seed) | stripes kept | colours right | materials right | steps | seconds |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|\n";
    const auto part = [](const json& row, const char* group, const char* key) {
        return row.contains(group) && row[group].contains(key) ? row[group][key] : json();
    };
    for (const json& row : rows) {
        const auto beside = [&](const char* key) -> std::string {
            if (!row.contains("beside_sds") || row["contender"] == "sds") return "";
            const json& found = row["beside_sds"][key];
            return fmt::format("{:+.3f} ({:+.3f})", found["mean"].get<double>(),
                               found["least_seed"].get<double>());
        };
        const json stripes = part(row, "stripes", "kept");
        const auto words = [&](const char* group) {
            const json verdict = part(row, group, "verdict");
            return verdict.is_string() ? verdict.get<std::string>() : "";
        };
        text +=
            fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |\n",
                        row["contender"].get<std::string>(), row["edits"].get<int>(),
                        number(row["directional"].get<double>()), beside("directional"),
                        number(row["kept"].get<double>()), beside("kept"),
                        stripes.is_number() ? number(stripes.get<double>()) : "", words("colors"),
                        words("materials"), std::lround(row["iterations"].get<double>()),
                        std::lround(row["seconds"].get<double>()));
    }
    return text;
}

/// A row for each case: the model before, then after each contender's edit.
void write_sheet(const AblationOptions& options, const Results& results,
                 const std::vector<std::string>& names, const std::string& group) {
    std::vector<std::string> cases;
    for (const json& result : results) {
        const auto name = result["case"].get<std::string>();
        if (result["group"] == group && std::find(cases.begin(), cases.end(), name) == cases.end())
            cases.push_back(name);
    }
    if (cases.empty()) return;
    std::sort(cases.begin(), cases.end());
    std::vector<Tile> tiles;
    const auto picture = [&](const json& result, const char* when) {
        return load_image(options.output / "results" /
                          fmt::format("{}-{}.png", result["name"].get<std::string>(), when));
    };
    for (const std::string& name : cases) {
        const Results of_case = matching(matching(results, "case", name), "seed", 0);
        if (of_case.empty()) continue;
        tiles.push_back({picture(of_case.front(), "before"), of_case.front()["to"]});
        for (const std::string& contender : names) {
            const Results found = matching(of_case, "contender", contender);
            tiles.push_back(found.empty() ? Tile{}
                                          : Tile{picture(found.front(), "after"), contender});
        }
    }
    ContactSheetOptions sheet;
    sheet.columns = static_cast<int>(names.size()) + 1;
    sheet.tile_width = sheet.tile_height = 144;
    save_image(options.output / (group + ".jpg"), contact_sheet(tiles, sheet));
}

}  // namespace

void write_ablation_report(const AblationOptions& options, const std::vector<json>& results) {
    const Results baseline = matching(results, "contender", "sds");
    json rows = json::array();
    std::vector<std::string> names;
    for (const Contender& contender : contenders()) {
        const Results of_contender = matching(results, "contender", contender.name);
        if (of_contender.empty()) continue;
        names.push_back(contender.name);
        rows.push_back(row_of(contender.name, of_contender, baseline));
    }
    write_atomically(options.output / "table.json", rows.dump(2) + "\n");
    write_atomically(options.output / "table.md", markdown(rows));
    for (const char* group : {"colors", "materials", "stripes"})
        write_sheet(options, results, names, group);
    fmt::print("{}", markdown(rows));
}

}  // namespace item3d
