#include "item3d/edit/state.h"

namespace item3d {

void to_json(nlohmann::json& json, const AdjustmentRecord& record) {
    json = {{"iteration", record.iteration}};
    if (!record.captions.empty()) json["captions"] = record.captions;
    if (record.text) json.update({{"angle", record.text->angle}, {"length", record.text->length}});
    if (record.direction) json["direction"] = *record.direction;
    if (record.source_loss) json["source_loss"] = *record.source_loss;
}

void from_json(const nlohmann::json& json, AdjustmentRecord& record) {
    json.at("iteration").get_to(record.iteration);
    record.captions = json.value("captions", std::vector<std::string>());
    if (json.contains("angle"))
        record.text =
            TextDirection{json.at("angle").get<double>(), json.at("length").get<double>()};
    if (json.contains("direction")) record.direction = json.at("direction").get<double>();
    if (json.contains("source_loss")) record.source_loss = json.at("source_loss").get<double>();
}

std::int64_t EditState::own_unet_rows() const {
    std::int64_t rows = 0;
    for (const auto& network : networks)
        rows += network->predicted_rows();
    return rows;
}

std::int64_t EditState::unet_rows() const {
    return earlier_unet_rows + unet_rows_elsewhere + own_unet_rows();
}

void DetailState::begin(const NeuralTexture& field) {
    before = snapshot(field);
    optimizer.add_group("table", {field->table()}, {});
    optimizer.add_group("network", field->network_parameters(), {});
}

}  // namespace item3d
