#include "item3d/core/error.h"
#include "item3d/reconstruct/dataset/orientation.h"
#include "tests/support/reconstruct.h"

#include <cmath>
#include <cstring>
#include <functional>

namespace item3d {
namespace {

using nlohmann::json;
using testing::disk_image;
using testing::fresh_folder;
using testing::ring_of_cameras;
using testing::rows_of;
namespace fs = std::filesystem;

/// A NeRF-synthetic dataset of disks whose JSON and images a test may damage.
class NerfFolder {
  public:
    explicit NerfFolder(const std::string& name, int count = 4) : folder(fresh_folder(name)) {
        document = {{"camera_angle_x", 0.7}, {"frames", json::array()}};
        fs::create_directories(folder / "train");
        for (const Camera& camera : ring_of_cameras(count)) {
            document["frames"].push_back(
                {{"file_path", "./train/" + camera.name},
                 {"transform_matrix", rows_of(testing::y_up_to_z_up() * camera.camera_to_world)}});
            save_image(folder / "train" / (camera.name + ".png"), disk_image(24, 24));
        }
    }
    Dataset load(const DatasetOptions& options = {}) const {
        write_atomically(folder / "transforms_train.json", std::string_view(document.dump()));
        return load_dataset(folder, options);
    }
    std::string problem(const DatasetOptions& options = {}) const {
        try {
            load(options);
        } catch (const InputError& error) {
            EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
            return error.what();
        }
        return "none";
    }

