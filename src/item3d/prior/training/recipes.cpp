// Settings of trainings by name.
#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/prior/training/train.h"

#include <map>

namespace item3d {
namespace {

TrainSettings large_recipe() {
    TrainSettings settings;
    settings.resolution = 128;
    settings.widths = {64, 128, 192};
    settings.samples = 800000;
    settings.data_samples = 100000;
    settings.autoencoder_pictures = 8000;
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
        throw InputError("recipe '" + name + "'", "there is none of that name",
                         fmt::format("recipes are {}", fmt::join(train_recipe_names(), ", ")));
    return found->second;
}

}  // namespace item3d
