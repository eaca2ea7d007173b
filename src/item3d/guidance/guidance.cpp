#include "item3d/guidance/guidance.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/guidance/csd.h"
#include "item3d/guidance/dds.h"
#include "item3d/guidance/ism.h"
#include "item3d/guidance/nfsd.h"
#include "item3d/guidance/pds.h"
#include "item3d/guidance/rdl.h"
#include "item3d/guidance/sdi.h"
#include "item3d/guidance/sds.h"

#include <algorithm>

namespace item3d {
namespace {

void require_one_of(const std::string& option, const std::string& value,
                    const std::vector<std::string>& names) {
    if (std::find(names.begin(), names.end(), value) == names.end()) {
        throw InputError(option, fmt::format("'{}' is not known", value),
                         fmt::format("choose one of {}", fmt::join(names, ", ")));
    }
}

template <typename Enum>
Enum parse_enum(const std::string& option, const std::string& name,
                const std::vector<std::string>& names) {
    require_one_of(option, name, names);
    return static_cast<Enum>(std::find(names.begin(), names.end(), name) - names.begin());
}

bool is_blank(const std::string& text) {
    return std::all_of(text.begin(), text.end(),
                       [](unsigned char c) { return std::isspace(c) != 0; });
}

using ModelPointer = std::shared_ptr<const DiffusionModel>;
using Maker = std::unique_ptr<Guidance> (*)(ModelPointer, const std::string& source_prompt,
                                            const std::string& target_prompt,
                                            const GuidanceOptions&);

template <typename Method>
std::unique_ptr<Guidance> from_both(ModelPointer pipeline, const std::string& source_prompt,
                                    const std::string& target_prompt,
                                    const GuidanceOptions& options) {
    return std::make_unique<Method>(std::move(pipeline), source_prompt, target_prompt, options);
}

template <typename Method>
std::unique_ptr<Guidance> from_target(ModelPointer pipeline, const std::string&,
                                      const std::string& target_prompt,
                                      const GuidanceOptions& options) {
    return std::make_unique<Method>(std::move(pipeline), target_prompt, options);
}

struct Method {
    GuidanceKind kind;
    Maker make;
};

const std::vector<Method>& methods() {
    static const std::vector<Method> all = {
        {{"rdl", "relative direction from the source text to the target text (the default)",
          "2; learned source: 1 + its samples, and a backward pass"},
         from_both<RelativeDirection>},
        {{"sds", "score distillation (the baseline): only the target, oversaturated", "2"},
         from_target<ScoreDistillation>},
        {{"dds", "delta denoising: rdl relative to the unedited model; keeps structure", "4"},
         from_both<DeltaDenoising>},
        {{"pds", "posterior distillation: dds with a pull to the unedited model", "4"},
         from_both<PosteriorDistillation>},
        {{"nfsd", "noise-free score distillation: sds without its noise term, less saturated", "3"},
         from_target<NoiseFreeDistillation>},
        {{"csd", "classifier score (DreamMat): direction from negative prompt to target", "3"},
         from_target<ClassifierScore>},
        {{"ism", "interval score matching (LucidDreamer): inverted noise, less blur", "3 to 8"},
         from_target<IntervalScore>},
        {{"sdi", "distillation via inversion: noise inverted from prompt and image; slow",
          "4 to 24"},
         from_target<InversionDistillation>}};
    return all;
}

}  // namespace

const std::vector<GuidanceKind>& guidance_kinds() {
    static const std::vector<GuidanceKind> kinds = [] {
        std::vector<GuidanceKind> all;
        for (const Method& method : methods())
            all.push_back(method.kind);
        return all;
    }();
    return kinds;
}

const std::vector<std::string>& guidance_methods() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> all;
        for (const GuidanceKind& kind : guidance_kinds())
            all.push_back(kind.name);
        return all;
    }();
    return names;
}

const std::vector<std::string>& adjustment_names() {
    static const std::vector<std::string> names = {"learned", "caption", "caption-paper", "off"};
    return names;
}

const std::vector<std::string>& weighting_names() {
    static const std::vector<std::string> names = {"early", "late", "dreamfusion", "uniform"};
    return names;
}

const std::vector<std::string>& timestep_schedule_names() {
    static const std::vector<std::string> names = {"uniform", "anneal", "dreamtime"};
    return names;
}

Adjustment parse_adjustment(const std::string& name) {
    return parse_enum<Adjustment>("--adjust", name, adjustment_names());
}

Weighting parse_weighting(const std::string& name) {
    return parse_enum<Weighting>("--weighting", name, weighting_names());
}

TimestepSchedule parse_timestep_schedule(const std::string& name) {
    return parse_enum<TimestepSchedule>("--timestep-schedule", name, timestep_schedule_names());
}

bool adjusts_by_captions(Adjustment adjustment) {
    return adjustment == Adjustment::caption || adjustment == Adjustment::caption_paper;
}

const std::string& default_negative_prompt() {
    static const std::string words =
        "unrealistic, blurry, low quality, out of focus, ugly, low contrast, dull, dark, "
        "low-resolution, gloomy";
    return words;
}

std::unique_ptr<Guidance> make_guidance(std::shared_ptr<const DiffusionModel> pipeline,
                                        const std::string& source_prompt,
                                        const std::string& target_prompt,
                                        const GuidanceOptions& options) {
    require_one_of("--guidance", options.method, guidance_methods());
    if (is_blank(source_prompt)) {
        throw InputError("--from", "the prompt is empty", "describe the model as it looks now");
    }
    if (is_blank(target_prompt)) {
        throw InputError("--to", "the prompt is empty", "describe the look that you want");
    }
    const auto chosen = std::find_if(methods().begin(), methods().end(), [&](const Method& method) {
        return method.kind.name == options.method;
    });
    return chosen->make(std::move(pipeline), source_prompt, target_prompt, options);
}

}  // namespace item3d
