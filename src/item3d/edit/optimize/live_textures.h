// The textures of an edit while it runs, small, for programs that show them.
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
///                                   "file"}], slot base_color or orm), "direction" (its length so
///                                   far, at most 200 values)
///
/// Materials that get a new UV map have none, since no model shows it yet. Each file is replaced as
/// a whole, textures.json last. What cannot be written is warned of once, and ends it.
class LiveTextures {
  public:
    /// Empty folder: nothing is written. scene outlives it. fitted: the field before the edit.
    LiveTextures(std::filesystem::path folder, const EditScene& scene, NeuralTexture& fitted);
    ~LiveTextures();
    LiveTextures(const LiveTextures&) = delete;
    LiveTextures& operator=(const LiveTextures&) = delete;

    /// Call after each step. is_last: draws in any case.
    void update(const EditState& state, bool is_last);

  private:
    struct Set;
    struct Pictures;
    bool has_written();
    void prepare(NeuralTexture& fitted);
    std::vector<Pictures> draw(NeuralTexture field) const;
    void write(const std::vector<Pictures>& pictures, const std::vector<float>& direction);

    std::filesystem::path folder_;
    const EditScene& scene_;
    NeuralTexture fitted_{nullptr};
    std::vector<Set> sets_;
    std::future<double> writing_;  ///< seconds that it took
    double next_ = 0;              ///< when another may be drawn
    double drawn_ = 0;             ///< seconds that the last took to draw
    int revision_ = 0;
};

}  // namespace item3d