    fs::path folder;
    json document;
};

void expect_problem(const std::string& found, const std::string& wanted) {
    EXPECT_NE(found.find(wanted), std::string::npos) << found;
}

void expect_cameras(const std::vector<Photograph>& views, const std::vector<Camera>& cameras) {
    ASSERT_EQ(views.size(), cameras.size());
    for (std::size_t i = 0; i < views.size(); ++i) {
        for (int k = 0; k < 16; ++k)
            EXPECT_NEAR(views[i].camera.camera_to_world[k / 4][k % 4],
                        cameras[i].camera_to_world[k / 4][k % 4], 1e-5);
        EXPECT_NEAR(views[i].camera.field_of_view_x, cameras[i].field_of_view_x, 1e-5);
    }
}

TEST(Dataset, NerfSyntheticBecomesYUp) {
    const Dataset dataset = NerfFolder("nerf").load();
    EXPECT_EQ(dataset.kind, DatasetKind::nerf_synthetic);
    EXPECT_EQ(dataset.masks, "alpha");
    expect_cameras(dataset.train, ring_of_cameras(4));
    EXPECT_LT(glm::length(dataset.centre), 1e-4f);
    EXPECT_NEAR(dataset.radius, 4 * std::sin(0.35), 1e-4);
    const Image& image = dataset.train[0].image;
    EXPECT_NEAR(image.at(12, 12, 0), srgb_to_linear(0.8f), 1e-3);
    EXPECT_EQ(image.at(12, 12, 3), 1.0f);
    EXPECT_EQ(image.at(0, 0, 0), 0.0f);  // premultiplied
}

TEST(Dataset, ImagesAreShrunkWithTheirLens) {
    DatasetOptions options;
    options.longest_side = 12;
    const Dataset dataset = NerfFolder("small").load(options);
    EXPECT_EQ(dataset.train[0].image.width, 12);
    EXPECT_NEAR(dataset.train[0].camera.field_of_view_x, 0.7, 1e-5);
}

TEST(Dataset, NamesWhatIsWrong) {
    NerfFolder missing("missing");
    fs::remove(missing.folder / "train/view_2.png");
    expect_problem(missing.problem(), "view_2: the image of view");

    NerfFolder mixed("mixed");
    save_image(mixed.folder / "train/view_1.png", disk_image(30, 24));
    expect_problem(mixed.problem(), "view_1.png: is 30 x 24, but the previous images are 24 x 24");

    NerfFolder sheared("sheared");
    sheared.document["frames"][1]["transform_matrix"][0][1] = 7.5;
    expect_problem(sheared.problem(), "frame 1: transform_matrix is not a rotation");

    expect_problem(NerfFolder("few", 2).problem(), "2 training view(s)");

    NerfFolder black("black");
    Image nothing = disk_image(24, 24, 0.0f);
    save_image(black.folder / "train/view_3.png", nothing);
    expect_problem(black.problem(), "the mask of 'train/view_3' is black");

    NerfFolder white("white");
    for (int i = 0; i < 4; ++i)
        save_image(white.folder / "train" / ("view_" + std::to_string(i) + ".png"),
                   disk_image(24, 24, 2.0f));
    expect_problem(white.problem(), "4 of 4 images have a mask that covers the whole image");

    NerfFolder cut("cut");
    for (int i = 0; i < 4; ++i)
        save_image(cut.folder / "train" / ("view_" + std::to_string(i) + ".png"),
                   disk_image(24, 24, 0.55f));
    expect_problem(cut.problem(), "cut off at the edge of every image");

    NerfFolder repeated("repeated");
    for (json& frame : repeated.document["frames"])
        frame["transform_matrix"] = repeated.document["frames"][0]["transform_matrix"];
    expect_problem(repeated.problem(), "all cameras are at the same position");

    NerfFolder inverse("inverse");
    for (json& frame : inverse.document["frames"]) {
        json& rows = frame["transform_matrix"];
        Mat4 pose(1.0f);
        for (int row = 0; row < 4; ++row)
            for (int column = 0; column < 4; ++column)
                pose[column][row] = rows[row][column].get<float>();
        rows = rows_of(glm::inverse(pose));
    }
    expect_problem(inverse.problem(), "camera-to-world matrices are required");

    for (const auto& [scale, offset, words] :
         {std::tuple(1e-9, 0.0, "units; scale the camera positions"),
          std::tuple(1e30, 0.0, "units; scale the camera positions"),
          std::tuple(1.0, 5.4e6, "subtract the mean position")}) {
        NerfFolder placed("placed");
        for (json& frame : placed.document["frames"])
            for (int row = 0; row < 3; ++row) {
                json& value = frame["transform_matrix"][row][3];
                value = value.get<double>() * scale + offset;
            }
        expect_problem(placed.problem(), words);
    }

    NerfFolder unmasked("unmasked");
    Image opaque(24, 24, 3, 1.0f);
    for (int y = 8; y < 16; ++y)
        for (int x = 6; x < 14; ++x)
            opaque.at(x, y, 1) = 0.3f;
    save_image(unmasked.folder / "train/view_2.png", opaque);
    expect_problem(unmasked.problem(), "'train/view_2' has no mask, but other images have one");

    DatasetOptions elsewhere;
    elsewhere.images = "elsewhere";
    expect_problem(NerfFolder("elsewhere").problem(elsewhere),
                   "--images: is only for COLMAP and LLFF");

    NerfFolder outside("outside");
    outside.document["frames"][0]["file_path"] = "../secret.png";
    expect_problem(outside.problem(), "is not inside");

    NerfFolder broken("broken");
    fs::create_directories(broken.folder / "masks");
    write_atomically(broken.folder / "masks/view_0.png", std::string_view("no picture"));
    expect_problem(broken.problem(), "masks/view_0.png");

    DatasetOptions sideways;
    sideways.up = "w";
    expect_problem(NerfFolder("up").problem(sideways), "--up: expected");
    NerfFolder nothing_there("nothing");
    EXPECT_THROW(load_dataset(nothing_there.folder / "train"), InputError);
    EXPECT_THROW(load_dataset(nothing_there.folder / "absent"), InputError);
}

TEST(Dataset, BackgroundColourMakesAMask) {
    NerfFolder plain("plain");
    for (int i = 0; i < 4; ++i) {
        Image image(24, 24, 3, 1.0f);
        for (int y = 8; y < 16; ++y)
            for (int x = 6; x < 14; ++x)
                image.at(x, y, 1) = 0.3f;
        save_image(plain.folder / "train" / ("view_" + std::to_string(i) + ".png"), image);
    }
    const auto covered = [](const Dataset& dataset) {
        float sum = 0;
        for (int y = 0; y < 24; ++y)
            for (int x = 0; x < 24; ++x)
                sum += dataset.train[0].image.at(x, y, 3);
        return sum;
    };
    DatasetOptions options;
    options.background = Vec3(1);
    EXPECT_EQ(covered(plain.load(options)), 64.0f);
    // Without the option, the plain background is detected.
    const Dataset found = plain.load();
    EXPECT_EQ(covered(found), 64.0f);
    EXPECT_EQ(found.masks, "the detected plain background");
    for (int i = 0; i < 4; ++i) {
        Image image(24, 24, 3);
        for (int y = 0; y < 24; ++y)
            for (int x = 0; x < 24; ++x)
                image.at(x, y, 1) = static_cast<float>((x + y) % 8) / 8;
        save_image(plain.folder / "train" / ("view_" + std::to_string(i) + ".png"), image);
    }
    expect_problem(plain.problem(), "covers the whole image (masks: none)");
}

/// Returns options that say that +Y is up in the dataset.
DatasetOptions upright_options() {
    DatasetOptions options;
    options.up = "y";
    return options;
}

json nerfstudio_document(const std::vector<Camera>& cameras) {
    json document = {{"fl_x", 30.0},
                     {"fl_y", 28.0},
                     {"cx", 15.0},
                     {"cy", 9.5},
                     {"w", 32},
                     {"h", 20},
                     {"k1", 0.1},
                     {"k2", 0.02},
                     {"p1", 0.01},
                     {"p2", -0.02},
                     {"camera_model", "OPENCV"},
                     {"frames", json::array()}};
    for (const Camera& camera : cameras)
        document["frames"].push_back({{"file_path", "images/" + camera.name + ".png"},
                                      {"mask_path", "cut/" + camera.name + ".png"},
                                      {"transform_matrix", rows_of(camera.camera_to_world)}});
    return document;
}

TEST(Dataset, NerfstudioUndistortsImageAndMask) {
    const fs::path folder = fresh_folder("studio");
    fs::create_directories(folder / "images");
    fs::create_directories(folder / "cut");
    const auto cameras = ring_of_cameras(4);
    const json document = nerfstudio_document(cameras);
    write_atomically(folder / "transforms.json", std::string_view(document.dump()));

    Lens lens;
    lens.width = 32;
    lens.height = 20;
    lens.focal_x = 30;
    lens.focal_y = 28;
    lens.centre_x = 15;
    lens.centre_y = 9.5;
    lens.radial = {0.1, 0.02};
    lens.tangential = {0.01, -0.02};
    // A ramp in the ideal image, as seen through the lens, must be restored.
    Image bent(32, 20, 3), mask(32, 20, 1);
    const auto ideal_column = [&](double u, double v) {
        double x = (u - lens.centre_x) / lens.focal_x, y = (v - lens.centre_y) / lens.focal_y;
        for (int i = 0; i < 50; ++i) {
            const glm::dvec2 miss = glm::dvec2(u, v) - lens.project(x, y);
            x += miss.x / lens.focal_x;
            y += miss.y / lens.focal_y;
        }
        return x * lens.focal_x + 16;
    };
    for (int y = 0; y < 20; ++y) {
        for (int x = 0; x < 32; ++x) {
            for (int c = 0; c < 3; ++c)
                bent.at(x, y, c) =
                    linear_to_srgb(static_cast<float>(ideal_column(x + 0.5, y + 0.5) / 32));
            mask.at(x, y, 0) = x > 4 && x < 27 && y > 3 && y < 16 ? 1.0f : 0.0f;
        }
    }
    for (const Camera& camera : cameras) {
        save_image(folder / "images" / (camera.name + ".png"), bent, 16);
        save_image(folder / "cut" / (camera.name + ".png"), mask);
    }
    const Dataset dataset = load_dataset(folder, upright_options());
    EXPECT_EQ(dataset.kind, DatasetKind::nerfstudio);
    EXPECT_EQ(dataset.masks, "mask_path");
    ASSERT_EQ(dataset.train.size(), 4u);
    const Photograph& view = dataset.train[0];
    EXPECT_NEAR(view.camera.field_of_view_x, 2 * std::atan(16.0 / 30.0), 1e-5);
    int compared = 0;
    for (int y = 0; y < 20; ++y) {
        for (int x = 0; x < 32; ++x) {
            if (view.image.at(x, y, 3) < 1) continue;
            EXPECT_NEAR(view.image.at(x, y, 1), (x + 0.5) / 32, 2e-3) << x << ' ' << y;
            ++compared;
        }
    }
    EXPECT_GT(compared, 150);
}

/// Returns these cameras in COLMAP's text format.
std::string colmap_images(const std::vector<Camera>& cameras) {
    std::string text = "# comment\n";
    int id = 1;
    for (const Camera& camera : cameras) {
        Mat3 rotation(camera.camera_to_world);
        rotation[1] = -rotation[1];
        rotation[2] = -rotation[2];
        rotation = glm::transpose(rotation);
        const Vec3 t = -(rotation * camera.position());
        // Quaternion of a rotation matrix whose trace is not -1.
        const float w2 = 1 + rotation[0][0] + rotation[1][1] + rotation[2][2];
        EXPECT_GT(w2, 1e-4f);
        const float w = 0.5f * std::sqrt(w2);
        text += std::to_string(id++) + " " + std::to_string(w) + " " +
                std::to_string((rotation[1][2] - rotation[2][1]) / (4 * w)) + " " +
                std::to_string((rotation[2][0] - rotation[0][2]) / (4 * w)) + " " +
                std::to_string((rotation[0][1] - rotation[1][0]) / (4 * w)) + " " +
                std::to_string(t.x) + " " + std::to_string(t.y) + " " + std::to_string(t.z) +
                " 7 " + camera.name + ".png\n\n";
    }
    return text;
}

TEST(Dataset, ColmapTextAndBinaryAgree) {
    const fs::path folder = fresh_folder("colmap");
    fs::create_directories(folder / "sparse/0");
    fs::create_directories(folder / "images");
    std::vector<Camera> cameras;
    for (const float azimuth : {0.3f, 0.9f, 1.5f, 2.1f})
        cameras.push_back(orbit_camera(Vec3(0), 4, azimuth, 0.3f, 2 * std::atan(12.0f / 30.0f)));
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        cameras[i].name = "v" + std::to_string(i);
        save_image(folder / "images" / (cameras[i].name + ".png"), disk_image(24, 24));
    }
    write_atomically(folder / "sparse/0/cameras.txt",
                     std::string_view("# x\n7 PINHOLE 24 24 30 30 12 12\n"));
    write_atomically(folder / "sparse/0/images.txt", std::string_view(colmap_images(cameras)));
    const Dataset text = load_dataset(folder);
    EXPECT_EQ(text.kind, DatasetKind::colmap);
    ASSERT_EQ(text.train.size(), 4u);
    for (std::size_t i = 0; i < 4; ++i)
        EXPECT_LT(glm::distance(text.train[i].camera.position(), cameras[i].position()), 1e-4f);

