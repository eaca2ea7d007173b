// Small textures of a running edit, for programs that show them.
#pragma once

#include "item3d/edit/request.h"
#include "item3d/edit/scene.h"
#include "item3d/edit/state.h"

#include <filesystem>
#include <future>
#include <vector>

namespace item3d {

/// Writes into a folder, about every second and for at most a twenty-fifth of the time:
///
///     N_base_color.png, N_orm.png   of material N of the model, at most 256 texels a side
///     textures.json                 "revision" (from 1), "textures" ([{"material", "slot",
///                                   "file"}], slot base_color or orm), "direction" (the curve of
///                                   its length, at most 200 values)
///
/// Leaves out materials that get a new UV map, since no model file has that map yet. Replaces each
/// file atomically, textures.json last. If a write fails, warns once and writes no more.
class LiveTextures {
  public:
    /// folder: if empty, nothing is written; scene: must outlive this object; fitted: neural
    /// texture before the edit.
    LiveTextures(std::filesystem::path folder, const EditScene& scene, NeuralTexture& fitted);
    ~LiveTextures();
    LiveTextures(const LiveTextures&) = delete;
    LiveTextures& operator=(const LiveTextures&) = delete;

    /// Must be called after each step. Writes if it is time for an update, and in any case if
    /// is_last.
    void update(const EditState& state, bool is_last);

  private:
    struct Set;
    struct Images;
    bool has_written();
    void prepare(NeuralTexture& fitted);
    std::vector<Images> draw(NeuralTexture field) const;
    void write(const std::vector<Images>& images, const std::vector<float>& direction);

    std::filesystem::path folder_;
    const EditScene& scene_;
    NeuralTexture fitted_{nullptr};
    std::vector<Set> sets_;
    std::future<double> writing_;  ///< returns its duration in seconds
    double next_ = 0;              ///< earliest time of the next drawing
    double drawn_ = 0;             ///< duration of the last drawing, seconds
    int revision_ = 0;
};

}  // namespace item3d
