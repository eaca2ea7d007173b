// The state shared by successive edits: networks, lights, and the last edited model.
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

/// The renders of a model for the report, and their cache key.
struct DrawnModel {
    std::filesystem::path model;  ///< file of the model
    std::string light;
    int pixels = 0;
    at::Tensor images;  ///< as draw_images() returns them
};

/// Cache of an edit's inputs. Each cached input equals the one that the edit would load or render
/// without a session.
class EditSession {
  public:
    /// Starts a session of one edit.
    EditSession() = default;
    /// Starts a session of several edits. Uses only their plans, so that a prior is loaded with the
    /// sentences of all edits.
    explicit EditSession(const std::vector<EditRequest>& edits);

    /// Returns the request's model. It is the model passed to keep_model() if file and variant
    /// match, else load_model() of the file. The session does not keep the returned model.
    Model take_model(const EditRequest& request);
    /// Stores a model for take_model(). model: equal to load_model() of `path`.
    void keep_model(const std::filesystem::path& path, const std::string& variant, Model model);

    /// Stores the model's groups, because .glb files have no groups. take_model() assigns them to
    /// later models with the same numbers of triangles.
    void keep_groups(const Model& model);

    /// Returns the prior with the plan's extras. Loads it in the background, unless the last
    /// request used the same prior. Warns of words in the sentences that the prior drops, because
    /// they exceed its text length.
    std::shared_future<std::shared_ptr<const DiffusionModel>> prior(const EditRequest& request,
                                                                    const PriorUse& use);
    /// True if prior() would load nothing.
    bool has_prior(const EditRequest& request, const PriorUse& use) const;
    std::shared_future<std::string> prior_hash(const std::filesystem::path& prior);

    /// Returns the captioner; null if the plan uses none. Throws as load_wanted_captioner().
    std::shared_ptr<const Captioner> captioner(const EditRequest& request,
                                               at::ScalarType precision);
    /// Returns the CLIP model; null for an empty path. Throws InputError.
    std::shared_ptr<const Clip> clip(const std::filesystem::path& folder);
    /// Returns the lights. Throws InputError for a light that cannot be loaded.
    std::shared_ptr<LightRig> lights(const EditPlan& plan, at::Device device);
    std::optional<DrawnModel> drawn;  ///< renders of the last edit's edited model

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
    std::vector<std::vector<int>> triangle_groups_;  ///< by primitive
    nlohmann::json prior_key_;
    std::shared_future<std::shared_ptr<DiffusionModel>> prior_;
    std::filesystem::path hashed_;
    std::shared_future<std::string> hash_;
    std::shared_ptr<const Captioner> captioner_;
    std::shared_ptr<const Clip> clip_;
    std::map<std::string, std::shared_ptr<LightRig>> lights_;
};

}  // namespace item3d
