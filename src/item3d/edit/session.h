// What edits that follow one another share: networks, lights, and the model that the last one left.
#pragma once

#include "item3d/edit/load_networks.h"
#include "item3d/edit/request.h"
#include "item3d/edit/views.h"
#include "item3d/metrics/clip_score.h"
#include "item3d/networks/diffusion/diffusion_model.h"
#include "item3d/networks/vision_language/captioner.h"
#include "item3d/scene/model.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace item3d {

/// Pictures of a model for the report, and what they depend on.
struct DrawnModel {
    std::filesystem::path model;  ///< its file
    std::string light;
    int pixels = 0;
    at::Tensor pictures;  ///< as draw_pictures() returns them
};

/// Nothing that an edit takes from here differs from what it would load or draw by itself.
class EditSession {
  public:
    /// Of one edit.
    EditSession() = default;
    /// Of all these, whose sentences the prior will be asked for; only their plans are looked at.
    explicit EditSession(const std::vector<EditRequest>& edits);

    /// The request's model: the one that keep_model() was given, where it is of the same file and
    /// variant, else as load_model() reads it. It is given away.
    Model take_model(const EditRequest& request);
    /// model: as load_model() reads it from `path`.
    void keep_model(const std::filesystem::path& path, const std::string& variant, Model model);

    /// Gives the models that are taken from now on this one's groups, which .glb files do not hold,
    /// where their triangles are as many.
    void keep_groups(const Model& model);

    /// The prior with what the plan adds to it; loads in the background unless the last request
    /// wanted the same. Warns of words of the sentences that it cuts off.
    std::shared_future<std::shared_ptr<const DiffusionModel>> prior(const EditRequest& request,
                                                                    const PriorUse& use);
    /// Whether prior() would load nothing.
    bool has_prior(const EditRequest& request, const PriorUse& use) const;
    std::shared_future<std::string> prior_hash(const std::filesystem::path& prior);

    /// Null where the plan asks none. Throws as load_wanted_captioner().
    std::shared_ptr<const Captioner> captioner(const EditRequest& request,
                                               at::ScalarType precision);
    /// Null for an empty path. Throws InputError.
    std::shared_ptr<const Clip> clip(const std::filesystem::path& folder);
    /// Throws InputError for a light that cannot be loaded.
    std::shared_ptr<LightRig> lights(const EditPlan& plan, at::Device device);
    std::optional<DrawnModel> drawn;  ///< what the last edit's report shows as edited

  private:
    void add_groups(Model& model) const;

    std::vector<EditPlan> plans_;
    struct KeptModel {
        std::filesystem::path path;
        std::string variant;
        Model model;
    };
    std::optional<KeptModel> model_;
    std::vector<std::vector<std::string>> groups_;
    std::vector<std::vector<int>> triangle_groups_;  ///< of each primitive
    nlohmann::json prior_key_;
    std::shared_future<std::shared_ptr<DiffusionModel>> prior_;
    std::filesystem::path hashed_;
    std::shared_future<std::string> hash_;
    std::shared_ptr<const Captioner> captioner_;
    std::shared_ptr<const Clip> clip_;
    std::map<std::string, std::shared_ptr<LightRig>> lights_;
};

}  // namespace item3d
