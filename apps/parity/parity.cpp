#include "apps/parity/parity.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"

#include <algorithm>
#include <cmath>

namespace item3d::parity {

Case::Case(const std::filesystem::path& folder)
    : folder_(folder), io_(SafeTensors::open(folder / "io.safetensors")) {}

bool Case::has_meta() const {
    return std::filesystem::exists(folder_ / "meta.json");
}

Config Case::meta() const {
    return Config::read(folder_ / "meta.json");
}

at::Tensor Case::input(const std::string& name) const {
    return io_.tensor("in." + name);
}

at::Tensor Case::expected(const std::string& name) const {
    return io_.tensor("out." + name);
}

std::vector<std::string> Case::outputs() const {
    return outputs_with_prefix("");
}

std::vector<std::string> Case::outputs_with_prefix(const std::string& prefix) const {
    const std::string start = "out." + prefix;
    std::vector<std::string> result;
    for (const std::string& name : io_.names())
        if (name.starts_with(start)) result.push_back(name.substr(start.size()));
    std::sort(result.begin(), result.end());
    return result;
}

void Case::compare(const std::string& name, const at::Tensor& actual, double tolerance,
                   const std::string& reported_as) {
    if (!has("out." + name)) return;
    seen_.insert(name);
    compared_ = true;
    const at::Tensor wanted = expected(name).to(at::kDouble);
    nlohmann::json result = {{"name", reported_as.empty() ? name : reported_as},
                             {"tolerance", tolerance}};
    bool pass = false;
    if (wanted.sizes() != actual.sizes()) {
        result["problem"] =
            fmt::format("shape [{}], expected [{}]", fmt::join(actual.sizes().vec(), ", "),
                        fmt::join(wanted.sizes().vec(), ", "));
    } else if (wanted.numel() == 0) {
        pass = true;
    } else {
        const at::Tensor difference = (actual.detach().to(at::kDouble) - wanted).abs();
        const double largest = difference.max().item<double>();
        const double relative = largest / std::max(1.0, wanted.abs().max().item<double>());
        pass = relative <= tolerance;  // false for NaN
        result["max_abs"] = largest;
        result["max_rel"] = relative;
        if (!std::isfinite(largest)) result["problem"] = "not finite";
    }
    result["pass"] = pass;
    failed_ = failed_ || !pass;
    results_.push_back(std::move(result));
}

void Case::orient(const std::string& name, const at::Tensor& actual,
                  const std::string& float32_name) {
    if (!has("out." + name) || !has("out." + float32_name)) return;
    seen_.insert(name);
    const at::Tensor wanted = expected(name), reference = expected(float32_name);
    if (wanted.sizes() != actual.sizes()) return;
    const double norm = std::max(wanted.norm().item<double>(), 1e-30);
    const double distance = (actual.to(at::kFloat) - wanted).norm().item<double>() / norm;
    const double advised = 2 * (reference - wanted).norm().item<double>() / norm;
    results_.push_back({{"name", name},
                        {"relative_l2", distance},
                        {"advised", advised},
                        {"orientation_only", true},
                        {"pass", distance <= advised}});
}

void Case::compare_texts(const std::string& name, std::int64_t count, std::int64_t different) {
    compared_ = compared_ || count > 0;
    failed_ = failed_ || different > 0;
    results_.push_back({{"name", name},
                        {"max_abs", different},
                        {"max_rel", different},
                        {"compared", count},
                        {"tolerance", within::exact},
                        {"pass", different == 0}});
}

void Case::skip(const std::string& prefix, const std::string& reason) {
    if (outputs_with_prefix(prefix).empty()) return;
    skipped_[prefix] = reason;
    for (const std::string& rest : outputs_with_prefix(prefix))
        seen_.insert(prefix + rest);
}

bool Case::passed() const {
    return compared_ && !failed_;
}

nlohmann::json Case::report() const {
    nlohmann::json skipped = skipped_;
    for (const std::string& name : outputs())
        if (seen_.count(name) == 0) skipped[name] = "no rule for this output";
    std::string name = folder_.filename().string();
    if (name.empty()) name = folder_.parent_path().filename().string();
    return {{"case", name},
            {"class", class_},
            {"outputs", results_},
            {"skipped", skipped},
            {"pass", passed()}};
}

}  // namespace item3d::parity