    // The same values in COLMAP's binary layout.
    Bytes camera_bytes, image_bytes;
    const auto put = [](Bytes& to, const auto& value) {
        const auto* from = reinterpret_cast<const std::uint8_t*>(&value);
        to.insert(to.end(), from, from + sizeof(value));
    };
    put(camera_bytes, std::uint64_t{1});
    put(camera_bytes, std::uint32_t{7});
    put(camera_bytes, std::int32_t{1});
    put(camera_bytes, std::uint64_t{24});
    put(camera_bytes, std::uint64_t{24});
    for (const double value : {30.0, 30.0, 12.0, 12.0})
        put(camera_bytes, value);
    put(image_bytes, std::uint64_t{4});
    std::istringstream lines(colmap_images(cameras));
    for (std::string line; std::getline(lines, line);) {
        if (line.empty() || line[0] == '#') continue;
        std::istringstream words(line);
        std::uint32_t id = 0;
        words >> id;
        put(image_bytes, id);
        for (int i = 0; i < 7; ++i) {
            double value = 0;
            words >> value;
            put(image_bytes, value);
        }
        std::uint32_t lens = 0;
        std::string name;
        words >> lens >> name;
        put(image_bytes, lens);
        image_bytes.insert(image_bytes.end(), name.begin(), name.end());
        image_bytes.push_back(0);
        put(image_bytes, std::uint64_t{1});
        image_bytes.insert(image_bytes.end(), 24, 0);
    }
    fs::remove_all(folder / "sparse");
    fs::create_directories(folder / "sparse");
    write_atomically(folder / "sparse/cameras.bin", std::span<const std::uint8_t>(camera_bytes));
    write_atomically(folder / "sparse/images.bin", std::span<const std::uint8_t>(image_bytes));
    const Dataset binary = load_dataset(folder);
    ASSERT_EQ(binary.train.size(), 4u);
    for (std::size_t i = 0; i < 4; ++i)
        EXPECT_EQ(binary.train[i].camera.camera_to_world, text.train[i].camera.camera_to_world);

