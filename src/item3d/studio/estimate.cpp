#include "item3d/studio/estimate.h"

#include "item3d/core/words.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace item3d {
namespace {

using Json = nlohmann::json;

/// Costs of the demo edit in docs/benchmarks.md, on two cores.
constexpr EditCost demo_cost{250, 64 * 64, 29.0, 16.6, 2.0, 7.6, 0.86e9};
constexpr int demo_threads = 2;

double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

template <typename Value>
double median_of(const std::vector<EditCost>& costs, Value value) {
    std::vector<double> values;
    for (const EditCost& cost : costs)
        values.push_back(value(cost));
    return median(std::move(values));
}

double number(const Json& settings, const Json& defaults, const char* name, double otherwise) {
    for (const Json* from : {&settings, &defaults})
        if (const auto found = from->find(name); found != from->end() && found->is_number())
            return found->get<double>();
    return otherwise;
}

std::string text(const Json& object, const char* key, const std::string& otherwise) {
    const auto found = object.find(key);
    return found != object.end() && found->is_string() ? found->get<std::string>() : otherwise;
}

/// True if the target has one of the prior's detail words that the source lacks, as in
/// EditPlan::paints_detail.
bool paints_detail(const Json& request, const Json& settings, const Json& defaults) {
    const std::string detail = text(settings, "detail", text(defaults, "detail", "auto"));
    if (detail != "auto") return detail == "always";
    const auto has = [](const std::vector<std::string>& words, const std::string& word) {
        return std::find(words.begin(), words.end(), word) != words.end();
    };
    const auto from = prompt_words(text(request, "from", "")),
               to = prompt_words(text(request, "to", ""));
    const Json words = defaults.value("detail_words", Json::array());
    return std::any_of(words.begin(), words.end(), [&](const Json& word) {
        return has(to, word.get<std::string>()) && !has(from, word.get<std::string>());
    });
}

struct EditSize {
    bool detail = false;
    double iterations = 0, pixels = 0;
};

EditSize size_of(const Json& request, const Json& settings, const Json& defaults) {
    EditSize size;
    size.detail = paints_detail(request, settings, defaults);
    const double usual = number(Json::object(), defaults, "iterations", demo_cost.iterations);
    const double before_detail = number(settings, defaults, "iterations_before_detail", 0);
    size.iterations = settings.contains("iterations")
                          ? number(settings, defaults, "iterations", usual)
                          : (size.detail && before_detail > 0 ? before_detail : usual);
    const double resolution = number(settings, defaults, "resolution", 64);
    size.pixels = number(settings, defaults, "batch", 1) * resolution * resolution;
    return size;
}

}  // namespace

std::optional<EditCost> edit_cost(const Json& summary) {
    try {
        const Json& seconds = summary.at("seconds");
        const Json& settings = summary.at("settings");
        EditCost cost;
        cost.iterations = summary.at("iterations_done").get<double>();
        const double resolution = settings.at("resolution").get<double>();
        cost.pixels = settings.at("batch").get<double>() * resolution * resolution;
        cost.optimize = seconds.at("optimize").get<double>();
        cost.detail = seconds.value("detail", 0.0);
        cost.before = seconds.value("load", 0.0) + seconds.value("fit", 0.0);
        cost.after = seconds.at("total").get<double>() - cost.before - cost.optimize - cost.detail;
        cost.memory = summary.at("peak_memory_bytes").get<double>();
        const bool is_whole = text(summary, "command", "").find(" --resume") == std::string::npos;
        if (!is_whole || cost.iterations <= 0 || cost.optimize <= 0) return std::nullopt;
        return cost;
    } catch (const Json::exception&) {
        return std::nullopt;
    }
}

EditPlanSeconds expected_seconds(const Json& request, const Json& defaults,
                                 const std::vector<EditCost>& former, int threads) {
    const Json settings = request.value("settings", Json::object());
    const EditSize size = size_of(request, settings, defaults);
    std::vector<EditCost> costs = former;
    double faster = 1;
    if (costs.empty()) {
        costs = {demo_cost};
        faster = static_cast<double>(std::max(1, threads)) / demo_threads;
    }
    EditPlanSeconds plan;
    plan.before = median_of(costs, [](const EditCost& cost) { return cost.before; }) / faster;
    plan.after = median_of(costs, [](const EditCost& cost) { return cost.after; }) / faster;
    const double per_pixel = median_of(costs, [](const EditCost& cost) {
        return cost.optimize / (cost.iterations * cost.pixels);
    });
    plan.optimize = per_pixel * size.iterations * size.pixels / faster;
    if (size.detail) {
        std::vector<EditCost> detailed;
        std::copy_if(costs.begin(), costs.end(), std::back_inserter(detailed),
                     [](const EditCost& cost) { return cost.detail > 0; });
        plan.detail =
            (detailed.empty()
                 ? demo_cost.detail
                 : median_of(detailed, [](const EditCost& cost) { return cost.detail; })) /
            faster;
    }
    return plan;
}

Json estimate_edit(const Json& request, const Json& defaults, const std::vector<EditCost>& former,
                   int threads) {
    const EditSize size = size_of(request, request.value("settings", Json::object()), defaults);
    const double seconds = expected_seconds(request, defaults, former, threads).total();
    const double memory = former.empty()
                              ? demo_cost.memory
                              : median_of(former, [](const EditCost& cost) { return cost.memory; });
    return {
        {"seconds", std::round(10 * seconds) / 10},
        {"memory_bytes", memory},
        {"iterations", size.iterations},
        {"detail", size.detail},
        {"basis", former.empty() ? "the demo edit on another machine" : "edits on this machine"}};
}

}  // namespace item3d
