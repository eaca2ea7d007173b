// Photographs of one object with known cameras, ready for comparing with renders.
#pragma once

#include "item3d/reconstruct/dataset/source.h"
#include "item3d/scene/camera.h"
#include "item3d/scene/image.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace item3d {

/// One photograph as an ideal pinhole would have taken it.
struct Photograph {
    std::string name;
    /// World: +Y up, the dataset's unit of length. Near and far planes are not set.
    Camera camera;
    /// Premultiplied linear RGB and coverage by the object: what the renderer draws. Row 0 on top.
    Image image;
    /// Of its exposure as EXIF has it, up to a factor that all share; 0: not said.
    double exposure = 0;
    std::filesystem::path file = {};  ///< that it was read from
};

struct Dataset {
    DatasetKind kind = DatasetKind::nerf_synthetic;
    std::vector<Photograph> train;
    std::vector<Photograph> test;  ///< held out: never optimised for
    /// From the dataset's own world to the one of the views: a rotation.
    Mat3 world_from_dataset{1.0f};
    std::string masks;        ///< where they came from, in words
    Vec3 centre{0.0f};        ///< where the cameras look, least squares
    float radius = 0.0f;      ///< of a sphere around it that all pictures show whole, about
    std::size_t cut_off = 0;  ///< views in which the object touches the picture's edge
};

struct DatasetOptions {
    std::filesystem::path images;        ///< folder of the pictures; empty: as the layout has it
    std::filesystem::path masks;         ///< folder of masks named as the pictures; empty: none
    std::optional<Vec3> background;      ///< sRGB: what has this colour is not the object
    float background_tolerance = 0.06f;  ///< largest difference of a channel
    int longest_side = 0;                ///< pictures are shrunk to it; 0: as they are
    bool is_linear = false;              ///< PNG and JPEG hold linear light
    int hold_out = 8;    ///< every n-th view is for testing where the layout does not say; 0: none
    int most_views = 0;  ///< of the training views, evenly chosen; 0: all
    std::string up = "auto";  ///< "x", "y", "z", "-y"...: up in the dataset's world
};

/// Finds out what `path` (a folder, or a transforms.json) is, reads it and checks it: a picture
/// for each pose and of one size with its lens; masks that show something and not everything; at
/// least three cameras at different places. Masks come from `options.masks`, mask_path, the folder
/// "masks", alpha, `options.background`, or a plain background, in this order. Throws InputError in
/// one line.
Dataset load_dataset(const std::filesystem::path& path, const DatasetOptions& options = {});

/// Up to `count` of them, evenly chosen.
std::vector<Photograph> some_views(const std::vector<Photograph>& views, std::size_t count);

}  // namespace item3d
