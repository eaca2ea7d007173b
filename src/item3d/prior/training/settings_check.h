// What a training was begun with against what it is now asked to go on with.
#pragma once

#include "item3d/prior/training/process_group.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>

namespace item3d {

/// The members of `now` that differ, as "batch: 16 instead of 32, ..."; what `before` lacks is
/// not compared, so that older files stay good. Empty where nothing differs.
std::string changed_settings(const nlohmann::json& before, const nlohmann::json& now);

/// A float as it is written: 0.001, not the digits of the nearest one.
double as_written(float value);

/// Throws InputError, naming `file`, where `before` is no JSON object or says otherwise than `now`.
void check_settings(const std::filesystem::path& file, const nlohmann::json& before,
                    const nlohmann::json& now);

/// A JSON object of the work folder. Throws InputError for anything else.
nlohmann::json read_work_json(const std::filesystem::path& file);

/// Throws InputError where this process was started with other settings than process 0.
void check_same_settings(const ProcessGroup& processes, const nlohmann::json& settings);

}  // namespace item3d
