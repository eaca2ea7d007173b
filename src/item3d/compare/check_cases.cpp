#include "item3d/compare/check_cases.h"

#include "item3d/compare/option_values.h"
#include "item3d/compare/verdict.h"
#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/edit/plan.h"

#include <set>
#include <string>

namespace item3d {
namespace {

/// Returns the settings of a run by EditSettings' names.
nlohmann::json settings_of_run(const CompareCase& test, const CompareMethod& method,
                               const std::string& subject) {
    nlohmann::json settings = {{"from", test.from}, {"to", test.to}};
    const nlohmann::json options = options_of(test, method);
    for (const auto& [option, value] : options.items())
        if (const Setting* setting = setting_of_option(option))
            settings[setting->name] = typed_value(*setting, value, subject);
    if (settings.value("keep", nlohmann::json()) == nlohmann::json::array({"nothing"}))
        settings["keep"] = nlohmann::json::array();
    return settings;
}

}  // namespace

void check_cases(const CompareOptions& options) {
    std::set<std::string> known;  // values and plans that were already checked
    for (std::size_t i = 0; i < options.cases.size(); ++i) {
        const CompareCase& test = options.cases[i];
        const std::string subject = fmt::format("case {} ('{}')", i + 1, test.name);
        for (const auto& [option, value] : test.options.items())
            if (known.insert(option + "=" + value.dump()).second)
                check_option(option, value, subject);
        for (const auto& prior : options.priors) {
            for (const CompareMethod& method : options.methods) {
                const std::string plan = fmt::format("{} {} {}", prior.name, method.name,
                                                     options_of(test, method).dump());
                if (!known.insert(plan).second) continue;
                try {
                    resolve_plan(prior.folder, settings_of_run(test, method, subject));
                } catch (const InputError& error) {
                    throw InputError(fmt::format("{}, method {}", subject, method.name),
                                     error.what());
                }
            }
        }
    }
    // Only for cases of a file must the prior know the expected word. A suite's case is judged only
    // if the prior knows it.
    CompareOptions given = options;
    std::erase_if(given.cases, [](const CompareCase& test) { return test.given_model.empty(); });
    check_expectations(given);
}

}  // namespace item3d
