#include "item3d/prior/training/settings.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/parse_json.h"
#include "item3d/tensors/precision.h"

#include <ATen/Parallel.h>

#include <map>

namespace item3d {
namespace {

TrainSettings large_recipe() {
    TrainSettings settings;
    settings.resolution = 128;
    settings.widths = {64, 128, 192};
    settings.samples = 800000;
    settings.data_samples = 100000;
    settings.autoencoder_images = 8000;
    settings.shape_variants = 12;
    settings.views_each = 6;
    return settings;
}

const std::map<std::string, TrainSettings>& recipes() {
    static const std::map<std::string, TrainSettings> known{{"embedded", TrainSettings{}},
                                                            {"embedded-xl", large_recipe()}};
    return known;
}

}  // namespace

const std::vector<std::string>& train_recipe_names() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> all;
        for (const auto& [name, settings] : recipes())
            all.push_back(name);
        return all;
    }();
    return names;
}

TrainSettings train_recipe(const std::string& name) {
    const auto found = recipes().find(name);
    if (found == recipes().end())
        throw InputError("recipe '" + name + "'", "unknown recipe",
                         fmt::format("recipes are {}", fmt::join(train_recipe_names(), ", ")));
    return found->second;
}

int drawing_threads(const TrainSettings& settings) {
    return settings.device.is_cpu() ? settings.replicas : at::get_num_threads();
}

int global_rank(const TrainSettings& settings, int rank) {
    return settings.processes.rank() * settings.replicas + rank;
}

nlohmann::json data_settings_json(const TrainSettings& s) {
    return {{"version", 9},
            {"seed", s.seed},
            {"init_from", s.init_from.string()},
            {"autoencoder", s.autoencoder.string()},
            {"resolution", s.resolution},
            {"data_samples", s.data_samples},
            {"autoencoder_samples", s.autoencoder_samples},
            {"autoencoder_pictures", s.autoencoder_images},
            {"shape_variants", s.shape_variants},
            {"views_each", s.views_each},
            {"lights", s.lights},
            {"pattern_weight", as_written(s.pattern_weight)},
            {"pairs", s.condition == image_condition},
            {"replicas", s.replicas * s.processes.size()},
            {"batch", s.batch}};
}

nlohmann::json settings_json(const TrainSettings& settings) {
    nlohmann::json all = data_settings_json(settings);
    all.update({{"samples", settings.samples},
                {"clip_samples", settings.clip_samples},
                {"captioner_samples", settings.captioner_samples},
                {"segmenter_samples", settings.segmenter_samples},
                {"segmenter_batch", settings.segmenter_batch},
                {"part_samples", settings.part_samples},
                {"part_variants", settings.part_variants},
                {"labeled_samples", settings.labeled_samples},
                {"labeled_variants", settings.labeled_variants},
                {"widths", settings.widths},
                {"condition", settings.condition},
                {"prediction_type", settings.prediction_type},
                {"optimizer", settings.optimizer},
                {"learning_rate", as_written(settings.learning_rate)},
                // Each process steps its own copy of the weights. The copies would diverge if the
                // processes rounded differently.
                {"precision", precision_name(choose_precision("auto", settings.device))},
                {"resume", settings.resume},
                {"stop_after", settings.stop_after}});
    return all;
}

std::string changed_settings(const nlohmann::json& before, const nlohmann::json& now) {
    std::string changes;
    for (const auto& [name, value] : now.items()) {
        if (!before.contains(name) || before.at(name) == value) continue;
        changes += fmt::format("{}{}: {} instead of {}", changes.empty() ? "" : ", ", name,
                               value.dump(), before.at(name).dump());
    }
    return changes;
}

double as_written(float value) {
    return std::stod(fmt::format("{}", value));
}

void check_settings(const std::filesystem::path& file, const nlohmann::json& before,
                    const nlohmann::json& now) {
    if (!before.is_object())
        throw InputError(file.string(), "does not record its settings",
                         "train without --resume, or in another --work folder");
    const std::string changes = changed_settings(before, now);
    if (!changes.empty())
        throw InputError(file.string(), "was made with different settings: " + changes,
                         "use the same settings, or train in another --work folder");
}

nlohmann::json read_work_json(const std::filesystem::path& file) {
    nlohmann::json json = parse_json(read_text(file));
    if (!json.is_object())
        throw InputError(file.string(), "is not a JSON object",
                         "train without --resume, or in another --work folder");
    return json;
}

void check_same_settings(const ProcessGroup& processes, const nlohmann::json& settings) {
    const auto first = nlohmann::json::parse(processes.broadcast(settings.dump()));
    const std::string changes = changed_settings(first, settings);
    if (!changes.empty())
        throw InputError(fmt::format("process {} of {}", processes.rank(), processes.size()),
                         "has different settings than process 0: " + changes,
                         "give all processes the same options");
}

}  // namespace item3d