    image_bytes.resize(image_bytes.size() - 30);
    write_atomically(folder / "sparse/images.bin", std::span<const std::uint8_t>(image_bytes));
    EXPECT_THROW(load_dataset(folder), InputError);
}

TEST(Dataset, LlffPoses) {
    const fs::path folder = fresh_folder("llff");
    fs::create_directories(folder / "images");
    const auto cameras = ring_of_cameras(4);
    std::string header = "{'descr': '<f8', 'fortran_order': False, 'shape': (4, 17), }";
    header.resize(117, ' ');
    header += '\n';
    Bytes bytes{0x93, 'N', 'U', 'M', 'P', 'Y', 1, 0, static_cast<std::uint8_t>(header.size()), 0};
    bytes.insert(bytes.end(), header.begin(), header.end());
    for (const Camera& camera : cameras) {
        const Mat4& pose = camera.camera_to_world;
        const std::array<double, 3> size{20, 32, 40};
        for (int r = 0; r < 3; ++r) {
            for (const double value :
                 {-static_cast<double>(pose[1][r]), static_cast<double>(pose[0][r]),
                  static_cast<double>(pose[2][r]), static_cast<double>(pose[3][r]),
                  size[static_cast<std::size_t>(r)]}) {
                const auto* from = reinterpret_cast<const std::uint8_t*>(&value);
                bytes.insert(bytes.end(), from, from + 8);
            }
        }
        bytes.insert(bytes.end(), 16, 0);
        save_image(folder / "images" / (camera.name + ".png"), disk_image(32, 20));
    }
    write_atomically(folder / "poses_bounds.npy", std::span<const std::uint8_t>(bytes));
    const Dataset dataset = load_dataset(folder, upright_options());
    EXPECT_EQ(dataset.kind, DatasetKind::llff);
    auto wanted = cameras;
    for (Camera& camera : wanted)
        camera.field_of_view_x = 2 * std::atan(16.0f / 40.0f);
    expect_cameras(dataset.train, wanted);
    fs::remove(folder / "images/view_1.png");
    EXPECT_THROW(load_dataset(folder), InputError);
}

TEST(Dataset, HoldsOutEveryEighthViewAndTakesFewer) {
    NerfFolder nerf("split", 20);
    nerf.load();  // writes the file
    fs::rename(nerf.folder / "transforms_train.json", nerf.folder / "transforms.json");
    const Dataset dataset = load_dataset(nerf.folder);
    EXPECT_EQ(dataset.kind, DatasetKind::nerfstudio);
    EXPECT_EQ(dataset.test.size(), 2u);
    EXPECT_EQ(dataset.train.size(), 18u);
    DatasetOptions fewer;
    fewer.max_views = 9;
    EXPECT_EQ(load_dataset(nerf.folder, fewer).train.size(), 9u);
    // The cameras are upright in a world where +Z is up, which is detected.
    EXPECT_LT(glm::length(dataset.world_from_dataset * Vec3(0, 0, 1) - Vec3(0, 1, 0)), 1e-5f);
}

TEST(Orientation, TurnsImagesAsExifSays) {
    Image stored(3, 2, 1);
    for (int i = 0; i < 6; ++i)
        stored.pixels[static_cast<std::size_t>(i)] = static_cast<float>(i);
    const Image turned = oriented(stored, 6);  // a quarter turn clockwise
    ASSERT_EQ(turned.width, 2);
    ASSERT_EQ(turned.height, 3);
    EXPECT_EQ(turned.pixels, (std::vector<float>{3, 0, 4, 1, 5, 2}));
    EXPECT_EQ(oriented(stored, 3).pixels, (std::vector<float>{5, 4, 3, 2, 1, 0}));
    EXPECT_EQ(oriented(stored, 8).pixels, (std::vector<float>{2, 5, 1, 4, 0, 3}));
}

}  // namespace
}  // namespace item3d
