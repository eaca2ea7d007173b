#include "item3d/compare/pairs.h"

#include "item3d/compare/table.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <tuple>

namespace item3d {
namespace {

using Json = nlohmann::json;

double number_at(const Json& row, const char* key) {
    const Json& value = row.at(key);
    return value.is_boolean() ? (value.get<bool>() ? 1.0 : 0.0) : value.get<double>();
}

PairedDifference paired(const std::vector<Json>& rows, const std::string& first,
                        const std::string& method, const std::string& prior, const char* key) {
    std::map<std::tuple<std::string, std::uint64_t>, double> firsts;
    for (const Json& row : rows)
        if (row.at("method") == first && row.at("prior") == prior && row.contains(key))
            firsts[{row.at("case"), row.at("seed")}] = number_at(row, key);
    std::map<std::uint64_t, std::pair<double, int>> seeds;  // sum and count
    PairedDifference result;
    for (const Json& row : rows) {
        if (row.at("method") != method || row.at("prior") != prior || !row.contains(key)) continue;
        const auto found = firsts.find({row.at("case"), row.at("seed")});
        if (found == firsts.end()) continue;
        const double more = number_at(row, key) - found->second;
        auto& [sum, count] = seeds[row.at("seed")];
        sum += more;
        ++count;
        result.mean += more;
        ++result.pairs;
    }
    if (result.pairs == 0) return result;
    result.mean /= result.pairs;
    result.worst_seed = std::numeric_limits<double>::infinity();
    for (const auto& [seed, values] : seeds)
        result.worst_seed = std::min(result.worst_seed, values.first / values.second);
    return result;
}

}  // namespace

std::vector<PairedMethod> beside_first(const std::vector<Json>& rows) {
    std::vector<PairedMethod> methods;
    if (rows.empty()) return methods;
    const auto first = rows.front().at("method").get<std::string>();
    for (const MethodSummary& one : summarize(rows)) {
        if (one.method == first) continue;
        methods.push_back({one.method, one.prior,
                           paired(rows, first, one.method, one.prior, "clip_directional"),
                           paired(rows, first, one.method, one.prior, "detail_kept"),
                           paired(rows, first, one.method, one.prior, "right"),
                           paired(rows, first, one.method, one.prior, "view_difference"),
                           paired(rows, first, one.method, one.prior, "seconds")});
    }
    return methods;
}

}  // namespace item3d
