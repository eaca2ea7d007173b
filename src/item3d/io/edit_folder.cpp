#include "item3d/io/edit_folder.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/parse_json.h"

#include <nlohmann/json.hpp>

namespace item3d {
namespace {

namespace fs = std::filesystem;

std::string text_at(const nlohmann::json& value, const char* pointer) {
    const nlohmann::json::json_pointer at(pointer);
    return value.contains(at) && value[at].is_string() ? value[at].get<std::string>() : "";
}

nlohmann::json read_record(const fs::path& folder) {
    const fs::path path = folder / "edit.json";
    if (!fs::exists(path))
        throw InputError(folder.string(),
                         "has no edit.json, so it is not the output of a completed edit",
                         "give the output folder of item3d edit");
    nlohmann::json record = parse_json(read_text(path));
    if (!record.is_object())
        throw InputError(path.string(), "is not a JSON object",
                         "the file is damaged; make the edit again");
    return record;
}

}  // namespace

EditFolder read_edit_folder(const fs::path& folder) {
    const nlohmann::json record = read_record(folder);
    EditFolder edit;
    edit.folder = folder;
    for (const char* name : {"model.glb", "model.vrm"})
        if (edit.model.empty() && fs::exists(folder / name)) edit.model = folder / name;
    if (edit.model.empty())
        throw InputError(folder.string(), "has no model.glb", "make the edit again");
    const bool is_plan =
        record.contains("edits") && record["edits"].is_array() && !record["edits"].empty();
    const nlohmann::json& last = is_plan ? record["edits"].back() : record;
    edit.from = text_at(last, "/from");
    edit.to = text_at(last, "/to");
    edit.variant = text_at(last, "/settings/variant");
    const nlohmann::json all = is_plan ? record["edits"] : nlohmann::json::array({record});
    for (const nlohmann::json& one : all)
        if (std::string hash = text_at(one, "/claim/input_sha256"); !hash.empty())
            edit.inputs.push_back(std::move(hash));
    if (edit.to.empty())
        throw InputError((folder / "edit.json").string(), "lacks the target sentence 'to'",
                         "the file is damaged; make the edit again");
    return edit;
}

}  // namespace item3d
