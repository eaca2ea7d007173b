#include "item3d/provenance/packet_metadata.h"

#include "item3d/provenance/xmp_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace item3d {
namespace {

std::string priors_of(const std::vector<EditClaim>& edits) {
    std::set<std::string> names;
    for (const EditClaim& edit : edits)
        if (!edit.prior.empty()) names.insert(edit.prior);
    return fmt::format("{}", fmt::join(names, ", "));
}

std::string sentences_of(const std::vector<EditClaim>& edits) {
    std::string sentences;
    for (const EditClaim& edit : edits) {
        if (edit.to.empty()) continue;
        sentences += (sentences.empty() ? "" : "; ") + edit.from + " -> " + edit.to;
    }
    return sentences;
}

/// True if all edits are reconstructions from photographs.
bool is_captured(const std::vector<EditClaim>& edits) {
    return !edits.empty() && std::all_of(edits.begin(), edits.end(), is_reconstruction);
}

std::string system_of(const std::vector<EditClaim>& edits) {
    const std::string priors = priors_of(edits);
    return priors.empty() ? "item3d" : "item3d, prior " + priors;
}

}  // namespace

std::vector<PacketProperty> properties_of(const nlohmann::json& claim) {
    const std::vector<EditClaim> edits = edits_of(claim);
    const bool is_capture = is_captured(edits);
    return {
        {xmp::iptc, "Iptc4xmpExt", "DigitalSourceType",
         is_capture ? edits.back().source_type : std::string(xmp::edited_by_model)},
        {xmp::iptc, "Iptc4xmpExt", "AISystemUsed", is_capture ? "" : system_of(edits)},
        {xmp::iptc, "Iptc4xmpExt", "AISystemVersionUsed",
         is_capture ? "" : claim.value("version", "")},
        {xmp::iptc, "Iptc4xmpExt", "AIPromptInformation", sentences_of(edits)},
        {xmp::basic, "xmp", "ModifyDate", date_of(edits)},
    };
}

}  // namespace item3d
