// Photographs of one object with known cameras, prepared for comparison with renders.
#pragma once

#include "item3d/reconstruct/dataset/source.h"
#include "item3d/scene/camera.h"
#include "item3d/scene/image.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace item3d {

/// Photograph as an ideal pinhole camera would have taken it.
struct Photograph {
    std::string name;
    /// World: +Y up, the dataset's unit of length. Near and far planes are not set.
    Camera camera;
    /// Premultiplied linear RGB and the object's coverage, as the renderer outputs. Row 0 on top.
    Image image;
    /// Exposure from EXIF, up to a common factor; 0: unknown.
    double exposure = 0;
    std::filesystem::path file = {};  ///< file that it was read from
};

struct Dataset {
    DatasetKind kind = DatasetKind::nerf_synthetic;
    std::vector<Photograph> train;
    std::vector<Photograph> test;  ///< held out: not used by the optimisation
    /// Rotation from the dataset's own world to that of the views.
    Mat3 world_from_dataset{1.0f};
    std::string masks;  ///< source of the masks, in words
    Vec3 centre{0.0f};  ///< point nearest to the cameras' optical axes, least squares
    /// Radius of a sphere around `centre` that half of the images show whole, see region_seen().
    float radius = 0.0f;
    std::size_t cut_off = 0;  ///< number of views in which the object touches the image's edge
};

struct DatasetOptions {
    std::filesystem::path images;        ///< folder of the images; empty: as the layout says
    std::filesystem::path masks;         ///< folder of masks named like the images; empty: none
    std::optional<Vec3> background;      ///< sRGB; pixels of this colour are background
    float background_tolerance = 0.06f;  ///< maximum difference from the background per channel
    int longest_side = 0;                ///< images are downscaled to it; 0: original size
    bool is_linear = false;              ///< true: PNG and JPEG hold linear light
    int hold_out = 8;   ///< every n-th view is for testing if the layout has no split; 0: none
    int max_views = 0;  ///< maximum number of training views, evenly chosen; 0: all
    std::string up = "auto";  ///< "x", "y", "z", "-y"...: up axis in the dataset's world
};

/// Detects the layout of `path` (a folder, or a transforms.json), reads it and checks it: each pose
/// must have an image of its lens's size, masks must not be empty or full, and at least three
/// cameras must be at different positions. The mask comes from the first of these that exists:
/// `options.masks`, mask_path, the folder "masks", the image's alpha, `options.background`, a plain
/// background. Throws InputError with a message of one line.
Dataset load_dataset(const std::filesystem::path& path, const DatasetOptions& options = {});

/// Returns up to `count` of the views, evenly chosen.
std::vector<Photograph> some_views(const std::vector<Photograph>& views, std::size_t count);

}  // namespace item3d
