#include "item3d/provenance/packet_facts.h"

#include "item3d/provenance/xmp_names.h"

#include <fmt/format.h>

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

}  // namespace

std::vector<PacketProperty> properties_of(const nlohmann::json& claim) {
    const std::vector<EditClaim> edits = edits_of(claim);
    const std::string priors = priors_of(edits);
    return {
        {xmp::iptc, "Iptc4xmpExt", "DigitalSourceType", std::string(xmp::edited_by_model)},
        {xmp::iptc, "Iptc4xmpExt", "AISystemUsed",
         priors.empty() ? "item3d" : "item3d, prior " + priors},
        {xmp::iptc, "Iptc4xmpExt", "AISystemVersionUsed", claim.value("version", "")},
        {xmp::iptc, "Iptc4xmpExt", "AIPromptInformation", sentences_of(edits)},
        {xmp::basic, "xmp", "ModifyDate", date_of(edits)},
    };
}

}  // namespace item3d
