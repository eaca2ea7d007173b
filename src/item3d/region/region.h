// A region, the part of a model's surface that an edit changes: a weight in [0, 1] at each point.
#pragma once

#include "item3d/region/feather.h"
#include "item3d/region/selector.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace item3d {

struct RegionRequest {
    std::vector<std::string> include;  ///< selectors to join; empty for the whole surface
    std::vector<std::string> exclude;  ///< selectors to subtract
    float feather = 0;  ///< width of the border, in percent of the diagonal of the model's box

    bool is_everything() const { return include.empty() && exclude.empty(); }
    /// True if a selector is by words.
    bool needs_segmenter() const;
    /// True if a selector is "auto".
    bool needs_sentences() const;
};

/// Points of a region, drawn uniformly by area, for cameras.
struct RegionPoints {
    at::Tensor positions;  ///< [K, 3] on the CPU
    at::Tensor normals;    ///< [K, 3]
};

/// The weights are 0 outside of the region, because the feather is on the inner side of its border.
/// A texture cannot distinguish points that share texels, or instances of one mesh. The weight of
/// the first such point or instance applies to all.
class Region {
  public:
    /// The scene must outlive this object. Throws InputError for an unusable selector, and for an
    /// empty selection.
    Region(const RegionRequest& request, const RegionScene& scene);

    const RegionRequest& request() const { return request_; }
    /// Returns the weights [P, 1] float32 on the surface's device.
    at::Tensor weight(const Surface& surface) const;
    /// Returns the mean weight over the area of the scene's edited materials.
    double share() const { return share_; }
    const RegionPoints& points() const { return points_; }
    /// Returns the materials that overlap the region, as rising indices into Model::materials.
    const std::vector<int>& materials() const { return materials_; }

  private:
    at::Tensor unfeathered(const Surface& surface) const;

    RegionRequest request_;
    std::vector<std::unique_ptr<Selector>> include_, exclude_;
    std::optional<Feather> feather_;
    double share_ = 0;
    RegionPoints points_;
    std::vector<int> materials_;
};

}  // namespace item3d
