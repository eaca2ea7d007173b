#include "apps/item3d/edit/relight_words.h"

#include "apps/item3d/edit/image_options.h"
#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/core/words.h"
#include "item3d/edit/relight.h"
#include "item3d/guidance/guidance.h"
#include "item3d/hub/find_prior.h"
#include "item3d/io/load_light.h"
#include "item3d/lighting/adjust.h"
#include "item3d/lighting/environment.h"
#include "item3d/lighting/optimized/light_model.h"
#include "item3d/lighting/words.h"
#include "item3d/networks/vocabulary.h"
#include "item3d/tensors/precision.h"

#include <algorithm>
#include <set>
#include <sstream>
#include <vector>

namespace item3d {
namespace {

/// Words of lights that a prior without a vocabulary is assumed to know.
const std::set<std::string> usual_light_words = {
    "afternoon", "backlight",   "blue",      "bright",    "candle",   "candlelight", "cloudy",
    "dark",      "darkness",    "dawn",      "day",       "daylight", "dim",         "dusk",
    "evening",   "fire",        "firelight", "fog",       "foggy",    "glow",        "glowing",
    "golden",    "illuminated", "lamp",      "lamplight", "light",    "lighting",    "lights",
    "lit",       "midnight",    "moon",      "moonlight", "morning",  "neon",        "night",
    "noon",      "overcast",    "rainy",     "shade",     "shadow",   "shadows",     "sky",
    "spotlight", "studio",      "sun",       "sunlight",  "sunny",    "sunrise",     "sunset",
    "torch",     "twilight",    "underwater"};

std::set<std::string> known_light_words(const PriorVocabulary& vocabulary) {
    if (vocabulary.open()) return usual_light_words;
    std::set<std::string> known;
    for (const KnownWord& word : vocabulary.words_of("lights"))
        known.insert(word.spellings.begin(), word.spellings.end());
    return known;
}

bool names_light(const std::string& sentence, const std::set<std::string>& known) {
    const std::vector<std::string> words = prompt_words(sentence);
    return std::any_of(words.begin(), words.end(),
                       [&](const std::string& word) { return known.contains(word); });
}

/// Returns the sentence without the word "lit". It has no meaning after the direction has been
/// removed.
std::string without_lit(const std::string& sentence) {
    std::istringstream words(sentence);
    std::string word, result;
    while (words >> word) {
        if (word == "lit" || word == "lighted" || word == "illuminated") continue;
        result += (result.empty() ? "" : " ") + word;
    }
    // A sentence such as "at night, lit from the left" leaves a comma.
    return result.substr(0, result.find_last_not_of(" ,;.") + 1);
}

UsageError no_light(const std::string& to, const std::set<std::string>& known) {
    return UsageError(
        fmt::format("--to '{}' contains no light; this prior knows {}; directions are {}", to,
                    fmt::join(known, ", "), fmt::join(light_words_help(), "; ")));
}

/// Returns the compass azimuth of the default view.
float viewer_azimuth() {
    return 180 - default_azimuth * 180 / pi;
}

}  // namespace

void add_words_options(CLI::App& command, RelightWords& words) {
    const std::string group = "By words";
    command
        .add_option("--from", words.from,
                    "Sentence that describes the model as it is; the new light is then found by "
                    "guidance: --from \"a mug\" --to \"a mug at sunset\"")
        ->group(group);
    command
        .add_option("--to", words.to,
                    "Sentence that describes the model in the new light. Directions in it are read "
                    "as by --lit, other words by the prior")
        ->group(group);
    command
        .add_option("--prior", words.prior,
                    "Diffusion model, by folder or name. Default: the embedded prior, which knows "
                    "sunset, night, dark, bright, overcast, noon, studio")
        ->group(group);
    const auto set = [&words](const char* key) {
        return [&words, key](const auto& value) { words.overrides[key] = value; };
    };
    command
        .add_option_function<std::string>("--light-model", set("light_model"),
                                          "Parameters of the light: physical (a sky, a sun and a "
                                          "ground; the default of small priors) or texels")
        ->check(CLI::IsMember(light_kind_names()))
        ->group(group);
    command
        .add_option_function<std::string>("--guidance", set("guidance"),
                                          "Guidance, as for `item3d edit`. Default: dds")
        ->check(CLI::IsMember(guidance_methods()))
        ->group(group);
    command
        .add_option_function<int>("--iterations", set("iterations"),
                                  "Optimisation steps. Default: 80")
        ->check(CLI::Range(0, 100000))
        ->group(group);
    command.add_option_function<std::uint64_t>("--seed", set("seed"), "Seed of all random numbers")
        ->check(seed_check())
        ->group(group);
    command.add_option("--precision", words.precision, "Precision of the networks")
        ->check(CLI::IsMember(precision_names()))
        ->capture_default_str()
        ->group(group);
    command.add_flag("--resume", words.resume, "Continue from the checkpoint in the output folder")
        ->group(group);
}

void require_light_words(const std::filesystem::path& prior, const std::string& sentence) {
    const auto known = known_light_words(PriorVocabulary::load(prior));
    if (!names_light(sentence, known)) throw no_light(sentence, known);
}

WordsLight light_by_words(const RelightWords& words, const std::filesystem::path& model,
                          const std::string& from_light, const std::filesystem::path& output,
                          at::Device device, const std::string& command, EditSession& session) {
    if (words.from.empty() || words.to.empty())
        throw UsageError(
            "--from and --to are both required: what the model looks like now, and in the new "
            "light");
    const LightWords said = parse_light_words(words.to, viewer_azimuth());
    const std::string from = without_lit(parse_light_words(words.from, viewer_azimuth()).rest);
    const std::string to = said.from ? without_lit(said.rest) : words.to;
    nlohmann::json record = {{"from", words.from}, {"to", words.to}, {"direction", nullptr}};
    if (said.from)
        record["direction"] = {{"azimuth", said.from->azimuth},
                               {"elevation", said.from->elevation}};

    EditRequest request;
    request.prior = find_prior(words.prior);
    const PriorVocabulary vocabulary = PriorVocabulary::load(request.prior);
    const auto known = known_light_words(vocabulary);
    if (!names_light(to, known)) {
        if (!said.from) throw no_light(words.to, known);
        const std::vector<std::string> unknown = vocabulary.unknown_words(to);
        if (!unknown.empty() && to != from)
            warn(fmt::format("the prior does not know {}: only the direction is used",
                             fmt::join(unknown, ", ")));
        return {place_sun(load_light(from_light), {.from = *said.from, .strength = {}}), record};
    }
    for (const std::string& prompt : {from, to}) {
        const std::string warning = vocabulary.warning(prompt, /*shape_is_given=*/true);
        if (!warning.empty()) warn(warning);
    }
    nlohmann::json overrides = words.overrides;
    overrides.update({{"from", from}, {"to", to}, {"optimize", "light"}, {"light", from_light}});
    if (said.from) overrides["light_from"] = {said.from->azimuth, said.from->elevation};
    request.plan = resolve_plan(request.prior, overrides);
    request.model = model;
    request.output = output;
    request.device = device;
    request.precision = words.precision;
    request.resume = words.resume;
    request.command = command;
    FoundLight found = find_light(request, session);
    record["prompts"] = {from, to};
    record["prior"] = request.prior.string();
    record.update(found.record);
    return {std::move(found.light), std::move(record)};
}

}  // namespace item3d
